//! Progressive solving that the caller owns.

use super::checkpoint::Checkpoint;
use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::{Equation, Query};
use crate::error::Error;
use crate::value::Value;

/// The state of knowledge after one more round.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Round<A> {
    /// 1, 2, 3, ….
    pub number: u64,
    /// Walks so far: of every cell, or of all together where one walk serves them all.
    pub samples: u64,
    /// Share of the walk budget spent, in (0, 1].
    pub fraction: f64,
    /// The estimates so far, in the detector's shape.
    pub estimates: A,
}

/// A method that can be solved in rounds: a [`Walk`](super::Walk), or [`Forward`](super::Forward) walks.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not go in rounds on this equation",
    note = "`Walk` and `Forward` do; for other methods, raise the budget and solve again"
)]
pub trait Progressive<G, K, D: Detector> {
    /// The run in progress.
    type Run<'a>: InProgress
    where
        G: 'a,
        K: 'a,
        D: 'a;

    /// Before the first walk.
    ///
    /// # Errors
    /// Whatever can be refused there.
    fn begin<'a>(&self, equation: &'a Equation<G, K>, detector: &'a D) -> Result<Self::Run<'a>, Error>;
}

/// A run that [`Rounds`] drive.
pub trait InProgress {
    /// What is estimated.
    type Value: Value;
    /// Estimates in the detector's shape.
    type Answer;

    /// Walks that were asked for.
    fn budget(&self) -> u64;

    /// Walks of the first round.
    fn first(&self) -> u64;

    /// Walks so far, all replicates together.
    fn done(&self) -> u64;

    /// Goes on until there are `samples` walks, rounded up to the replicates.
    ///
    /// # Errors
    /// Those of a solve.
    fn advance(&mut self, samples: u64) -> Result<(), Error>;

    /// Everything found so far.
    fn state(&self) -> &Checkpoint<Self::Value>;

    /// The same, to go on from another.
    fn state_mut(&mut self) -> &mut Checkpoint<Self::Value>;

    /// The estimates so far.
    fn answer(&self) -> Self::Answer;
}

/// An iterator over rounds of doubling size: 1024 walks, then 2048, 4096, … until the budget of the method is spent; for every cell, or for all together where
/// one walk serves them all. Walks from more than 1024 cells, such as an image's, begin with 16.
///
/// The sizes depend on nothing but the round's number, so the bits of a result do not depend on where a run was interrupted.
///
/// ```
/// use fredholm::{Equation, Forward, Walk, detector::Bins};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let walk = Walk::collision().samples_per_cell(1 << 14);
/// let query = eq.at(0.5);
/// let mut first = query.rounds(&walk)?;
/// first.next().unwrap()?;
/// let saved = first.checkpoint();                       // serde, feature `serde`
/// let rest = query.rounds(&walk)?.resume(saved)?.last().unwrap()?;
/// assert_eq!(rest.estimates.value, query.solve(&walk)?.value);
/// // forward walks too
/// for round in eq.seen_by(&Bins::new(0.0..=1.0, 4)).rounds(&Forward::new())? {
///     println!("{}", round?.estimates[0]);
/// }
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Debug)]
pub struct Rounds<R> {
    run: R,
    failed: bool,
}

impl<G, K, D: Detector> Query<'_, G, K, D> {
    /// Solves in rounds that you own: leave the loop when you like, save the state, resume bit for bit.
    ///
    /// # Errors
    /// Whatever can be refused before the first walk.
    pub fn rounds<M: Progressive<G, K, D>>(&self, method: &M) -> Result<Rounds<M::Run<'_>>, Error> {
        Ok(Rounds { run: contained(|| method.begin(self.equation(), self.detector()))?, failed: false })
    }
}

impl<R: InProgress> Rounds<R> {
    /// The state between two rounds. After an error it has what was finished of the last one, and can be gone on with all the same.
    pub fn checkpoint(&self) -> Checkpoint<R::Value> {
        self.run.state().clone()
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the state was saved by another method or for another number of cells. The equation itself cannot be compared.
    pub fn resume(mut self, saved: Checkpoint<R::Value>) -> Result<Self, Error> {
        self.run.state_mut().resume(saved)?;
        Ok(self)
    }
}

impl<R: InProgress> Iterator for Rounds<R> {
    type Item = Result<Round<R::Answer>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let (budget, done) = (self.run.budget(), self.run.done());
        if self.failed || done >= budget {
            return None;
        }
        let round = self.run.state().round;
        let target = self.run.first().checked_shl(round as u32).unwrap_or(budget).min(budget);
        let advanced = contained(|| {
            self.run.advance(target.max(done + 1))?;
            self.run.state_mut().round = round + 1;
            Ok(self.run.answer())
        });
        let (samples, fraction) = (self.run.done(), (self.run.done() as f64 / budget as f64).min(1.0));
        self.failed = advanced.is_err();
        Some(advanced.map(|estimates| Round { number: round + 1, samples, fraction, estimates }))
    }
}
