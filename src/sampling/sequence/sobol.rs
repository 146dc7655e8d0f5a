//! Sobol' points, scrambled.
//!
//! Coordinate j of point i is the sum modulo 2 of direction numbers, x = ⊕_{k: bit k of i is 1} v_{j,k} (И. М. Соболь 1967), with the polynomials
//! and initial numbers of Joe and Kuo (2008); the first two coordinates are a (0, 2)-sequence in base 2. The points come in the natural order of i:
//! every aligned block of 2^m is the same set as in the Gray-code order of other programs. Directions have 64 bits, so there is no limit on i.
//!
//! # Scrambling
//! Read the digits of x from the first on as those of a 2-adic integer y, lowest bit first. Scrambling is y ↦ h(m(y + s)), with s random and m random and
//! odd; h(y) = c₂(y ⊕ c₁y) (c₁ even, c₂ odd) is a fixed bijection. Each of these maps changes a digit depending only on the digits before. For two points whose first k digits agree and whose next do not, m(y' − y) is uniform over the differences of exactly that kind and m(y + s)
//! uniform, independent of it: the pair has *the very distribution* of Owen's nested uniform scrambling (*Randomly permuted
//! (t,m,s)-nets*, 1995), so means and variances are those of Owen's theory. h keeps that law; it breaks up the linearity among three points and more. (The form is that of the hashes of Laine, Karras 2011 and Vegdahl 2021, the law is not.)
//!
//! No crate served the numbers at need: `sobol` (unmaintained since 2020) and `sobol-qmc` (a second nalgebra, code generation at build time) give sequential
//! points only, `sobol_burley` 24 bits, 2¹⁶ points, 256 dimensions. The table is joe_kuo.txt, under the licence of its authors.

use super::cursor::{Coordinates, PointSampler};
use super::settings::{Scrambling, Settings, common_settings};
use crate::sampling::Sequence;
use crate::sampling::hash::{folded, open_unit, word};
use std::ops::Range;
use std::sync::LazyLock;

/// Sobol' points with Owen scrambling: 1111 coordinates, any number of points, 52 bits. Use powers of 2 in each replicate.
///
/// The variance of an estimate is at most a constant times that of independent points, for any square-integrable function, and falls as
/// n^(−3+ε) for smooth ones (theory (4.14.3)). Beyond its coordinates, numbers are independent.
///
/// ```
/// use fredholm::sampling::{Sampler, Sequence, Sobol};
/// let first = |i| Sobol::new(0).unscrambled().point(0, 0, i).next_2d().map(|x| (x * 4.0) as u32);
/// assert_eq!([0, 1, 2, 3].map(first), [[0, 0], [2, 2], [1, 3], [3, 1]]);     // in quarters
///
/// use fredholm::{Equation, Walk};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let f = eq.at(0.5).solve(&Walk::collision().sequence(Sobol::new(7).replicates(32)))?;
/// assert!(f.agrees_with(1.15, 5.0) && f.degrees_of_freedom == 31);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sobol {
    settings: Settings,
}

impl Sobol {
    /// Coordinates that the table of direction numbers has.
    pub const DIMENSIONS: u32 = 1111;

    /// Scrambled by this seed, 16 replicates.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Sobol { settings: Settings::new(seed) }
    }
}

common_settings!(Sobol);

impl Sequence for Sobol {
    type Sampler = PointSampler<SobolPoint>;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> Self::Sampler {
        let Settings { scrambling, layout, .. } = self.settings;
        PointSampler::new(SobolPoint { table: &TABLE, key: self.settings.key(cell, replicate), index, scrambling }, layout)
    }

    #[inline]
    fn points(&self, cell: u64, replicate: u32, indices: Range<u64>) -> impl Iterator<Item = Self::Sampler> {
        let (Settings { scrambling, layout, .. }, key) = (self.settings, self.settings.key(cell, replicate));
        let table: &'static [Matrix] = &TABLE;
        indices.map(move |index| PointSampler::new(SobolPoint { table, key, index, scrambling }, layout))
    }

