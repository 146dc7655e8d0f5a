//! Stratified sampling.
//!
//! ```text
//! Î = Σ_i v_i (1/n_i) Σ_j Y_ij,   Y_ij scores in stratum i of volume v_i,        V = Σ_i v_i² σ_i²/n_i
//! ```
//!
//! With n_i = n v_i the variance *between* strata is gone: V ≤ that of the secondary estimator, always. One sample in each of n equal cells (jittered)
//! gives an error of n^−(½ + 1/d) for smooth f, n^−3/2 on a line, but nothing to measure it by: repeat it independently. Other allocations may be worse than no
//! strata at all (theory (4.14.5)). Reference: Cochran, *Sampling techniques* (1977), ch. 5; Haber, *A modified Monte-Carlo quadrature*, Math.
//! Comp. 20 (1966) 361.

use super::draw::{BATCH, CHUNK, Drawn, Probe, all, chunk};
use super::plain::Plain;
use super::secondary::{Primary, validate};
use super::{Allocation, Integral, Integrator, Strata};
use crate::domain::Domain;
use crate::error::Error;
use crate::sampling::{Pcg, Sequence, pilot_points};
use crate::source::Source;
use crate::statistics::{Estimate, Moments, Pooled};
use crate::value::Value;
use std::time::Instant;

/// A primary estimator in every stratum of the cube.
///
/// The error comes from the scatter within strata, if each has at least two samples; otherwise from independent replicates of the whole, if there are any.
///
/// ```
/// use fredholm::integral::{Integral, Secondary, Strata, Stratified};
/// let integral = Integral::on_interval(0.0..=1.0, f64::exp);
/// let strata = integral.solve(&Stratified::new(Strata::uniform(64)).samples(1 << 14))?;
/// let plain = integral.solve(&Secondary::plain().samples(1 << 14))?;
/// assert!(strata.agrees_with(1f64.exp() - 1.0, 5.0));
/// assert!(strata.std_error.unwrap() < plain.std_error.unwrap() / 50.0);
/// // one sample a cell, repeated 20 times for the error
/// let jittered = integral.solve(&Stratified::jittered(Strata::uniform(1024), 20))?;
/// assert!(jittered.std_error.unwrap() < 1e-5);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Stratified<P = Plain, Q = Pcg> {
    primary: P,
    pub(super) strata: Strata,
    pub(super) allocation: Allocation,
    sequence: Q,
    pub(super) samples: u64,
    pub(super) replicates: u32,
}

impl Stratified {
    /// Proportional allocation of 16 384 samples, PCG with seed 0, error from within the strata.
    pub fn new(strata: Strata) -> Self {
        Stratified::of(Plain, strata)
    }

    /// One sample in each stratum, the whole repeated `replicates` times. Equal strata make it jittered sampling.
    pub fn jittered(strata: Strata, replicates: u32) -> Self {
        let samples = (strata.count() as u64).saturating_mul(u64::from(replicates));
        Stratified { allocation: Allocation::Equal, samples, replicates, ..Stratified::new(strata) }
    }
}

impl<P> Stratified<P> {
    /// Your own primary estimator in every stratum.
    pub fn of(primary: P, strata: Strata) -> Self {
        let (allocation, sequence) = (Allocation::Proportional, Pcg::default());
        Stratified { primary, strata, allocation, sequence, samples: 1 << 14, replicates: 1 }
    }
}

impl<P: Clone, Q: Sequence> Stratified<P, Q> {
    /// Scores in all strata and replicates together, rounded up in every stratum.
    pub fn samples(self, samples: u64) -> Self {
        Stratified { samples, ..self }
    }

    /// How they are shared between strata.
    pub fn allocation(self, allocation: Allocation) -> Self {
        Stratified { allocation, ..self }
    }

