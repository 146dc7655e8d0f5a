//! Eigenvalues and eigenfunctions of T, and det(I − zT), from Nyström matrices.
//!
//! ```text
//! λ φ(x) = ∫ K(x, y) φ(y) dμ(y)  ≈  Σ_j w_j K(x, y_j) φ_j                      Atkinson, SIAM J. Numer. Anal. 4 (1967) 337; Kress, ch. 12
//! λ̃ − λ ≈ ⟨ψ, T φ̃ − λ̃ φ̃⟩ / ⟨ψ, φ̃⟩                                         ψ: the eigenfunction of the adjoint
//! ```
//!
//! The eigenvalues of T_n converge to those of T with the order of the rule, in clusters for multiple ones; [`eigenpairs`] tells how far they are, from
//! residuals by a rule that shares no nodes. |λ| = ρ(T) decides whether Σ Tⁿg converges; ρ(|T|), which decides for walks, is
//! [`Series`](crate::kernel::Series)' business. A nilpotent kernel shows what spectra leave out: rounding puts its eigenvalues at ε^{1/k}, not at 0, and
//! only their condition tells.

mod determinant;
mod matrix;
mod pairs;
mod residuals;
mod ritz;
mod search;

pub use determinant::{Determinant, determinant};
pub use pairs::{Eigenpair, eigenpairs};

use super::grid::Grid;
use super::nystrom::{Nystrom, Rule};
use crate::contained::contained;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, gelfand};
use matrix::Matrix;
use nalgebra::Complex;

/// Eigenvalues of T by a fixed rule, largest modulus first; as many as the rule has unknowns, the small ones meaningless. 10 n³ multiplications.
///
/// [`eigenpairs`] finds the few that matter, with their functions and errors.
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
    let matrix = contained(|| matrix_of(kernel, settings))?;
    matrix.eigenvalues().ok_or_else(|| matrix.unended())
}

/// Spectral radius ρ(T), signs of K included: the Neumann series Σ Tⁿg converges for every g iff it is below 1.
///
/// By eigenvalues; where their iteration does not end, by Gelfand's ‖Tᵐ‖^{1/m}. An [adaptive](Nystrom::adaptive) rule finds it to its tolerance.
///
/// ```
/// use fredholm::{deterministic::{Nystrom, spectral_radius}, domain::Interval, kernel::kernel_fn};
/// let log = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| (x - y).abs().ln());
/// assert!(spectral_radius(&log, &Nystrom::adaptive().tolerance(1e-10))? > 1.0);
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// Those of assembling the matrix; [`Error::NotConverged`] for adaptive rules.
pub fn spectral_radius<K: Kernel + HasDomain + Clone>(kernel: &K, settings: &Nystrom) -> Result<f64, Error> {
    if let Rule::Adaptive { .. } = settings.rule {
        return Ok(eigenpairs(kernel, settings, 1)?.first().map_or(0.0, |pair| pair.value().norm()));
    }
    let matrix = contained(|| matrix_of(kernel, settings))?;
    let largest = matrix.eigenvalues().and_then(|e| e.first().map(|l| l.norm()));
    Ok(largest.unwrap_or_else(|| gelfand(matrix.embedded())))
}

fn validated<K: Kernel + HasDomain>(kernel: &K) -> Result<(), Error> {
    kernel.validate()?;
    kernel.domain().validate()
}

fn grid_of<K: Kernel + HasDomain>(kernel: &K, settings: &Nystrom) -> Result<Grid<K::Point>, Error> {
    validated(kernel)?;
    settings.grid(kernel.domain())
}

fn matrix_of<K: Kernel + HasDomain>(kernel: &K, settings: &Nystrom) -> Result<Matrix, Error> {
    Ok(Matrix::assemble(kernel, &grid_of(kernel, settings)?)?.0)
}
