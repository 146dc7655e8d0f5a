//! Forward (adjoint) walks: from the source, along the transposed kernel, to every cell of a detector at once.
//!
//! ```text
//! ⟨h, f⟩ = ⟨φ, g⟩,  φ = h + T†φ                                                                                theory (4.5.1)
//! Z₀ ~ q₀,  W₀ = g(Z₀)/q₀(Z₀),   W_{n+1} = K(Z_{n+1}, Z_n) W_n / π*(Z_n, Z_{n+1})                              theory (4.5.2)
//! ```
//!
//! Derivation: Σ W_n δ(Z_n) has the expectation g + T g + T² g + … = f (theory (4.6.1)), whatever the detector. W_n is a *value*: K acts on it from the
//! left, the new point first; a matrix would be needed only in the other direction.
//!
//! Wins where the source is small and the detector large or of many cells: one set of walks serves them all. Fails where walks seldom reach the
//! detector; a cell that none has reached is [unknown](crate::statistics::Verdict::NothingScored), not zero. Reference: Spanier, Gelbard (1969), §2.7; Coveyou,
//! Cain, Yost, NSE 27 (1967) 219; in rendering: Arvo, *Backward ray tracing* (1986), light tracing.

mod errand;
mod run;
mod scores;
mod scoring;
mod tally;
mod trace;

pub(super) use errand::Carried;
pub use run::Run as ForwardRun;
pub use scoring::{Collided, Connections, ForwardScoring, Seen};
pub use tally::ForwardTally;
pub use trace::ForwardTrace;

use super::{Collision, Ending, FixedDepth, InProgress, NextEvent, Progressive, Roulette, Subcritical, Walk};
use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::{Equation, Method};
use crate::error::Error;
use crate::kernel::{HasAdjoint, Operator, Transition};
use crate::sampling::{Pcg, Sequence};
use crate::source::Emit;
use crate::statistics::Estimate;
use crate::value::Weight;

/// Forward walks: scoring rule × ending × sequence, and a budget of walks for all cells together.
///
/// Defaults: 16 384 walks, collisions scored, roulette by throughput P = min(1, |W_n|/|W₀|), PCG with seed 0, at most 10⁶ steps a walk.
///
/// ```
/// use fredholm::{Equation, Forward, detector::Bins};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);        // f = 1 + 3x/10
/// let bins = eq.seen_by(&Bins::new(0.0..=1.0, 4)).solve(&Forward::new().walks(1 << 16))?;
/// assert!(bins[3].agrees_with(1.0 + 0.3 * 0.875, 5.0));
/// // f at points: no walk hits a point, but every vertex is connected with all of them
/// let values = eq.on(&[0.0, 0.5, 1.0]).solve(&Forward::next_event())?;
/// assert!(values[1].agrees_with(1.15, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// A kernel that can only be walked cannot be connected with a detector, and has no kernel tally:
///
/// ```compile_fail
/// use fredholm::{Equation, Error, Forward, domain::Interval, kernel::*, sampling::Sampler, source::source_fn};
/// struct Mirror;
/// impl Operator for Mirror { type Point = f64; type Weight = f64; }
/// impl Transition for Mirror {
///     fn step<S: Sampler>(&self, x: &f64, _: &mut S) -> Option<Step<f64, f64>> { Some(Step::singular(1.0 - x, 0.5)) }
/// }
/// impl HasAdjoint for Mirror { type Adjoint = Mirror; fn adjoint(&self) -> Result<Mirror, Error> { Ok(Mirror) } }
/// let eq = Equation::new(source_fn(Interval::from(0.0..=1.0), |_: &f64| 1.0), Mirror);
/// let f = eq.at(0.5).solve(&Forward::next_event());         // `Mirror` cannot be evaluated, only walked
/// ```
///
/// Collisions with a point are not a question:
///
/// ```compile_fail
/// use fredholm::{Equation, Forward};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let f = eq.at(0.5).solve(&Forward::new());      // `At<f64>` cannot be hit by forward walks
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Forward<C = Collision, E = Roulette, Q = Pcg> {
    walk: Walk<C, E, Q>,
}

impl Default for Forward {
    fn default() -> Self {
        Forward::new()
    }
}

impl Forward {
    /// Scores h(Z_n) W_n at every vertex (theory (4.5.3)); the detector needs [`Score`](crate::detector::Score).
    pub fn new() -> Self {
        Forward::scoring(Collision, Roulette::throughput(1.0))
    }
}

impl Forward<NextEvent> {
    /// Connects every vertex with a point of the detector (theory (4.5.5)); needs [`Kernel`](crate::kernel::Kernel) and
    /// [`SampleDetector`](crate::detector::SampleDetector).
    pub fn next_event() -> Self {
        Forward::scoring(NextEvent, Roulette::throughput(1.0))
    }
}

