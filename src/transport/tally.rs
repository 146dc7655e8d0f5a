//! What forward histories score in the bins of a slab.
//!
//! ```text
//! collision      Φ_bin = (1/Δ) E[Σ w over collisions in the bin]                     Σ_t = 1: collision rate = flux
//! track length   Φ_bin = (1/Δ) E[Σ w · (length of the path inside the bin)]
//! ```
//!
//! Derivation: Φ dx dt is both the mean number of collisions (cross-section 1) and the mean path length in dx. A path scores in every bin it
//! crosses, even without colliding: less variance, above all in thin or empty regions, for more work a flight. Reference: Spanier, Gelbard (1969),
//! §2.6; Lux, Koblinger (1991), §3.III.

use crate::domain::Interval;
use crate::error::Error;
use crate::statistics::{Bias, Estimate, Profile};
use std::fmt::Debug;

/// Equal bins of a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    thickness: f64,
    bins: usize,
    width: f64,
    per_length: f64,
}

impl Grid {
    /// `bins` equal bins of `slab`.
    ///
    /// # Errors
    /// [`Error::Invalid`] for 0 bins.
    pub(super) fn new(slab: &Interval, bins: usize) -> Result<Self, Error> {
        if bins == 0 {
            return Err(Error::invalid("bins", 0.0, "must be at least 1"));
        }
        let thickness = slab.length();
        Ok(Grid { thickness, bins, width: thickness / bins as f64, per_length: bins as f64 / thickness })
    }

    /// Number of bins.
    #[inline]
    #[must_use]
    pub fn bins(&self) -> usize {
        self.bins
    }

    /// Δ.
    #[inline]
    #[must_use]
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The bin of x ∈ [0, a].
    #[inline]
    #[must_use]
    pub fn bin(&self, x: f64) -> usize {
        ((x * self.per_length) as usize).min(self.bins - 1)
    }

    /// Left end of bin `i`; the right end of the last bin is `edge(bins)`.
    #[inline]
    #[must_use]
    pub fn edge(&self, i: usize) -> f64 {
        i as f64 * self.width
    }

    /// Middle of bin `i`.
    #[must_use]
    pub fn centre(&self, i: usize) -> f64 {
        (i as f64 + 0.5) * self.width
    }

    /// a.
    #[must_use]
    pub fn thickness(&self) -> f64 {
        self.thickness
    }
}

/// A straight path inside the slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Where it begins.
    pub from: f64,
    /// Where it collides, or the face through which it leaves.
    pub to: f64,
    /// Direction cosine μ.
    pub cosine: f64,
    /// Length of the path between the two.
    pub length: f64,
    /// Weight of the particle.
    pub weight: f64,
}

/// A rule that scores flights and collisions in bins. Pairs `(A, B)` score both in the same histories.
pub trait Tally: Copy + Debug + Send + Sync + 'static {
    /// Sums of one batch.
    type Bins: Send;
    /// The result: [`Flux`], or a pair of results.
    type Flux;

    /// All zero.
    fn empty(&self, grid: &Grid) -> Self::Bins;

    /// Scores a flight.
    #[inline]
    fn flight(&self, grid: &Grid, bins: &mut Self::Bins, flight: &Flight) {
        let _ = (grid, bins, flight);
    }

    /// Scores a collision at x of a particle of this weight.
    #[inline]
    fn collision(&self, grid: &Grid, bins: &mut Self::Bins, x: f64, weight: f64) {
        let _ = (grid, bins, x, weight);
    }

    /// From the sums of all batches of `size` histories, in order; `estimate` turns one sum a batch into a mean with its error.
    fn finish(&self, grid: &Grid, batches: Vec<Self::Bins>, size: u64, estimate: &dyn Fn(&[f64]) -> Estimate) -> Self::Flux;
}

/// The scalar flux Φ, averaged over each bin, with its error.
#[derive(Clone, Debug)]
pub struct Flux {
    grid: Grid,
    bins: Vec<Estimate>,
    /// Φ of every bin, batch by batch
    batches: Vec<Vec<f64>>,
}

impl Flux {
    /// The bins' places.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Φ of every bin. The scores behind an estimate are the batches' means, so `samples()` counts batches.
    #[must_use]
    pub fn bins(&self) -> &[Estimate] {
        &self.bins
    }

