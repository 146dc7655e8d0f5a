//! Bidirectional walks: one from the detector, one from the source, joined in every way, weighted by multiple importance sampling.
//!
//! ```text
//! ⟨h, Tᵐ g⟩ = ∫ h(x₀) K(x₀, x₁) … K(x_{m−1}, x_m) g(x_m)                                                         theory (4.7.1)
//! p_s(x̄)  = p₀(x₀) Π_{i < t} π(x_{i−1}, x_i) · q₀(x_m) Π_{j < s} π*(x_{m−j+1}, x_{m−j}),     t = m + 1 − s           theory (4.7.2)
//! Y       = Σ_{s,t} w_{s,t} C_{s,t},      w = 1/Σ_k (p_k/p_s)^β                                                  theory (4.7.5)
//! ```
//!
//! Derivation: a path of order m is found by m + 2 strategies: its first t vertices by the backward walk, its last s by the forward walk (m + 1 for f at a
//! point, which no forward walk hits). E[C_{s,t}] = ⟨h, Tᵐ g⟩ for each alone, if it can find every path; weights that add up to 1 along a path keep the sum
//! unbiased. The survival probability belongs in π and π*, at the place and in the direction of travel. Strategies whose joining edge would be a Dirac part
//! have weight 0: the others carry it. All vertices are joined, however long the walks.
//!
//! Forward walks that end at one of many cells score there, whatever cell the backward walk of their pair started from.
//!
//! Wins where neither end is easy to find: small sources seen by small detectors through a peaked kernel. Costs a kernel evaluation for every pair of
//! vertices; where one direction is good everywhere, that direction alone is cheaper. Reference: Veach, Guibas, *Bidirectional estimators for light
//! transport* (1994); Lafortune, Willems, *Bi-directional path tracing* (1993); Georgiev, *Implementing vertex connection and merging* (2012), for the recursion.

mod connect;
mod fault;
mod meet;
mod optimal;
mod pair;
mod path;
mod shared;
mod strategies;
mod table;
mod tally;
mod weights;

pub use connect::{Beyond, Connect};
pub use meet::{Meet, Met, meet_by_density};
pub use pair::{PairEstimator, PairMemory};
pub(crate) use table::MOST_EDGES;
pub use table::Strategy;
pub use tally::SharedPairs;

use super::backward::met_nothing;
use super::{Ending, Heuristic, Roulette, Walk};
use crate::equation::{Equation, Method, Query};
use crate::error::Error;
use crate::estimator::{estimate, score_block};
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::sampling::{Pcg, Sequence, pilot_points};
use crate::source::EmitPdf;
use crate::statistics::Estimate;
use crate::value::Weight;

/// Which strategies are summed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategies {
    /// Those of all orders: f.
    #[default]
    All,
    /// Those of paths of m edges: Tᵐ g.
    Order(u64),
    /// s vertices from the source and t from the detector, unweighted: T^{s+t−1} g, if this strategy can find every path.
    One {
        /// Vertices from the source.
        s: u64,
        /// Vertices from the detector.
        t: u64,
    },
}

impl Strategies {
    /// The s to be joined with t vertices of a backward walk, of a forward walk of `light` vertices.
    #[inline]
    fn range(self, t: usize, light: usize) -> std::ops::Range<usize> {
        let only = |s: Option<u64>| match s {
            Some(s) if s <= light as u64 => s as usize..s as usize + 1,
            _ => 0..0,
        };
        match self {
            Strategies::All => 0..light + 1,
            Strategies::Order(m) => only(m.checked_add(1).and_then(|vertices| vertices.checked_sub(t as u64))),
            Strategies::One { s, t: own } => only((own == t as u64).then_some(s)),
        }
    }
}

