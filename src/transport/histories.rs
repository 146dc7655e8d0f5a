//! Forward analog histories: particles are born, fly, collide, are captured or leave, as in nature.
//!
//! ```text
//! x₀ ~ S/∫S (weight S/q₀);   loop:  y = x + μs;   leaves?   collides at y;   captured with probability 1 − c;   isotropic new μ
//! ```
//!
//! One run gives the flux of every bin at once, where backward walks answer for one point at a time. History i reads point i of the sequence,
//! whatever the batches and threads: results have the same bits on any number of threads. Errors come from the batches, as bins of the same history are
//! correlated and most bins of a history stay empty. Reference: Spanier, Gelbard (1969), ch. 2; Lux, Koblinger (1991), §2.

use super::{Flight, Grid, Slab, Tally};
use crate::contained::contained;
use crate::error::Error;
use crate::kernel::{HasDomain, Operator};
use crate::parallel;
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::source::Emit;
use crate::statistics::{Estimate, Moments};
use std::time::{Duration, Instant};

/// Analog histories from an isotropic source S in a [`Slab`] with c ≤ 1, and what is tallied.
///
/// ```
/// use fredholm::transport::{CollisionTally, Histories, Slab};
/// let slab = Slab::new(10.0).scattering(0.9);
/// let run = Histories::new(CollisionTally).bins(20).histories(20_000).seed(7).run(&slab, &slab.uniform(1.0))?;
/// println!("flux in the middle {}, leakage to the left {}", run.flux.bins()[10], run.left.rate);
/// assert!(run.left.rate.agrees_with(1.295_321_788_037_631, 5.0));
/// assert_eq!(run.captured.count + run.left.count + run.right.count, run.histories);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Histories<T> {
    tally: T,
    bins: usize,
    histories: u64,
    batches: u64,
    max_collisions: u64,
    sequence: Pcg,
}

/// How many histories ended in one way, and the rate of particles that do.
#[derive(Clone, Debug)]
pub struct Fate {
    /// Histories.
    pub count: u64,
    /// Particles for each unit of time and area, in units of S × length.
    pub rate: Estimate,
}

/// What a run of [`Histories`] found. Balance: `captured.count + left.count + right.count == histories`.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Outcome<F> {
    /// The tally's result.
    pub flux: F,
    /// Captured in a collision.
    pub captured: Fate,
    /// Left through x = 0.
    pub left: Fate,
    /// Left through x = a.
    pub right: Fate,
    /// Histories.
    pub histories: u64,
    /// Collisions of all histories.
    pub collisions: u64,
    /// Wall time. Never influences a number.
    pub elapsed: Duration,
}

/// Sums of one batch.
struct Batch<B> {
    bins: B,
    collisions: u64,
    /// by [`End`]
    counts: [u64; 3],
    weights: [f64; 3],
}

#[derive(Clone, Copy)]
enum End {
    Captured,
    Left,
    Right,
    /// More than `max_collisions`.
    Endless,
}

impl<T: Tally> Histories<T> {
    /// 100 bins, 100 000 histories in 100 batches, seed 0.
    pub fn new(tally: T) -> Self {
        Histories { tally, bins: 100, histories: 100_000, batches: 100, max_collisions: 1_000_000, sequence: Pcg::default() }
    }

    /// Equal bins of the slab.
    pub fn bins(self, bins: usize) -> Self {
        Histories { bins, ..self }
    }

    /// Histories in all; rounded up to a multiple of the batches.
    pub fn histories(self, histories: u64) -> Self {
        Histories { histories, ..self }
    }

    /// Batches from whose spread the errors come; with a single one there are none.
    pub fn batches(self, batches: u64) -> Self {
        Histories { batches, ..self }
    }

    /// A history of more collisions is an [`Error::WalkTooLong`].
    pub fn max_collisions(self, max_collisions: u64) -> Self {
        Histories { max_collisions, ..self }
    }

    /// Sets the seed.
    pub fn seed(self, seed: u64) -> Self {
        Histories { sequence: Pcg::new(seed), ..self }
    }

    /// Runs all histories.
    ///
    /// # Errors
    /// [`Error::Invalid`] for c > 1 (an analog collision would have to split the particle), zero counts, and whatever the slab and the source refuse;
    /// [`Error::NonFiniteSource`]; [`Error::WalkTooLong`].
    pub fn run<S>(&self, slab: &Slab, source: &S) -> Result<Outcome<T::Flux>, Error>
    where
        S: Emit<Point = f64, Value = f64, State = f64>,
    {
        contained(|| {
            let clock = Instant::now();
            slab.validate()?;
            source.validate()?;
            self.validate(slab)?;
            let grid = Grid::new(slab.domain(), self.bins)?;
            let size = self.histories.div_ceil(self.batches);
            let batches = parallel::map(self.batches as usize, |b| self.batch(slab, source, &grid, (b as u64).saturating_mul(size), size));
            let batches = batches.into_iter().collect::<Result<Vec<_>, Error>>()?;
            Ok(self.merge(&grid, batches, size, clock))
        })
    }

