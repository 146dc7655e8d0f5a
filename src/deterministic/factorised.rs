//! I − T on the nodes of a rule, factorised once for many sources.

use super::coarse::Layout;
use super::erased::erased;
use super::fast;
use super::grid::Grid;
use super::linear::Factor;
use super::nystrom::Nystrom;
use super::solution::{NystromSolution, apply_row};
use crate::contained::contained;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::{Value, Weight};
use nalgebra::DVector;
use std::sync::Arc;

/// A kernel on the nodes of a rule, with I − T factorised: one more source costs n² instead of n³/3 multiplications and n² kernel evaluations.
///
/// ```
/// use fredholm::{Equation, deterministic::Nystrom, domain::Interval, source::source_fn};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let solver = eq.factorise(&Nystrom::gauss_legendre(8))?;
/// let f = solver.solve(&source_fn(Interval::from(0.0..=1.0), |x: &f64| *x))?;
/// assert!((f.eval(0.5) - 0.6).abs() < 1e-15);                    // f = x + ½x ∫ y f = 6x/5
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Debug)]
pub struct Factorised<K: Operator> {
    pub(super) system: Arc<System<K>>,
}

impl<K: Operator> Clone for Factorised<K> {
    fn clone(&self) -> Self {
        Factorised { system: Arc::clone(&self.system) }
    }
}

/// What solutions share.
#[derive(Clone, Debug)]
pub(super) struct System<K: Operator> {
    pub(super) kernel: K,
    pub(super) grid: Grid<K::Point>,
    pub(super) factor: Factor,
    pub(super) evaluations: u64,
}

impl<K: Kernel + HasDomain + Clone> Factorised<K> {
    pub(super) fn on_grid(kernel: &K, grid: Grid<K::Point>) -> Result<Self, Error> {
        let (factor, evaluations) = match fast::factor(&erased(kernel), &grid)? {
            Some(found) => found,
            None => {
                let (matrix, evaluations) = grid.matrix(kernel)?;
                (Factor::of_rows(matrix, &Layout::of(&grid, super::near::components::<K>()))?, evaluations)
            }
        };
        Ok(Factorised { system: Arc::new(System { kernel: kernel.clone(), grid, factor, evaluations }) })
    }

    /// f for one more source.
    ///
    /// # Errors
    /// [`Error::NonFiniteSource`] with the place; [`Error::NonFiniteSolution`]; [`Error::NotConverged`] with the relative residual of the linear system.
    pub fn solve<G>(&self, source: &G) -> Result<NystromSolution<G, K>, Error>
    where
        G: Source<Point = K::Point> + Clone,
        K::Weight: Weight<Value = G::Value>,
    {
        contained(|| {
            source.validate()?;
            let g = values_at(source, &self.system.grid)?;
            let f = self.system.factor.try_solve(&components_of(&g))?;
            if f.iter().any(|v| !v.is_finite()) {
                return Err(Error::NonFiniteSolution { unknowns: f.len() });
            }
            let values = values_of(&f);
            Ok(NystromSolution::new(source.clone(), Arc::clone(&self.system), values))
        })
    }
}

impl<K: Kernel + HasDomain> Factorised<K> {
    /// (Tφ)(x) at any places, by the rule of the solve and without its matrix: one row of T each.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Nystrom, domain::Interval, source::source_fn};
    /// let domain = Interval::from(0.0..=1.0);
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y: f64| (x - y).abs().ln());
    /// let log = eq.factorise(&Nystrom::graded(2, 16))?;
    /// let image = log.apply(&source_fn(domain, |x: &f64| *x), &[0.0, 1.0])?;        // ∫ y ln|x − y| dy
    /// assert!((image[0] + 0.25).abs() < 1e-14 && (image[1] + 0.75).abs() < 1e-14);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NonFiniteSource`] where φ, [`Error::NonFiniteKernel`] where K is not finite; [`Error::Outside`] for a place outside the domain.
    pub fn apply<S>(&self, phi: &S, places: &[K::Point]) -> Result<Vec<S::Value>, Error>
    where
        S: Source<Point = K::Point>,
        K::Weight: Weight<Value = S::Value>,
    {
        contained(|| {
            let System { kernel, grid, .. } = &*self.system;
            let values = values_at(phi, grid)?;
            let at = |x: &K::Point| match kernel.domain().contains(x) {
                true => apply_row(kernel, grid, &values, x),
                false => Err(Error::Outside { x: format!("{x:?}") }),
            };
            parallel::map(places.len(), |i| at(&places[i])).into_iter().collect()
        })
    }
}

/// A source at the nodes.
fn values_at<S: Source>(source: &S, grid: &Grid<S::Point>) -> Result<Vec<S::Value>, Error> {
    let at = |x: &S::Point| Some(source.eval(x)).filter(Value::all_finite).ok_or_else(|| Error::non_finite_source(x, &source.eval(x)));
    grid.nodes.iter().map(|n| at(&n.point)).collect()
}

impl<K: Operator> System<K> {
    /// (I − T_n)⁻¹ applied to values at the nodes.
    pub(super) fn inverse_of<V: Value>(&self, values: &[V]) -> Vec<V> {
        values_of(&self.factor.solve(&components_of(values)))
    }
}

/// The unknowns of the linear system: values node by node, in each its components.
fn components_of<V: Value>(values: &[V]) -> DVector<f64> {
    DVector::from_iterator(values.len() * V::COMPONENTS, values.iter().flat_map(|v| (0..V::COMPONENTS).map(|a| v.component(a))))
}

fn values_of<V: Value>(unknowns: &DVector<f64>) -> Vec<V> {
    unknowns.as_slice().chunks_exact(V::COMPONENTS).map(|f| V::from_components(|a| f[a])).collect()
}

impl<K: Operator> Factorised<K> {
    /// Size of the linear system.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.system.factor.unknowns()
    }

    /// How the linear system is solved, in words: LU while it is fast, then FFT, low rank or GMRES, as the kernel allows.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Nystrom};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y: f64| 0.5 * f64::exp(-(x - y).abs()));
    /// assert_eq!(eq.factorise(&Nystrom::gauss_legendre(8))?.linear_algebra(), "LU");
    /// let many = eq.factorise(&Nystrom::composite(50_000, 1))?;            // midpoints: K of x − y on uniform nodes
    /// assert!(many.linear_algebra().starts_with("FFT and GMRES"));
    /// let f = many.solve(eq.source())?;
    /// assert!((f.eval(0.5) - 1.625).abs() < 1e-9);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    #[must_use]
    pub fn linear_algebra(&self) -> &str {
        self.system.factor.how()
    }

    /// Estimated reciprocal condition number, 1-norm.
    #[must_use]
    pub fn rcond(&self) -> f64 {
        self.system.factor.rcond()
    }
}

impl<G, K> Equation<G, K>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    /// Assembles and factorises I − T once, for many sources: n² kernel evaluations (a thousand times n more near the diagonal for graded rules) and
    /// n³/3 multiplications.
    ///
    /// # Errors
    /// [`Error::Singular`], [`Error::NonFiniteKernel`] with the place, [`Error::NotIntegrable`], [`Error::Invalid`] for settings that do not fit;
    /// adaptive settings have no fixed rule and are refused.
    pub fn factorise(&self, settings: &Nystrom) -> Result<Factorised<K>, Error> {
        contained(|| {
            self.validate()?;
            let grid = settings.grid(self.kernel().domain())?;
            Factorised::on_grid(self.kernel(), grid)
        })
    }
}
