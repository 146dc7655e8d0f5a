//! Forward walks and profiles: the zoo, both directions, bands, bias, bits, bad input.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/erased.rs"]
mod erased;
#[path = "../common/problems.rs"]
mod problems;

mod both_directions;
mod profiles;
mod refusals;
mod same_bits;
mod zoo;

use common::Budget;
use fredholm::{Estimate, Value};

const PILOT: u64 = 16384;

/// Walks for a standard error that sees a bias of `margin`, from a pilot of another seed.
fn enough<V: Value>(budget: &Budget, pilot: &Estimate<V>, margin: f64) -> u64 {
    let sigma = pilot.variance().unwrap().magnitude().sqrt();
    // 2.5: the pilot's variance is itself uncertain, most of all where tails are heavy
    ((budget.detectable() * sigma / margin).powi(2) * 2.5).clamp(4096.0, 4e6) as u64
}

fn judge(budget: &mut Budget, what: &str, e: &Estimate, truth: f64, margin: f64) -> Result<(), String> {
    budget.mean(what, (e.value, e.std_error.unwrap(), e.degrees_of_freedom as f64), truth, margin)
}
