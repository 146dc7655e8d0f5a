//! Walks in both directions joined; estimators combined, debiased, and driven by Metropolis' rule.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/problems.rs"]
mod problems;

mod combination;
mod debias;
mod equations;
mod exact;
mod joined;
mod metropolis;
mod optimal;

use fredholm::{Equation, Estimate, IntervalEquation};
use std::sync::Arc;

type Source = Arc<dyn Fn(f64) -> f64 + Send + Sync>;
type Kernel = Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>;

/// (mean, error, freedom) as the budget takes it.
fn stated(e: &Estimate) -> (f64, f64, f64) {
    // no error: nothing met K, as at the start of a Volterra equation, where f = g must come out exactly
    (e.value, e.std_error.unwrap_or(0.0), e.degrees_of_freedom as f64)
}

/// One type for all equations on an interval: every method is compiled once.
fn of(
    (a, b): (f64, f64),
    g: Source,
    k: Kernel,
) -> IntervalEquation<f64, f64, impl Fn(&f64) -> f64 + Send + Sync + Clone, impl Fn(&f64, &f64) -> f64 + Send + Sync + Clone> {
    Equation::on_interval(a..=b, move |x| g(x), move |x, y| k(x, y))
}

/// f = g + ∫K f on an interval.
macro_rules! erased {
    ($interval:expr, $g:expr, $k:expr) => {
        $crate::of($interval, std::sync::Arc::new($g), std::sync::Arc::new($k))
    };
}
use erased;
