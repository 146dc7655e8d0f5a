//! Distributions by inversion: each a map from uniform numbers, its density beside it, and the way back.
//!
//! | distribution | of | density ∝ |
//! |---|---|---|
//! | [`PiecewiseConstant`], [`PiecewiseLinear`] | numbers | a table |
//! | [`PiecewiseConstant2d`] | points of a rectangle | a table: marginal × conditional |
//! | [`Discrete`], [`Alias`] | indices | weights; in logarithmic, or constant time |
//! | [`Power`], [`Exponential`] | numbers | xⁿ, e^{−λx} |
//! | [`UniformDisk`], [`UniformTriangle`] | points | 1 |
//! | [`UniformSphere`], [`UniformHemisphere`], [`UniformCone`] | directions | 1 |
//! | [`CosineHemisphere`], [`HenyeyGreenstein`] | directions | cos θ, (1 + g² − 2g cos θ)^{−3/2} |
//!
//! Inversion, not rejection: one point of the unit cube gives one point, near points go to near points, and low discrepancy survives. The
//! axis of directions is (0, 0, 1).

mod directions;
mod discrete;
mod flat;
mod line;
mod linear;
mod plane;
mod steps;

pub use directions::{CosineHemisphere, HenyeyGreenstein, UniformCone, UniformHemisphere, UniformSphere};
pub use discrete::{Alias, Discrete};
pub use flat::{UniformDisk, UniformTriangle};
pub use line::{Exponential, Power};
pub use linear::PiecewiseLinear;
pub use plane::PiecewiseConstant2d;
pub use steps::PiecewiseConstant;

use crate::error::Error;

/// A random variable as a map from the unit cube.
///
/// Law: for u uniform in (0, 1) or (0, 1)², `sample(u)` has the density `pdf`; `pdf(sample(u))` is positive.
pub trait Distribution {
    /// The uniform numbers consumed: `f64` or `[f64; 2]`.
    type Unit;
    /// What is drawn.
    type Point;

    /// The point that u goes to.
    fn sample(&self, u: Self::Unit) -> Self::Point;

    /// The density there; 0 outside the support.
    fn pdf(&self, x: &Self::Point) -> f64;
}

/// A distribution whose map can be inverted.
///
/// Law: `invert(sample(u)) = u` up to rounding.
pub trait Inverse: Distribution {
    /// The u that goes to x; `None` outside the support.
    fn invert(&self, x: &Self::Point) -> Option<Self::Unit>;
}

/// Cumulative sums of weights, from 0 to exactly 1, and their total.
fn cumulative(parameter: &'static str, weights: impl IntoIterator<Item = f64>) -> Result<(Vec<f64>, f64), Error> {
    let (mut sums, mut sum) = (vec![0.0], 0.0);
    for w in weights {
        if !(w >= 0.0 && w.is_finite()) {
            return Err(Error::invalid(parameter, w, "must be finite and not negative"));
        }
        sum += w;
        sums.push(sum);
    }
    if !(sum > 0.0 && sum.is_finite()) {
        return Err(Error::invalid("sum of the weights", sum, "must be positive and finite: something must have weight"));
    }
    // x/x is 1 without rounding: whatever follows the last weight has probability 0
    sums.iter_mut().for_each(|s| *s /= sum);
    Ok((sums, sum))
}

/// The bin of positive probability with `sums[k]` ≤ u < `sums[k + 1]`; the last such bin for u ≥ 1, the first for u ≤ 0.
fn bin(sums: &[f64], u: f64) -> usize {
    // from below 1, so that the search ends before bins of probability 0 at the end; equal sums are bins of probability 0, passed over
    let u = u.clamp(0.0, 1.0 - f64::EPSILON / 2.0);
    sums.partition_point(|s| *s <= u).saturating_sub(1)
}

/// Refuses ends of cells that do not increase.
fn increasing(parameter: &'static str, edges: &[f64]) -> Result<(), Error> {
    if let Some(e) = edges.iter().find(|e| !e.is_finite()) {
        return Err(Error::invalid(parameter, *e, "must be finite"));
    }
    match edges.windows(2).find(|pair| !(pair[0] < pair[1])) {
        Some(pair) => Err(Error::invalid(parameter, pair[1], "must be greater than the one before")),
        None => Ok(()),
    }
}

/// Refuses lists of the wrong length.
fn matching(parameter: &'static str, count: usize, expected: usize, requirement: &'static str) -> Result<(), Error> {
    if count == expected { Ok(()) } else { Err(Error::invalid(parameter, count as f64, requirement)) }
}
