//! The radical inverse: digits of a whole number mirrored at the point.
//!
//! ```text
//! i = Σ d_ℓ b^ℓ   ↦   φ_b(i) = Σ d_ℓ b^{−ℓ−1}
//! ```
//!
//! Scrambled, digit ℓ is replaced by π(d_ℓ), where the permutation π is drawn anew for every prefix d_0 … d_{ℓ−1}: Owen's nested uniform
//! scrambling. π(d) = μ(d) + c modulo b, with c uniform and μ a random permutation that fixes 0. Two different digits then go to any two
//! different ones with equal probability, which is all that means and variances depend on (Owen, *Variance with alternative scramblings of
//! digital nets*, 2003). The digits c along a prefix P 0 0 0 … are those of one random number U(P) in base b: so the infinite tail of zeros
//! of a finite i costs one hash, and a coordinate as many as i has digits.

use super::permutation::permuted;
use crate::sampling::hash::{below, folded, midpoint};

/// A base, and how to divide by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Radix {
    base: u64,
    /// ⌊2⁶⁴/b⌋ + 1 (for b = 2: 2⁶³ + 1)
    reciprocal: u64,
}

/// Powers beyond this are finer than a coordinate can show.
const FINEST: u64 = 1 << 56;

impl Radix {
    /// Bases from 2 to 2³².
    pub(super) const fn new(base: u64) -> Self {
        Radix { base, reciprocal: ((1u128 << 64) / base as u128) as u64 + 1 }
    }

    /// Quotient and remainder. The product with the reciprocal exceeds x/b by less than x/2⁶⁴, which is harmless below 1/b: for x < 2⁶⁴/b.
    #[inline]
    fn divide(self, x: u64) -> (u64, u64) {
        let quotient = if x < 1 << 32 { below(x, self.reciprocal) } else { x / self.base };
        (quotient, x - quotient * self.base)
    }

    /// φ_b(i): whole numbers and one division (theory (2.2.7)).
    pub(super) fn inverse(self, mut index: u64) -> f64 {
        let (mut mirrored, mut power) = (0u64, 1u64);
        while index > 0 && power <= FINEST / self.base {
            let (higher, digit) = self.divide(index);
            mirrored = mirrored * self.base + digit;
            power *= self.base;
            index = higher;
        }
        midpoint(mirrored as f64 / power as f64)
    }

    /// Multiplication by a random unit: a permutation of the digits of a prime base below 2¹⁶ that fixes 0.
    #[inline]
    pub(super) fn multiplied(self, digit: u64, random: u64) -> u64 {
        self.divide(digit * (1 + below(random, self.base - 1))).1
    }

    /// A random permutation of the digits of any base that fixes 0.
    pub(super) fn shuffled(self, digit: u64, random: u64) -> u64 {
        if digit == 0 { 0 } else { 1 + permuted(digit - 1, self.base - 1, random) }
    }

    /// φ_b(i), scrambled by `key`; `nonzero(b, d, random)` is the random permutation μ.
    #[inline]
    pub(super) fn scrambled(self, index: u64, key: u64, nonzero: impl Fn(Self, u64, u64) -> u64) -> f64 {
        let base = self.base;
        let (mut rest, mut prefix, mut mirrored, mut power) = (index, 0u64, 0u64, 1u64);
        while rest > 0 && power <= FINEST / base {
            let (higher, digit) = self.divide(rest);
            let u = folded(key, prefix);
            let sum = below(u.wrapping_mul(power), base) + nonzero(self, digit, folded(u, power));
            mirrored = mirrored * base + if sum < base { sum } else { sum - base };
            prefix += digit * power;
            power *= base;
            rest = higher;
        }
        let tail = folded(key, index).wrapping_mul(power) as f64 / 2f64.powi(64);
        midpoint((mirrored as f64 + tail) / power as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points that share k digits share them after scrambling, and differ in the next.
    #[test]
    fn scrambling_is_nested() {
        let (prime, any): (fn(Radix, u64, u64) -> u64, fn(Radix, u64, u64) -> u64) = (Radix::multiplied, Radix::shuffled);
        for (base, nonzero) in [(2u64, prime), (3, prime), (7, prime), (6, any), (10, any)] {
            let x: Vec<f64> = (0..base.pow(4)).map(|i| Radix::new(base).scrambled(i, 99, nonzero)).collect();
            for level in 0..4 {
                let cell = |i: usize| (x[i] * base.pow(level + 1) as f64) as u64;
                let (coarse, fine) = (base.pow(level) as usize, base.pow(level + 1) as usize);
                for i in 0..x.len() {
                    assert_eq!(cell(i), cell(i % fine), "base {base}, digit {level}");
                    assert_eq!(cell(i) / base, cell(i % coarse) / base);
                }
                let mut seen: Vec<u64> = (0..fine).map(cell).collect();
                seen.sort_unstable();
                assert!(seen.iter().enumerate().all(|(i, c)| i as u64 == *c), "base {base}, digit {level}: {seen:?}");
            }
        }
    }

    #[test]
    fn huge_indices_stay_inside() {
        for base in [2, 3, 10, 8161, 1 << 20, u64::from(u32::MAX)] {
            for index in [u64::MAX, u64::MAX - 1, 1 << 63, 0] {
                let radix = Radix::new(base);
                for x in [radix.inverse(index), radix.scrambled(index, 5, Radix::shuffled)] {
                    assert!(x > 0.0 && x < 1.0, "base {base}, index {index}: {x}");
                }
            }
        }
    }

    #[test]
    fn reciprocals_divide_exactly() {
        for base in [2u64, 3, 5, 7, 10, 641, 8161, 65_521, 65_537, u64::from(u32::MAX)] {
            for k in 0..64 {
                for x in [(1u64 << k) - 1, 1 << k, (u64::MAX >> k) / base * base, ((u64::MAX >> k) / base * base).wrapping_sub(1)] {
                    assert_eq!(Radix::new(base).divide(x), (x / base, x % base), "{x} / {base}");
                }
            }
        }
    }
}
