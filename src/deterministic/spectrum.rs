//! Eigenvalues of T, from the matrix of a Nyström rule.
//!
//! The eigenvalues of T_n = (w_j K(x_i, x_j)) converge to those of T with the order of the rule (Atkinson 1967; Kress, ch. 12), in clusters for
//! multiple ones. |λ| = ρ(T) decides whether Σ Tⁿg converges; ρ(|T|), which decides for walks, is [`Series`](crate::kernel::Series)' business.
//! A nilpotent kernel shows what spectra leave out: rounding puts its eigenvalues at ε^{1/k}, not at 0.

use super::near::components;
use super::nystrom::Nystrom;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, gelfand};
use nalgebra::{Complex, DMatrix, Schur};

/// Eigenvalues of T by a fixed rule, largest modulus first; as many as the rule has unknowns, the small ones meaningless. 10 n³ multiplications.
///
/// ```
/// use fredholm::{deterministic::{Nystrom, eigenvalues}, domain::Interval, kernel::kernel_fn};
/// let k = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| x.min(*y));          // 1/((k − ½)²π²)
/// let largest = eigenvalues(&k, &Nystrom::graded(2, 8).levels(1))?[0];
/// assert!((largest.re - 4.0 / std::f64::consts::PI.powi(2)).abs() < 1e-12 && largest.im == 0.0);
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// Those of assembling the matrix; [`Error::NotConverged`] if the QR iteration does not end.
pub fn eigenvalues<K: Kernel + HasDomain>(kernel: &K, settings: &Nystrom) -> Result<Vec<Complex<f64>>, Error> {
    let matrix = matrix_of(kernel, settings)?;
    let n = matrix.nrows();
    schur(matrix).ok_or(Error::NotConverged { error: f64::NAN, tolerance: f64::EPSILON, unknowns: n })
}

/// Spectral radius ρ(T), signs of K included: the Neumann series Σ Tⁿg converges for every g iff it is below 1.
///
/// By eigenvalues; where their iteration does not end, by Gelfand's ‖Tᵐ‖^{1/m}.
///
/// # Errors
/// Those of assembling the matrix.
pub fn spectral_radius<K: Kernel + HasDomain>(kernel: &K, settings: &Nystrom) -> Result<f64, Error> {
    let matrix = matrix_of(kernel, settings)?;
    Ok(schur(matrix.clone()).and_then(|e| e.first().map(|l| l.norm())).unwrap_or_else(|| gelfand(matrix)))
}

fn matrix_of<K: Kernel + HasDomain>(kernel: &K, settings: &Nystrom) -> Result<DMatrix<f64>, Error> {
    kernel.validate()?;
    kernel.domain().validate()?;
    let grid = settings.grid(kernel.domain())?;
    let (rows, _) = grid.matrix(kernel)?;
    let n = grid.nodes.len() * components::<K>();
    Ok(DMatrix::from_row_slice(n, n, &rows))
}

fn schur(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let most = 60 * matrix.nrows().max(10);
    let schur = Schur::try_new(matrix, f64::EPSILON, most)?;
    let mut values: Vec<_> = schur.complex_eigenvalues().iter().copied().collect();
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    Some(values)
}
