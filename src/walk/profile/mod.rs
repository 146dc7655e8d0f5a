//! The whole of f from one set of forward walks (theory §4.6).
//!
//! The weighted collisions of forward walks are distributed as f: `E Σ W_n ψ(Z_n) = ⟨ψ, f⟩`. What is estimated here is T f, from K(·, Z_n) or from the
//! collisions after a step; g is added as it is known.
//!
//! | tally | values | wins | fails |
//! |---|---|---|---|
//! | [`KernelTally`] | unbiased at every point | smooth kernels; any domain | K not square-integrable at y = x: infinite variance, said by the [verdict](crate::statistics::Profile::verdicts) |
//! | [`Histogram`] | unbiased means over cells | costs nothing a cell; kernels that cannot be evaluated | f varies within a cell |
//! | [`Smoothed`] | biased by b² | as the histogram, for a curve | MSE falls as n^(−4/5), not n^(−1) |
//! | [`Expansion`] | biased by what the basis misses | few coefficients say it all | layers, jumps of T f |
//!
//! Tails of scores, which tell an infinite variance, are kept for up to 1024 cells; with more of them no verdict is better than doubtful. Every one gives a [`Profile`](crate::statistics::Profile), whose [`band`](crate::statistics::Profile::band) holds for all points at once. Flights of particles have tallies of
//! their own: [`Histories`](crate::transport::Histories).

mod expansion;
mod histogram;
mod kernel;
mod smoothed;

pub use expansion::{Basis, Expansion};
pub use histogram::Histogram;
pub use kernel::KernelTally;
pub use smoothed::{Smoothed, SmoothingKernels};

use super::forward::ForwardRun;
use super::{Collision, Ending, Forward, ForwardScoring, Roulette};
use crate::detector::Detector;
use crate::domain::Point;
use crate::equation::{Equation, Everywhere, Method};
use crate::error::Error;
use crate::kernel::{HasAdjoint, Operator, Transition};
use crate::sampling::{Pcg, Sequence};
use crate::source::Emit;
use crate::statistics::{Bias, Estimate, Profile, Verdict};
use crate::value::{Value, Weight};
use std::fmt::Debug;

/// How the collisions of forward walks become a curve.
pub trait Tally<G: Emit, K: HasAdjoint>: Debug + Send + Sync {
    /// Where the curve is wanted.
    type Point: Point;
    /// What the walks score in.
    type Detector: Detector<Point = G::Point>;
    /// How they score there.
    type Scoring: ForwardScoring<G, K, Self::Detector>;

    /// The cells for a budget of `walks`, and how values follow from them.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value; [`Error::NonFiniteSource`].
    fn plan(&self, equation: &Equation<G, K>, walks: u64) -> Result<PlanOf<G, K, Self>, Error>;
}

/// What a tally plans.
pub type PlanOf<G, K, T> =
    Plan<<T as Tally<G, K>>::Point, <G as crate::source::Source>::Value, <T as Tally<G, K>>::Detector, <T as Tally<G, K>>::Scoring>;

/// value(x_i) = known_i + Σ_c matrix_ic · E[cell c].
#[derive(Clone, Debug)]
pub struct Plan<X, V, D, C> {
    /// x_i.
    pub points: Vec<X>,
    /// The cells.
    pub detector: D,
    /// How walks score in them.
    pub scoring: C,
    /// What is known without walks.
    pub known: Vec<V>,
    /// Bound on its error.
    pub known_error: f64,
    /// A row for every point; `None`: the cells are the points.
    pub matrix: Option<Vec<Vec<f64>>>,
    /// What the values estimate, if not f.
    pub bias: Bias,
}

impl<X, V: Value, D, C> Plan<X, V, D, C> {
    fn values(&self, cells: Vec<V>) -> Vec<V> {
        let Some(matrix) = &self.matrix else { return cells };
        let product = |row: &Vec<f64>| row.iter().zip(&cells).fold(V::ZERO, |sum, (a, c)| sum + c.scale(*a));
        matrix.iter().map(product).collect()
    }

    fn verdicts(&self, cells: &[Verdict]) -> Vec<Verdict> {
        let Some(matrix) = &self.matrix else { return cells.to_vec() };
        let worst = |row: &Vec<f64>| row.iter().zip(cells).filter(|(a, _)| **a != 0.0).map(|(_, v)| *v).max();
        matrix.iter().map(|row| worst(row).unwrap_or(Verdict::NothingScored)).collect()
    }
}

