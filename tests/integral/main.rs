//! Plain integrals: lecture problems and slips, variance laws, rates, coverage, refusals; Array-RQMC.

#[path = "../sampling/any.rs"]
mod any;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/erased.rs"]
mod erased;

mod array;
mod lectures;
mod rates;
mod refusals;
mod sequences;
mod variances;

use fredholm::Estimate;
use fredholm::statistics::{Measured, Study};

/// (mean, error, freedom) as the budget takes it.
fn stated(e: &Estimate) -> (f64, f64, f64) {
    (e.value, e.std_error.unwrap(), e.degrees_of_freedom as f64)
}

/// A measured number; repetitions are so many that Student's quantile is the normal one.
fn measured(m: Measured) -> (f64, f64, f64) {
    (m.value, m.std_error, 1e6)
}

/// Repeats a solve, by seeds.
fn study(truth: f64, repetitions: u64, solve: &(dyn Fn(u64) -> Estimate + Sync)) -> Study {
    Study::run(truth, repetitions, |seed| Ok(solve(seed))).unwrap()
}