    /// Repeats the whole, each time with a share of the samples; from two on the error comes from the repetitions. A sequence with replicates of its own
    /// has its own number.
    pub fn replicates(self, replicates: u32) -> Self {
        Stratified { replicates, ..self }
    }

    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Stratified { sequence: self.sequence.with_seed(seed), ..self }
    }

    /// Draws from another sequence, in every stratum on its own.
    pub fn sequence<R: Sequence>(self, sequence: R) -> Stratified<P, R> {
        let Stratified { primary, strata, allocation, samples, replicates, .. } = self;
        Stratified { primary, strata, allocation, sequence, samples, replicates }
    }

    fn repetitions(&self) -> u32 {
        self.sequence.replicates().unwrap_or(self.replicates)
    }

    /// Moments of every stratum in one replicate, and the evaluations; strata begin at cell `first` of the sequence.
    fn replicate<D, G>(
        &self,
        integral: &Integral<D, G>,
        primary: &P,
        (first, replicate): (u64, u32),
        counts: &[u64],
    ) -> Result<Vec<Drawn<G::Value>>, Error>
    where
        D: Domain,
        G: Source<Point = D::Point>,
        P: Primary<D, G::Value>,
    {
        // strata of few samples are grouped, so that a task is worth its while
        let mean = counts.iter().sum::<u64>() / counts.len() as u64;
        let group = (CHUNK / mean.max(1)).max(1) as usize;
        let parts = all(counts.len().div_ceil(group) as u64, &|g| {
            let one = |i: usize| self.stratum(integral, primary, (first, replicate), i, counts[i]);
            (g as usize * group..((g as usize + 1) * group).min(counts.len())).map(one).collect::<Result<Vec<_>, Error>>()
        });
        Ok(parts?.into_iter().flatten().collect())
    }

    /// `count` scores in stratum `i`.
    fn stratum<D, G>(
        &self,
        integral: &Integral<D, G>,
        primary: &P,
        (first, replicate): (u64, u32),
        i: usize,
        count: u64,
    ) -> Result<Drawn<G::Value>, Error>
    where
        D: Domain,
        G: Source<Point = D::Point>,
        P: Primary<D, G::Value>,
    {
        let score = |probe: &Probe<'_, D, G>, u: &mut Q::Sampler| {
            primary.score(integral.domain(), &|x| probe.eval(x), &mut self.strata.confine(i, u))
        };
        let cell = first + i as u64;
        if count <= CHUNK {
            return chunk(integral, &self.sequence, (cell, replicate), 0..count, f64::INFINITY, &score);
        }
        // many samples: chunks in parallel
        let mut sum = Drawn { moments: Moments::default(), tail: Default::default(), evaluations: 0 };
        let chunks = count.div_ceil(CHUNK);
        for from in (0..chunks).step_by(BATCH as usize) {
            let drawn = all((chunks - from).min(BATCH), &|c| {
                let start = (from + c) * CHUNK;
                chunk(integral, &self.sequence, (cell, replicate), start..(start + CHUNK).min(count), f64::INFINITY, &score)
            });
            for part in drawn? {
                sum.moments.merge(&part.moments);
                sum.evaluations += part.evaluations;
            }
        }
        Ok(sum)
    }

    /// σ_i of every stratum from a pilot on points of its own, and the evaluations.
    fn spread<D, G>(&self, integral: &Integral<D, G>, primary: &P, points: &Pcg) -> Result<(Vec<f64>, u64), Error>
    where
        D: Domain,
        G: Source<Point = D::Point>,
        P: Primary<D, G::Value>,
    {
        let Allocation::Neyman { pilot } = self.allocation else { return Ok((Vec::new(), 0)) };
        // the first cells belong to the primary's own pilots
        let parts = self.clone().sequence(*points).replicate(integral, primary, (2, 0), &vec![pilot; self.strata.count()])?;
        let evaluations = parts.iter().map(|p| p.evaluations).sum();
        let spread = parts.iter().map(|p| p.moments.variance().map_or(0.0, |v| v.magnitude().sqrt())).collect();
        Ok((spread, evaluations))
    }
}

/// One estimate from the strata: moments of the scores scaled so that their mean is Σ v_i ȳ_i, and the error from within the strata.
fn assemble<V: Value>(strata: &Strata, parts: &[Drawn<V>]) -> (Moments<V>, Option<V>, u64) {
    let total = parts.iter().map(|p| p.moments.count).sum::<u64>() as f64;
    let (mut all, mut variance, mut fourth) = (Moments::default(), Some(V::ZERO), V::ZERO);
    for (i, part) in parts.iter().enumerate() {
        let m = &part.moments;
        all.merge(&m.scaled(strata.volume(i) * total / m.count as f64));
        let own = m.variance().map(|v| v.scale(strata.volume(i).powi(2) / m.count as f64));
        variance = variance.zip(own).map(|(sum, v)| sum + v);
        // E s⁴ = σ⁴ (ν + 2)/ν for ν = n_i − 1: ν + 2 in the place of ν makes σ⁴ unbiased
        fourth += own.map_or(V::ZERO, |v| v.map(|v| v * v / (m.count + 1) as f64));
    }
    // Welch (1947) and Satterthwaite (1946), ν = (Σ s²)²/Σ(s⁴/(ν_i + 2)) − 2, exact for one stratum; the least of all components
    let spare = (total as u64).saturating_sub(parts.len() as u64);
    let degrees = variance.map_or(0, |variance| {
        let of = |i: usize| {
            let (v, f) = (variance.component(i), fourth.component(i));
            if f > 0.0 { ((v * v / f).round() as u64).saturating_sub(2).clamp(1, spare.max(1)) } else { spare }
        };
        (0..V::COMPONENTS).map(of).min().unwrap_or(0)
    });
    (all, variance.map(|v| v.map(f64::sqrt)), degrees)
}

impl<D, G, P, Q> Integrator<D, G> for Stratified<P, Q>
where
    D: Domain,
    G: Source<Point = D::Point>,
    P: Primary<D, G::Value>,
    Q: Sequence,
{
    type Solution = Estimate<G::Value>;

    fn solve(&self, integral: &Integral<D, G>) -> Result<Estimate<G::Value>, Error> {
        let clock = Instant::now();
        integral.validate()?;
        self.primary.validate()?;
        self.strata.validate()?;
        self.allocation.validate()?;
        let repetitions = self.repetitions();
        validate(self.samples, Some(repetitions))?;
        let points = pilot_points(&self.sequence);
        let (primary, tuning) = self.primary.tuned(integral, &points)?;
        let (spread, pilot) = self.spread(integral, &primary, &points)?;
        let counts = self.allocation.counts(&self.strata, self.samples.div_ceil(u64::from(repetitions)), &spread);
        let (mut wholes, mut evaluations, mut within) = (Vec::new(), tuning + pilot, None);
        for r in 0..repetitions {
            let parts = self.replicate(integral, &primary, (0, r), &counts)?;
            evaluations += parts.iter().map(|p| p.evaluations).sum::<u64>();
            let (whole, std_error, freedom) = assemble(&self.strata, &parts);
            wholes.push(whole);
            within = Some((std_error, freedom));
        }
        let mut pooled = Pooled::randomised(&wholes);
        if self.sequence.replicates().is_none() && repetitions == 1 {
            let (std_error, freedom) = within.unwrap_or((None, 0));
            pooled = Pooled::new(pooled.moments, std_error, freedom);
        }
        let Pooled { moments, std_error, degrees_of_freedom } = pooled;
        Ok(Estimate {
            value: moments.mean,
            std_error,
            degrees_of_freedom,
            moments,
            tail: None,
            steps: 0,
            evaluations,
            truncation: None,
            elapsed: clock.elapsed(),
        })
    }
}
