//! Scores of one point for many cells.

use crate::error::Error;
use crate::estimator::{Estimator, Score};
use crate::sampling::{Purpose, Sampler};
use crate::value::Value;

/// An unbiased estimator of all cells at once: one point of the cube scores in any of them.
///
/// Law: over uniform points, `E[Σ of what is added to cell j]` is the value of cell j.
///
/// An [`Estimator`], which knows one cell at a time, is a tally: one coordinate of the point chooses the cell.
pub trait Tally: Send + Sync {
    /// What is estimated.
    type Value: Value;
    /// Memory reused from point to point; what is left in it never matters.
    type Scratch: Default;

    /// Number of cells.
    fn cells(&self) -> usize;

    /// Calls `add(cell, score)` for the cells that the point scores in; returns steps and evaluations.
    fn tally<S: Sampler>(&self, u: &mut S, scratch: &mut Self::Scratch, add: &mut impl FnMut(usize, Self::Value)) -> (u64, u64);

    /// Why a score of the point is not finite, from a fresh cursor on it.
    fn explain<S: Sampler>(&self, u: &mut S) -> Option<Error> {
        let _ = u;
        None
    }
}

/// The cell that a point chooses, each with probability 1/cells.
pub(crate) fn choose<S: Sampler>(cells: usize, u: &mut S) -> usize {
    // walks start once: no walk reads these coordinates, whereas a fresh cursor may stand at those of the start
    u.seek(1, Purpose::Start);
    ((u.next_1d() * cells as f64) as usize).min(cells - 1)
}

impl<T: Estimator> Tally for T {
    type Value = T::Value;
    type Scratch = T::Scratch;

    fn cells(&self) -> usize {
        Estimator::cells(self)
    }

    #[inline]
    fn tally<S: Sampler>(&self, u: &mut S, scratch: &mut T::Scratch, add: &mut impl FnMut(usize, T::Value)) -> (u64, u64) {
        let cells = Estimator::cells(self);
        let cell = choose(cells, u);
        let score = self.score(cell, u, scratch);
        add(cell, score.value.scale(cells as f64));
        (score.steps, score.evaluations)
    }

    fn explain<S: Sampler>(&self, u: &mut S) -> Option<Error> {
        let cell = choose(Estimator::cells(self), u);
        Estimator::explain(self, cell, 0, u)
    }
}

/// A [`Tally`] as an [`Estimator`]: of what a point scores, what falls into the cell that was asked for.
///
/// ```
/// use fredholm::{Equation, Forward, detector::Bins, estimator::{Estimator, OneCell}, sampling::{Pcg, Sequence}};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let bins = Bins::new(0.0..=1.0, 4);
/// let query = eq.seen_by(&bins);
/// let walk = OneCell(query.tally(&Forward::new())?);
/// let scores: Vec<f64> = (0..4).map(|cell| walk.score(cell, &mut Pcg::new(1).point(0, 0, 5), &mut Vec::new()).value).collect();
/// // one walk, and every vertex of it falls into one cell
/// assert!(scores.iter().any(|score| *score > 0.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct OneCell<T>(pub T);

impl<T: Tally> Estimator for OneCell<T> {
    type Value = T::Value;
    type Scratch = T::Scratch;

    fn cells(&self) -> usize {
        self.0.cells()
    }

    #[inline]
    fn score<S: Sampler>(&self, cell: usize, u: &mut S, scratch: &mut T::Scratch) -> Score<T::Value> {
        let mut value = T::Value::ZERO;
        let (steps, evaluations) = self.0.tally(u, scratch, &mut |at, score| {
            // a score that is not finite is an error wherever it falls
            if at == cell || !score.all_finite() {
                value += score;
            }
        });
        Score { value, steps, evaluations }
    }

    fn explain<S: Sampler>(&self, _: usize, _: u64, u: &mut S) -> Option<Error> {
        self.0.explain(u)
    }
}
