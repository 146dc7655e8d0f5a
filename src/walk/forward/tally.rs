//! A forward walk as a function on the unit cube, scoring in all cells.

use super::Forward;
use super::errand::{Onward, born};
use super::scoring::ForwardScoring;
use super::trace::Recorder;
use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::{Equation, Query};
use crate::error::Error;
use crate::estimator::Tally;
use crate::kernel::{HasAdjoint, Operator, Transition};
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::source::Emit;
use crate::value::{Value, Weight};
use crate::walk::driver::{Driver, End};
use crate::walk::{Ending, Observer, Walk};

/// A forward walk, bound to its equation and detector; see [`Query::tally`].
pub struct ForwardTally<'a, G, K: HasAdjoint, D, C, E> {
    equation: &'a Equation<G, K>,
    adjoint: K::Adjoint,
    detector: &'a D,
    walk: Walk<C, E, Pcg>,
}

impl<G, K: HasAdjoint, D, C: std::fmt::Debug, E: std::fmt::Debug> std::fmt::Debug for ForwardTally<'_, G, K, D, C, E> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ForwardTally").field("walk", &self.walk).finish_non_exhaustive()
    }
}

impl<'a, G, K, D> Query<'a, G, K, D>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
{
    /// The forward walk as an unbiased [`Tally`] of all cells, to be driven by [`Metropolis`](crate::estimator::Metropolis) or, cell by cell
    /// ([`OneCell`](crate::estimator::OneCell)), combined with others. Its sequence and budget are left behind.
    ///
    /// ```
    /// use fredholm::{Equation, Forward, Walk, estimator::{Combination, OneCell}, domain::Interval, detector::Functional};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let h = Functional::new(Interval::from(0.0..=1.0), |x| 2.0 * x);
    /// let query = eq.seen_by(&h);
    /// let both = Combination::new()
    ///     .with(query.estimator(&Walk::collision())?)
    ///     .with(OneCell(query.tally(&Forward::new())?))
    ///     .solve()?;
    /// assert!(both[0].estimate.agrees_with(1.2, 5.0));
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// Whatever can be refused before the first walk; [`Error::Invalid`] for a fixed depth, which is biased.
    pub fn tally<'q, C, E, Q>(&'q self, walk: &Forward<C, E, Q>) -> Result<ForwardTally<'q, G, K, D, C, E>, Error>
    where
        C: ForwardScoring<G, K, D>,
        E: Ending<K::Adjoint>,
        Q: Sequence,
    {
        contained(|| {
            let (equation, detector, walk) = (self.equation(), self.detector(), walk.walk);
            equation.validate()?;
            detector.validate()?;
            let adjoint = equation.kernel().adjoint()?;
            walk.budgeted(equation, &adjoint, || None)?;
            if let Some(depth) = walk.ending.cut() {
                return Err(Error::invalid("depth", depth as f64, "a walk cut at a fixed depth is no unbiased estimator"));
            }
            Ok(ForwardTally { equation, adjoint, detector, walk: walk.sequence(Pcg::default()) })
        })
    }
}

impl<G, K, D, C, E> ForwardTally<'_, G, K, D, C, E>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
    C: ForwardScoring<G, K, D>,
    E: Ending<K::Adjoint>,
{
    fn walk<S: Sampler, O: Observer<G::State, K::Weight>>(
        &self,
        u: S,
        ranks: &mut Vec<u32>,
        observer: &mut O,
        mut add: impl FnMut(usize, G::Value),
    ) -> (u64, End) {
        let Walk { scoring, ending, max_steps, .. } = &self.walk;
        let add = |_, cell, score| add(cell, score);
        let mut errand = Onward { equation: self.equation, detector: self.detector, scoring, add };
        let driver = Driver { kernel: &self.adjoint, ending, max_steps: *max_steps };
        let mut end = End::Absorbed;
        let steps = driver.walk(&mut errand, &mut [born(self.equation.source(), 0, u)], ranks, observer, |walk| end = walk.end);
        (steps, end)
    }
}

impl<G, K, D, C, E> Tally for ForwardTally<'_, G, K, D, C, E>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
    C: ForwardScoring<G, K, D>,
    E: Ending<K::Adjoint>,
{
    type Value = G::Value;
    type Scratch = Vec<u32>;

    fn cells(&self) -> usize {
        self.detector.cells()
    }

    #[inline]
    fn tally<S: Sampler>(&self, u: &mut S, ranks: &mut Vec<u32>, add: &mut impl FnMut(usize, G::Value)) -> (u64, u64) {
        let (steps, end) = self.walk(u, ranks, &mut (), &mut *add);
        if end == End::TooLong {
            add(0, G::Value::from_components(|_| f64::NAN));
        }
        (steps, steps + self.walk.scoring.evaluations(self.detector) * (steps + 1))
    }

    fn explain<S: Sampler>(&self, u: &mut S) -> Option<Error> {
        let mut recorder = Recorder::new(0);
        let (_, end) = self.walk(u, &mut Vec::new(), &mut recorder, |_, _| {});
        let too_long = Error::WalkTooLong { cell: 0, walk: 0, steps: self.walk.max_steps };
        Some(if end == End::TooLong { too_long } else { recorder.cause(0) })
    }
}
