//! A walk as a function on the unit cube.

use super::backward::{Backward, start};
use super::driver::{Driver, End};
use super::replay::replay_on;
use super::{Ending, Scoring, Walk};
use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::{Equation, Query};
use crate::error::Error;
use crate::estimator::{Estimator, Score};
use crate::kernel::{Operator, Transition};
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::source::Source;
use crate::value::{Value, Weight};

/// A walk, bound to its equation and detector; see [`Query::estimator`].
#[derive(Debug)]
pub struct WalkEstimator<'a, G, K, D, C, E> {
    equation: &'a Equation<G, K>,
    detector: &'a D,
    walk: Walk<C, E, Pcg>,
}

impl<'a, G, K, D> Query<'a, G, K, D>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
{
    /// The walk as an unbiased [`Estimator`], to be combined with others or driven by [`Metropolis`](crate::estimator::Metropolis). Its sequence and budget are
    /// left behind: points come from whoever asks for scores.
    ///
    /// # Errors
    /// Whatever can be refused before the first walk; [`Error::Invalid`] for a fixed depth, which is biased: [`Debias`](crate::estimator::Debias) its levels.
    pub fn estimator<'q, C, E, Q>(&'q self, walk: &Walk<C, E, Q>) -> Result<WalkEstimator<'q, G, K, D, C, E>, Error>
    where
        C: Scoring<G, K>,
        E: Ending<K>,
        Q: Sequence,
    {
        contained(|| {
            let bound = WalkEstimator::bind(self, walk)?;
            if let Some(depth) = walk.ending.cut() {
                return Err(Error::invalid(
                    "depth",
                    depth as f64,
                    "a walk cut at a fixed depth is no unbiased estimator: use `Debias` with `Depths`",
                ));
            }
            Ok(bound)
        })
    }
}

impl<'a, G, K, D, C, E> WalkEstimator<'a, G, K, D, C, E>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    D: Detector<Point = G::Point>,
{
    /// Biased, if the walk is cut.
    pub(super) fn bind<Q: Sequence>(query: &'a Query<'_, G, K, D>, walk: &Walk<C, E, Q>) -> Result<Self, Error> {
        let (equation, detector) = (query.equation(), query.detector());
        walk.prepare(equation, detector)?;
        Ok(WalkEstimator { equation, detector, walk: walk.sequence(Pcg::default()) })
    }
}

impl<G, K, D, C, E> Estimator for WalkEstimator<'_, G, K, D, C, E>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    D: Detector<Point = G::Point>,
{
    type Value = G::Value;
    type Scratch = Vec<u32>;

    fn cells(&self) -> usize {
        self.detector.cells()
    }

    #[inline]
    fn score<S: Sampler>(&self, cell: usize, u: &mut S, ranks: &mut Vec<u32>) -> Score<G::Value> {
        let Walk { scoring, ending, max_steps, .. } = &self.walk;
        let mut errand = Backward { equation: self.equation, scoring };
        let driver = Driver { kernel: self.equation.kernel(), ending, max_steps: *max_steps };
        let mut value = G::Value::ZERO;
        let steps = driver.walk(&mut errand, &mut [start(self.detector, cell, 0, u)], ranks, &mut (), |walk| {
            // a walk without an end has no score
            value = if walk.end == End::TooLong { G::Value::from_components(|_| f64::NAN) } else { walk.score };
        });
        Score { value, steps, evaluations: steps + C::EVALUATIONS * (steps + 1) }
    }

    fn explain<S: Sampler>(&self, cell: usize, walk: u64, u: &mut S) -> Option<Error> {
        let (fault, trace) = replay_on(&self.walk, self.equation, self.detector, (cell, walk), u);
        let too_long = (trace.end == End::TooLong).then_some(Error::WalkTooLong { cell, walk, steps: self.walk.max_steps });
        fault.or(too_long)
    }
}
