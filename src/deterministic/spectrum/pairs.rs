//! Eigenvalues with their functions, residuals and errors.

use super::matrix::{Matrix, Shifted, Vector, apply_row, fields};
use super::residuals::residuals;
use super::{search, validated};
use crate::contained::contained;
use crate::deterministic::grid::Grid;
use crate::deterministic::near::components;
use crate::deterministic::nystrom::{Nystrom, Rule};
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use nalgebra::Complex;
use std::fmt;
use std::sync::Arc;

/// Values below this share of ‖T‖ are rounding: T may have no such eigenvalue.
const ROUNDING: f64 = 1e-13;
/// Eigenvalues closer than this, relative to the modulus, count as one multiple eigenvalue.
const CLUSTER: f64 = 1e-6;
/// A first-order estimate is known to its own order of magnitude.
const SAFETY: f64 = 2.0;

/// An eigenvalue λ of T and its function φ, scaled to max |φ| = 1 with φ > 0 there.
///
/// `Display` prints the value with its error.
pub struct Eigenpair<K: Operator> {
    shared: Arc<Shared<K>>,
    value: Complex<f64>,
    error: f64,
    residual: f64,
    /// part of the error
    rounding: f64,
    condition: f64,
    values: Vec<Complex<f64>>,
}

impl<K: Operator> Clone for Eigenpair<K> {
    fn clone(&self) -> Self {
        Eigenpair { shared: Arc::clone(&self.shared), values: self.values.clone(), ..*self }
    }
}

struct Shared<K: Operator> {
    kernel: K,
    grid: Grid<K::Point>,
    evaluations: u64,
}

/// The `count` eigenvalues of T of largest modulus, with eigenfunctions; fewer if the others are lost in rounding.
///
/// A fixed rule reports what its errors are; [`Nystrom::adaptive`] refines until the errors of all eigenvalues and all residuals ‖Tφ − λφ‖∞ are below
/// its tolerance times |λ₁|.
///
/// ```
/// use fredholm::{deterministic::{Nystrom, eigenpairs}, domain::Interval, kernel::kernel_fn};
/// // |x − y|: λ = −2/ω² for the zeros of cos(ω/2) and … ; the largest is 2/ω², ω tanh(ω/2) = 2
/// let k = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| (x - y).abs());
/// let pairs = eigenpairs(&k, &Nystrom::adaptive().tolerance(1e-11), 2)?;
/// let omega = (2.0 / pairs[0].value().re).sqrt();
/// assert!((omega * (omega / 2.0).tanh() - 2.0).abs() < 1e-9 && pairs[0].error() < 1e-11);
/// let phi = |x: f64| pairs[0].eval(x).re;
/// assert!((phi(0.5) / phi(0.0) - 1.0 / (omega / 2.0).cosh()).abs() < 1e-9);
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// Those of assembling the matrix; [`Error::NotConverged`] with the largest error if an adaptive search does not reach its tolerance: for nilpotent and
/// nearly defective kernels none does.
pub fn eigenpairs<K: Kernel + HasDomain + Clone>(kernel: &K, settings: &Nystrom, count: usize) -> Result<Vec<Eigenpair<K>>, Error> {
    validated(kernel)?;
    if count == 0 {
        return Err(Error::invalid("count", 0.0, "must be at least 1"));
    }
    contained(|| match settings.rule {
        Rule::Adaptive { tolerance, most } => search::adaptive(kernel, settings, tolerance, most, count),
        _ => on_grid(kernel, settings.grid(kernel.domain())?, count),
    })
}

/// Pairs by one rule.
pub(super) fn on_grid<K: Kernel + HasDomain + Clone>(kernel: &K, grid: Grid<K::Point>, count: usize) -> Result<Vec<Eigenpair<K>>, Error> {
    let (matrix, evaluations) = Matrix::assemble(kernel, &grid)?;
    let norm = matrix.norm();
    let leading = matrix.leading(count).ok_or_else(|| matrix.unended())?;
    let mut found: Vec<Found> = Vec::new();
    for (k, theta) in leading.iter().take(count).enumerate().filter(|(_, theta)| theta.norm() > ROUNDING * norm) {
        let apart: Vec<&Vector> = found.iter().filter(|f| f.is_near(*theta)).map(|f| &f.right).collect();
        let vectors = Shifted::new(&matrix, *theta).vectors(&apart, k);
        let (right, left) = vectors.ok_or_else(|| matrix.unended())?;
        found.push(Found::of(&matrix, *theta, right, left));
    }
    let (at_nodes, at_probes) = residuals(kernel, &grid, &found)?;
    let shared = Arc::new(Shared { kernel: kernel.clone(), grid, evaluations });
    let pair = |(k, f): (usize, &Found)| {
        let scale = f.right.iter().fold(Complex::from(0.0), |m: Complex<f64>, v| if v.norm() > m.norm() { *v } else { m });
        let largest = at_nodes[k].iter().chain(&at_probes[k]).fold(0.0f64, |m, r| if r.is_finite() { m.max(r.norm()) } else { f64::NAN });
        let residual = largest / scale.norm();
        // within a cluster the perturbation mixes the functions
        let mixed = found.iter().zip(&at_nodes).filter(|(other, _)| other.is_near(f.value));
        let first = mixed.map(|(_, r)| (f.left.dotc(r) / f.overlap).norm()).fold(0.0, f64::max);
        let relative = residual / f.value.norm();
        let second = f.condition * relative * relative.min(1.0) * f.value.norm();
        let rounding = 8.0 * f64::EPSILON * norm * f.condition;
        let error = SAFETY * (first + second) + rounding;
        Eigenpair {
            shared: Arc::clone(&shared),
            value: f.value,
            // NaN is no error estimate
            error: if error.is_nan() { f64::INFINITY } else { error },
            residual,
            rounding,
            condition: f.condition,
            values: f.right.iter().map(|v| v / scale).collect(),
        }
    };
    Ok(found.iter().enumerate().map(pair).collect())
}

