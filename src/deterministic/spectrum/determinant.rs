//! Fredholm's determinant.
//!
//! ```text
//! det(I − zT) = Π (1 − zλ_k) = Σ (−z)ⁿ/n! ∫ det[K(x_i, x_j)] ≈ det(δ_ij − z w_j K(x_i, y_j))           Bornemann, Math. Comp. 79 (2010) 871
//! ```
//!
//! Converges as the rule does: geometrically for analytic K, slowly for kinks, and not at all for kernels that are infinite on the diagonal, whose
//! eigenvalues have no sum. Errors are absolute: rounding leaves about ε Σ|zλ_k| of them, whatever is left of the determinant itself.

use super::matrix::Matrix;
use super::validated;
use crate::contained::contained;
use crate::deterministic::erased::erased;
use crate::deterministic::grid::Grid;
use crate::deterministic::nystrom::{Nystrom, Rule};
use crate::deterministic::scan::Scan;
use crate::deterministic::seen::Sight;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use nalgebra::Complex;

/// det(I − zT) and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Determinant {
    /// det(I − zT).
    pub value: Complex<f64>,
    /// Estimated absolute error: the change from a smaller rule, and rounding.
    pub error: f64,
    /// Size of the matrix.
    pub unknowns: usize,
}

/// Rounding of a determinant, in units of ε ‖zT‖.
const ROUNDING: f64 = 4.0;
/// From three quarters of the nodes to all: the change of an error that falls as 1/n is a third of it.
const SLOW: f64 = 3.0;

/// det(I − zT) for one z: 0 iff 1/z is an eigenvalue of T.
///
/// A fixed plain rule is compared with one of three quarters of its nodes; [`Nystrom::adaptive`] doubles a Gauss rule until the change is below its
/// tolerance and rows and columns of K have nothing between the nodes.
///
/// ```
/// use fredholm::{deterministic::{Nystrom, determinant}, domain::Interval, kernel::kernel_fn};
/// let k = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| x * y);                 // λ = ⅓
/// let d = determinant(&k, 1.5, &Nystrom::adaptive())?;
/// assert!((d.value.re - 0.5).abs() < 1e-14 && d.error < 1e-10);
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// [`Error::NonFiniteKernel`] for kernels that are infinite on the diagonal; [`Error::Invalid`] for graded rules; [`Error::NotConverged`] with the last
/// change.
pub fn determinant<K: Kernel + HasDomain>(kernel: &K, z: impl Into<Complex<f64>>, settings: &Nystrom) -> Result<Determinant, Error> {
    contained(|| {
        validated(kernel)?;
        let (z, domain) = (z.into(), kernel.domain());
        if !z.is_finite() {
            return Err(Error::invalid("z", if z.re.is_finite() { z.im } else { z.re }, "must be finite"));
        }
        let at = |panels: usize, order: usize| -> Result<(Complex<f64>, f64, usize), Error> {
            let (matrix, _) = Matrix::assemble(kernel, &Grid::plain(domain, panels, order)?)?;
            let rounding = ROUNDING * f64::EPSILON * z.norm() * matrix.norm();
            let value = matrix.determinant(z);
            // a product of many factors carries their rounding along
            Ok((value, rounding * value.norm().max(1.0), matrix.unknowns()))
        };
        match settings.rule {
            Rule::Plain { panels, order } => {
                let (fine, rounding, unknowns) = at(panels, order)?;
                let (coarse, ..) =
                    if order > 1 { at(panels, (3 * order).div_ceil(4).min(order - 1))? } else { at((3 * panels).div_ceil(4), 1)? };
                finite(Determinant { value: fine, error: SLOW * (fine - coarse).norm() + rounding, unknowns })
            }
            Rule::Adaptive { tolerance, most } => {
                let d = domain.dimension() as i32;
                let mut last: Option<Complex<f64>> = None;
                let (mut order, mut error, mut largest) = (if d == 1 { 10 } else { 4 }, f64::INFINITY, 0);
                while (order as f64).powi(d) * domain.states() as f64 <= most as f64 {
                    let (value, rounding, unknowns) = at(1, order)?;
                    largest = unknowns;
                    if let Some(last) = last {
                        let scale = value.norm().max(1.0);
                        error = (value - last).norm() + rounding;
                        if error <= tolerance * scale {
                            error += z.norm() * unseen(kernel, &Grid::plain(domain, 1, order)?) * scale;
                        }
                        if error <= tolerance * scale {
                            return finite(Determinant { value, error, unknowns });
                        }
                    }
                    last = Some(value);
                    order = if d == 1 { 2 * order } else { order + order / 2 };
                }
                Err(Error::NotConverged { error, tolerance, unknowns: largest })
            }
            Rule::Graded { .. } | Rule::Centred { .. } => Err(Error::invalid(
                "Nystrom::graded",
                0.0,
                "has no determinant, as little as a centred rule: take a plain or an adaptive one",
            )),
        }
    })
}

/// What rows and columns of K have between the nodes: the determinant changes by about −z tr((I − zT)⁻¹ δT) of itself.
fn unseen<K: Kernel + HasDomain>(kernel: &K, grid: &Grid<K::Point>) -> f64 {
    let kernel = erased(kernel);
    let seen = Sight { kernel: &kernel, grid }.look(&Scan::of(kernel.domain(), grid), &[]);
    seen.row + seen.column
}

fn finite(d: Determinant) -> Result<Determinant, Error> {
    if d.value.is_finite() { Ok(d) } else { Err(Error::NonFiniteSolution { unknowns: d.unknowns }) }
}
