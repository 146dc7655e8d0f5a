//! Several unbiased estimators of one quantity, combined with the weights of least variance.
//!
//! ```text
//! Y = Σ_k a_k Y_k,      a = S⁻¹1 / (1ᵀS⁻¹1),   S = Cov(Y₁, Y₂, …)                                                       theory (4.15.1)
//! ```
//!
//! Derivation: E Y = Σ a_k E Y_k = I for all a with Σ a_k = 1; least aᵀSa by Lagrange. S comes from a pilot on points of its own: from the same scores the
//! result would be biased. Weights may be negative, for estimators with common errors. Never worse than the best member but for the pilot's noise, of relative
//! size members/pilot. Every member walks for every score: what a bad member costs is not weighed against what it brings; its weight is reported.
//! Reference: Halton, *On the relative merits of correlated and importance sampling* (1965); Graybill, Deal, *Combining unbiased estimators*,
//! Biometrics 15 (1959) 543.

use super::Estimator;
use super::covariance::{covariance, weights};
use super::run::{Block, check_budget, estimate, score_block};
use crate::contained::contained;
use crate::error::Error;
use crate::sampling::{Pcg, Sequence};
use crate::statistics::Estimate;
use crate::value::Value;
use nalgebra::DVector;
use std::ops::Range;

/// Whether members read the same points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coupling {
    /// Score i of every member is from point i: errors are correlated, and the weights make use of it.
    #[default]
    Common,
    /// Every member has points of its own: independent errors.
    Separate,
}

/// An estimator of any type, block by block.
trait Member<V, Q>: Send + Sync {
    fn cells(&self) -> usize;
    fn scores(&self, sequence: &Q, cell: usize, stream: (u64, u32), indices: Range<u64>) -> Result<Block<V>, Error>;
}

impl<T: Estimator, Q: Sequence> Member<T::Value, Q> for T {
    fn cells(&self) -> usize {
        Estimator::cells(self)
    }
    fn scores(&self, sequence: &Q, cell: usize, stream: (u64, u32), indices: Range<u64>) -> Result<Block<T::Value>, Error> {
        score_block(self, sequence, cell, stream, indices)
    }
}

/// Unbiased estimators of one quantity, run together.
///
/// ```
/// use fredholm::{Equation, Walk, estimator::Combination, walk::Roulette};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let f = eq.at(0.5);
/// let best = Combination::new()
///     .with(f.estimator(&Walk::collision())?)
///     .with(f.estimator(&Walk::next_event())?)
///     .with(f.estimator(&Walk::absorption().roulette(Roulette::constant(0.5)))?)
///     .samples_per_cell(1 << 14)
///     .solve()?;
/// assert!(best[0].estimate.agrees_with(1.15, 5.0));
/// assert!((best[0].weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[must_use]
pub struct Combination<'a, V, Q = Pcg> {
    members: Vec<Box<dyn Member<V, Q> + 'a>>,
    sequence: Q,
    coupling: Coupling,
    pilot: u64,
    samples: u64,
}

impl<V, Q: std::fmt::Debug> std::fmt::Debug for Combination<'_, V, Q> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Combination { members, sequence, coupling, pilot, samples } = self;
        let (n, mut f) = (members.len(), f.debug_struct("Combination"));
        f.field("members", &n)
            .field("sequence", sequence)
            .field("coupling", coupling)
            .field("pilot", pilot)
            .field("samples", samples)
            .finish()
    }
}

/// The estimate of one cell and how it came about.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Combined<V = f64> {
    /// From the scores Σ a_k Y_k of the main run.
    pub estimate: Estimate<V>,
    /// a_k of every member, by components of the value.
    pub weights: Vec<V>,
    /// Variance of one score of every member in the pilot.
    pub variances: Vec<V>,
    /// aᵀSa: variance of one combined score in the pilot; a little too low, since it chose a.
    pub predicted: V,
    /// Scores of every member in the pilot.
    pub pilot: u64,
}

/// Streams of the sequence: cells × members × {main run, pilot}.
const MEMBER: u64 = 1 << 40;
const PILOT: u64 = 1 << 62;

impl<'a, V: Value> Combination<'a, V, Pcg> {
    /// No members yet; 16 384 scores a cell, 1024 of a pilot, common points, PCG with seed 0.
    pub fn new() -> Self {
        Combination { members: Vec::new(), sequence: Pcg::default(), coupling: Coupling::Common, pilot: 1 << 10, samples: 1 << 14 }
    }
}

impl<V: Value> Default for Combination<'_, V, Pcg> {
    fn default() -> Self {
        Combination::new()
    }
}

