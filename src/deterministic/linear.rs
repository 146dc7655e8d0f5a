//! Dense linear systems: the one file that knows how they are factorised.
//!
//! Condition numbers are estimates from the factors, Hager, *SIAM J. Sci. Stat. Comput.* 5 (1984) 311, in the form of Higham, *ACM TOMS* 14 (1988)
//! 381, algorithm 2.4: a lower bound of ‖A⁻¹‖₁, in practice within a factor of 3.

use crate::error::Error;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Reciprocal condition number below which a system counts as singular: of the 16 digits fewer than two are left.
const SINGULAR: f64 = 1e-14;

/// P A = L U with norms.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    lu: LU<f64, Dyn, Dyn>,
    rcond: f64,
    inverse_norm: f64,
}

impl Factor {
    /// Factorises I − T, with T given row by row. n³/3 multiplications.
    pub(crate) fn identity_minus(rows: &[f64], n: usize) -> Result<Self, Error> {
        let mut a = DMatrix::from_row_slice(n, n, rows);
        a.neg_mut();
        (0..n).for_each(|i| a[(i, i)] += 1.0);
        Factor::new(a)
    }

    pub(crate) fn new(a: DMatrix<f64>) -> Result<Self, Error> {
        let n = a.nrows();
        let norm = a.column_iter().map(|c| c.iter().map(|v| v.abs()).sum()).fold(0.0, f64::max);
        let mut factor = Factor { lu: a.lu(), rcond: 0.0, inverse_norm: f64::INFINITY };
        if factor.lu.is_invertible() {
            let inverse_one = norm_estimate(n, |v| factor.solve(v), |v| factor.solve_transposed(v));
            factor.rcond = 1.0 / (norm * inverse_one);
            factor.inverse_norm = norm_estimate(n, |v| factor.solve_transposed(v), |v| factor.solve(v));
        }
        if factor.rcond.is_nan() || factor.rcond <= SINGULAR {
            return Err(Error::Singular { rcond: factor.rcond, unknowns: n });
        }
        Ok(factor)
    }

    /// Estimated 1/(‖A‖₁ ‖A⁻¹‖₁).
    pub(crate) fn rcond(&self) -> f64 {
        self.rcond
    }

    /// Estimated ‖A⁻¹‖∞: what a residual may be amplified by.
    pub(crate) fn inverse_norm(&self) -> f64 {
        self.inverse_norm
    }

    pub(crate) fn unknowns(&self) -> usize {
        self.lu.lu_internal().nrows()
    }

    /// A⁻¹ b.
    pub(crate) fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let mut x = b.clone();
        self.lu.solve_mut(&mut x);
        x
    }

    /// A⁻ᵀ b: Uᵀ y = b, Lᵀ z = y, x = Pᵀ z.
    fn solve_transposed(&self, b: &DVector<f64>) -> DVector<f64> {
        let factors = self.lu.lu_internal();
        let n = factors.nrows();
        let mut x = b.clone();
        for j in 0..n {
            let sum: f64 = (0..j).map(|i| factors[(i, j)] * x[i]).sum();
            x[j] = (x[j] - sum) / factors[(j, j)];
        }
        for j in (0..n).rev() {
            let sum: f64 = (j + 1..n).map(|i| factors[(i, j)] * x[i]).sum();
            x[j] -= sum;
        }
        self.lu.p().inv_permute_rows(&mut x);
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