    /// The flux as a curve through the middles of the bins, with covariances and a band that holds for all bins at once.
    ///
    /// ```
    /// use fredholm::transport::{Histories, Slab, TrackTally};
    /// let slab = Slab::new(2.0).scattering(0.8);
    /// let flux = Histories::new(TrackTally).bins(10).run(&slab, &slab.uniform(1.0))?.flux.profile();
    /// let band = flux.band(0.95).expect("100 batches");
    /// assert!(band.critical > 2.0 && band.lower[5] < flux.values()[5]);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    #[must_use]
    pub fn profile(&self) -> Profile<f64> {
        let points = (0..self.grid.bins).map(|i| self.grid.centre(i)).collect();
        let verdicts = self.bins.iter().map(Estimate::verdict).collect();
        let bias = Bias::CellMeans { width: self.grid.width };
        Profile::of_batches(points, self.batches.clone(), verdicts, self.bins.clone(), bias)
    }

    /// Mean over the bins of the relative variance of Φ: the σ² of the figure of merit 1/(σ²T). `None` with one batch, or where nothing scored.
    #[must_use]
    pub fn relative_variance(&self) -> Option<f64> {
        let one = |e: &Estimate| e.std_error.map(|s| (s / e.value).powi(2)).filter(|v| v.is_finite());
        let sum: Option<f64> = self.bins.iter().map(one).sum();
        sum.map(|s| s / self.bins.len() as f64)
    }
}

fn flux(grid: &Grid, mut batches: Vec<Vec<f64>>, size: u64, estimate: &dyn Fn(&[f64]) -> Estimate) -> Flux {
    let bin = |i: usize| estimate(&batches.iter().map(|b| b[i] / grid.width).collect::<Vec<_>>());
    let bins = (0..grid.bins).map(bin).collect();
    batches.iter_mut().flatten().for_each(|sum| *sum /= grid.width * size as f64);
    Flux { grid: *grid, bins, batches }
}

/// Scores the weight at every collision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CollisionTally;

impl Tally for CollisionTally {
    type Bins = Vec<f64>;
    type Flux = Flux;
    fn empty(&self, grid: &Grid) -> Vec<f64> {
        vec![0.0; grid.bins]
    }
    #[inline]
    fn collision(&self, grid: &Grid, bins: &mut Vec<f64>, x: f64, weight: f64) {
        bins[grid.bin(x)] += weight;
    }
    fn finish(&self, grid: &Grid, batches: Vec<Vec<f64>>, size: u64, estimate: &dyn Fn(&[f64]) -> Estimate) -> Flux {
        flux(grid, batches, size, estimate)
    }
}

/// Scores weight × path length in every bin that a flight crosses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackTally;

impl Tally for TrackTally {
    type Bins = Vec<f64>;
    type Flux = Flux;
    fn empty(&self, grid: &Grid) -> Vec<f64> {
        vec![0.0; grid.bins]
    }
    #[inline]
    fn flight(&self, grid: &Grid, bins: &mut Vec<f64>, flight: &Flight) {
        let (low, high) = if flight.from < flight.to { (flight.from, flight.to) } else { (flight.to, flight.from) };
        let (first, last) = (grid.bin(low), grid.bin(high));
        if first == last {
            bins[first] += flight.weight * flight.length;
            return;
        }
        // path length for each unit of depth; μ ≠ 0, since the flight crosses an edge
        let slant = flight.weight / flight.cosine.abs();
        bins[first] += (grid.edge(first + 1) - low) * slant;
        let whole = grid.width * slant;
        bins[first + 1..last].iter_mut().for_each(|b| *b += whole);
        bins[last] += (high - grid.edge(last)) * slant;
    }
    fn finish(&self, grid: &Grid, batches: Vec<Vec<f64>>, size: u64, estimate: &dyn Fn(&[f64]) -> Estimate) -> Flux {
        flux(grid, batches, size, estimate)
    }
}

impl<A: Tally, B: Tally> Tally for (A, B) {
    type Bins = (A::Bins, B::Bins);
    type Flux = (A::Flux, B::Flux);
    fn empty(&self, grid: &Grid) -> Self::Bins {
        (self.0.empty(grid), self.1.empty(grid))
    }
    #[inline]
    fn flight(&self, grid: &Grid, bins: &mut Self::Bins, flight: &Flight) {
        self.0.flight(grid, &mut bins.0, flight);
        self.1.flight(grid, &mut bins.1, flight);
    }
    #[inline]
    fn collision(&self, grid: &Grid, bins: &mut Self::Bins, x: f64, weight: f64) {
        self.0.collision(grid, &mut bins.0, x, weight);
        self.1.collision(grid, &mut bins.1, x, weight);
    }
    fn finish(&self, grid: &Grid, batches: Vec<Self::Bins>, size: u64, estimate: &dyn Fn(&[f64]) -> Estimate) -> Self::Flux {
        let (a, b) = batches.into_iter().unzip();
        (self.0.finish(grid, a, size, estimate), self.1.finish(grid, b, size, estimate))
    }
}
