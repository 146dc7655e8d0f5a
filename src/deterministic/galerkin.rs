//! The Galerkin method with finite elements.
//!
//! ```text
//! f_h = Σ f_j φ_j,    Σ_j (⟨φ_i, φ_j⟩ − ⟨φ_i, T φ_j⟩) f_j = ⟨φ_i, g⟩          ‖f − f_h‖∞ = O(h^{p+1})
//! f̂   = g + T f_h                                                          ‖f − f̂‖∞ = O(h^{2p+2}) for smooth K and f
//! ```
//!
//! T φ_j is integrated towards the diagonal as in [`Nystrom::graded`]. The iterated solution f̂ costs one row of the operator an evaluation:
//! f − f̂ = T (f − f_h) tests the error of f_h, which is orthogonal to the φ_i but for higher orders, with K(x, ·). So its order is that of f_h plus
//! that to which K(x, ·) can be approximated: p + 1 more for smooth K. With a kink at y = x (a Green's function of order 2) one element can be
//! approximated to h only, over a length h: min(2p + 2, p + 3), but 2p + 2 where x is an end of an element.
//!
//! References: Sloan, *Improvement by iteration for compact operator equations*, Math. Comp. 30 (1976) 758; Chatelin, Lebbar, *The iterated
//! projection solution for the Fredholm integral equation of second kind*, J. Austral. Math. Soc. B 22 (1981) 439; Atkinson, *The Numerical Solution
//! of Integral Equations of the Second Kind* (1997), §3.4.
//!
//! [`Nystrom::graded`]: super::Nystrom::graded

use super::elements::{self, ElementSolution};
use super::mesh::{Mesh, Shape};
use crate::equation::{Equation, Everywhere, Method};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::Weight;

/// Galerkin finite elements on a one-dimensional domain of finite length, times groups.
///
/// Hat functions, continuous and linear on every element, unless a [`degree`](Galerkin::degree) is stated.
///
/// ```
/// use fredholm::{Equation, deterministic::Galerkin};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let f = eq.solve(&Galerkin::elements(8))?;
/// assert!((f.eval(0.3) - 1.09).abs() < 1e-14);       // f = 1 + 3x/10 is in the space of hats
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Galerkin {
    mesh: Mesh,
}

impl Galerkin {
    /// `elements` equal elements with `elements` + 1 hats a group.
    pub fn elements(elements: usize) -> Self {
        Galerkin { mesh: Mesh::new(elements, Shape::Hats) }
    }

    /// Piecewise polynomials of this degree, at most 16, that may jump from element to element: p + 1 unknowns an element and group.
    ///
    /// Equations of the second kind do not need continuous elements. Without continuity the Lagrange functions of the Gauss nodes are orthogonal (the
    /// mass matrix is diagonal), degree 0 exists, f may jump at [`breakpoints`](Galerkin::breakpoints), and the iterated solution has its full order
    /// 2p + 2. Degree 1 thus differs from hats, which have half its unknowns.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Galerkin};
    /// let eq = Equation::on_interval(0.0..=1.0, |x| x.exp() - 0.5 * x, |x, y: f64| 0.5 * x * (-y).exp());      // f = eˣ
    /// let f = eq.solve(&Galerkin::elements(4).degree(4))?;
    /// assert!((f.eval(0.3) - 0.3f64.exp()).abs() < 1e-7);
    /// assert!((f.iterated(0.3)? - 0.3f64.exp()).abs() < 1e-14);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn degree(self, degree: usize) -> Self {
        Galerkin { mesh: Mesh { shape: Shape::Degree(degree), ..self.mesh } }
    }

    /// Places x inside the domain where K or g jump or have a kink whatever y: elements end there, and are shared over the segments between by length,
    /// at least one each. Hats stay continuous; with a stated degree f_h may jump there.
    pub fn breakpoints(self, at: &[f64]) -> Self {
        Galerkin { mesh: Mesh { breakpoints: at.to_vec(), ..self.mesh } }
    }

    /// Grades the mesh to both ends of the domain (and to breakpoints): ends of elements at ½ (2i/n)^q; `exponent` q ≥ 1, 1 is uniform.
    ///
    /// For solutions like d^β or d^β ln d at an end: q ≥ (p + 1)/β keeps the order p + 1.
    pub fn graded(self, exponent: f64) -> Self {
        Galerkin { mesh: Mesh { grading: exponent, ..self.mesh } }
    }
}

impl<G, K> Method<G, K, Everywhere> for Galerkin
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    type Solution = ElementSolution<G, K>;

    fn solve(&self, equation: &Equation<G, K>, _: &Everywhere) -> Result<Self::Solution, Error> {
        elements::solve(equation, &self.mesh, elements::tested)
    }
}