impl Forward<Collision, Subcritical> {
    /// Survives with probability M*(z) = ∫ |K(x, z)| dμ(x) (theory (4.5.3)); the adjoint needs [`RowMass`](crate::kernel::RowMass).
    pub fn subcritical() -> Self {
        Forward::scoring(Collision, Subcritical)
    }
}

impl<C, E> Forward<C, E, Pcg> {
    /// Your own scoring rule and ending.
    pub fn scoring(scoring: C, ending: E) -> Self {
        Forward { walk: Walk::new(scoring, ending) }
    }
}

impl<C, E, Q> Forward<C, E, Q> {
    /// Walks, for all cells and in all replicates together; rounded up to a multiple of the replicates.
    pub fn walks(self, walks: u64) -> Self {
        Forward { walk: self.walk.samples_per_cell(walks) }
    }

    /// A walk of more steps is an [`Error::WalkTooLong`].
    pub fn max_steps(self, max_steps: u64) -> Self {
        Forward { walk: self.walk.max_steps(max_steps) }
    }

    /// Walks even if the Neumann series of |T| is known to diverge; see [`Walk::accept_divergence`].
    pub fn accept_divergence(self) -> Self {
        Forward { walk: self.walk.accept_divergence() }
    }

    /// Ends walks by another rule; it is asked for |W_n|/|W₀|.
    pub fn ending<F>(self, ending: F) -> Forward<C, F, Q> {
        Forward { walk: self.walk.ending(ending) }
    }

    /// Ends walks by Russian roulette.
    pub fn roulette(self, roulette: Roulette) -> Forward<C, Roulette, Q> {
        self.ending(roulette)
    }

    /// Cuts walks after `depth` steps: biased, with a bound in the result.
    pub fn depth(self, depth: u64) -> Forward<C, FixedDepth, Q> {
        self.ending(FixedDepth(depth))
    }

    /// Draws from another sequence.
    pub fn sequence<R: Sequence>(self, sequence: R) -> Forward<C, E, R> {
        Forward { walk: self.walk.sequence(sequence) }
    }

    pub(super) fn of(walk: Walk<C, E, Q>) -> Self {
        Forward { walk }
    }

    /// Walks.
    pub(super) fn budget(&self) -> u64 {
        self.walk.samples
    }

    /// Budget, ending and sequence with another scoring rule.
    pub(crate) fn scored_by<R>(&self, scoring: R) -> Walk<R, E, Q>
    where
        E: Copy,
        Q: Copy,
    {
        self.walk.scored_by(scoring)
    }
}

impl<C, E, Q: Sequence> Forward<C, E, Q> {
    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Forward { walk: self.walk.seed(seed) }
    }

    /// Replays walk `walk` vertex by vertex (first replicate).
    ///
    /// ```
    /// # use fredholm::{Equation, Forward, detector::Bins};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let trace = Forward::new().seed(7).trace(&eq, &Bins::new(0.0..=1.0, 4), 3)?;
    /// assert_eq!(trace.vertices[0].1, 1.0);                      // g/q₀
    /// assert_eq!(trace.scores.len(), trace.vertices.len());
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// Whatever is refused before the first walk.
    pub fn trace<G, K, D>(&self, equation: &Equation<G, K>, detector: &D, walk: u64) -> Result<ForwardTrace<G::State, G::Value>, Error>
    where
        G: Emit,
        K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
        C: ForwardScoring<G, K, D>,
        E: Ending<K::Adjoint>,
        D: Detector<Point = G::Point>,
    {
        contained(|| Ok(ForwardRun::new(&self.walk, equation, detector)?.trace(walk)))
    }
}

impl<G, K, D, C, E, Q> Method<G, K, D> for Forward<C, E, Q>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: ForwardScoring<G, K, D>,
    E: Ending<K::Adjoint>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Solution = D::Answer<Estimate<G::Value>>;

    fn solve(&self, equation: &Equation<G, K>, detector: &D) -> Result<Self::Solution, Error> {
        let mut run = ForwardRun::new(&self.walk, equation, detector)?;
        run.advance_to(self.walk.samples)?;
        Ok(run.answer())
    }
}

impl<G, K, D, C, E, Q> Progressive<G, K, D> for Forward<C, E, Q>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: ForwardScoring<G, K, D>,
    E: Ending<K::Adjoint>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Run<'a>
        = ForwardRun<'a, G, K, D, C, E, Q>
    where
        G: 'a,
        K: 'a,
        D: 'a;

    fn begin<'a>(&self, equation: &'a Equation<G, K>, detector: &'a D) -> Result<Self::Run<'a>, Error> {
        ForwardRun::new(&self.walk, equation, detector)
    }
}
