//! Projection onto piecewise polynomials: one assembly for Galerkin and collocation, and the solution both find.
//!
//! ```text
//! f_h = Σ f_j φ_j,   Σ_q w_q φ_i(x_q) (f_h − T f_h − g)(x_q) = 0   for all i,   each equation divided by Σ_q w_q φ_i(x_q)
//! ```
//!
//! With many Gauss nodes x_q an element these are the Galerkin equations. With the p + 1 nodes that carry the Lagrange basis, φ_i(x_q) = δ_iq,
//! and they are the collocation equations: collocation is Galerkin with the shortest rule for the outer integral.

use super::linear::Factor;
use super::mesh::{Mesh, Space};
use super::near::components;
use super::quadrature::unit_rule;
use crate::contained::contained;
use crate::domain::{Domain, Node};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::{Value, Weight};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Places u just inside the ends of an element, where the error of a projection is largest (its leading term is a multiple of the Legendre polynomial of
/// degree p + 1) and f of one element still is, should it jump.
const ENDS: [f64; 2] = [0.001, 0.999];

/// Gauss nodes an element for integrals against polynomials of that degree.
pub(super) fn tested(degree: usize) -> usize {
    degree + 5
}

/// The solution of a [`Galerkin`](super::Galerkin) or [`Collocation`](super::Collocation) solve: the piecewise polynomial f_h, and its iterate
/// f̂ = g + T f_h.
#[derive(Clone, Debug)]
pub struct ElementSolution<G: Source, K: Operator> {
    source: G,
    kernel: K,
    space: Space,
    values: Vec<G::Value>,
    factor: Arc<Factor>,
    evaluations: u64,
}

/// Estimated largest errors of an [`ElementSolution`], in the units of f.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementErrors {
    /// Of f_h: [`eval`](ElementSolution::eval).
    pub solution: f64,
    /// Of f̂: [`iterated`](ElementSolution::iterated).
    pub iterated: f64,
}

/// Solves with `outer(degree)` Gauss nodes an element for the outer integral.
pub(super) fn solve<G, K>(equation: &Equation<G, K>, mesh: &Mesh, outer: fn(usize) -> usize) -> Result<ElementSolution<G, K>, Error>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    equation.validate()?;
    let (source, kernel, c) = (equation.source(), equation.kernel(), components::<K>());
    let space = mesh.space(kernel.domain(), c)?;
    let rule = unit_rule(outer(space.degree));
    let (width, functions) = (c * space.len(), space.basis.len());
    let mut matrix = DMatrix::zeros(width, width);
    let (mut load, mut masses) = (DVector::zeros(width), vec![0.0; space.len()]);
    let mut evaluations = 0;
    for (index, tests) in parallel::map(space.elements(), |i| Tests::new(source, kernel, &space, &rule, i)).into_iter().enumerate() {
        let (tests, first) = (tests?, space.first(index));
        evaluations += tests.evaluations;
        for k in 0..functions {
            masses[first + k] += tests.mass[k * functions..][..functions].iter().sum::<f64>();
            for a in 0..c {
                let (row, local) = ((first + k) * c + a, k * c + a);
                load[row] += tests.load[local];
                (0..width).for_each(|j| matrix[(row, j)] -= tests.rows[local * width + j]);
                (0..functions).for_each(|l| matrix[(row, (first + l) * c + a)] += tests.mass[k * functions + l]);
            }
        }
    }
    // elements of any length count alike: Lagrange functions sum to 1, so this makes f_i's row of the mass matrix sum to 1
    let scale = DVector::from_fn(width, |row, _| 1.0 / masses[row / c]);
    matrix.column_iter_mut().for_each(|mut column| column.component_mul_assign(&scale));
    load.component_mul_assign(&scale);
    let factor = Factor::new(matrix)?;
    let f = factor.solve(&load);
    let values = (0..space.len()).map(|i| G::Value::from_components(|a| f[i * c + a])).collect();
    Ok(ElementSolution { source: source.clone(), kernel: kernel.clone(), space, values, factor: Arc::new(factor), evaluations })
}

