//! Piecewise polynomial collocation at Gauss points.
//!
//! ```text
//! f_h(x_i) − (T f_h)(x_i) = g(x_i)    at p + 1 Gauss points of every element       ‖f − f_h‖∞ = O(h^{p+1})
//! f̂ = g + T f_h,    f̂(x_i) = f_h(x_i)                                             ‖f − f̂‖∞ = O(h^{2p+2}) for smooth K and f
//! ```
//!
//! The interpolation error at Gauss points is orthogonal to polynomials of degree p but for higher orders, so that all that is said of the iterated
//! solution of [`Galerkin`] holds here, also the orders with a kink at y = x: min(2p + 2, p + 3), and 2p + 2 at the ends of elements, where this is
//! collocation of a boundary-value problem (de Boor, Swartz, *SIAM J. Numer. Anal.* 10 (1973) 582). It takes p + 1 rows of the operator an element
//! where Galerkin takes p + 5. For smooth K this is almost the Nyström method of the same nodes; T f_h is integrated towards the diagonal, so that
//! the order stays where Nyström's is lost.
//!
//! References: Sloan, Noussair, Burn, *Projection methods for equations of the second kind*, J. Math. Anal. Appl. 69 (1979) 84; Atkinson, *The
//! Numerical Solution of Integral Equations of the Second Kind* (1997), §3.4.
//!
//! [`Galerkin`]: super::Galerkin

use super::elements::{self, ElementSolution};
use super::mesh::{Mesh, Shape};
use crate::equation::{Equation, Everywhere, Method};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::Weight;

/// Piecewise polynomial collocation on a one-dimensional domain of finite length, times groups.
///
/// ```
/// use fredholm::{Equation, deterministic::Collocation};
/// let eq = Equation::on_interval(0.0..=1.0, |x| x.exp() - 0.5 * x, |x, y: f64| 0.5 * x * (-y).exp());      // f = eˣ
/// let f = eq.solve(&Collocation::elements(4).degree(4))?;
/// assert!((f.eval(0.3) - 0.3f64.exp()).abs() < 1e-7);
/// assert!((f.iterated(0.3)? - 0.3f64.exp()).abs() < 1e-14);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Collocation {
    mesh: Mesh,
}

impl Collocation {
    /// `elements` equal elements, of degree 1 unless another is stated.
    pub fn elements(elements: usize) -> Self {
        Collocation { mesh: Mesh::new(elements, Shape::Degree(1)) }
    }

    /// Polynomials of this degree, at most 16, free to jump from element to element: p + 1 unknowns an element and group.
    pub fn degree(self, degree: usize) -> Self {
        Collocation { mesh: Mesh { shape: Shape::Degree(degree), ..self.mesh } }
    }

    /// Places x inside the domain where K, g or f jump or have a kink whatever y: elements end there, and are shared over the segments between by
    /// length, at least one each.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Collocation};
    /// let eq = Equation::on_interval(0.0..=1.0, |x| if x < 0.3 { 0.0 } else { 1.0 }, |_, _| 0.5);     // f = g + 0.7
    /// let f = eq.solve(&Collocation::elements(2).degree(0).breakpoints(&[0.3]))?;
    /// assert!((f.eval(0.2) - 0.7).abs() < 1e-14 && (f.eval(0.3) - 1.7).abs() < 1e-14);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn breakpoints(self, at: &[f64]) -> Self {
        Collocation { mesh: Mesh { breakpoints: at.to_vec(), ..self.mesh } }
    }

    /// Grades the mesh to both ends of the domain (and to breakpoints): ends of elements at ½ (2i/n)^q; `exponent` q ≥ 1, 1 is uniform.
    ///
    /// For solutions like d^β or d^β ln d at an end: q ≥ (p + 1)/β keeps the order p + 1.
    pub fn graded(self, exponent: f64) -> Self {
        Collocation { mesh: Mesh { grading: exponent, ..self.mesh } }
    }
}

impl<G, K> Method<G, K, Everywhere> for Collocation
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    type Solution = ElementSolution<G, K>;

    fn solve(&self, equation: &Equation<G, K>, _: &Everywhere) -> Result<Self::Solution, Error> {
        elements::solve(equation, &self.mesh, |degree| degree + 1)
    }
}
