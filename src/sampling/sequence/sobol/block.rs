//! Sobol' points by the block of 32: work that neighbours share is done once.
//!
//! Points of a block differ in the lowest digit i₀ of i in base 32, which moves the first five binary digits of x alone, the matrices being triangular:
//! y = Y + r with r < 32 and Y common to the block. Hence m(y + s) = mY + m(r + s), with a table of m(r + s) and of c₁ times it: of the three products of
//! a scramble one is left. Words are mirrored a whole block at a time, in steps that a compiler turns into vector instructions.

use super::{BLOCK, C1, C2, Matrix, Scramble, row};
use crate::sampling::hash::{folded, open_unit};
use crate::sampling::sequence::settings::Scrambling;
use std::ops::Range;

/// One coordinate of a block.
struct Column {
    /// what the lowest digit of the index adds to y
    low: [u64; BLOCK as usize],
    scramble: Scramble,
    /// m(r + s), and c₁ times it, for all r
    parts: [[u64; 2]; BLOCK as usize],
    /// what the higher digits add
    high: u64,
    /// mY, and c₁ times it
    common: [u64; 2],
}

impl Column {
    fn new(matrix: &Matrix, scramble: Scramble) -> Self {
        let part = |r: usize| times_c1((r as u64).wrapping_add(scramble.s).wrapping_mul(scramble.m));
        Column { low: matrix[0], scramble, parts: std::array::from_fn(part), high: 0, common: [0; 2] }
    }

    /// Goes to the block with this number.
    fn enter(&mut self, matrix: &Matrix, number: u64) {
        self.high = row(&matrix[1..], number);
        self.common = times_c1((self.high & !(BLOCK - 1)).wrapping_mul(self.scramble.m));
    }

    #[inline]
    fn plain(&self, index: u64) -> u64 {
        self.high ^ self.low[(index % BLOCK) as usize]
    }

    #[inline]
    fn scrambled(&self, index: u64) -> u64 {
        let [a, b] = self.parts[(self.plain(index) % BLOCK) as usize];
        (self.common[0].wrapping_add(a) ^ self.common[1].wrapping_add(b)).wrapping_mul(C2)
    }
}

fn times_c1(y: u64) -> [u64; 2] {
    [y, y.wrapping_mul(C1)]
}

/// The first coordinates of the points of a range, one for each matrix.
pub(super) fn fill(table: &[Matrix], scrambling: Scrambling, key: u64, indices: Range<u64>, out: &mut [f64]) {
    let column = |(j, matrix): (u64, &Matrix)| Column::new(matrix, Scramble::new(folded(key, j)));
    let mut columns: Vec<Column> = (0..).zip(table).map(column).collect();
    let (mut next, mut rest) = (indices.start, out);
    while next < indices.end {
        let count = (BLOCK - next % BLOCK).min(indices.end - next);
        let (block, later) = std::mem::take(&mut rest).split_at_mut(count as usize * table.len());
        columns.iter_mut().zip(table).for_each(|(column, matrix)| column.enter(matrix, next / BLOCK));
        for (index, point) in (next..next + count).zip(block.chunks_exact_mut(table.len())) {
            let words = point.iter_mut().zip(&columns);
            match scrambling {
                Scrambling::Nested => words.for_each(|(x, column)| *x = f64::from_bits(column.scrambled(index).swap_bytes())),
                Scrambling::None => words.for_each(|(x, column)| *x = f64::from_bits(column.plain(index).swap_bytes())),
            }
        }
        block.iter_mut().for_each(|x| *x = open_unit(mirrored_bytes(x.to_bits())));
        (next, rest) = (next + count, later);
    }
}

/// The bits of every byte in reverse.
#[inline]
fn mirrored_bytes(y: u64) -> u64 {
    let swap = |y: u64, by: u32, mask: u64| ((y >> by) & mask) | ((y & mask) << by);
    swap(swap(swap(y, 4, 0x0f0f_0f0f_0f0f_0f0f), 2, 0x3333_3333_3333_3333), 1, 0x5555_5555_5555_5555)
}
