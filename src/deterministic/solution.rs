//! f as a function, from its values at the nodes.

use super::class::KernelClass;
use super::factorised::System;
use super::grid::Grid;
use super::quadrature::compensated_sum;
use super::scan::resolution;
use crate::contained::contained;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};
use std::fmt;
use std::sync::{Arc, OnceLock};

/// The solution of a Nyström solve: f_n(x) = g(x) + Σ_j w_j K(x, y_j) f_j anywhere in the domain.
///
/// `Display` says how it was found.
#[derive(Clone)]
pub struct NystromSolution<G: Source, K: Operator> {
    pub(super) source: G,
    pub(super) system: Arc<System<K>>,
    pub(super) values: Vec<G::Value>,
    error: Option<f64>,
    resolution: Option<f64>,
    class: Option<KernelClass>,
    warning: Option<String>,
    evaluations: u64,
    pub(super) check: OnceLock<Checked<K::Point, G::Value>>,
}

type Checked<X, V> = Result<Check<X, V>, Error>;

/// f_n on the nodes of a rule that shares none with the solve.
#[derive(Clone, Debug)]
pub(super) struct Check<X, V> {
    pub(super) grid: Grid<X>,
    pub(super) values: Vec<V>,
}

impl<G, K> NystromSolution<G, K>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    pub(super) fn new(source: G, system: Arc<System<K>>, values: Vec<G::Value>) -> Self {
        let evaluations = system.evaluations;
        NystromSolution {
            source,
            system,
            values,
            error: None,
            resolution: None,
            class: None,
            warning: None,
            evaluations,
            check: OnceLock::new(),
        }
    }

    /// The same solution of an equation of the same values.
    pub(super) fn of<H, L>(self, source: H, kernel: L) -> NystromSolution<H, L>
    where
        H: Source<Point = G::Point, Value = G::Value>,
        K: Clone,
        L: Operator<Point = K::Point, Weight = K::Weight>,
    {
        let NystromSolution { system, values, error, resolution, class, warning, evaluations, check, .. } = self;
        let System { grid, factor, evaluations: assembled, .. } = Arc::unwrap_or_clone(system);
        let system = Arc::new(System { kernel, grid, factor, evaluations: assembled });
        NystromSolution { source, system, values, error, resolution, class, warning, evaluations, check }
    }

    pub(super) fn with_error(self, error: f64, evaluations: u64) -> Self {
        let resolution = Some(resolution(self.system.kernel.domain().dimension()));
        NystromSolution { error: Some(error), resolution, evaluations, ..self }
    }

    pub(super) fn with_class(self, class: KernelClass, warning: Option<String>) -> Self {
        NystromSolution { class: Some(class), warning, ..self }
    }

    pub(super) fn source(&self) -> &G {
        &self.source
    }

    pub(super) fn system(&self) -> &System<K> {
        &self.system
    }

    /// f(x); NaN in every component where K or g is not finite or panics, or for x outside the domain. Costs one row of the operator.
    pub fn eval(&self, x: K::Point) -> G::Value {
        self.try_eval(&x).unwrap_or_else(|_| G::Value::from_components(|_| f64::NAN))
    }

    /// f(x), or why it is not known.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] and [`Error::NonFiniteSource`] with the place; [`Error::Outside`] for x outside the domain.
    pub fn try_eval(&self, x: &K::Point) -> Result<G::Value, Error> {
        contained(|| self.value_at(x))
    }

    /// The same where a panic is to end what asks.
    pub(super) fn value_at(&self, x: &K::Point) -> Result<G::Value, Error> {
        if !self.system.kernel.domain().contains(x) {
            return Err(Error::Outside { x: format!("{x:?}") });
        }
        let g = self.source.eval(x);
        if !g.all_finite() {
            return Err(Error::non_finite_source(x, &g));
        }
        Ok(g + self.image(x)?)
    }

    /// (Tf)(x): by the row at x, or from f − g at the nodes where there is none to be trusted.
    fn image(&self, x: &K::Point) -> Result<G::Value, Error> {
        let (grid, domain) = (&self.system.grid, self.system.kernel.domain());
        match grid.is_held_off(domain, x).then(|| grid.stencil(domain, x)).flatten() {
            Some(stencil) => {
                let term = |j: usize, a: usize| self.values[j].component(a) - self.source.eval(&grid.nodes[j].point).component(a);
                Ok(G::Value::from_components(|a| stencil.apply(|j| term(j, a))))
            }
            None => apply_row(&self.system.kernel, grid, &self.values, x),
        }
    }

    /// (Tf)(x) = f(x) − g(x), without the cancellation of taking the difference.
    ///
    /// # Errors
    /// Those of [`try_eval`](NystromSolution::try_eval).
    pub fn integral_term(&self, x: K::Point) -> Result<G::Value, Error> {
        contained(|| match self.system.kernel.domain().contains(&x) {
            true => self.image(&x),
            false => Err(Error::Outside { x: format!("{x:?}") }),
        })
    }

    /// The nodes y_j.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = K::Point> + '_ {
        self.system.grid.nodes.iter().map(|n| n.point)
    }

    /// f at the nodes.
    pub fn values(&self) -> &[G::Value] {
        &self.values
    }

    /// ⟨h, f⟩ = ∫ h(y) f(y) dμ(y) by the nodes of the solve.
    ///
    /// ```
    /// # use fredholm::{Equation, deterministic::Nystrom};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let f = eq.solve(&Nystrom::gauss_legendre(8))?;
    /// assert!((f.functional(|x| *x) - 0.6).abs() < 1e-15);        // ∫ x (1 + 3x/10)
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn functional(&self, h: impl Fn(&K::Point) -> f64) -> G::Value {
        let mut sum = G::Value::ZERO;
        for (n, f) in self.system.grid.nodes.iter().zip(&self.values) {
            sum += f.scale(n.weight * h(&n.point));
        }
        sum
    }

    /// max |f| over the nodes and components.
    #[must_use]
    pub fn magnitude(&self) -> f64 {
        self.values.iter().map(Value::magnitude).fold(0.0, f64::max)
    }

    /// The same but for what is closer to an end of a line than a millionth of it: f may grow beyond all bounds there.
    pub(super) fn bulk(&self) -> f64 {
        const EDGE: f64 = 1e-6;
        let domain = self.system.kernel.domain();
        let inside = |x: &K::Point| domain.dimension() > 1 || (EDGE..=1.0 - EDGE).contains(&domain.coordinate(x, 0));
        self.nodes().zip(&self.values).filter(|(x, _)| inside(x)).map(|(_, f)| f.magnitude()).fold(0.0, f64::max)
    }

    /// Size of the linear system.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.system.factor.unknowns()
    }

    /// How the linear system was solved, in words.
    #[must_use]
    pub fn linear_algebra(&self) -> &str {
        self.system.factor.how()
    }

    /// Kernel evaluations of assembling the systems (all attempts, for an adaptive one); choosing panels and checking the answer are not counted.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Estimated reciprocal condition number of the system, 1-norm: digits of f beyond −log₁₀(ε/rcond) are noise.
    #[must_use]
    pub fn rcond(&self) -> f64 {
        self.system.factor.rcond()
    }

    /// Estimated ‖(I − T)⁻¹‖∞: |error| ≤ this × largest |residual|.
    #[must_use]
    pub fn inverse_norm(&self) -> f64 {
        self.system.factor.inverse_norm()
    }

    /// Estimated largest |error|, in the units of f; only adaptive solves know it.
    #[must_use]
    pub fn error_estimate(&self) -> Option<f64> {
        self.error
    }

    /// Width of the narrowest features that the checks behind [`error_estimate`](Self::error_estimate) are sure to meet, as a share of the domain's
    /// coordinate: what g and f have away from [breakpoints](super::Nystrom::breakpoints) and is narrower may be missed, and of K what covers less than
    /// about 1/5000 of the square away from the diagonal. No finite number of values excludes it. `None` for rules that check nothing.
    ///
    /// ```
    /// # use fredholm::{Equation, deterministic::Nystrom};
    /// let lamp = |x: f64| (-((x - 0.3) / 1e-8).powi(2)).exp() / (1e-8 * std::f64::consts::PI.sqrt());
    /// let eq = Equation::on_interval(0.0..=1.0, lamp, |_, _| 0.5);
    /// let missed = eq.solve(&Nystrom::adaptive())?;
    /// assert!(missed.eval(0.5) == 0.0 && missed.resolution() > Some(1e-8));
    /// let declared = eq.solve(&Nystrom::adaptive().breakpoints(&[0.3]))?;
    /// assert!((declared.eval(0.5) - 1.0).abs() < 1e-8);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    #[must_use]
    pub fn resolution(&self) -> Option<f64> {
        self.resolution
    }

    /// What the kernel looked like to an adaptive solve on a line.
    #[must_use]
    pub fn class(&self) -> Option<KernelClass> {
        self.class
    }

    /// Where values of the kernel contradict what was [declared](super::Nystrom::diagonal).
    #[must_use]
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    /// Condition number ‖I − T_n‖₁ ‖(I − T_n)⁻¹‖₁, estimated from below, in practice within a factor of 3.
    #[must_use]
    pub fn condition(&self) -> f64 {
        1.0 / self.rcond()
    }
}