/// Bidirectional walks: weights × endings × sequence, and a budget of pairs.
///
/// Defaults: 16 384 pairs a cell, balance heuristic, roulette by throughput P = min(1, |α|/|α at the start|) in both directions, PCG with seed 0, at most 10⁶
/// steps a walk. Weights count survival probabilities that depend on the place alone ([`Roulette::constant`], [`Subcritical`](super::Subcritical)).
///
/// ```
/// use fredholm::{Bidirectional, Equation, domain::Interval, detector::Functional, walk::Strategies};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);       // f = 1 + 3x/10
/// assert!(eq.at(0.5).solve(&Bidirectional::new())?.agrees_with(1.15, 5.0));
/// let h = Functional::new(Interval::from(0.0..=1.0), |x| 2.0 * x);
/// assert!(eq.seen_by(&h).solve(&Bidirectional::new())?.agrees_with(1.2, 5.0));
/// // paths of one edge: (Tg)(½) = 1/8
/// assert!(eq.at(0.5).solve(&Bidirectional::new().strategies(Strategies::Order(1)))?.agrees_with(0.125, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// A kernel that can only be walked cannot be joined:
///
/// ```compile_fail
/// use fredholm::{Bidirectional, Equation, Error, kernel::*, sampling::Sampler, domain::Interval, source::source_fn};
/// struct Mirror;
/// impl Operator for Mirror { type Point = f64; type Weight = f64; }
/// impl Transition for Mirror {
///     fn step<S: Sampler>(&self, x: &f64, _: &mut S) -> Option<Step<f64, f64>> { Some(Step::singular(1.0 - x, 0.5)) }
/// }
/// impl TransitionPdf for Mirror { fn pdf(&self, _: &f64, _: &f64) -> f64 { 0.0 } }
/// impl HasAdjoint for Mirror { type Adjoint = Mirror; fn adjoint(&self) -> Result<Mirror, Error> { Ok(Mirror) } }
/// let eq = Equation::new(source_fn(Interval::from(0.0..=1.0), |_: &f64| 1.0), Mirror);
/// let f = eq.at(0.5).solve(&Bidirectional::new());         // `Mirror` cannot be evaluated, only walked
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Bidirectional<E = Roulette, F = Roulette, Q = Pcg> {
    heuristic: Heuristic,
    strategies: Strategies,
    backward: E,
    forward: F,
    sequence: Q,
    samples: u64,
    max_steps: u64,
    pilot: Option<u64>,
}

impl Bidirectional {
    /// All strategies, by the balance heuristic.
    pub fn new() -> Self {
        let roulette = Roulette::throughput(1.0);
        Bidirectional {
            heuristic: Heuristic::Balance,
            strategies: Strategies::All,
            backward: roulette,
            forward: roulette,
            sequence: Pcg::default(),
            samples: 1 << 14,
            max_steps: 1_000_000,
            pilot: None,
        }
    }
}

impl Default for Bidirectional {
    fn default() -> Self {
        Bidirectional::new()
    }
}

impl<E, F, Q> Bidirectional<E, F, Q> {
    /// How strategies share a path.
    pub fn heuristic(self, heuristic: Heuristic) -> Self {
        Bidirectional { heuristic, ..self }
    }

    /// Optimal weights from `pilot` pairs for every cell, on points of their own: the heuristic, and controls that take away what the densities of the strategies
    /// explain of the scores of paths of up to three edges (Kondapaneni et al. 2019; theory (4.4.8)). Unbiased; the heuristic alone where the halves of the pilot
    /// do not confirm each other's weights, so take a thousand pairs or more.
    ///
    /// Densities must be known: endings whose survival depends on the place alone, and states that are the same in both directions. Cells are solved one by one.
    ///
    /// ```
    /// use fredholm::{Bidirectional, Equation, walk::Roulette};
    /// let eq = Equation::on_interval(0.0..=1.0, |x| (2.0 * x).exp(), |x, y| 0.5 * x * y);
    /// let walks = Bidirectional::new().roulette(Roulette::constant(0.5));
    /// let (balance, best) = (eq.at(0.5).solve(&walks)?, eq.at(0.5).solve(&walks.optimal(1024))?);
    /// assert!(best.variance() < balance.variance());
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn optimal(self, pilot: u64) -> Self {
        Bidirectional { pilot: Some(pilot), ..self }
    }

    /// Which strategies are summed.
    pub fn strategies(self, strategies: Strategies) -> Self {
        Bidirectional { strategies, ..self }
    }

    /// Pairs of walks for every detector cell, in all replicates together; rounded up to a multiple of the replicates.
    pub fn samples_per_cell(self, samples: u64) -> Self {
        Bidirectional { samples, ..self }
    }

    /// A walk of more steps is an [`Error::WalkTooLong`].
    pub fn max_steps(self, max_steps: u64) -> Self {
        Bidirectional { max_steps, ..self }
    }

    /// Ends backward and forward walks by other rules.
    pub fn endings<A, B>(self, backward: A, forward: B) -> Bidirectional<A, B, Q> {
        let Bidirectional { heuristic, strategies, sequence, samples, max_steps, pilot, .. } = self;
        Bidirectional { heuristic, strategies, backward, forward, sequence, samples, max_steps, pilot }
    }

    /// Ends walks of both directions by Russian roulette.
    pub fn roulette(self, roulette: Roulette) -> Bidirectional<Roulette, Roulette, Q> {
        self.endings(roulette, roulette)
    }