/// Integrals over one element against the functions φ_k that live on it.
struct Tests {
    /// ⟨φ_k, T φ_j⟩: `[(k c + a) width + (j c + b)]`
    rows: Vec<f64>,
    /// ⟨φ_k, g⟩: `[k c + a]`
    load: Vec<f64>,
    /// ⟨φ_k, φ_l⟩
    mass: Vec<f64>,
    evaluations: u64,
}

impl Tests {
    fn new<G, K>(source: &G, kernel: &K, space: &Space, rule: &[Node<f64>], element: usize) -> Result<Self, Error>
    where
        G: Source,
        K: Kernel + HasDomain + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
    {
        let (c, functions) = (components::<K>(), space.basis.len());
        let width = c * space.len();
        let mut out = Tests {
            rows: vec![0.0; functions * c * width],
            load: vec![0.0; functions * c],
            mass: vec![0.0; functions * functions],
            evaluations: 0,
        };
        let (mut row, mut values) = (vec![0.0; c * width], vec![0.0; functions]);
        for n in rule {
            let x = space.place(kernel.domain(), element, n.point);
            let g = finite(source, &x.point)?;
            out.evaluations += space.row(kernel, &x.point, &mut row)?;
            space.basis.values(n.point, &mut values);
            for (k, value) in values.iter().enumerate() {
                let w = n.weight * x.weight * value;
                (0..c).for_each(|a| out.load[k * c + a] += w * g.component(a));
                out.rows[k * c * width..][..c * width].iter_mut().zip(&row).for_each(|(t, r)| *t += w * r);
                out.mass[k * functions..].iter_mut().zip(&values).for_each(|(m, v)| *m += w * v);
            }
        }
        Ok(out)
    }
}

/// g(x), if it is a number.
fn finite<G: Source>(source: &G, x: &G::Point) -> Result<G::Value, Error> {
    let g = source.eval(x);
    if g.all_finite() { Ok(g) } else { Err(Error::non_finite_source(x, &g)) }
}

/// `f(0), …, f(count − 1)` on all cores, or the first error.
fn collect<V: Send>(count: usize, f: impl Fn(usize) -> Result<V, Error> + Send + Sync) -> Result<Vec<V>, Error> {
    parallel::map(count, f).into_iter().collect()
}