/// Σ_j (row of T at x)_j f_j.
pub(super) fn apply_row<K, V>(kernel: &K, grid: &Grid<K::Point>, values: &[V], x: &K::Point) -> Result<V, Error>
where
    K: Kernel + HasDomain,
    K::Weight: Weight<Value = V>,
    V: Value,
{
    let (c, n) = (V::COMPONENTS, values.len());
    let mut row = vec![0.0; c * c * n];
    grid.row(kernel, x, &mut row)?;
    let term = |a: usize, i: usize| row[a * n * c + i] * values[i / c].component(i % c);
    let component = |a: usize| compensated_sum((0..n * c).map(|i| term(a, i)));
    Ok(V::from_components(component))
}

impl<G: Source, K: Operator> fmt::Debug for NystromSolution<G, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NystromSolution")
            .field("nodes", &self.values.len())
            .field("rcond", &self.system.factor.rcond())
            .field("error", &self.error)
            .finish_non_exhaustive()
    }
}

impl<G: Source, K: Operator> fmt::Display for NystromSolution<G, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factor = &self.system.factor;
        write!(f, "Nyström, {} unknowns by {}, rcond {:.1e}", factor.unknowns(), factor.how(), factor.rcond())?;
        match self.error {
            Some(error) => write!(f, ", |error| ≲ {error:.1e}")?,
            None => write!(f, ", error not estimated")?,
        }
        if let Some(width) = self.resolution {
            write!(f, ", blind to what is narrower than {width:.0e} of the domain")?;
        }
        if let Some(class) = &self.class {
            write!(f, "; kernel {class}")?;
        }
        match &self.warning {
            Some(warning) => write!(f, "; warning: {warning}"),
            None => Ok(()),
        }
    }
}
