//! Pictures of results: convergence, profiles, comparisons. SVG and PNG, without fonts or libraries of the system.
//!
//! | plot | shows |
//! |---|---|
//! | [`Convergence`] | error against walks or against time, log-log, with the slope −1/2 of Monte Carlo |
//! | [`Profile`] | estimates with error bars over curves, and their deviations in standard errors |
//! | [`Comparison`] | one number a method as horizontal bars on a log scale, such as efficiency |
//! | [`Scatter`] | point sets in the unit square, side by side |
//!
//! ```
//! # fn main() -> Result<(), fredholm::Error> {
//! use fredholm::plot::Convergence;
//! let errors = [(1e2, 3.1e-2), (1e3, 1.1e-2), (1e4, 2.9e-3), (1e5, 9.7e-4)];
//! # let folder = std::env::temp_dir().join("fredholm-plot-doctest");
//! Convergence::against_samples("error of f(½)").series("collision", errors).save(folder.join("convergence.svg"))?;
//! # std::fs::remove_dir_all(folder).ok();
//! # Ok(())
//! # }
//! ```
//!
//! Every plot has `save` (the extension chooses SVG or PNG; missing folders are made), `to_svg` and `to_png`. What cannot be drawn is refused
//! with the series, the point and the number ([`Error::Unplottable`]); nothing is left out.
//!
//! Colours are those of Okabe, Ito, *Color universal design* (2008), which colour-blind readers tell apart; markers and dashes tell series apart
//! in grey. plotters draws the primitives; the axes are our own, because its charts have no minor ticks, powers of ten or outside legends.

mod axis;
mod comparison;
mod convergence;
mod drawing;
mod panel;
mod profile;
mod scatter;
mod style;

pub use comparison::Comparison;
pub use convergence::Convergence;
pub use profile::Profile;
pub use scatter::Scatter;

use crate::error::Error;

/// Refuses a number of a series.
fn check(
    series: &str,
    quantity: &'static str,
    requirement: &'static str,
    values: impl IntoIterator<Item = f64>,
    allowed: impl Fn(f64) -> bool,
) -> Result<(), Error> {
    match values.into_iter().enumerate().find(|(_, v)| !(v.is_finite() && allowed(*v))) {
        Some((i, value)) => Err(Error::Unplottable { series: series.to_owned(), quantity, at: format!("point {i}"), value, requirement }),
        None => Ok(()),
    }
}

/// Refuses plots of nothing.
fn some(parameter: &'static str, count: usize) -> Result<(), Error> {
    if count == 0 { Err(Error::invalid(parameter, 0.0, "there must be something to plot")) } else { Ok(()) }
}