/// Forward walks that find f as a curve; see [`Forward::profile`].
#[derive(Clone, Debug)]
#[must_use]
pub struct Profiling<T, E = Roulette, Q = Pcg> {
    tally: T,
    forward: Forward<Collision, E, Q>,
    batches: u64,
}

/// Batches of independent walks that errors come from: 127 degrees of freedom lose little against all walks.
const BATCHES: u64 = 128;

impl<C, E: Copy, Q: Copy> Forward<C, E, Q> {
    /// f as a curve, by one of the [tallies](crate::walk::Tally); errors from 128 batches of walks, or from the sequence's replicates.
    ///
    /// ```
    /// use fredholm::{Equation, Forward, walk::{Expansion, Histogram, Smoothed}};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);                // f = 1 + 3x/10
    /// let xs = [0.1, 0.5, 0.9];
    /// let walks = Forward::new().walks(1 << 14);
    /// let lines = eq.solve(&walks.profile(Expansion::legendre(0.0..=1.0, 2, &xs)))?;
    /// assert!(lines.band(0.999).expect("batches").contains(&[1.03, 1.15, 1.27]));
    /// let smooth = eq.solve(&walks.profile(Smoothed::at(0.0..=1.0, &xs)))?;
    /// let means = eq.solve(&walks.profile(Histogram::new(0.0..=1.0, 3)))?;
    /// println!("{lines}\n{smooth}\n{means}");
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn profile<T>(self, tally: T) -> Profiling<T, E, Q> {
        Profiling { tally, forward: Forward::of(self.scored_by(Collision)), batches: BATCHES }
    }
}

impl<T, E, Q> Profiling<T, E, Q> {
    /// Batches of independent points; sequences with replicates have these as batches.
    pub fn batches(self, batches: u64) -> Self {
        Profiling { batches, ..self }
    }

    /// The tally.
    pub fn tally(&self) -> &T {
        &self.tally
    }
}

impl<G, K, T, E, Q> Method<G, K, Everywhere> for Profiling<T, E, Q>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    T: Tally<G, K>,
    E: Ending<K::Adjoint>,
    Q: Sequence,
{
    type Solution = Profile<T::Point, G::Value>;

    fn solve(&self, equation: &Equation<G, K>, _: &Everywhere) -> Result<Self::Solution, Error> {
        equation.validate()?;
        if self.batches == 0 {
            return Err(Error::invalid("batches", 0.0, "must be at least 1"));
        }
        let plan = self.tally.plan(equation, self.forward.budget())?;
        let walk = self.forward.scored_by(plan.scoring);
        let mut run = ForwardRun::new(&walk, equation, &plan.detector)?;
        let batches = run.batches(self.batches)?;
        let cells = run.estimates();
        // a tail that was not kept may be any
        let verdict = |e: &Estimate<G::Value>| if e.tail.is_some() { e.verdict() } else { e.verdict().max(Verdict::Doubtful) };
        let verdicts: Vec<_> = cells.iter().map(verdict).collect();
        let values = batches.into_iter().map(|cells| plan.values(cells)).collect();
        let profile = Profile::of_batches(plan.points.clone(), values, plan.verdicts(&verdicts), cells, plan.bias);
        Ok(profile.shifted(&plan.known, plan.known_error))
    }
}

/// g at points, refused where it is not finite.
fn source_at<G: crate::source::Source>(source: &G, points: &[G::Point]) -> Result<Vec<G::Value>, Error> {
    let one = |x: &G::Point| {
        let g = source.eval(x);
        if g.all_finite() { Ok(g) } else { Err(Error::non_finite_source(x, &g)) }
    };
    points.iter().map(one).collect()
}

/// Refuses a curve without points, or with points that are no numbers inside.
fn check_points(interval: crate::domain::Interval, xs: &[f64]) -> Result<(), Error> {
    use crate::domain::Domain;
    interval.validate()?;
    if xs.is_empty() {
        return Err(Error::invalid("points", 0.0, "a profile needs at least one point"));
    }
    match xs.iter().find(|x| !interval.contains(x)) {
        Some(x) => Err(Error::Outside { x: format!("{x:?}") }),
        None => Ok(()),
    }
}
