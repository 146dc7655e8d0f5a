//! Random-walk estimators of f = Σ Tⁿg, cut along three independent choices.
//!
//! - *Where the next point comes from*: the kernel's own [`Transition`], or a [proposal](crate::kernel::Proposal).
//! - *When the walk ends*: [`Roulette`], [`FixedDepth`], [`Subcritical`], [`OwnAbsorption`].
//! - *What is scored*: [`Collision`], [`Absorption`], [`NextEvent`], [`Mis`].
//!
//! Named presets put them together: [`Walk::collision`], [`Walk::subcritical`], [`Walk::absorption`], [`Walk::next_event`], [`Walk::mis`],
//! [`Walk::fixed_depth`]; every part can be exchanged. [`Forward`] goes the other way, from the source along the transposed kernel;
//! [`Bidirectional`] joins both.

mod array;
mod backward;
mod bidirectional;
mod checkpoint;
mod driver;
mod ending;
mod estimator;
mod forward;
mod observer;
mod order;
mod prepare;
mod profile;
mod replay;
mod rounds;
mod run;
mod scoring;

pub use array::ArrayRqmc;
pub(crate) use bidirectional::MOST_EDGES;
pub use bidirectional::{
    Beyond, Bidirectional, Connect, Meet, Met, PairEstimator, PairMemory, SharedPairs, Strategies, Strategy, meet_by_density,
};
pub use checkpoint::Checkpoint;
pub use driver::End;
pub use ending::{Ending, FixedDepth, OwnAbsorption, Roulette, Subcritical, Survival};
pub use estimator::WalkEstimator;
pub use forward::{Collided, Connections, Forward, ForwardRun, ForwardScoring, ForwardTally, ForwardTrace, Seen};
pub use observer::{Observer, Trace, TracedVertex};
pub use order::Sort;
pub use profile::{Basis, Expansion, Histogram, KernelTally, Plan, PlanOf, Profiling, Smoothed, SmoothingKernels, Tally};
pub use rounds::{InProgress, Progressive, Round, Rounds};
pub use run::Run as WalkRun;
pub use scoring::{Absorption, Arrival, Collision, Heuristic, Mis, NextEvent, OptimalMis, Scoring, Technique, Visit};

use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::{Equation, Method};
use crate::error::Error;
use crate::kernel::{Operator, Transition};
use crate::sampling::{Pcg, Sequence};
use crate::source::Source;
use crate::statistics::Estimate;
use crate::value::Weight;
use run::Run;

/// A random-walk method: scoring rule × ending × sequence, and a budget.
///
/// Defaults: 16 384 walks a cell, PCG with seed 0, at most 10⁶ steps a walk, roulette by throughput (P = min(1, |W|)) where the preset needs one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Walk<C = Collision, E = Roulette, Q = Pcg> {
    scoring: C,
    ending: E,
    sequence: Q,
    samples: u64,
    max_steps: u64,
    divergence: Divergence,
}

/// What to do if Σ|T|ⁿ is known to diverge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Divergence {
    Refuse,
    Accept,
}

impl<C, E> Walk<C, E, Pcg> {
    /// Your own scoring rule and ending.
    pub fn new(scoring: C, ending: E) -> Self {
        Walk { scoring, ending, sequence: Pcg::default(), samples: 1 << 14, max_steps: 1_000_000, divergence: Divergence::Refuse }
    }
}

impl Walk {
    /// Scores W g at every vertex (theory (4.2.1)); needs a [`Transition`].
    pub fn collision() -> Self {
        Walk::new(Collision, Roulette::throughput(1.0))
    }
}

impl Walk<Collision, FixedDepth> {
    /// Cuts every walk after `depth` steps; the bias bound is part of the result (theory (4.2.3)).
    pub fn fixed_depth(depth: u64) -> Self {
        Walk::new(Collision, FixedDepth(depth))
    }
}

impl Walk<Collision, Subcritical> {
    /// Survives with probability M(x), weights near 1 (theory (4.2.5)); needs [`RowMass`](crate::kernel::RowMass).
    ///
    /// For kernels with a proposal. A kernel of your own whose `step` already absorbs with probability 1 − M(x) would die twice: unbiased, but
    /// with needless variance; walk it by [`OwnAbsorption`].
    pub fn subcritical() -> Self {
        Walk::new(Collision, Subcritical)
    }
}

impl Walk<Absorption, OwnAbsorption> {
    /// Scores where the kernel absorbs the walk (theory (4.2.2)); needs [`Absorbing`](crate::kernel::Absorbing). Kernels that never absorb, such as
    /// closures, need a `.roulette(…)` of constant probability.
    pub fn absorption() -> Self {
        Walk::new(Absorption, OwnAbsorption)
    }
}

impl Walk<NextEvent> {
    /// Scores a point of the source at every vertex (theory (4.4.2)); needs [`Kernel`](crate::kernel::Kernel) and
    /// [`SampleSource`](crate::source::SampleSource).
    pub fn next_event() -> Self {
        Walk::new(NextEvent, Roulette::throughput(1.0))
    }
}

