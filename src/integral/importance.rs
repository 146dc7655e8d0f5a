//! Importance sampling.
//!
//! ```text
//! ⟨I⟩ = f(ξ)/p(ξ),   ξ ~ p > 0 wherever f ≠ 0,        V = ∫ f²/p dμ − I²
//! ```
//!
//! p = |f|/∫|f| makes V least, and 0 for f of one sign. Fails, even with infinite variance, where p is small and f is not: combine techniques there
//! ([`Combined`](super::Combined)). Reference: Kahn, Marshall, *Methods of reducing sample size in Monte Carlo computations*, Oper. Res. 1 (1953) 263.

use super::Density;
use super::predict::{Predict, density_moments};
use super::secondary::Primary;
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Value;
use std::fmt::Debug;

/// f(ξ)/p(ξ) with a density p of your choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Importance<P>(pub P);

impl<D: Domain, V: Value, P: Density<D::Point> + Clone + Debug> Primary<D, V> for Importance<P> {
    #[inline]
    fn score<S: Sampler>(&self, _: &D, f: &impl Fn(&D::Point) -> V, u: &mut S) -> V {
        let node = self.0.sample(u);
        f(&node.point).scale(node.weight)
    }
}

impl<D: Domain, V: Value, P: Density<D::Point> + Clone + Debug> Predict<D, V> for Importance<P> {
    fn moments(&self, _: &D, nodes: &[Node<D::Point>], f: &dyn Fn(&D::Point) -> V) -> Result<(V, V), Error> {
        Ok(density_moments(nodes, f, |x| self.0.pdf(x)))
    }
}
