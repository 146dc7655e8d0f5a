//! Sobol' points, scrambled.
//!
//! Coordinate j of point i is the sum modulo 2 of direction numbers, x = ⊕_{k: bit k of i is 1} v_{j,k} (И. М. Соболь 1967), with the
//! polynomials and initial numbers of Joe and Kuo (2008); the first two coordinates are a (0, 2)-sequence in base 2. The points come in the
//! natural order of i: every aligned block of 2^m is the same set as in the Gray-code order of other programs. Directions have 64 bits, so
//! there is no limit on i.
//!
//! # Scrambling
//! Read the digits of x from the first on as those of a 2-adic integer y, lowest bit first. Scrambling is y ↦ h(m(y + s)), s random, m
//! random and odd, h(y) = c₂(y ⊕ c₁y) fixed (c₁ even, c₂ odd): each map is a bijection and changes a digit depending only on the digits
//! before. Of two points whose first k digits agree and whose next do not, m(y' − y) is uniform over the differences of exactly that kind,
//! and m(y + s) uniform, independent of it: the pair has *the very distribution* of Owen's nested uniform scrambling (*Randomly permuted
//! (t,m,s)-nets*, 1995), so means and variances are those of Owen's theory. h keeps that law; it breaks up the linearity among three points
//! and more. (The form is that of the hashes of Laine, Karras 2011 and Vegdahl 2021, the law is not.)
//!
//! No crate served the numbers at need: `sobol` (unmaintained since 2020) and `sobol-qmc` (a second nalgebra, code generation at build
//! time) give sequential points only, `sobol_burley` 24 bits, 2¹⁶ points, 256 dimensions. The table is joe_kuo.txt, under the licence of
//! its authors.

mod block;

use super::cursor::{Coordinates, PointSampler};
use super::settings::{Scrambling, Settings, common_settings};
use crate::sampling::hash::{folded, open_unit, word};
use crate::sampling::{Sampler, Sequence, coordinates_each};
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

    fn fill(&self, cell: u64, replicate: u32, indices: Range<u64>, out: &mut [f64]) {
        let (key, dimension) = (self.settings.key(cell, replicate), coordinates_each(&indices, out.len()));
        let table: &'static [Matrix] = &TABLE;
        let Some(table) = table.get(..dimension).filter(|t| !t.is_empty()) else {
            // no coordinates, or more than there are
            return self.points(cell, replicate, indices).zip(out.chunks_exact_mut(dimension.max(1))).for_each(|(mut u, point)| {
                point.iter_mut().for_each(|x| *x = u.next_1d());
            });
        };
        block::fill(table, self.settings.scrambling, key, indices, out);
    }

    fn with_seed(self, seed: u64) -> Self {
        Sobol { settings: self.settings.with_seed(seed) }
    }

    fn replicates(&self) -> Option<u32> {
        Some(self.settings.replicates)
    }

    fn is_randomised(&self) -> bool {
        self.settings.is_randomised()
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
        let y = row(&self.table[j as usize], self.index);
        let y = match self.scrambling {
            Scrambling::Nested => Scramble::new(folded(self.key, u64::from(j))).apply(y),
            Scrambling::None => y,
        };
        unmirrored(y)
    }

    fn key(&self) -> u64 {
        word(!self.key, self.index)
    }
}

/// The number whose first digit is the lowest bit.
#[inline]
fn unmirrored(y: u64) -> f64 {
    open_unit(y.reverse_bits())
}

/// The sum of the directions of the digits of an index.
#[inline]
fn row(digits: &[[u64; BLOCK as usize]], mut index: u64) -> u64 {
    let mut sum = 0;
    for digit in digits {
        sum ^= digit[(index % BLOCK) as usize];
        index /= BLOCK;
        if index == 0 {
            break;
        }
    }
    sum
}

/// y ↦ h(m(y + s)).
#[derive(Clone, Copy)]
struct Scramble {
    s: u64,
    m: u64,
}

impl Scramble {
    #[inline]
    fn new(s: u64) -> Self {
        Scramble { s, m: folded(s, 0) | 1 }
    }

    #[inline]
    fn apply(self, y: u64) -> u64 {
        let y = y.wrapping_add(self.s).wrapping_mul(self.m);
        (y ^ y.wrapping_mul(C1)).wrapping_mul(C2)
    }
}

/// c₁ and c₂ of h.
const C1: u64 = 0x6c50_b47c_b3b1_d5e4;
const C2: u64 = 0x8ebc_6af0_9c88_c6e3;

/// Values of a digit of the index: of 32 coordinates, the tables in use fit the first cache.
const BLOCK: u64 = 32;

/// Sums of the direction numbers of one coordinate, for each digit of the index in base 32 and each of its values; the first digit of x is
/// the lowest bit.
type Matrix = [[u64; BLOCK as usize]; 13];

/// A constant: 3.7 MB, made of joe_kuo.txt at the first use.
static TABLE: LazyLock<Vec<Matrix>> = LazyLock::new(|| {
    let lines = include_str!("../joe_kuo.txt").lines().filter(|l| !l.starts_with('#'));
    // the first coordinate is van der Corput's: x is the index mirrored
    let first = sums(&std::array::from_fn(|k| 1 << k));
    std::iter::once(first).chain(lines.map(|line| sums(&directions(line)))).collect()
});

/// v_1 … v_64, digits mirrored, from a line `a m_1 … m_s`: v_k = m_k 2^−k for k ≤ s, then v_k = ⊕_{i < s} a_i v_{k−i} ⊕ v_{k−s} ⊕ v_{k−s}
/// 2^−s.
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
            (0..5).filter(|bit| (value >> bit) & 1 == 1 && 5 * d + bit < 64).fold(0, |sum, bit| sum ^ v[5 * d + bit])
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
                let v = matrix[k / 5][1 << (k % 5)];
                assert_eq!(v >> k, 1);
            }
        }
    }
}
