//! Functionals ⟨h, f⟩ with the accuracy of f and of its adjoint multiplied.
//!
//! ```text
//! ψ = h + T†ψ,   r = g + T f̃ − f̃:      ⟨h, f⟩ = ⟨h, f̃⟩ + ⟨ψ, r⟩,     so ⟨h, f̃⟩ + ⟨ψ̃, r⟩ errs by ⟨ψ − ψ̃, r⟩ = ⟨ρ, f − f̃⟩,  ρ = h + T†ψ̃ − ψ̃
//! ```
//!
//! Pierce, Giles, *SIAM Review* 42 (2000) 247; Becker, Rannacher, *Acta Numerica* 10 (2001) 1. ψ̃ comes from the factors of the solve, transposed; r, ρ
//! and all integrals from a rule that shares no nodes with it. f̃ and ψ̃ are the polynomials through their values at the nodes: the Nyström interpolant of
//! a kernel with a kink has kinks itself, which no rule would see.

use super::grid::Grid;
use super::solution::NystromSolution;
use crate::contained::contained;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};
use nalgebra::DVector;

/// ⟨h, f⟩ with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Functional<V> {
    /// ⟨h, f̃⟩ + ⟨ψ̃, r⟩.
    pub value: V,
    /// ⟨h, f̃⟩ by the nodes of the solve alone.
    pub uncorrected: V,
    /// Estimated largest |error| of a component of `value`: ‖ρ‖₁ ‖(I − T)⁻¹‖∞ max |r|, what another rule makes of the integrals, and rounding.
    pub error: f64,
}

/// Rounding of sums, in units of ε.
const ROUNDING: f64 = 16.0;

