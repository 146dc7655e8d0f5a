//! Linear systems and what is known about them: the one file that decides how they are solved.
//!
//! | unknowns | system | by |
//! |---|---|---|
//! | more than 3000, on a plain rule | K of x − y on uniform nodes | [FFT](super::toeplitz) and GMRES, O(n log n) |
//! | | numerical rank up to 200 | [Woodbury's formula](super::low_rank), O(n r²) |
//! | up to 6000 | any other | [LU](super::lu), n³/3 |
//! | up to 16384 | any other | [GMRES](super::krylov) with a [coarse inverse](super::coarse), O(n²); LU where that does not converge |
//!
//! Measured on two cores that had other work too, seconds from kernel to factors + for a source: Love's kernel on uniform nodes by FFT, N = 4000:
//! 0.014 + 0.002, N = 20 000: 0.14 + 0.02; e^{xy} of rank 15, N = 20 000: 0.07 + 0.001; e^{−|x−y|} on panels, N = 4000: GMRES 1.2 + 0.18, LU 1.8 + 0.02;
//! N = 8000: GMRES 4.2 + 0.7, LU 8.7 + 0.1.
//!
//! Condition numbers are estimates from products with the inverse, Hager, *SIAM J. Sci. Stat. Comput.* 5 (1984) 311, in the form of Higham, *ACM TOMS*
//! 14 (1988) 381, algorithm 2.4: a lower bound of ‖A⁻¹‖₁, in practice within a factor of 3.

use super::coarse::{Coarse, Layout};
use super::krylov::gmres;
use super::low_rank::Woodbury;
use super::lu::Lu;
use super::stored::Stored;
use crate::error::Error;
use nalgebra::{DMatrix, DVector};
use std::fmt::Debug;
use std::sync::{Arc, OnceLock};

/// Reciprocal condition number below which a system counts as singular: of the 16 digits fewer than two are left.
const SINGULAR: f64 = 1e-14;
/// Up to this size elimination is the fastest, whatever the kernel.
pub(super) const SMALL: usize = 3000;
/// Up to this size it is, of a full matrix, if there are a few sources.
const DENSE: usize = 6000;
/// Products with T that a solve may take.
const MOST_STEPS: usize = 400;
/// Residuals that rounding may leave, in units of ε (‖A‖ |x| + |b|).
const ROUNDING: f64 = 64.0;
/// Relative residual of solves that only tell a norm.
const ROUGH: f64 = 1e-2;

/// T as products alone.
pub(super) trait LinearMap: Debug + Send + Sync {
    /// T v.
    fn apply(&self, v: &DVector<f64>) -> DVector<f64>;
    /// Tᵀ v.
    fn apply_transposed(&self, v: &DVector<f64>) -> DVector<f64>;
}

/// A = I − T ready to be solved, with norms.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    solver: Solver,
    unknowns: usize,
    /// ‖A‖₁
    norm: f64,
    rcond: f64,
    inverse_norm: OnceLock<f64>,
    how: String,
}