impl<'a, V: Value, Q: Sequence> Combination<'a, V, Q> {
    /// The same settings with points of another sequence, to be chosen before the members.
    pub fn sequence<R: Sequence>(self, sequence: R) -> Combination<'a, V, R> {
        let Combination { coupling, pilot, samples, .. } = self;
        Combination { members: Vec::new(), sequence, coupling, pilot, samples }
    }

    /// One more estimator of the same cells.
    pub fn with(mut self, estimator: impl Estimator<Value = V> + 'a) -> Self {
        self.members.push(Box::new(estimator));
        self
    }

    /// Whether members read the same points.
    pub fn coupling(self, coupling: Coupling) -> Self {
        Combination { coupling, ..self }
    }

    /// Scores of every member in the pilot, for every cell.
    pub fn pilot(self, pilot: u64) -> Self {
        Combination { pilot, ..self }
    }

    /// Scores of every member in the main run, for every cell.
    pub fn samples_per_cell(self, samples: u64) -> Self {
        Combination { samples, ..self }
    }

    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Combination { sequence: self.sequence.with_seed(seed), ..self }
    }

    /// Estimates every cell.
    ///
    /// # Errors
    /// [`Error::Invalid`] without members, with a pilot below two scores a member, or if members differ in their number of cells; whatever a member's scores
    /// have as their [explanation](Estimator::explain).
    pub fn solve(&self) -> Result<Vec<Combined<V>>, Error> {
        contained(|| {
            let Some(first) = self.members.first() else {
                return Err(Error::invalid("members", 0.0, "there must be at least one"));
            };
            let cells = first.cells();
            if let Some(other) = self.members.iter().find(|m| m.cells() != cells) {
                return Err(Error::invalid("cells of a member", other.cells() as f64, "must be those of the first"));
            }
            let least = 2 * self.members.len() as u64;
            if self.pilot < least {
                return Err(Error::invalid("pilot", self.pilot as f64, "must be at least twice the number of members"));
            }
            Error::held("pilot", self.pilot)?;
            check_budget("samples_per_cell", self.samples, self.sequence.replicates())?;
            (0..cells).map(|cell| self.cell(cell)).collect()
        })
    }

    fn cell(&self, cell: usize) -> Result<Combined<V>, Error> {
        let pilot: Vec<Vec<V>> =
            (0..self.members.len()).map(|k| Ok(self.member(k, cell, PILOT, 0, 0..self.pilot)?.scores)).collect::<Result<_, Error>>()?;
        let parts: Vec<Plan> = (0..V::COMPONENTS).map(|c| Plan::of(&pilot, c)).collect();
        let weights: Vec<V> = (0..pilot.len()).map(|k| V::from_components(|c| parts[c].weights[k])).collect();
        let estimate = estimate(self.sequence.replicates(), self.samples, &|replicate, indices| {
            let mut sum = Block { scores: vec![V::ZERO; (indices.end - indices.start) as usize], steps: 0, evaluations: 0 };
            for (k, a) in weights.iter().enumerate() {
                let block = self.member(k, cell, 0, replicate, indices.clone())?;
                sum.scores.iter_mut().zip(&block.scores).for_each(|(s, y)| *s += a.zip(*y, |a, y| a * y));
                sum.steps += block.steps;
                sum.evaluations += block.evaluations;
            }
            Ok(sum)
        })?;
        let variances = (0..pilot.len()).map(|k| V::from_components(|c| parts[c].variances[k])).collect();
        Ok(Combined { estimate, weights, variances, predicted: V::from_components(|c| parts[c].predicted), pilot: self.pilot })
    }

    fn member(&self, k: usize, cell: usize, offset: u64, replicate: u32, indices: Range<u64>) -> Result<Block<V>, Error> {
        let own = if self.coupling == Coupling::Separate { k as u64 * MEMBER } else { 0 };
        self.members[k].scores(&self.sequence, cell, (offset + own + cell as u64, replicate), indices)
    }
}

/// The weights of one component.
struct Plan {
    weights: DVector<f64>,
    variances: DVector<f64>,
    predicted: f64,
}

impl Plan {
    fn of<V: Value>(pilot: &[Vec<V>], component: usize) -> Self {
        let columns: Vec<Vec<f64>> = pilot.iter().map(|y| y.iter().map(|y| y.component(component)).collect()).collect();
        let s = covariance(&columns);
        // a member that never scored shows no variance, which is not to say that it has none
        let seen: Vec<usize> = (0..columns.len()).filter(|k| columns[*k].iter().any(|y| *y != 0.0)).collect();
        let a = if seen.is_empty() {
            weights(&s)
        } else {
            scatter(&weights(&s.select_rows(&seen).select_columns(&seen)), &seen, columns.len())
        };
        Plan { predicted: a.dot(&(&s * &a)), variances: s.diagonal(), weights: a }
    }
}

/// Entries at the places `at`, zeros elsewhere.
fn scatter(entries: &DVector<f64>, at: &[usize], count: usize) -> DVector<f64> {
    let mut all = DVector::zeros(count);
    at.iter().zip(entries.iter()).for_each(|(k, a)| all[*k] = *a);
    all
}
