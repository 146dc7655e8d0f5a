//! Metropolis' walk through the unit cube, from point to point that score: many cells of a detector at once.
//!
//! ```text
//! target      C(u) = Σ_j |F_j(u)|,  F_j the scores of u for the cells,   b = ∫ C du
//! proposal    with probability p_L a fresh u', else every coordinate moves by a small symmetric step, wrapped around
//! acceptance  a = min(1, C(u')/C(u))                                                                                       theory (4.13.1)
//! tally       F̂_j = (b/n) Σ [ (1−a) F_j(u)/C(u) + a F_j(u')/C(u') ]                                                        theory (4.13.2)
//! combined    F̂_j = (1/n) Σ [ (1−a) F_j(u) v(u) + (a + 1{fresh}/v) F_j(u') v(u') ],  v = 1/(C/β + p_L), β ≈ b              theory (4.13.3)
//! ```
//!
//! Derivation: at equilibrium u has density C/b, so E[F_j(u)/C(u)] = ∫F_j/b; signs stay in F_j (theory (4.13.4)). Coordinates are lazy: one that the current
//! point did not read does not influence its score, and is drawn afresh when a proposal reads it, a Gibbs step that leaves C invariant.
//!
//! *No start-up bias.* Every chain draws a pool of independent points, starts from one of them chosen ∝ C, and multiplies by the mean b̂ of C over *its own*
//! pool: E[b̂ F_j(U)/C(U)] = ∫F_j exactly, and steps that leave C invariant keep it so (Veach, Guibas 1997, §4). Chains are then independent unbiased
//! replicates, and the interval is Student's over chains: what the scores of one chain say about the error is not used, they are correlated.
//!
//! *Scope* (theory (4.13.5)). Steps towards where C is large move effort from dark cells to bright ones, and from points that do not score to those that do.
//! **For one number there is nothing to gain**: J = b E[sign], and b comes from plain sampling. A detector of one cell is refused. Even with many cells
//! the error of b is common to all. Fails where parts of the cube that score are far apart and p_L finds them rarely: chains then disagree, and the interval says so.
//!
//! Reference: Kelemen, Szirmay-Kalos, Antal, Csonka, *A simple and robust mutation strategy for the Metropolis light transport algorithm*, Comput. Graph.
//! Forum 21 (2002) 531; Veach, Guibas, *Metropolis light transport*, SIGGRAPH 1997.

mod chain;
mod point;
mod tally;

pub(crate) use tally::choose;
pub use tally::{OneCell, Tally};

use super::run::check_budget;
use crate::contained::contained;
use crate::error::Error;
use crate::parallel;
use crate::statistics::{Estimate, Moments, Pooled};
use crate::value::Value;
use chain::{Outcome, Setting, Spent};
use std::time::{Duration, Instant};

/// What fresh points are used for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LargeSteps {
    /// Proposals like others: theory (4.13.2).
    #[default]
    Proposals,
    /// Also samples of their own, combined with the chain by the balance heuristic: theory (4.13.3). Better in dark cells.
    Combined,
}

/// Metropolis' walk.
///
/// ```
/// use fredholm::{Equation, Walk, detector::Bins, estimator::Metropolis};
/// let eq = Equation::on_interval(0.0..=1.0, |x| (-20.0 * x).exp(), |x, y| 0.5 * x * y);
/// let bins = Bins::new(0.0..=1.0, 16);
/// let query = eq.seen_by(&bins);
/// let found = Metropolis::new().mutations(2048).solve(&query.estimator(&Walk::next_event())?)?;
/// assert_eq!(found.cells.len(), 16);
/// assert!(found.acceptance.unwrap() > 0.1);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Metropolis {
    chains: u64,
    mutations: u64,
    pool: u64,
    large: f64,
    steps: (f64, f64),
    large_steps: LargeSteps,
    seed: u64,
}

/// What the chains found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Chains<V = f64> {
    /// One estimate a cell, its error from independent chains. Its moments are those of single tallies, which are correlated: `variance()/std_error²` is the
    /// effective number of samples.
    pub cells: Vec<Estimate<V>>,
    /// b = ∫ C, from the pools of independent points. What they cost is part of the cells' cost: of their steps, evaluations and efficiency.
    pub normalisation: Estimate<f64>,
    /// Share of small steps that were accepted; `None` if there were none.
    pub acceptance: Option<f64>,
    /// Share of fresh points that were accepted; `None` if there were none.
    pub large_acceptance: Option<f64>,
}

impl Metropolis {
    /// 32 chains of 16 384 mutations from pools of 512 points; p_L = 0.3; small steps between 1/1024 and 1/64; seed 0.
    pub fn new() -> Self {
        Metropolis {
            chains: 32,
            mutations: 1 << 14,
            pool: 512,
            large: 0.3,
            steps: (1.0 / 1024.0, 1.0 / 64.0),
            large_steps: LargeSteps::Proposals,
            seed: 0,
        }
    }

    /// Independent chains, from which the error comes: at least 20.
    pub fn chains(self, chains: u64) -> Self {
        Metropolis { chains, ..self }
    }

    /// Mutations of every chain.
    pub fn mutations(self, mutations: u64) -> Self {
        Metropolis { mutations, ..self }
    }

    /// Independent points of every chain, for its start and its b.
    pub fn pool(self, pool: u64) -> Self {
        Metropolis { pool, ..self }
    }

