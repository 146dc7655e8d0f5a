//! Piecewise-linear finite elements.
//!
//! ```text
//! f_h = Σ f_j φ_j,    Σ_j (⟨φ_i, φ_j⟩ − ⟨φ_i, T φ_j⟩) f_j = ⟨φ_i, g⟩            ‖f − f_h‖∞ = O(h²)
//! f̂   = g + T f_h                                                            O(h⁴) for smooth K and f: Sloan 1976
//! ```
//!
//! φ_j are hat functions on a uniform mesh, the mass matrix is exact, T φ_j is integrated towards the diagonal as in [`Nystrom::graded`]. The
//! iterated solution f̂ costs one row of the operator an evaluation and doubles the order: its distance to f_h estimates the error of f_h.
//! Reference: Sloan, *Improvement by iteration for compact operator equations*, Math. Comp. 30 (1976) 758.
//!
//! [`Nystrom::graded`]: super::Nystrom::graded

use super::basis::Basis;
use super::grid::MOST_UNKNOWNS;
use super::linear::Factor;
use super::near::{Target, components};
use super::quadrature::unit_rule;
use crate::domain::Domain;
use crate::equation::{Equation, Everywhere, Method};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::{Value, Weight};
use nalgebra::{DMatrix, DVector};

/// Piecewise-linear Galerkin finite elements on a one-dimensional domain of finite length, times groups.
///
/// ```
/// use fredholm::{Equation, deterministic::Galerkin};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let f = eq.solve(&Galerkin::elements(8))?;
/// assert!((f.eval(0.3) - 1.09).abs() < 1e-14);       // f = 1 + 3x/10 is in the space of hats
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Galerkin {
    elements: usize,
}

impl Galerkin {
    /// `elements` equal elements, `elements` + 1 hats a group.
    pub fn elements(elements: usize) -> Self {
        Galerkin { elements }
    }
}

/// Gauss nodes an element for integrals against test functions.
const OUTER: usize = 6;
/// Gauss nodes a piece for T φ_j.
const INNER: usize = 12;

/// f_h = Σ f_j φ_j.
#[derive(Clone, Debug)]
pub struct GalerkinSolution<G: Source, K: Operator> {
    source: G,
    kernel: K,
    /// over state × hat
    values: Vec<G::Value>,
    elements: usize,
    rcond: f64,
    evaluations: u64,
}

impl<G, K> Method<G, K, Everywhere> for Galerkin
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    type Solution = GalerkinSolution<G, K>;

    fn solve(&self, equation: &Equation<G, K>, _: &Everywhere) -> Result<Self::Solution, Error> {
        equation.validate()?;
        let (kernel, source) = (equation.kernel(), equation.source());
        let domain = kernel.domain();
        domain.validate()?;
        if domain.dimension() != 1 {
            return Err(Error::invalid("dimension", domain.dimension() as f64, "finite elements need a one-dimensional domain"));
        }
        if !domain.volume().is_finite() {
            return Err(Error::InfiniteDomain { operation: "a finite-element solve" });
        }
        if self.elements == 0 {
            return Err(Error::invalid("elements", 0.0, "must be at least 1"));
        }
        let unknowns = (self.elements as f64 + 1.0) * domain.states() as f64 * G::Value::COMPONENTS as f64;
        if unknowns > MOST_UNKNOWNS as f64 {
            return Err(Error::invalid("unknowns", unknowns, "must be at most 16384: a dense system of n unknowns takes 8 n² bytes"));
        }
        self.assemble(source, kernel)
    }
}

impl Galerkin {
    fn assemble<G, K>(&self, source: &G, kernel: &K) -> Result<GalerkinSolution<G, K>, Error>
    where
        G: Source + Clone,
        K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
        K::Weight: Weight<Value = G::Value>,
    {
        let (c, states, n) = (components::<K>(), kernel.domain().states(), self.elements);
        let width = c * states * (n + 1);
        let mut matrix = DMatrix::zeros(width, width);
        let mut load = DVector::zeros(width);
        let mut evaluations = 0;
        let columns = |state: usize, hat: usize, a: usize| (state * (n + 1) + hat) * c + a;
        for (index, element) in parallel::map(states * n, |i| self.element(source, kernel, i / n, i % n)).into_iter().enumerate() {
            let element = element?;
            evaluations += element.evaluations;
            for side in 0..2 {
                for a in 0..c {
                    let row = columns(index / n, index % n + side, a);
                    load[row] += element.load[side * c + a];
                    (0..width).for_each(|j| matrix[(row, j)] -= element.rows[(side * c + a) * width + j]);
                    for other in 0..2 {
                        matrix[(row, columns(index / n, index % n + other, a))] += element.mass[side + other];
                    }
                }
            }
        }
        let factor = Factor::new(matrix)?;
        let f = factor.solve(&load);
        let values = (0..states * (n + 1)).map(|i| G::Value::from_components(|a| f[i * c + a])).collect();
        Ok(GalerkinSolution { source: source.clone(), kernel: kernel.clone(), values, elements: n, rcond: factor.rcond(), evaluations })
    }