/// An eigenvalue of the matrix with unit vectors.
pub(super) struct Found {
    pub(super) value: Complex<f64>,
    pub(super) right: Vector,
    pub(super) left: Vector,
    pub(super) overlap: Complex<f64>,
    pub(super) condition: f64,
}

impl Found {
    fn of(matrix: &Matrix, theta: Complex<f64>, right: Vector, left: Vector) -> Self {
        let overlap = left.dotc(&right);
        let condition = left.norm() * right.norm() / overlap.norm();
        let value = left.dotc(&matrix.times(&right)) / overlap;
        // of a nearly defective matrix the quotient is noise
        let value = if (value - theta).norm() <= CLUSTER * theta.norm() { value } else { theta };
        // real up to rounding: what the real arithmetic of a real matrix leaves of it
        let value = if theta.im == 0.0 { value.re.into() } else { value };
        Found { value, right, left, overlap, condition }
    }

    fn is_near(&self, theta: Complex<f64>) -> bool {
        (self.value - theta).norm() <= CLUSTER * theta.norm()
    }
}

impl<K: Operator> Eigenpair<K> {
    /// λ.
    #[must_use]
    pub fn value(&self) -> Complex<f64> {
        self.value
    }

    /// Estimated |error| of λ: to first order from the residual and the adjoint eigenfunction, doubled, and what rounding may do.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.error
    }

    /// max |Tφ − λφ| by a rule that shares no nodes with the solve.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// ‖ψ‖ ‖φ‖/|⟨ψ, φ⟩| on the nodes: what a perturbation of T is multiplied by in λ. Of the order of 1 for symmetric kernels, infinite for defective ones.
    #[must_use]
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Size of the matrix.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.values.len()
    }

    /// Kernel evaluations of the matrix.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.shared.evaluations
    }

    /// The nodes.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = K::Point> + '_ {
        self.shared.grid.nodes.iter().map(|n| n.point)
    }

    /// φ at the nodes, component by component.
    #[must_use]
    pub fn values(&self) -> &[Complex<f64>] {
        &self.values
    }

    /// What rounding alone may do to λ.
    pub(super) fn rounding(&self) -> f64 {
        self.rounding
    }

    /// T was not resolved, up to operators of norm `missed`.
    pub(super) fn miss(&mut self, missed: f64) {
        self.error += missed * self.condition;
        self.residual += missed;
    }

    pub(super) fn grid(&self) -> &Grid<K::Point> {
        &self.shared.grid
    }
}

impl<K: Kernel + HasDomain> Eigenpair<K> {
    /// φ(x), of systems its first component; NaN where K is not finite or x is outside the domain.
    pub fn eval(&self, x: K::Point) -> Complex<f64> {
        self.component(x, 0)
    }

    /// Component `i` of φ(x) = (1/λ) Σ_j w_j K(x, y_j) φ_j; NaN where K is not finite, x is outside the domain or there is no such component.
    pub fn component(&self, x: K::Point, i: usize) -> Complex<f64> {
        self.try_components(&x).ok().and_then(|f| f.get(i).copied()).unwrap_or(Complex::new(f64::NAN, f64::NAN))
    }

    fn try_components(&self, x: &K::Point) -> Result<Vec<Complex<f64>>, Error> {
        let (kernel, grid, c) = (&self.shared.kernel, &self.shared.grid, components::<K>());
        if !kernel.domain().contains(x) {
            return Err(Error::Outside { x: format!("{x:?}") });
        }
        let mut row = vec![0.0; c * c * grid.nodes.len()];
        grid.row(kernel, x, &mut row)?;
        let mut out = vec![Complex::from(0.0); fields::<K>()];
        apply_row::<K>(&row, &self.values, &mut out);
        Ok(out.iter().map(|v| v / self.value).collect())
    }

    /// ∫ h φ dμ by the nodes of the solve, component by component.
    pub fn functional(&self, h: impl Fn(&K::Point) -> f64) -> Vec<Complex<f64>> {
        let m = fields::<K>();
        let mut sums = vec![Complex::from(0.0); m];
        for (n, phi) in self.shared.grid.nodes.iter().zip(self.values.chunks_exact(m)) {
            sums.iter_mut().zip(phi).for_each(|(s, v)| *s += v * (n.weight * h(&n.point)));
        }
        sums
    }

    /// ∫ |φ|² dμ by the nodes of the solve.
    #[must_use]
    pub fn norm_squared(&self) -> f64 {
        let m = fields::<K>();
        self.shared
            .grid
            .nodes
            .iter()
            .zip(self.values.chunks_exact(m))
            .map(|(n, phi)| n.weight * phi.iter().map(|v| v.norm_sqr()).sum::<f64>())
            .sum()
    }
}

impl<K: Operator> fmt::Debug for Eigenpair<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Eigenpair")
            .field("value", &self.value)
            .field("error", &self.error)
            .field("residual", &self.residual)
            .field("condition", &self.condition)
            .field("unknowns", &self.values.len())
            .finish_non_exhaustive()
    }
}

impl<K: Operator> fmt::Display for Eigenpair<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.value.im == 0.0 {
            write!(f, "λ = {}", self.value.re)?;
        } else {
            write!(f, "λ = {}", self.value)?;
        }
        write!(f, " ± {:.1e}, residual {:.1e}, condition {:.1e}, {} unknowns", self.error, self.residual, self.condition, self.values.len())
    }
}
