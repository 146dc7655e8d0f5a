//! The variance of an estimator by its formula, with quadrature for the integrals: what theory says, beside what was measured.

use super::{Gauss, Integral, Primary};
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::source::Source;
use crate::value::Value;

/// A primary estimator with a formula for its variance.
pub trait Predict<D: Domain, V: Value>: Primary<D, V> {
    /// Mean and variance of a score, with `nodes` as the rule for integrals over the domain. Infinite where a density misses a node with f ≠ 0.
    ///
    /// # Errors
    /// [`Error::Invalid`] where integrals over the domain do not tell.
    fn moments(&self, domain: &D, nodes: &[Node<D::Point>], f: &dyn Fn(&D::Point) -> V) -> Result<(V, V), Error>;
}

/// A method with a formula for the variance of its estimate.
#[diagnostic::on_unimplemented(
    message = "the variance of `{Self}` has no formula here",
    note = "variances are predicted for independent points (`Pcg`): those of low-discrepancy points come from replicates"
)]
pub trait Predictable<D: Domain, G: Source> {
    /// Var Î.
    ///
    /// # Errors
    /// Those of the method and of the rule.
    fn predict(&self, integral: &Integral<D, G>, rule: &Gauss) -> Result<G::Value, Error>;
}

/// a²/p where a ≠ 0.
#[inline]
pub(super) fn square_over(a: f64, p: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a * a / p }
}

/// ∫ f dμ and ∫ (f/p − I)² p dμ: as ∫ f²/p − I² wherever the density covers f, without its cancellation.
pub(super) fn density_moments<X, V: Value>(nodes: &[Node<X>], f: &dyn Fn(&X) -> V, pdf: impl Fn(&X) -> f64) -> (V, V) {
    let mut mean = V::ZERO;
    for n in nodes {
        mean += f(&n.point).scale(n.weight);
    }
    let (mut variance, mut covered) = (V::ZERO, 0.0);
    for n in nodes {
        let (value, p) = (f(&n.point), pdf(&n.point));
        covered += p * n.weight;
        variance += value.zip(mean, |f, i| square_over(f - i * p, p)).scale(n.weight);
    }
    // where p has mass beyond the domain, scores are 0 there: (0 − I)² each; what rounding leaves is no mass
    let outside = if covered < 1.0 - 1e-13 { 1.0 - covered } else { 0.0 };
    (mean, variance + mean.map(|i| i * i * outside))
}
