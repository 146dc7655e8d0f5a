//! The plain primary estimator.
//!
//! ```text
//! ⟨I⟩ = f(ξ)/p(ξ),   ξ by the domain's own map (uniform where the volume is finite),        V = ∫ f²/p dμ − I²
//! ```
//!
//! Wins when f is nearly constant, or when nothing is known of it. Reference: Hammersley, Handscomb, *Monte Carlo methods* (1964), §5.1 (crude Monte
//! Carlo); Veach, *Robust Monte Carlo methods for light transport simulation* (1997), §2.4.

use super::predict::{Predict, density_moments};
use super::secondary::Primary;
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Value;

/// f(ξ)/p(ξ) with the domain's own density p.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plain;

impl<D: Domain, V: Value> Primary<D, V> for Plain {
    #[inline]
    fn score<S: Sampler>(&self, domain: &D, f: &impl Fn(&D::Point) -> V, u: &mut S) -> V {
        let node = domain.sample(u);
        f(&node.point).scale(node.weight)
    }
}

impl<D: Domain, V: Value> Predict<D, V> for Plain {
    fn moments(&self, domain: &D, nodes: &[Node<D::Point>], f: &dyn Fn(&D::Point) -> V) -> Result<(V, V), Error> {
        Ok(density_moments(nodes, f, |x| domain.density(x)))
    }
}