impl<G, K> ElementSolution<G, K>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    /// f_h(x): the piecewise polynomial, continued from the right where two elements meet; NaN outside the domain.
    pub fn eval(&self, x: K::Point) -> G::Value {
        if !self.kernel.domain().contains(&x) {
            return G::Value::from_components(|_| f64::NAN);
        }
        let (element, u) = self.space.locate(self.kernel.domain(), &x);
        self.inside(element, u)
    }

    /// f_h at u ∈ [0, 1] of an element.
    fn inside(&self, element: usize, u: f64) -> G::Value {
        self.space.value(&self.values, element, u)
    }

    /// f̂(x) = g(x) + (T f_h)(x), of twice the order for smooth kernels. Costs one row of the operator.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] and [`Error::NonFiniteSource`] with the place; [`Error::Outside`].
    pub fn iterated(&self, x: K::Point) -> Result<G::Value, Error> {
        contained(|| {
            if !self.kernel.domain().contains(&x) {
                return Err(Error::Outside { x: format!("{x:?}") });
            }
            let g = finite(&self.source, &x)?;
            Ok(g + self.space.apply(&self.kernel, &x, &self.values)?)
        })
    }

    /// Estimated largest |f − f_h| and |f − f̂| over the domain and all components.
    ///
    /// ```text
    /// f − f_h = r + e,    r = f̂ − f_h,    f − f̂ = e = (I − T)⁻¹ T r = T (r + e)
    /// ```
    ///
    /// r, the residual of f_h, is evaluated at p + 3 Gauss nodes and at the ends of every element; e at the nodes of f_h, with (I − T)⁻¹ that of the
    /// solve, and from there at the ends, where singular kernels leave most of it. Between those |f − f̂| may be larger: up to 5 times
    /// for kinks and degree 5, twice for degree 2. Costs 2p + 8 rows of the operator an element.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Galerkin};
    /// let eq = Equation::on_interval(0.0..=1.0, |x| x.exp() - 0.5 * x, |x, y: f64| 0.5 * x * (-y).exp());      // f = eˣ
    /// let f = eq.solve(&Galerkin::elements(8).degree(2))?;
    /// let estimate = f.error_estimate()?;
    /// let error = (f.eval(1.0) - 1f64.exp()).abs();
    /// assert!(error < 1.1 * estimate.solution && estimate.solution < 1e-4);
    /// let error = (f.iterated(1.0)? - 1f64.exp()).abs();
    /// assert!(error < 1.1 * estimate.iterated && estimate.iterated < 1e-9);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`iterated`](ElementSolution::iterated).
    pub fn error_estimate(&self) -> Result<ElementErrors, Error> {
        contained(|| {
            let finer = self.space.finer();
            let (gauss, domain) = (finer.basis.rule(), self.kernel.domain());
            let residual =
                |element: usize, u: f64| Ok(self.iterated(self.space.place(domain, element, u).point)? - self.inside(element, u));
            let within = collect(gauss.len() * self.space.elements(), |i| residual(i / gauss.len(), gauss[i % gauss.len()].point))?;
            let at_ends = collect(2 * self.space.elements(), |i| residual(i / 2, ENDS[i % 2]))?;
            let nodes: Vec<_> = self.nodes().collect();
            let again = collect(nodes.len(), |i| finer.apply(&self.kernel, &nodes[i], &within))?;
            let c = G::Value::COMPONENTS;
            let e = self.factor.solve(&DVector::from_fn(self.unknowns(), |i, _| again[i / c].component(i % c)));
            let e: Vec<_> = (0..nodes.len()).map(|i| G::Value::from_components(|a| e[i * c + a])).collect();
            let errors = within.iter().enumerate().map(|(i, r)| *r + self.space.value(&e, i / gauss.len(), gauss[i % gauss.len()].point));
            let errors: Vec<_> = errors.collect();
            let at_ends_too = collect(2 * self.space.elements(), |i| {
                finer.apply(&self.kernel, &self.space.place(domain, i / 2, ENDS[i % 2]).point, &errors)
            })?;
            let largest = |values: &[G::Value]| values.iter().map(Value::magnitude).fold(0.0, f64::max);
            let iterated = largest(&e).max(largest(&at_ends_too));
            Ok(ElementErrors { solution: largest(&within).max(largest(&at_ends)) + iterated, iterated })
        })
    }

    /// ⟨h, f_h⟩ = ∫ h(y) f_h(y) dμ(y) by p + 5 Gauss nodes an element; for smooth h and K of the order of f̂.
    pub fn functional(&self, h: impl Fn(&K::Point) -> f64) -> G::Value {
        let rule = unit_rule(tested(self.space.degree));
        let mut sum = G::Value::ZERO;
        for element in 0..self.space.elements() {
            for n in &rule {
                let x = self.space.place(self.kernel.domain(), element, n.point);
                sum += self.inside(element, n.point).scale(n.weight * x.weight * h(&x.point));
            }
        }
        sum
    }

    /// The places of [`values`](ElementSolution::values), state by state: ends of elements for hats, else p + 1 Gauss nodes an element.
    pub fn nodes(&self) -> impl Iterator<Item = K::Point> + '_ {
        let last = self.space.elements() - 1;
        (0..=last).flat_map(move |element| {
            // a function shared with the next element belongs to that
            let shared = if element == last { self.space.len() } else { self.space.first(element + 1) };
            let own = &self.space.basis.rule()[..shared - self.space.first(element)];
            own.iter().map(move |n| self.space.place(self.kernel.domain(), element, n.point).point)
        })
    }

    /// f_h at the [`nodes`](ElementSolution::nodes).
    pub fn values(&self) -> &[G::Value] {
        &self.values
    }

    /// max |f_h| over the nodes and components.
    #[must_use]
    pub fn magnitude(&self) -> f64 {
        self.values.iter().map(Value::magnitude).fold(0.0, f64::max)
    }

    /// Size of the linear system.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.values.len() * G::Value::COMPONENTS
    }

    /// Kernel evaluations of the assembly.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Estimated reciprocal condition number of the system, 1-norm.
    #[must_use]
    pub fn rcond(&self) -> f64 {
        self.factor.rcond()
    }
}
