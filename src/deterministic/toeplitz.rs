//! T_ij = t_{i−j}: kernels of x − y on uniform nodes.
//!
//! ```text
//! T v = first n of F⁻¹[F(t) · F(v, 0)],    t laid around a circle of 2n or more places           Golub, Van Loan, §4.8; Chan, Ng, SIAM Rev. 38 (1996) 427
//! ```
//!
//! n log n instead of n²; the crate `realfft` (on `rustfft`) does the transforms. One thread: the same bits for any number.

use super::linear::LinearMap;
use nalgebra::DVector;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::fmt;
use std::sync::Arc;

/// A Toeplitz matrix by its first column and row.
#[derive(Clone)]
pub(super) struct Toeplitz {
    n: usize,
    length: usize,
    spectrum: Vec<Complex<f64>>,
    forward: Arc<dyn RealToComplex<f64>>,
    backward: Arc<dyn ComplexToReal<f64>>,
}

impl fmt::Debug for Toeplitz {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Toeplitz").field("n", &self.n).finish_non_exhaustive()
    }
}

impl Toeplitz {
    /// `column[i]` = T_i0, `row[j]` = T_0j; the corner is the column's.
    pub(super) fn new(column: &[f64], row: &[f64]) -> Self {
        let n = column.len();
        let length = (2 * n).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        let (forward, backward) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
        let mut circle = vec![0.0; length];
        circle[..n].copy_from_slice(column);
        (1..n).for_each(|j| circle[length - j] = row[j]);
        let mut t = Toeplitz { n, length, spectrum: Vec::new(), forward, backward };
        t.spectrum = t.transform(&mut circle);
        t
    }

    fn transform(&self, input: &mut [f64]) -> Vec<Complex<f64>> {
        let mut output = self.forward.make_output_vec();
        self.forward.process(input, &mut output).expect("lengths of one plan");
        output
    }

    /// With the spectrum, or its conjugate for the transpose.
    fn convolve(&self, v: &DVector<f64>, factor: impl Fn(&Complex<f64>) -> Complex<f64>) -> DVector<f64> {
        let mut padded = vec![0.0; self.length];
        padded[..self.n].copy_from_slice(v.as_slice());
        let mut product = self.transform(&mut padded);
        let scale = 1.0 / self.length as f64;
        product.iter_mut().zip(&self.spectrum).for_each(|(p, s)| *p *= factor(s) * scale);
        // of a real sequence both ends are real; rounding must not make the transform refuse them
        product[0].im = 0.0;
        product[self.length / 2].im = 0.0;
        self.backward.process(&mut product, &mut padded).expect("lengths of one plan");
        padded.truncate(self.n);
        DVector::from_vec(padded)
    }
}

impl LinearMap for Toeplitz {
    fn apply(&self, v: &DVector<f64>) -> DVector<f64> {
        self.convolve(v, |s| *s)
    }

    fn apply_transposed(&self, v: &DVector<f64>) -> DVector<f64> {
        self.convolve(v, Complex::conj)
    }
}

/// Sums of T over blocks from sums of sums: Σ_{i ∈ [a, b)} Σ_{j ∈ [c, d)} t_{i−j}.
#[derive(Clone, Debug)]
pub(super) struct BlockSums {
    n: usize,
    /// Σ_{e < k} Σ_{l < e} t_{l−n+1}
    twice: Vec<f64>,
}

impl BlockSums {
    pub(super) fn new(column: &[f64], row: &[f64]) -> Self {
        let n = column.len();
        let (mut once, mut twice) = (0.0, vec![0.0, 0.0]);
        for t in row[1..].iter().rev().chain(column) {
            once += t;
            twice.push(twice[twice.len() - 1] + once);
        }
        BlockSums { n, twice }
    }

    pub(super) fn of(&self, (a, b): (usize, usize), (c, d): (usize, usize)) -> f64 {
        // Σ_{i < m} Σ_{j} telescopes to four values at differences of the ends
        let at = |i: usize, j: usize| self.twice[(i + self.n) - j];
        at(b, c) - at(a, c) - at(b, d) + at(a, d)
    }
}

#[cfg(test)]
mod tests {
    use super::{BlockSums, Toeplitz};
    use crate::deterministic::linear::LinearMap;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn products_and_sums_are_those_of_the_matrix() {
        for n in [1, 2, 7, 64, 100] {
            let column: Vec<f64> = (0..n).map(|i| 1.0 / (1.0 + i as f64)).collect();
            let row: Vec<f64> = (0..n).map(|i| (-0.3 * i as f64).exp()).collect();
            let dense = DMatrix::from_fn(n, n, |i, j| if i >= j { column[i - j] } else { row[j - i] });
            let (fast, v) = (Toeplitz::new(&column, &row), DVector::from_fn(n, |i, _| (i as f64).sin() + 0.3));
            assert!((fast.apply(&v) - &dense * &v).amax() < 1e-14 * n as f64);
            assert!((fast.apply_transposed(&v) - dense.transpose() * &v).amax() < 1e-14 * n as f64);
            let sums = BlockSums::new(&column, &row);
            for (rows, columns) in [((0, n), (0, n)), ((n / 3, n), (0, n / 2)), ((0, 1), (n - 1, n))] {
                let direct = dense.view_range(rows.0..rows.1, columns.0..columns.1).sum();
                assert!((sums.of(rows, columns) - direct).abs() < 1e-11, "{n}");
            }
        }
    }
}
