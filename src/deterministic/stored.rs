//! Products with a dense matrix, on all cores and yet the same bits for any number of them.

use super::linear::LinearMap;
use crate::parallel;
use nalgebra::DVector;
use std::fmt::Debug;

/// A matrix, row by row.
pub(super) struct Stored {
    rows: Vec<f64>,
    n: usize,
}

impl Stored {
    pub(super) fn new(rows: Vec<f64>, n: usize) -> Self {
        Stored { rows, n }
    }

    pub(super) fn rows(&self) -> &[f64] {
        &self.rows
    }

    pub(super) fn into_rows(self) -> Vec<f64> {
        self.rows
    }
}

impl Debug for Stored {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stored").field("n", &self.n).finish_non_exhaustive()
    }
}

/// Columns that one task of a transposed product sums up.
const STRIP: usize = 1024;

impl LinearMap for Stored {
    fn apply(&self, v: &DVector<f64>) -> DVector<f64> {
        let dot = |i: usize| dot(&self.rows[i * self.n..(i + 1) * self.n], v.as_slice());
        DVector::from_vec(parallel::map(self.n, dot))
    }

    fn apply_transposed(&self, v: &DVector<f64>) -> DVector<f64> {
        let mut sums = DVector::zeros(self.n);
        parallel::chunks(sums.as_mut_slice(), STRIP, |strip, sums| {
            for (row, v) in self.rows.chunks_exact(self.n).zip(v) {
                sums.iter_mut().zip(&row[strip * STRIP..]).for_each(|(s, t)| *s += t * v);
            }
        });
        sums
    }
}

/// Eight sums at once, in an order of its own on every machine.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0f64; 8];
    let (heads, tails) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = heads.remainder().iter().zip(tails.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in heads.zip(tails) {
        (0..8).for_each(|k| sums[k] += a[k] * b[k]);
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::Stored;
    use crate::deterministic::linear::LinearMap;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn products() {
        for n in [1, 7, 8, 30, 1500] {
            let a = DMatrix::from_fn(n, n, |i, j| ((3 * i + 7 * j) as f64).sin());
            let rows = Stored::new(a.transpose().as_slice().to_vec(), n);
            let v = DVector::from_fn(n, |i, _| 1.0 / (1 + i) as f64);
            assert!((rows.apply(&v) - &a * &v).amax() < 1e-13 && (rows.apply_transposed(&v) - a.tr_mul(&v)).amax() < 1e-13);
        }
    }
}
