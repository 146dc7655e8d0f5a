//! Fredholm integral equations of the second kind, f(x) = g(x) + ∫ K(x, y) f(y) dμ(y).

pub mod detector;
pub mod deterministic;
pub mod domain;
mod equation;
mod error;
pub mod kernel;
mod parallel;
pub mod sampling;
pub mod source;
pub mod statistics;
mod value;
pub mod walk;

pub use equation::{ClosureEquation, Equation, Everywhere, IntervalEquation, Method, Query};
pub use error::Error;
pub use statistics::Estimate;
pub use value::{GroupMatrix, Spectrum, Value, Weight};
pub use walk::Walk;