    fn with_seed(self, seed: u64) -> Self {
        Sobol { settings: self.settings.with_seed(seed) }
    }

    fn replicates(&self) -> Option<u32> {
        Some(self.settings.replicates)
    }
}

/// One Sobol' point.
#[derive(Clone)]
pub struct SobolPoint {
    table: &'static [Matrix],
    key: u64,
    index: u64,
    scrambling: Scrambling,
}

impl std::fmt::Debug for SobolPoint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SobolPoint").field("key", &self.key).field("index", &self.index).field("scrambling", &self.scrambling).finish()
    }
}

impl Coordinates for SobolPoint {
    #[inline]
    fn count(&self) -> u32 {
        Sobol::DIMENSIONS
    }

    #[inline]
    fn coordinate(&self, j: u32) -> f64 {
        let (mut y, mut rest) = (0, self.index);
        for digit in &self.table[j as usize] {
            y ^= digit[(rest & 63) as usize];
            rest >>= 6;
            if rest == 0 {
                break;
            }
        }
        let y = match self.scrambling {
            Scrambling::Nested => scrambled(y, folded(self.key, u64::from(j))),
            Scrambling::None => y,
        };
        open_unit(y.reverse_bits())
    }

    fn key(&self) -> u64 {
        word(!self.key, self.index)
    }
}

/// h(m(y + s)), with m from s.
#[inline]
fn scrambled(y: u64, s: u64) -> u64 {
    let m = folded(s, 0);
    let y = y.wrapping_add(s).wrapping_mul(m | 1);
    (y ^ y.wrapping_mul(0x6c50_b47c_b3b1_d5e4)).wrapping_mul(0x8ebc_6af0_9c88_c6e3)
}

/// Sums of the direction numbers of one coordinate, for each hexadecimal digit of the index and each of its values; the first digit of x is the
/// lowest bit.
type Matrix = [[u64; 64]; 11];

/// A constant: 2.3 MB, made of joe_kuo.txt at the first use.
static TABLE: LazyLock<Vec<Matrix>> = LazyLock::new(|| {
    let lines = include_str!("joe_kuo.txt").lines().filter(|l| !l.starts_with('#'));
    // the first coordinate is van der Corput's: x is the index mirrored
    let first = sums(&std::array::from_fn(|k| 1 << k));
    std::iter::once(first).chain(lines.map(|line| sums(&directions(line)))).collect()
});

/// v_1 … v_64, digits mirrored, from a line `a m_1 … m_s`: v_k = m_k 2^−k for k ≤ s, then v_k = ⊕_{i < s} a_i v_{k−i} ⊕ v_{k−s} ⊕ v_{k−s} 2^−s.
fn directions(line: &str) -> [u64; 64] {
    let numbers: Vec<u64> = line.split_whitespace().map(|n| n.parse().expect("the table holds whole numbers")).collect();
    let (a, m) = (numbers[0], &numbers[1..]);
    let s = m.len();
    let mut v = [0u64; 64];
    for k in 0..64 {
        v[k] = match m.get(k) {
            Some(m) => m << (63 - k),
            None => (1..s).filter(|i| (a >> (s - 1 - i)) & 1 == 1).fold(v[k - s] ^ (v[k - s] >> s), |sum, i| sum ^ v[k - i]),
        };
    }
    v.map(u64::reverse_bits)
}

fn sums(v: &[u64; 64]) -> Matrix {
    std::array::from_fn(|d| {
        std::array::from_fn(|value| {
            (0..6).filter(|bit| (value >> bit) & 1 == 1 && 6 * d + bit < 64).fold(0, |sum, bit| sum ^ v[6 * d + bit])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_complete() {
        assert_eq!(TABLE.len(), Sobol::DIMENSIONS as usize);
        // every matrix is unit upper triangular: digit k of v_k is 1, those after it 0
        for matrix in TABLE.iter() {
            for k in 0..64 {
                let v = matrix[k / 6][1 << (k % 6)];
                assert_eq!(v >> k, 1);
            }
        }
    }
}