impl<G, K> NystromSolution<G, K>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    /// ⟨h, f⟩ = ∫ h f dμ corrected by the adjoint solution, component by component, with an estimate of its error.
    ///
    /// Costs a transposed solve by the same factors and one assembly by an independent rule.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Nystrom};
    /// // f = 1 + ½ ∫₀¹ e^{−|x − y|} f: ten Gauss nodes leave 10⁻³ in f and in ∫ f, and 10⁻⁶ in the corrected ∫ f
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y: f64| 0.5 * f64::exp(-(x - y).abs()));
    /// let f = eq.solve(&Nystrom::gauss_legendre(10))?;
    /// let integral = f.corrected_functional(|_| 1.0)?;
    /// let exact = 1.0 + 0.5 + 0.125 - 1.0 / 24.0;
    /// assert!((integral.value - exact).abs() < 1e-5 && (integral.uncorrected - exact).abs() > 1e-4);
    /// assert!((integral.value - exact).abs() <= integral.error);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] and [`Error::NonFiniteSource`] with the place; [`Error::NonFiniteSolution`] if h is not finite somewhere.
    pub fn corrected_functional(&self, h: impl Fn(&K::Point) -> f64) -> Result<Functional<G::Value>, Error> {
        contained(|| {
            let c = G::Value::COMPONENTS;
            let domain = self.system().kernel.domain();
            let other = self.system().grid.independent(domain)?;
            let third = other.independent(domain)?;
            let (rows, _) = other.matrix(&self.system().kernel)?;
            let f = self.interpolated(&other, |j, a| self.values()[j].component(a))?;
            let residual = self.residual_on(&other, &rows, &f)?;
            let worst = residual.amax();
            let on = |grid: &Grid<K::Point>, f: &DVector<f64>, a: usize| -> f64 {
                grid.nodes.iter().enumerate().map(|(k, n)| n.weight * h(&n.point) * f[c * k + a]).sum()
            };
            let f_third = self.interpolated(&third, |j, a| self.values()[j].component(a))?;
            let (mut value, mut error) = (vec![0.0; c], 0.0f64);
            for (a, value) in value.iter_mut().enumerate() {
                let psi = self.adjoint_on(&other, &h, a)?;
                let defect = adjoint_defect(&other, &rows, &psi, &h, a);
                let weight = |i: usize| other.nodes[i / c].weight;
                let correction: f64 = (0..psi.len()).map(|i| weight(i) * psi[i] * residual[i]).sum();
                let plain = on(&other, &f, a);
                *value = plain + correction;
                let left = (0..psi.len()).map(|i| weight(i) * defect[i].abs()).sum::<f64>() * self.inverse_norm() * worst;
                let size: f64 = other.nodes.iter().enumerate().map(|(k, n)| n.weight * (h(&n.point) * f[c * k + a]).abs()).sum();
                // the third rule errs as well, by less
                let between = 1.5 * (plain - on(&third, &f_third, a)).abs();
                let here = left + between + ROUNDING * f64::EPSILON * size / self.rcond().min(1.0).sqrt();
                error = if here.is_nan() { f64::NAN } else { error.max(here) };
            }
            if !error.is_finite() || value.iter().any(|v| !v.is_finite()) {
                return Err(Error::NonFiniteSolution { unknowns: self.unknowns() });
            }
            let uncorrected = self.functional(&h);
            Ok(Functional { value: G::Value::from_components(|a| value[a]), uncorrected, error })
        })
    }

    /// Polynomials through values at the nodes, at the nodes of another rule; for composite rules, which have none, the Nyström interpolant of f.
    fn interpolated(&self, other: &Grid<K::Point>, values: impl Fn(usize, usize) -> f64) -> Result<DVector<f64>, Error> {
        let (c, domain) = (G::Value::COMPONENTS, self.system().kernel.domain());
        let mut out = DVector::zeros(c * other.nodes.len());
        for (k, n) in other.nodes.iter().enumerate() {
            match self.system().grid.stencil(domain, &n.point) {
                Some(stencil) => (0..c).for_each(|a| out[c * k + a] = stencil.apply(|j| values(j, a))),
                None => {
                    let f = self.value_at(&n.point)?;
                    (0..c).for_each(|a| out[c * k + a] = f.component(a));
                }
            }
        }
        Ok(out)
    }

    fn residual_on(&self, other: &Grid<K::Point>, rows: &[f64], f: &DVector<f64>) -> Result<DVector<f64>, Error> {
        let (c, width) = (G::Value::COMPONENTS, f.len());
        let mut r = DVector::zeros(width);
        for (k, n) in other.nodes.iter().enumerate() {
            let g = self.source().eval(&n.point);
            if !g.all_finite() {
                return Err(Error::non_finite_source(&n.point, &g));
            }
            for a in 0..c {
                let i = c * k + a;
                r[i] = g.component(a) - f[i] + rows[i * width..(i + 1) * width].iter().zip(f.iter()).map(|(t, f)| t * f).sum::<f64>();
            }
        }
        Ok(r)
    }

    /// ψ = h e_a + T†ψ at the nodes of another rule.
    fn adjoint_on(&self, other: &Grid<K::Point>, h: &impl Fn(&K::Point) -> f64, a: usize) -> Result<DVector<f64>, Error> {
        let (c, nodes) = (G::Value::COMPONENTS, &self.system().grid.nodes);
        let (kernel, domain) = (&self.system().kernel, self.system().kernel.domain());
        let b = DVector::from_fn(c * nodes.len(), |i, _| if i % c == a { nodes[i / c].weight * h(&nodes[i / c].point) } else { 0.0 });
        let psi = self.system().factor.solve_transposed(&b);
        let mut out = DVector::zeros(c * other.nodes.len());
        for (k, n) in other.nodes.iter().enumerate() {
            let stencil = self.system().grid.stencil(domain, &n.point);
            for b in 0..c {
                let through = stencil.as_ref().map(|s| s.apply(|j| psi[c * j + b] / nodes[j].weight));
                out[c * k + b] = through.unwrap_or_else(|| {
                    // the adjoint Nyström interpolant: columns of K
                    let column = |j: usize| {
                        let w = kernel.eval(&nodes[j].point, &n.point);
                        (0..c).map(|d| w.entry(d, b) * psi[c * j + d]).sum::<f64>()
                    };
                    (0..nodes.len()).map(column).sum::<f64>() + if a == b { h(&n.point) } else { 0.0 }
                });
            }
        }
        Ok(out)
    }
}

/// ρ = h e_a + T†ψ̃ − ψ̃, with T† as the transpose of the rule's T in L².
fn adjoint_defect<X: crate::domain::Point>(
    grid: &Grid<X>,
    rows: &[f64],
    psi: &DVector<f64>,
    h: &impl Fn(&X) -> f64,
    a: usize,
) -> DVector<f64> {
    let width = psi.len();
    let c = width / grid.nodes.len();
    let mut image = DVector::<f64>::zeros(width);
    for i in 0..width {
        let scale = grid.nodes[i / c].weight * psi[i];
        image.iter_mut().zip(&rows[i * width..(i + 1) * width]).for_each(|(s, t)| *s += scale * t);
    }
    DVector::from_fn(width, |l, _| {
        let n = &grid.nodes[l / c];
        image[l] / n.weight - psi[l] + if l % c == a { h(&n.point) } else { 0.0 }
    })
}
