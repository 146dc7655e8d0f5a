//! The absorption estimator.
//!
//! ```text
//! Y = W_N g(X_N) / (1 − P(X_N)),        P = probability to go on, method and kernel together            theory (4.2.2)
//! ```
//!
//! Derivation: the walk ends at X_n with probability 1 − P(X_n) given that it got there; dividing by it gives the expectation of the collision
//! score W_n g(X_n) of each vertex.
//!
//! Wins near a zero-variance walk (theory §4.9) and when g is expensive: one evaluation a walk. Fails where P is close to 1 or g vanishes mostly.
//! Unbiased only if P < 1 wherever g ≠ 0. Reference: Spanier, Gelbard (1969), §2.4; Forsythe, Leibler, *Matrix inversion by a Monte Carlo
//! method*, MTAC 4 (1950) 127.

use super::{Scoring, Visit, collide};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::Absorbing;
use crate::source::Source;
use crate::value::Weight;
use crate::walk::{Ending, Observer};

/// Score W g/(1 − P) where the walk ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Absorption;

impl<G, K> Scoring<G, K> for Absorption
where
    G: Source,
    K: Absorbing + crate::kernel::Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    #[inline]
    fn end<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        let going_on = visit.survival * (1.0 - equation.kernel().absorption(&visit.point));
        *score += collide(equation, visit, 1.0 / (1.0 - going_on), observer);
    }

    fn validate<E: Ending<K>>(&self, equation: &Equation<G, K>, ending: &E) -> Result<(), Error> {
        if let Some(depth) = ending.cut() {
            return Err(Error::invalid(
                "depth",
                depth as f64,
                "the absorption estimator needs walks that end at random, not at a fixed depth",
            ));
        }
        if equation.kernel().never_absorbs() && !ending.always_may_end() {
            return Err(Error::invalid(
                "absorption probability",
                0.0,
                "the absorption estimator needs walks that may end at every vertex: use `.roulette(Roulette::constant(p))` with p < 1",
            ));
        }
        Ok(())
    }
}
