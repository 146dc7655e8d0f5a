//! The collision estimator.
//!
//! ```text
//! Y = Σ_{n=0}^{N} W_n g(X_n),        E Y = f(X₀)                                         theory (4.2.1)
//! ```
//!
//! Derivation: f = Σ_n Tⁿg, and E[W_n g(X_n)] = (Tⁿg)(X₀) by induction on the law of a step, E[W φ(Y)] = Tφ. Terms add up under (S) support,
//! (A) absolute convergence, (E) termination. n = 0 belongs to the sum (theory (2.2.3)).
//!
//! Wins when g is spread over the domain; each walk scores at all its vertices. Fails when walks rarely find g: use next event there. Variance
//! is finite iff ρ(K²/π) < 1 (theory (4.3.1)). Reference: Spanier, Gelbard, *Monte Carlo principles and neutron transport problems* (1969), §2.4.

use super::{Arrival, Scoring, Visit, collide};
use crate::equation::Equation;
use crate::kernel::Operator;
use crate::source::Source;
use crate::value::Weight;
use crate::walk::Observer;

/// Score W g(x) at every vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Collision;

impl<G, K> Scoring<G, K> for Collision
where
    G: Source,
    K: Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    #[inline]
    fn arrival<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        _: Arrival<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        *score += collide(equation, visit, 1.0, observer);
    }
}
