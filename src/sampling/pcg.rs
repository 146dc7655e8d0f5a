//! The permuted congruential generator, one stream a walk.
//!
//! O'Neill, *PCG: a family of simple fast space-efficient statistically good algorithms for random number generation* (2014); the 128-bit
//! multiplicative member of `rand_pcg`. Streams with neighbouring numbers are correlated (see its documentation), so every walk starts
//! from a *hashed* state instead.

use super::hash::{GOLDEN, key, open_unit};
use super::{Sampler, Sequence};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;
use std::ops::Range;

/// Independent pseudo-random points: the default sequence.
///
/// ```
/// use fredholm::sampling::{Pcg, Sampler, Sequence};
/// let mut a = Pcg::new(7).point(0, 0, 41);
/// let mut b = Pcg::new(7).point(0, 0, 41);
/// assert_eq!(a.next_1d(), b.next_1d());           // a pure function of (seed, cell, replicate, index)
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pcg {
    seed: u64,
}

impl Pcg {
    /// The sequence with this seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Pcg { seed }
    }
}

/// What pilots draw from, whatever the main run does: independent points, seeded by a cell of its sequence that it never reads.
pub(crate) fn pilot_points(sequence: &impl Sequence) -> Pcg {
    Pcg::new(sequence.point(u64::MAX, 0, 0).next_1d().to_bits())
}

impl Sequence for Pcg {
    type Sampler = PcgSampler;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> PcgSampler {
        PcgSampler::start(key(self.seed, cell, replicate), index)
    }

    #[inline]
    fn points(&self, cell: u64, replicate: u32, indices: Range<u64>) -> impl Iterator<Item = PcgSampler> {
        let key = key(self.seed, cell, replicate);
        indices.map(move |index| PcgSampler::start(key, index))
    }

    fn with_seed(self, seed: u64) -> Self {
        Pcg { seed }
    }
}

/// The generator of one walk.
#[derive(Clone, Debug)]
pub struct PcgSampler(Pcg64Mcg);

impl PcgSampler {
    #[inline]
    fn start(key: u64, index: u64) -> Self {
        let x = index.wrapping_mul(GOLDEN).wrapping_add(key);
        // one wide multiplication (Wang Yi, wyrand, 2019): a second mixer would cost a tenth of a short walk
        let product = u128::from(x) * u128::from(x ^ 0xa076_1d64_78bd_642f);
        let state = (product >> 64) as u64 ^ product as u64;
        PcgSampler(Pcg64Mcg::new((u128::from(state) << 64) | u128::from(x)))
    }
}

impl Sampler for PcgSampler {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        open_unit(self.0.next_u64())
    }
}