#[derive(Clone, Debug)]
enum Solver {
    /// of Aᵀ: rows of A are then columns in memory, and nothing is copied
    Dense(Lu),
    Iterative {
        map: Arc<dyn LinearMap>,
        coarse: Arc<Coarse>,
    },
    LowRank(Arc<Woodbury>),
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
        let lu = Lu::new(a);
        let invertible = lu.is_invertible();
        let factor = Factor::with(Solver::Dense(lu), n, sums.max(), "LU".into());
        if invertible { factor.checked() } else { Err(Error::Singular { rcond: 0.0, unknowns: n, alternative: None }) }
    }

    /// I − T of a matrix given row by row, by elimination or, where that is slow, by GMRES.
    pub(crate) fn of_rows(rows: Vec<f64>, layout: &Layout) -> Result<Self, Error> {
        let n = layout.unknowns();
        if n <= DENSE {
            return Factor::identity_minus(rows, n);
        }
        let map = Arc::new(Stored::new(rows, n));
        // a coarse system may be singular where the fine one is not
        let iterative = Coarse::of_rows(map.rows(), layout).and_then(|coarse| Factor::iterative(map.clone(), coarse, n, "GMRES"));
        match iterative {
            Ok(factor) => Ok(factor),
            // in the same memory: two copies of the matrix might not fit
            Err(_) => Factor::identity_minus(Arc::try_unwrap(map).map_err(|_| Error::NonFiniteSolution { unknowns: n })?.into_rows(), n),
        }
    }

    /// I − T of a map that has been checked against the kernel.
    pub(super) fn iterative(map: Arc<dyn LinearMap>, coarse: Coarse, n: usize, by: &str) -> Result<Self, Error> {
        let how = format!("{by} with a coarse inverse of {} unknowns", coarse.unknowns());
        let norm = norm_estimate(n, |v| v - map.apply(v), |v| v - map.apply_transposed(v));
        let factor = Factor::with(Solver::Iterative { map, coarse: Arc::new(coarse) }, n, norm, how);
        // the longest solve there will be must converge
        factor.try_solve(&DVector::from_element(n, 1.0))?;
        factor.checked()
    }

    pub(super) fn low_rank(woodbury: Woodbury, n: usize) -> Result<Self, Error> {
        let how = format!("a kernel of rank {}", woodbury.rank());
        let norm = norm_estimate(n, |v| v - woodbury.apply(v), |v| v - woodbury.apply_transposed(v));
        Factor::with(Solver::LowRank(Arc::new(woodbury)), n, norm, how).checked()
    }

    fn with(solver: Solver, unknowns: usize, norm: f64, how: String) -> Self {
        Factor { solver, unknowns, norm, rcond: 0.0, inverse_norm: OnceLock::new(), how }
    }

    /// With its condition; refuses singular systems.
    fn checked(mut self) -> Result<Self, Error> {
        let inverse_one = norm_estimate(self.unknowns, |v| self.roughly(v), |v| self.roughly_transposed(v));
        self.rcond = 1.0 / (self.norm * inverse_one);
        // of sums over many nodes rounding leaves more
        let noise = match self.solver {
            Solver::Dense(_) => SINGULAR,
            _ => SINGULAR.max(16.0 * f64::EPSILON * (self.unknowns as f64).sqrt()),
        };
        if self.rcond.is_nan() || self.rcond <= noise {
            return Err(Error::Singular { rcond: self.rcond, unknowns: self.unknowns, alternative: None });
        }
        Ok(self)
    }

    /// Estimated 1/(‖A‖₁ ‖A⁻¹‖₁).
    pub(crate) fn rcond(&self) -> f64 {
        self.rcond
    }

    /// Estimated ‖A⁻¹‖∞: what a residual may be amplified by. Costs a few solves, the first time.
    pub(crate) fn inverse_norm(&self) -> f64 {
        *self.inverse_norm.get_or_init(|| norm_estimate(self.unknowns(), |v| self.roughly_transposed(v), |v| self.roughly(v)))
    }

    pub(crate) fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// How systems are solved, in words.
    pub(crate) fn how(&self) -> &str {
        &self.how
    }

    /// A⁻¹ b; NaN where an iteration did not converge, so that no estimate made of it passes.
    pub(crate) fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        self.try_solve(b).unwrap_or_else(|_| b.map(|_| f64::NAN))
    }

    /// A⁻¹ b. [`Error::NotConverged`] with the relative residual of an iteration that rounding does not explain.
    pub(crate) fn try_solve(&self, b: &DVector<f64>) -> Result<DVector<f64>, Error> {
        match &self.solver {
            Solver::Dense(lu) => Ok(changed(b, |x| lu.solve_transposed(x))),
            Solver::LowRank(woodbury) => Ok(woodbury.solve(b)),
            Solver::Iterative { map, coarse } => self.iterate(b, |v| v - map.apply(v), |v| coarse.apply(v), f64::EPSILON),
        }
    }

    /// A⁻ᵀ b; NaN where an iteration did not converge.
    pub(crate) fn solve_transposed(&self, b: &DVector<f64>) -> DVector<f64> {
        self.transposed(b, f64::EPSILON)
    }

    fn transposed(&self, b: &DVector<f64>, tolerance: f64) -> DVector<f64> {
        match &self.solver {
            Solver::Dense(lu) => changed(b, |x| lu.solve(x)),
            Solver::LowRank(woodbury) => woodbury.solve_transposed(b),
            Solver::Iterative { map, coarse } => self
                .iterate(b, |v| v - map.apply_transposed(v), |v| coarse.apply_transposed(v), tolerance)
                .unwrap_or_else(|_| b.map(|_| f64::NAN)),
        }
    }

    /// A⁻¹ b, good enough for a norm.
    fn roughly(&self, b: &DVector<f64>) -> DVector<f64> {
        match &self.solver {
            Solver::Iterative { map, coarse } => {
                self.iterate(b, |v| v - map.apply(v), |v| coarse.apply(v), ROUGH).unwrap_or_else(|_| b.map(|_| f64::NAN))
            }
            _ => self.solve(b),
        }
    }

    fn roughly_transposed(&self, b: &DVector<f64>) -> DVector<f64> {
        self.transposed(b, ROUGH)
    }

    fn iterate(
        &self,
        b: &DVector<f64>,
        apply: impl Fn(&DVector<f64>) -> DVector<f64>,
        precondition: impl Fn(&DVector<f64>) -> DVector<f64>,
        tolerance: f64,
    ) -> Result<DVector<f64>, Error> {
        let found = gmres(apply, precondition, b, tolerance, MOST_STEPS);
        let allowed = tolerance.max(ROUNDING * f64::EPSILON * (self.norm * found.x.norm() / b.norm() + 1.0));
        // 0 for b = 0
        if found.residual == 0.0 || found.residual <= allowed {
            return Ok(found.x);
        }
        Err(Error::NotConverged { error: found.residual, tolerance: allowed, unknowns: self.unknowns })
    }
}

fn changed(b: &DVector<f64>, solve: impl Fn(&mut DVector<f64>)) -> DVector<f64> {
    let mut x = b.clone();
    solve(&mut x);
    x
}

/// Lower bound of ‖B‖₁ from products with B and Bᵀ.
pub(super) fn norm_estimate(
    n: usize,
    apply: impl Fn(&DVector<f64>) -> DVector<f64>,
    transposed: impl Fn(&DVector<f64>) -> DVector<f64>,
) -> f64 {
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
