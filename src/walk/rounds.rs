//! Progressive solving that the caller owns.

use super::run::{Checkpoint, Run};
use super::{Ending, Scoring};
use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{Operator, Transition};
use crate::sampling::Sequence;
use crate::source::Source;
use crate::statistics::Estimate;
use crate::value::Weight;

/// The state of knowledge after one more round.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Round<A> {
    /// 1, 2, 3, ….
    pub number: u64,
    /// Walks a cell so far.
    pub samples: u64,
    /// Share of the walk budget spent, in (0, 1].
    pub fraction: f64,
    /// The estimates so far, in the detector's shape.
    pub estimates: A,
}

/// An iterator over rounds of doubling size: 1024 walks a cell, then 2048, 4096, … until the budget of the [`Walk`](super::Walk) is spent. Detectors of
/// more than 1024 cells, such as images, begin with 16.
///
/// The sizes depend on nothing but the round's number, so the bits of a result do not depend on where a run was interrupted.
///
/// ```
/// use fredholm::{Equation, Walk};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let walk = Walk::collision().samples_per_cell(1 << 14);
/// let query = eq.at(0.5);
/// let mut first = query.rounds(&walk)?;
/// first.next().unwrap()?;
/// let saved = first.checkpoint();                       // serde, feature `serde`
/// let rest = query.rounds(&walk)?.resume(saved)?.last().unwrap()?;
/// assert_eq!(rest.estimates.value, query.solve(&walk)?.value);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Debug)]
pub struct Rounds<'a, G: Source, K, D, C, E, Q> {
    run: Run<'a, G, K, D, C, E, Q>,
    failed: bool,
}

impl<'a, G, K, D, C, E, Q> Rounds<'a, G, K, D, C, E, Q>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    pub(super) fn new(run: Run<'a, G, K, D, C, E, Q>) -> Self {
        Rounds { run, failed: false }
    }

    /// The state between two rounds.
    pub fn checkpoint(&self) -> Checkpoint<G::Value> {
        self.run.state.clone()
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the state was saved by another method or for another number of cells. The equation itself cannot be compared.
    pub fn resume(mut self, saved: Checkpoint<G::Value>) -> Result<Self, Error> {
        self.run.resume(saved)?;
        Ok(self)
    }

    /// The equation that is solved.
    pub fn equation(&self) -> &'a Equation<G, K> {
        self.run.equation()
    }
}

impl<'a, G, K, D, C, E, Q> Iterator for Rounds<'a, G, K, D, C, E, Q>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Item = Result<Round<D::Answer<Estimate<G::Value>>>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let budget = self.run.walk.samples;
        let done = self.run.done();
        if self.failed || done >= budget {
            return None;
        }
        let target = self.run.chunk.checked_shl(self.run.state.round() as u32).unwrap_or(budget).min(budget);
        if let Err(error) = contained(|| self.run.advance_round(target.max(done + 1))) {
            self.failed = true;
            return Some(Err(error));
        }
        Some(Ok(Round {
            number: self.run.state.round(),
            samples: self.run.done(),
            fraction: (self.run.done() as f64 / budget as f64).min(1.0),
            estimates: self.run.answer(),
        }))
    }
}