    /// How walks of both directions end.
    pub(crate) fn ends_by(&self) -> (&E, &F) {
        (&self.backward, &self.forward)
    }

    /// Draws from another sequence.
    pub fn sequence<R: Sequence>(self, sequence: R) -> Bidirectional<E, F, R> {
        let Bidirectional { heuristic, strategies, backward, forward, samples, max_steps, pilot, .. } = self;
        Bidirectional { heuristic, strategies, backward, forward, sequence, samples, max_steps, pilot }
    }
}

impl<E: Copy, F: Copy, Q: Sequence> Bidirectional<E, F, Q> {
    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Bidirectional { sequence: self.sequence.with_seed(seed), ..self }
    }

    /// Everything that can be refused before the first walk.
    fn bind<'a, G, K, D>(&self, equation: &'a Equation<G, K>, detector: &'a D) -> Result<PairEstimator<'a, G, K, D, E, F>, Error>
    where
        G: EmitPdf,
        K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>>
            + TransitionPdf
            + Connect<K::Adjoint>
            + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
        D: Meet<G::State, G::Value, Point = G::Point>,
        E: Ending<K>,
        F: Ending<K::Adjoint>,
    {
        equation.validate()?;
        detector.validate()?;
        self.heuristic.validate()?;
        if self.strategies == (Strategies::One { s: 0, t: 0 }) {
            return Err(Error::invalid("vertices of a strategy", 0.0, "s + t must be at least 1"));
        }
        let adjoint = equation.kernel().adjoint()?;
        if let Some(depth) = self.backward.cut().or(self.forward.cut()) {
            let why = "bidirectional walks of all orders cannot be cut without bias; ask for orders by `Strategies::Order`";
            return Err(Error::invalid("depth", depth as f64, why));
        }
        // what a walk of either direction refuses
        let walk = Walk::new((), self.backward).sequence(self.sequence).samples_per_cell(self.samples).max_steps(self.max_steps);
        walk.budgeted(equation, equation.kernel(), || None)?;
        walk.ending(self.forward).budgeted(equation, &adjoint, || None)?;
        let endings = (self.backward, self.forward);
        let (heuristic, strategies, max_steps) = (self.heuristic, self.strategies, self.max_steps);
        let mut pairs =
            PairEstimator { equation, adjoint, detector, endings, heuristic, strategies, share: 1, max_steps, tuned: Vec::new() };
        if let Some(pilot) = self.pilot {
            pairs.tune(&pilot_points(&self.sequence), pilot, 0..detector.cells())?;
        }
        Ok(pairs)
    }
}

impl<'a, G, K, D> Query<'a, G, K, D>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
{
    /// Pairs of walks as an unbiased [`Estimator`](crate::estimator::Estimator): to be combined strategy by strategy, or driven by
    /// [`Metropolis`](crate::estimator::Metropolis). Sequence and budget are left behind.
    ///
    /// # Errors
    /// Whatever can be refused before the first walk.
    pub fn bidirectional<E, F, Q>(&self, walks: &Bidirectional<E, F, Q>) -> Result<PairEstimator<'_, G, K, D, E, F>, Error>
    where
        E: Ending<K>,
        F: Ending<K::Adjoint>,
        Q: Sequence,
    {
        walks.bind(self.equation(), self.detector())
    }
}

impl<G, K, D, E, F, Q> Method<G, K, D> for Bidirectional<E, F, Q>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    E: Ending<K>,
    F: Ending<K::Adjoint>,
    Q: Sequence,
    D: Meet<G::State, G::Value, Point = G::Point>,
{
    type Solution = D::Answer<Estimate<G::Value>>;

    fn solve(&self, equation: &Equation<G, K>, detector: &D) -> Result<Self::Solution, Error> {
        let mut pairs = self.bind(equation, detector)?;
        if D::EXTENDED && detector.cells() > 1 && self.pilot.is_none() {
            pairs.share = detector.cells() as u64;
            return Ok(detector.answer(pairs.all_cells(&self.sequence, self.samples)?));
        }
        let cell = |cell: usize| {
            let mut e = estimate(self.sequence.replicates(), self.samples, &|replicate, indices| {
                score_block(&pairs, &self.sequence, cell, (cell as u64, replicate), indices)
            })?;
            if let Some(pilot) = pairs.tuned.get(cell) {
                (e.steps, e.evaluations) = (e.steps + pilot.steps, e.evaluations + pilot.evaluations);
            }
            Ok(e.unless(|score| met_nothing(equation, detector, (cell, self.sequence.point(cell as u64, 0, 0)), score)))
        };
        Ok(detector.answer((0..detector.cells()).map(cell).collect::<Result<_, Error>>()?))
    }
}
