//! Halton points, scrambled: coordinate j is the radical inverse in the j-th prime.
//!
//! Halton, *On the efficiency of certain quasi-random sequences of points*, 1960; nested scrambling after Owen, *A randomized Halton
//! algorithm in R*, 2017, and [`radical`](super::radical). Any number of points, not only powers; without scrambling neighbouring
//! coordinates of large bases are useless.

use super::cursor::{Coordinates, PointSampler};
use super::radical::Radix;
use super::settings::{Scrambling, Settings, common_settings};
use crate::sampling::Sequence;
use crate::sampling::hash::word;
use std::ops::Range;

/// Halton points with nested scrambling: 1024 coordinates (bases 2 to 8161), any number of points.
///
/// ```
/// use fredholm::sampling::{Halton, Sampler, Sequence};
/// let mut u = Halton::new(0).unscrambled().point(0, 0, 5);
/// assert!((u.next_1d() - 0.625).abs() < 1e-15);            // 5 = 101 in base 2
/// assert!((u.next_1d() - 7.0 / 9.0).abs() < 1e-15);        // 5 = 12 in base 3
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Halton {
    settings: Settings,
}

impl Halton {
    /// Coordinates before independent numbers follow.
    pub const DIMENSIONS: u32 = 1024;

    /// Scrambled by this seed, 16 replicates.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Halton { settings: Settings::new(seed) }
    }
}

common_settings!(Halton);

impl Sequence for Halton {
    type Sampler = PointSampler<HaltonPoint>;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> Self::Sampler {
        let Settings { scrambling, layout, .. } = self.settings;
        PointSampler::new(HaltonPoint { key: self.settings.key(cell, replicate), index, scrambling }, layout)
    }

    #[inline]
    fn points(&self, cell: u64, replicate: u32, indices: Range<u64>) -> impl Iterator<Item = Self::Sampler> {
        let (Settings { scrambling, layout, .. }, key) = (self.settings, self.settings.key(cell, replicate));
        indices.map(move |index| PointSampler::new(HaltonPoint { key, index, scrambling }, layout))
    }

    fn with_seed(self, seed: u64) -> Self {
        Halton { settings: self.settings.with_seed(seed) }
    }

    fn replicates(&self) -> Option<u32> {
        Some(self.settings.replicates)
    }

    fn is_randomised(&self) -> bool {
        self.settings.is_randomised()
    }
}

/// One Halton point.
#[derive(Clone, Debug)]
pub struct HaltonPoint {
    pub(super) key: u64,
    pub(super) index: u64,
    pub(super) scrambling: Scrambling,
}

impl Coordinates for HaltonPoint {
    #[inline]
    fn count(&self) -> u32 {
        Halton::DIMENSIONS
    }

    #[inline]
    fn coordinate(&self, j: u32) -> f64 {
        let radix = PRIMES[j as usize];
        match self.scrambling {
            Scrambling::Nested => radix.scrambled(self.index, word(self.key, u64::from(j)), Radix::multiplied),
            Scrambling::None => radix.inverse(self.index),
        }
    }

    fn key(&self) -> u64 {
        word(!self.key, self.index)
    }
}

/// The first primes, by Eratosthenes' sieve.
static PRIMES: [Radix; Halton::DIMENSIONS as usize] = {
    const LAST: usize = 8161;
    let (mut composite, mut primes, mut found, mut n) = ([false; LAST + 1], [Radix::new(2); Halton::DIMENSIONS as usize], 0, 2);
    while n <= LAST {
        if !composite[n] {
            primes[found] = Radix::new(n as u64);
            found += 1;
            let mut multiple = n * n;
            while multiple <= LAST {
                composite[multiple] = true;
                multiple += n;
            }
        }
        n += 1;
    }
    assert!(found == primes.len());
    primes
};

#[cfg(test)]
mod tests {
    use super::{PRIMES, Radix};

    #[test]
    fn known_primes() {
        assert_eq!(PRIMES[..8], [2, 3, 5, 7, 11, 13, 17, 19].map(Radix::new));
        assert_eq!((PRIMES[99], PRIMES[999], PRIMES[1023]), (Radix::new(541), Radix::new(7919), Radix::new(8161)));
    }
}
