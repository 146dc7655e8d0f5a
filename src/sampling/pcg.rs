//! The permuted congruential generator, one stream a walk.
//!
//! O'Neill, *PCG: a family of simple fast space-efficient statistically good algorithms for random number generation* (2014); the 128-bit
//! multiplicative member of `rand_pcg`. Streams with neighbouring numbers are correlated (see its documentation), so every walk starts
//! from a *hashed* state instead (Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, 2014, §3: SplitMix64's mixer).

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

impl Pcg {
    fn key(&self, cell: u64, replicate: u32) -> u64 {
        mix(mix(mix(self.seed.wrapping_add(GOLDEN)) ^ cell).wrapping_add(GOLDEN) ^ u64::from(replicate))
    }
}

/// SplitMix64's mixer: a bijection of 64-bit words.
#[inline]
fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

impl Sequence for Pcg {
    type Sampler = PcgSampler;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> PcgSampler {
        PcgSampler::start(self.key(cell, replicate), index)
    }

    #[inline]
    fn points(&self, cell: u64, replicate: u32, indices: Range<u64>) -> impl Iterator<Item = PcgSampler> {
        let key = self.key(cell, replicate);
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

/// (k + ½) 2⁻⁵² from the top 52 bits: exact, and never 0 or 1 (theory (6.1.4)).
#[inline]
pub(crate) fn open_unit(bits: u64) -> f64 {
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    // [1, 2) − (1 − 2⁻⁵³): both the operand and the result are representable, so nothing rounds
    f64::from_bits((bits >> 12) | ONE) - (1.0 - f64::EPSILON / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniforms_stay_strictly_inside_the_unit_interval() {
        assert_eq!(open_unit(0), 2f64.powi(-53));
        assert_eq!(open_unit(u64::MAX), 1.0 - 2f64.powi(-53));
        assert_eq!(open_unit(1 << 63), 0.5 + 2f64.powi(-53));
    }
}
