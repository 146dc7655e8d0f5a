//! A random permutation as a pure function: no table, any length.

use crate::sampling::hash::below;

/// Where permutation number `key` of 0 … n−1 sends `i` < n.
///
/// Rounds of random affine maps and shifts to the right permute the next power of two; values from n on are sent on until they fall below
/// (cycle walking), and a random rotation makes every single value exactly uniform (Kensler, *Correlated multi-jittered sampling*, Pixar
/// 2013, with other rounds).
#[inline]
pub(super) fn permuted(mut i: u64, n: u64, key: u64) -> u64 {
    if n == 1 {
        return 0;
    }
    let bits = u64::BITS - (n - 1).leading_zeros();
    let (mask, half) = (u64::MAX >> (u64::BITS - bits), bits.div_ceil(2));
    loop {
        let mut state = key;
        for _ in 0..ROUNDS {
            // two words of a linear congruence: multiplier from the high half, increment from the low one
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            let word = state ^ (state >> 29);
            i = i.wrapping_mul((word >> 31) | 1).wrapping_add(word.rotate_left(17)) & mask;
            i ^= i >> half;
        }
        if i < n {
            break;
        }
    }
    let turned = i + below(key.rotate_left(32) ^ key.wrapping_mul(0x9e37_79b9_7f4a_7c15), n);
    if turned < n { turned } else { turned - n }
}

const ROUNDS: usize = 6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::word;
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    #[test]
    fn is_a_permutation() {
        for n in [1, 2, 3, 5, 8, 13, 64, 100, 1023] {
            for key in 0..20 {
                let mut seen: Vec<u64> = (0..n).map(|i| permuted(i, n, word(key, n))).collect();
                seen.sort_unstable();
                assert!(seen.iter().enumerate().all(|(i, v)| i as u64 == *v), "{n}: {seen:?}");
            }
        }
    }

    /// Two values go to any two different places with equal probability, for every pair: level 10⁻⁹ a test.
    #[test]
    fn pairs_are_uniform() {
        for n in [2usize, 3, 4, 5, 6, 7, 8, 9, 12, 16, 17] {
            for (a, b) in [(0, 1), (0, n - 1), (n / 2, n - 1)].into_iter().filter(|(a, b)| a != b) {
                let (mut counts, draws) = (vec![0u32; n * n], 200_000);
                for key in 0..draws {
                    let place = |i: usize| permuted(i as u64, n as u64, word(7, key)) as usize;
                    counts[place(a) * n + place(b)] += 1;
                }
                let expected = draws as f64 / (n * (n - 1)) as f64;
                let off = (0..n * n).filter(|c| c / n != c % n);
                let chi: f64 = off.map(|c| (f64::from(counts[c]) - expected).powi(2) / expected).sum();
                let p = ChiSquared::new((n * (n - 1) - 1) as f64).unwrap().sf(chi);
                assert!(p > 1e-9, "n = {n}, pair {a}, {b}: χ² = {chi:.1}, p = {p:.1e}");
            }
        }
    }
}