    fn validate(&self, slab: &Slab) -> Result<(), Error> {
        if slab.ratio() > 1.0 {
            return Err(Error::invalid("scattering ratio", slab.ratio(), "analog histories need c ≤ 1; use `Walk` for multiplying slabs"));
        }
        for (parameter, count) in [("histories", self.histories), ("batches", self.batches), ("max_collisions", self.max_collisions)] {
            if count == 0 {
                return Err(Error::invalid(parameter, 0.0, "must be at least 1"));
            }
        }
        Error::held("batches", self.batches)
    }

    fn batch<S>(&self, slab: &Slab, source: &S, grid: &Grid, from: u64, size: u64) -> Result<Batch<T::Bins>, Error>
    where
        S: Emit<Point = f64, Value = f64, State = f64>,
    {
        let mut batch = Batch { bins: self.tally.empty(grid), collisions: 0, counts: [0; 3], weights: [0.0; 3] };
        // the next history's point is prepared while this one runs: its hash then costs no latency
        let mut next = self.sequence.point(0, 0, from);
        for index in from..from.saturating_add(size) {
            let mut u = std::mem::replace(&mut next, self.sequence.point(0, 0, index + 1));
            let birth = source.emit(&mut u);
            if !birth.weight.is_finite() {
                return Err(Error::non_finite_source(&birth.point, &birth.weight));
            }
            let (end, collisions) = self.history(slab, grid, birth.point, birth.weight, &mut u, &mut batch.bins);
            if matches!(end, End::Endless) {
                return Err(Error::WalkTooLong { cell: 0, walk: index, steps: collisions });
            }
            batch.collisions += collisions;
            batch.counts[end as usize] += 1;
            batch.weights[end as usize] += birth.weight;
        }
        Ok(batch)
    }

    #[inline]
    fn history<U: Sampler>(&self, slab: &Slab, grid: &Grid, birth: f64, weight: f64, u: &mut U, bins: &mut T::Bins) -> (End, u64) {
        let (mut x, mut cosine, mut collisions) = (birth, 2.0 * u.next_1d() - 1.0, 0);
        loop {
            let path = -u.next_1d().ln();
            let y = x + cosine * path;
            if !(y > 0.0 && y < slab.thickness()) {
                let (face, end) = if y <= 0.0 { (0.0, End::Left) } else { (slab.thickness(), End::Right) };
                let length = (face - x) / cosine;
                self.tally.flight(grid, bins, &Flight { from: x, to: face, cosine, length, weight });
                return (end, collisions);
            }
            self.tally.flight(grid, bins, &Flight { from: x, to: y, cosine, length: path, weight });
            self.tally.collision(grid, bins, y, weight);
            collisions += 1;
            match slab.scatter(u) {
                None => return (End::Captured, collisions),
                Some(_) if collisions == self.max_collisions => return (End::Endless, collisions),
                Some(next) => (x, cosine) = (y, next),
            }
        }
    }

    fn merge(&self, grid: &Grid, batches: Vec<Batch<T::Bins>>, size: u64, clock: Instant) -> Outcome<T::Flux> {
        let histories = size * batches.len() as u64;
        let collisions: u64 = batches.iter().map(|b| b.collisions).sum();
        let count = |end: End| batches.iter().map(|b| b.counts[end as usize]).sum::<u64>();
        let flights = collisions + count(End::Left) + count(End::Right);
        let elapsed = clock.elapsed();
        let estimate = |sums: &[f64]| {
            let means: Vec<f64> = sums.iter().map(|s| s / size as f64).collect();
            let moments = Moments::from_scores(&means);
            Estimate {
                value: moments.mean,
                std_error: moments.std_error(),
                degrees_of_freedom: moments.count - 1,
                moments,
                tail: None,
                steps: flights,
                evaluations: flights,
                truncation: None,
                elapsed,
            }
        };
        let fate =
            |end: End| Fate { count: count(end), rate: estimate(&batches.iter().map(|b| b.weights[end as usize]).collect::<Vec<_>>()) };
        let (captured, left, right) = (fate(End::Captured), fate(End::Left), fate(End::Right));
        let flux = self.tally.finish(grid, batches.into_iter().map(|b| b.bins).collect(), size, &estimate);
        Outcome { flux, captured, left, right, histories, collisions, elapsed }
    }
}
