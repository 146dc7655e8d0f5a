//! Hammersley points: i/n, then Halton's coordinates.
//!
//! Hammersley, *Monte Carlo methods for solving multivariable problems*, 1960. The number of points is known beforehand, which is worth a
//! factor ln n of discrepancy.

use super::cursor::{Coordinates, PointSampler};
use super::halton::{Halton, HaltonPoint};
use super::permutation::permuted;
use super::settings::{Scrambling, Settings, common_settings};
use crate::error::Error;
use crate::sampling::Sequence;
use crate::sampling::hash::{midpoint, open_unit, word};

/// Hammersley sets of a given number of points in each replicate.
///
/// The first coordinate of point i is i/n; randomised, it is uniform in the i-th of n strata, and the points come in a random order: every
/// point alone is uniform, a set that was interrupted is a random part of it instead of an arc, and the number of a point says nothing about
/// its first coordinate. Points from n on are another set, with later Halton points. Unscrambled, they come in the order of i: take all n.
///
/// ```
/// use fredholm::sampling::{Hammersley, Sampler, Sequence};
/// let mut u = Hammersley::new(10)?.unscrambled().point(0, 0, 5);
/// assert!((u.next_1d() - 0.5).abs() < 1e-15 && (u.next_1d() - 0.625).abs() < 1e-15);
/// assert!(Hammersley::new(0).is_err());
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hammersley {
    settings: Settings,
    points: u64,
}

impl Hammersley {
    /// Sets of `points` points, scrambled by seed 0, 16 replicates.
    ///
    /// # Errors
    /// [`Error::Invalid`] for no points at all.
    pub fn new(points: u64) -> Result<Self, Error> {
        if points == 0 {
            return Err(Error::invalid("points", 0.0, "a set needs at least one point"));
        }
        Ok(Hammersley { settings: Settings::new(0), points })
    }
}

common_settings!(Hammersley);

impl Sequence for Hammersley {
    type Sampler = PointSampler<HammersleyPoint>;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> Self::Sampler {
        let Settings { scrambling, layout, .. } = self.settings;
        let key = self.settings.key(cell, replicate);
        let index = match scrambling {
            Scrambling::Nested => shuffled(index, self.points, key),
            Scrambling::None => index,
        };
        PointSampler::new(HammersleyPoint { halton: HaltonPoint { key, index, scrambling }, points: self.points }, layout)
    }

    fn with_seed(self, seed: u64) -> Self {
        Hammersley { settings: self.settings.with_seed(seed), ..self }
    }

    fn replicates(&self) -> Option<u32> {
        Some(self.settings.replicates)
    }

    fn is_randomised(&self) -> bool {
        self.settings.is_randomised()
    }
}

/// One Hammersley point.
#[derive(Clone, Debug)]
pub struct HammersleyPoint {
    halton: HaltonPoint,
    points: u64,
}

impl HammersleyPoint {
    fn first(&self) -> f64 {
        let HaltonPoint { key, index, scrambling } = self.halton;
        let within = match scrambling {
            Scrambling::None => 0.0,
            Scrambling::Nested => open_unit(word(word(key, u64::MAX - 1), index)),
        };
        midpoint(((index % self.points) as f64 + within) / self.points as f64)
    }
}

/// A random order within every set of n.
fn shuffled(index: u64, n: u64, key: u64) -> u64 {
    let (set, i) = (index / n, index % n);
    (index - i).wrapping_add(permuted(i, n, word(word(key, u64::MAX - 2), set)))
}

impl Coordinates for HammersleyPoint {
    #[inline]
    fn count(&self) -> u32 {
        Halton::DIMENSIONS + 1
    }

    #[inline]
    fn coordinate(&self, j: u32) -> f64 {
        if j == 0 { self.first() } else { self.halton.coordinate(j - 1) }
    }

    fn key(&self) -> u64 {
        self.halton.key()
    }
}