    /// Integrals over one element of the two hats that live on it.
    fn element<G, K>(&self, source: &G, kernel: &K, state: usize, index: usize) -> Result<Element, Error>
    where
        G: Source,
        K: Kernel + HasDomain + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
    {
        let (domain, c) = (kernel.domain(), components::<K>());
        let width = c * domain.states() * (self.elements + 1);
        let h = 1.0 / self.elements as f64;
        let mut out = Element { rows: vec![0.0; 2 * c * width], load: vec![0.0; 2 * c], mass: [0.0; 3], evaluations: 0 };
        let mut row = vec![0.0; c * width];
        for n in unit_rule(OUTER) {
            let x = domain.place(state, || (index as f64 + n.point) * h);
            let g = source.eval(&x.point);
            if !g.all_finite() {
                return Err(Error::non_finite_source(&x.point, &g));
            }
            out.evaluations += hat_row(kernel, &x.point, self.elements, &mut row)?;
            let hats = [1.0 - n.point, n.point];
            let w = n.weight * h * x.weight;
            for (side, hat) in hats.into_iter().enumerate() {
                for a in 0..c {
                    out.load[side * c + a] += w * hat * g.component(a);
                    let target = &mut out.rows[(side * c + a) * width..][..width];
                    target.iter_mut().zip(&row[a * width..]).for_each(|(t, r)| *t += w * hat * r);
                }
            }
            out.mass[0] += w * hats[0] * hats[0];
            out.mass[1] += w * hats[0] * hats[1];
            out.mass[2] += w * hats[1] * hats[1];
        }
        Ok(out)
    }
}

struct Element {
    rows: Vec<f64>,
    load: Vec<f64>,
    mass: [f64; 3],
    evaluations: u64,
}

/// (T φ_j)(x) for all hats: `out[a · width + column]`. Returns kernel evaluations.
fn hat_row<K: Kernel + HasDomain>(kernel: &K, x: &K::Point, elements: usize, out: &mut [f64]) -> Result<u64, Error> {
    let (c, states) = (components::<K>(), kernel.domain().states());
    let width = c * states * (elements + 1);
    let (basis, pieces) = (Basis::hats(), Basis::gauss(INNER));
    let target = Target::new(kernel, x);
    let mut block = vec![0.0; 2 * c * c];
    let mut evaluations = 0;
    out.fill(0.0);
    for index in 0..states * elements {
        let (state, element) = (index / elements, index % elements);
        let panel = (element as f64 / elements as f64, (element + 1) as f64 / elements as f64);
        block.fill(0.0);
        evaluations += target.moments(state, panel, &basis, &pieces, &mut block)?;
        for (i, w) in block.iter().enumerate() {
            let (side, e) = (i / (c * c), i % (c * c));
            out[(e / c) * width + (state * (elements + 1) + element + side) * c + e % c] += w;
        }
    }
    Ok(evaluations)
}

impl<G, K> GalerkinSolution<G, K>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    /// f_h(x): the finite-element function; NaN outside the domain.
    pub fn eval(&self, x: K::Point) -> G::Value {
        let domain = self.kernel.domain();
        if !domain.contains(&x) {
            return G::Value::from_components(|_| f64::NAN);
        }
        let s = domain.coordinate(&x, 0) * self.elements as f64;
        let element = (s as usize).min(self.elements - 1);
        let first = domain.state(&x) * (self.elements + 1) + element;
        let u = s - element as f64;
        self.values[first].scale(1.0 - u) + self.values[first + 1].scale(u)
    }

    /// f̂(x) = g(x) + (T f_h)(x), of twice the order.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] and [`Error::NonFiniteSource`] with the place; [`Error::Outside`].
    pub fn iterated(&self, x: K::Point) -> Result<G::Value, Error> {
        if !self.kernel.domain().contains(&x) {
            return Err(Error::Outside { x: format!("{x:?}") });
        }
        let g = self.source.eval(&x);
        if !g.all_finite() {
            return Err(Error::non_finite_source(&x, &g));
        }
        let (c, n) = (G::Value::COMPONENTS, self.values.len());
        let mut row = vec![0.0; c * c * n];
        hat_row(&self.kernel, &x, self.elements, &mut row)?;
        let component = |a: usize| (0..c * n).map(|j| row[a * c * n + j] * self.values[j / c].component(j % c)).sum::<f64>();
        Ok(g + G::Value::from_components(component))
    }

    /// f_h at the nodes of the mesh, state by state.
    pub fn values(&self) -> &[G::Value] {
        &self.values
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
        self.rcond
    }
}
