//! Pairs of walks for [`Metropolis`](crate::estimator::Metropolis): one coordinate chooses where the backward walk starts, the forward walk scores where it ends.

use super::pair::{Cost, Memory, PairEstimator};
use super::{Connect, Meet};
use crate::error::Error;
use crate::estimator::{Estimator, Tally, choose};
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::sampling::Sampler;
use crate::source::{EmitPdf, Source};
use crate::value::{Value, Weight};
use crate::walk::Ending;

/// Pairs of walks that score in all cells they come to; see [`PairEstimator::shared`].
pub struct SharedPairs<'a, G: Source, K: HasAdjoint, D, E, F>(PairEstimator<'a, G, K, D, E, F>);

impl<G, K, D, E, F> std::fmt::Debug for SharedPairs<'_, G, K, D, E, F>
where
    G: Source,
    K: HasAdjoint,
{
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SharedPairs").finish_non_exhaustive()
    }
}

impl<'a, G, K, D, E, F> PairEstimator<'a, G, K, D, E, F>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
    E: Ending<K>,
    F: Ending<K::Adjoint>,
{
    /// The same pairs as a tally: forward walks score in any cell, and weights count on it. Those of a pilot, which are of single cells, do not: the heuristic's
    /// remain.
    #[must_use]
    pub fn shared(mut self) -> SharedPairs<'a, G, K, D, E, F> {
        self.tuned.clear();
        self.share = if D::EXTENDED { self.detector.cells() as u64 } else { 1 };
        SharedPairs(self)
    }
}

impl<G, K, D, E, F> Tally for SharedPairs<'_, G, K, D, E, F>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
    E: Ending<K>,
    F: Ending<K::Adjoint>,
{
    type Value = G::Value;
    type Scratch = Memory<G, K>;

    fn cells(&self) -> usize {
        self.0.detector.cells()
    }

    #[inline]
    fn tally<S: Sampler>(&self, u: &mut S, memory: &mut Memory<G, K>, add: &mut impl FnMut(usize, G::Value)) -> (u64, u64) {
        let cells = self.0.detector.cells();
        let cell = choose(cells, u);
        match self.0.pair(cell, u, memory, |j| add(j.cell, j.contribution.scale(j.weight * cells as f64))) {
            Ok(Cost { steps, joins }) => (steps, steps + joins),
            Err(_) => {
                add(cell, G::Value::from_components(|_| f64::NAN));
                (0, 0)
            }
        }
    }

    fn explain<S: Sampler>(&self, u: &mut S) -> Option<Error> {
        let cell = choose(self.0.detector.cells(), u);
        Estimator::explain(&self.0, cell, 0, u)
    }
}
