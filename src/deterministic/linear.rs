//! Dense linear systems and what is known about them: the one file that decides how they are solved.
//!
//! Condition numbers are estimates from the factors, Hager, *SIAM J. Sci. Stat. Comput.* 5 (1984) 311, in the form of Higham, *ACM TOMS* 14 (1988)
//! 381, algorithm 2.4: a lower bound of ‖A⁻¹‖₁, in practice within a factor of 3.

use super::lu::Lu;
use crate::error::Error;
use nalgebra::{DMatrix, DVector};
use std::sync::OnceLock;

/// Reciprocal condition number below which a system counts as singular: of the 16 digits fewer than two are left.
const SINGULAR: f64 = 1e-14;

/// A factorised, with norms.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    /// of Aᵀ: rows of A are then columns in memory, and nothing is copied
    transpose: Lu,
    rcond: f64,
    inverse_norm: OnceLock<f64>,
}

impl Factor {
    /// Factorises I − T in the memory of T, given row by row. n³/3 multiplications.
    pub(crate) fn identity_minus(mut rows: Vec<f64>, n: usize) -> Result<Self, Error> {
        rows.iter_mut().for_each(|t| *t = -*t);
        (0..n).for_each(|i| rows[i * (n + 1)] += 1.0);
        Factor::of_transpose(DMatrix::from_vec(n, n, rows))
    }

    pub(crate) fn new(mut a: DMatrix<f64>) -> Result<Self, Error> {
        a.transpose_mut();
        Factor::of_transpose(a)
    }

    fn of_transpose(a: DMatrix<f64>) -> Result<Self, Error> {
        let n = a.nrows();
        let mut sums = DVector::zeros(n);
        a.column_iter().for_each(|row| sums.zip_apply(&row, |sum: &mut f64, v| *sum += v.abs()));
        let mut factor = Factor { transpose: Lu::new(a), rcond: 0.0, inverse_norm: OnceLock::new() };
        if factor.transpose.is_invertible() {
            let inverse_one = norm_estimate(n, |v| factor.solve(v), |v| factor.solve_transposed(v));
            factor.rcond = 1.0 / (sums.max() * inverse_one);
        }
        if factor.rcond.is_nan() || factor.rcond <= SINGULAR {
            return Err(Error::Singular { rcond: factor.rcond, unknowns: n, alternative: None });
        }
        Ok(factor)
    }

    /// Estimated 1/(‖A‖₁ ‖A⁻¹‖₁).
    pub(crate) fn rcond(&self) -> f64 {
        self.rcond
    }

    /// Estimated ‖A⁻¹‖∞: what a residual may be amplified by. Costs a few solves, the first time.
    pub(crate) fn inverse_norm(&self) -> f64 {
        *self.inverse_norm.get_or_init(|| norm_estimate(self.unknowns(), |v| self.solve_transposed(v), |v| self.solve(v)))
    }

    pub(crate) fn unknowns(&self) -> usize {
        self.transpose.unknowns()
    }

    /// A⁻¹ b.
    pub(crate) fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let mut x = b.clone();
        self.transpose.solve_transposed(&mut x);
        x
    }

    /// A⁻ᵀ b.
    pub(crate) fn solve_transposed(&self, b: &DVector<f64>) -> DVector<f64> {
        let mut x = b.clone();
        self.transpose.solve(&mut x);
        x
    }
}

/// Lower bound of ‖B‖₁ from products with B and Bᵀ.
fn norm_estimate(n: usize, apply: impl Fn(&DVector<f64>) -> DVector<f64>, transposed: impl Fn(&DVector<f64>) -> DVector<f64>) -> f64 {
    let mut x = DVector::from_element(n, 1.0 / n as f64);
    let mut estimate = 0.0;
    let mut last = usize::MAX;
    for _ in 0..5 {
        let y = apply(&x);
        let norm = y.lp_norm(1);
        if norm <= estimate {
            break;
        }
        estimate = norm;
        let z = transposed(&y.map(|v| if v < 0.0 { -1.0 } else { 1.0 }));
        let steepest = z.icamax();
        if steepest == last || z[steepest].abs() <= z.dot(&x) {
            break;
        }
        x.fill(0.0);
        x[steepest] = 1.0;
        last = steepest;
    }
    // Higham's second guess, for matrices on which the ascent stalls
    let zigzag = DVector::from_fn(n, |i, _| (1.0 + i as f64 / (n.max(2) - 1) as f64) * if i.is_multiple_of(2) { 1.0 } else { -1.0 });
    estimate.max(2.0 * apply(&zigzag).lp_norm(1) / (3 * n) as f64)
}

#[cfg(test)]
mod tests {
    use super::Factor;
    use crate::error::Error;
    use nalgebra::{DMatrix, DVector};

    fn hilbert(n: usize) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |i, j| 1.0 / (1 + i + j) as f64)
    }

    #[test]
    fn condition_of_hilbert_matrices() {
        // κ₁ of the Hilbert matrices: 748, 28 375, 943 656, 29 070 279 for n = 3, 4, 5, 6
        for (n, known) in [(3, 748.0), (4, 28_375.0), (5, 943_656.0), (6, 29_070_279.0)] {
            let kappa = 1.0 / Factor::new(hilbert(n)).unwrap().rcond();
            assert!(kappa <= known * 1.000_001 && kappa >= known / 3.0, "{n}: {kappa}");
        }
    }

    #[test]
    fn transposed_systems() {
        let a = DMatrix::from_fn(7, 7, |i, j| ((3 * i + 5 * j * j) % 7) as f64 + if i == j { 4.0 } else { 0.0 });
        let b = DVector::from_fn(7, |i, _| i as f64 - 2.5);
        let factor = Factor::new(a.clone()).unwrap();
        assert!((a.transpose() * factor.solve_transposed(&b) - &b).amax() < 1e-13);
        assert!((a * factor.solve(&b) - &b).amax() < 1e-13);
    }

    #[test]
    fn singular_systems_are_refused() {
        for a in [DMatrix::zeros(3, 3), DMatrix::from_element(4, 4, 1.0), hilbert(14)] {
            assert!(matches!(Factor::new(a), Err(Error::Singular { .. })));
        }
    }
}