    /// Probability p_L ∈ (0, 1] of a fresh point: every point of the cube can be reached.
    pub fn large_step_probability(self, large: f64) -> Self {
        Metropolis { large, ..self }
    }

    /// Small steps have lengths between `least` and `most`, uniform in the logarithm: a heavy tail.
    pub fn small_steps(self, least: f64, most: f64) -> Self {
        Metropolis { steps: (least, most), ..self }
    }

    /// What fresh points are used for.
    pub fn large_steps(self, large_steps: LargeSteps) -> Self {
        Metropolis { large_steps, ..self }
    }

    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Metropolis { seed, ..self }
    }

    /// Walks. Any [`Estimator`](super::Estimator) of two cells or more is a [`Tally`].
    ///
    /// # Errors
    /// [`Error::Invalid`] for a single cell, where Metropolis cannot help, fewer than 20 chains, and other parameters outside their range;
    /// [`Error::ZeroTarget`] if no point of any pool scored; whatever a score that is not finite has as its explanation.
    pub fn solve<T: Tally>(&self, tally: &T) -> Result<Chains<T::Value>, Error> {
        contained(|| {
            let clock = Instant::now();
            self.validate(tally.cells())?;
            let setting =
                Setting { seed: self.seed, mutations: self.mutations, pool: self.pool, large: self.large, steps: self.steps, scale: None };
            let (scale, scaling) = match self.large_steps {
                LargeSteps::Proposals => (None, Spent::default()),
                LargeSteps::Combined => setting.scale(tally, self.chains).map(|(scale, spent)| (Some(scale), spent))?,
            };
            let setting = Setting { scale, ..setting };
            let outcomes = parallel::map(self.chains as usize, |c| setting.chain(tally, c as u64));
            let outcomes = outcomes.into_iter().collect::<Result<Vec<Outcome<T::Value>>, Error>>()?;
            let pools = pooled(outcomes.iter().map(|o| &o.pool));
            if pools.moments.nonzero == 0 {
                return Err(Error::ZeroTarget { samples: self.chains * self.pool });
            }
            let elapsed = clock.elapsed();
            let pooling = outcomes.iter().fold(Spent::default(), |sum, o| sum.and(o.before));
            let spent = outcomes.iter().fold(pooling.and(scaling), |sum, o| sum.and(o.after));
            let cost = Cost { spent, elapsed };
            let cell = |j: usize| {
                let chains: Vec<Moments<T::Value>> = outcomes.iter().map(|o| o.cells[j].moments(2 * self.mutations)).collect();
                cost.estimate(Pooled::randomised(&chains))
            };
            let share = |count: fn(&Outcome<T::Value>) -> (u64, u64)| {
                let (proposed, accepted) = outcomes.iter().map(count).fold((0, 0), |(a, b), (p, q)| (a + p, b + q));
                (proposed > 0).then(|| accepted as f64 / proposed as f64)
            };
            Ok(Chains {
                cells: (0..tally.cells()).map(cell).collect(),
                normalisation: Cost { spent: pooling, elapsed }.estimate(pools),
                acceptance: share(|o| o.small),
                large_acceptance: share(|o| o.large),
            })
        })
    }

    fn validate(&self, cells: usize) -> Result<(), Error> {
        if cells < 2 {
            let why =
                "Metropolis moves effort between cells, and cannot help with a single number (theory (4.13.5)): solve with the walk itself";
            return Err(Error::invalid("cells", cells as f64, why));
        }
        if self.chains < 20 {
            return Err(Error::invalid("chains", self.chains as f64, "must be at least 20: the interval comes from them"));
        }
        Error::held("chains", self.chains)?;
        Error::held("cells", cells as u64)?;
        Error::held("pool", self.pool)?;
        check_budget("mutations", self.mutations, None)?;
        check_budget("pool", self.pool, None)?;
        if !(self.large > 0.0 && self.large <= 1.0) {
            return Err(Error::invalid(
                "large step probability",
                self.large,
                "must lie in (0, 1]: without fresh points a chain may never leave its island",
            ));
        }
        let (least, most) = self.steps;
        if !(least > 0.0 && least <= most) {
            return Err(Error::invalid("least small step", least, "must be positive and not above the largest"));
        }
        if !(most <= 0.5) {
            return Err(Error::invalid("largest small step", most, "must be at most 1/2: the cube is wrapped around"));
        }
        Ok(())
    }
}

impl Default for Metropolis {
    fn default() -> Self {
        Metropolis::new()
    }
}

/// What all chains cost together.
#[derive(Clone, Copy)]
struct Cost {
    spent: Spent,
    elapsed: Duration,
}

impl Cost {
    fn estimate<V: Value>(self, pooled: Pooled<V>) -> Estimate<V> {
        let Pooled { moments, std_error, degrees_of_freedom } = pooled;
        let Cost { spent: Spent { steps, evaluations }, elapsed } = self;
        let value = moments.mean;
        Estimate { value, std_error, degrees_of_freedom, moments, tail: None, steps, evaluations, truncation: None, elapsed }
    }
}

fn pooled<'a>(pools: impl Iterator<Item = &'a Moments<f64>>) -> Pooled<f64> {
    Pooled::independent(&pools.copied().collect::<Vec<_>>())
}