impl Walk<Mis> {
    /// Next event and the walk's own hits, weighted by the balance heuristic (theory (4.4.4)); needs also
    /// [`TransitionPdf`](crate::kernel::TransitionPdf).
    pub fn mis() -> Self {
        Walk::new(Mis(Heuristic::Balance), Roulette::throughput(1.0))
    }
}

impl<E, Q> Walk<Mis, E, Q> {
    /// Another combination of the two techniques.
    pub fn heuristic(self, heuristic: Heuristic) -> Self {
        Walk { scoring: Mis(heuristic), ..self }
    }
}

impl<C, E, Q> Walk<C, E, Q> {
    /// Walks for every detector cell, in all replicates together; rounded up to a multiple of the replicates.
    pub fn samples_per_cell(self, samples: u64) -> Self {
        Walk { samples, ..self }
    }

    /// A walk of more steps is an [`Error::WalkTooLong`].
    pub fn max_steps(self, max_steps: u64) -> Self {
        Walk { max_steps, ..self }
    }

    /// Walks even if the Neumann series of |T| is known to diverge. Expectation and variance may then not exist: you insist, you answer for it.
    pub fn accept_divergence(self) -> Self {
        Walk { divergence: Divergence::Accept, ..self }
    }

    /// Ends walks by another rule.
    pub fn ending<F>(self, ending: F) -> Walk<C, F, Q> {
        let Walk { scoring, sequence, samples, max_steps, divergence, .. } = self;
        Walk { scoring, ending, sequence, samples, max_steps, divergence }
    }

    /// Ends walks by Russian roulette.
    pub fn roulette(self, roulette: Roulette) -> Walk<C, Roulette, Q> {
        self.ending(roulette)
    }

    /// Cuts walks after `depth` steps: biased, with a bound in the result.
    pub fn depth(self, depth: u64) -> Walk<C, FixedDepth, Q> {
        self.ending(FixedDepth(depth))
    }

    /// The same walks, scored by another rule.
    pub(crate) fn scored_by<D>(&self, scoring: D) -> Walk<D, E, Q>
    where
        E: Copy,
        Q: Copy,
    {
        let Walk { ending, sequence, samples, max_steps, divergence, .. } = *self;
        Walk { scoring, ending, sequence, samples, max_steps, divergence }
    }

    /// What is scored.
    pub(crate) fn scores_by(&self) -> &C {
        &self.scoring
    }

    /// How walks end.
    pub(crate) fn ends_by(&self) -> &E {
        &self.ending
    }

    /// Draws from another sequence.
    pub fn sequence<R: Sequence>(self, sequence: R) -> Walk<C, E, R> {
        let Walk { scoring, ending, samples, max_steps, divergence, .. } = self;
        Walk { scoring, ending, sequence, samples, max_steps, divergence }
    }
}

impl<C, E, Q: Sequence> Walk<C, E, Q> {
    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Walk { sequence: self.sequence.with_seed(seed), ..self }
    }

    /// Replays walk `walk` of detector cell `cell` vertex by vertex (first replicate).
    ///
    /// ```
    /// # use fredholm::{Equation, Walk, detector::At};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let trace = Walk::collision().seed(7).trace(&eq, &At(0.5), 0, 3)?;
    /// assert_eq!(trace.vertices[0].point, 0.5);
    /// assert_eq!(trace.score, trace.vertices.iter().map(|v| v.score).sum::<f64>());
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for a cell that the detector does not have, and whatever is refused before the first walk.
    pub fn trace<G, K, D>(
        &self,
        equation: &Equation<G, K>,
        detector: &D,
        cell: usize,
        walk: u64,
    ) -> Result<Trace<K::Point, K::Weight>, Error>
    where
        G: Source,
        K: Transition + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
        C: Scoring<G, K>,
        E: Ending<K>,
        D: Detector<Point = G::Point>,
    {
        contained(|| {
            self.prepare(equation, detector)?;
            if cell >= detector.cells() {
                return Err(Error::invalid("cell", cell as f64, "must be below the detector's number of cells"));
            }
            Ok(replay::replay(self, equation, detector, cell, 0, walk).1)
        })
    }
}

impl<G, K, D, C, E, Q> Method<G, K, D> for Walk<C, E, Q>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Solution = D::Answer<Estimate<G::Value>>;

    fn solve(&self, equation: &Equation<G, K>, detector: &D) -> Result<Self::Solution, Error> {
        let mut run = Run::new(self, equation, detector)?;
        run.advance_to(self.samples)?;
        Ok(run.answer())
    }
}

impl<G, K, D, C, E, Q> Progressive<G, K, D> for Walk<C, E, Q>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Run<'a>
        = Run<'a, G, K, D, C, E, Q>
    where
        G: 'a,
        K: 'a,
        D: 'a;

    fn begin<'a>(&self, equation: &'a Equation<G, K>, detector: &'a D) -> Result<Self::Run<'a>, Error> {
        Run::new(self, equation, detector)
    }
}
