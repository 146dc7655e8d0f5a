//! Meshes of a one-dimensional domain, and the piecewise polynomials on them.
//!
//! ```text
//! t_i = ½ (2i/n)^q,   1 − t_i = ½ (2 − 2i/n)^q        beyond the middle: q = 1 uniform, q > 1 graded to both ends of a segment
//! ```
//!
//! A solution f ~ d^β at an end has the full order h^{p+1} of degree p on meshes with q ≥ (p + 1)/β: Rice, *J. Approx. Theory* 2 (1969) 329;
//! for weakly singular kernels: Vainikko, Uba, *J. Austral. Math. Soc. B* 22 (1981) 431.

use super::basis::Basis;
use super::erased::erased;
use super::grid::check_size;
use super::near::{Target, components};
use super::nystrom::segments_at;
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::value::{Value, Weight};

/// Highest degree of an element.
const MOST_DEGREE: usize = 16;
/// Shortest element, as a share of the domain.
const SHORTEST: f64 = 1.0 / (1u64 << 40) as f64;

/// Polynomials of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// Degree 1, continuous.
    Hats,
    /// Any polynomial of that degree, free to jump from element to element.
    Degree(usize),
}

/// What Galerkin and collocation settings have in common.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mesh {
    pub(super) elements: usize,
    pub(super) shape: Shape,
    pub(super) breakpoints: Vec<f64>,
    pub(super) grading: f64,
}

impl Mesh {
    pub(super) fn new(elements: usize, shape: Shape) -> Self {
        Mesh { elements, shape, breakpoints: Vec::new(), grading: 1.0 }
    }

    /// The space of piecewise polynomials on a domain, for values of `components` real numbers.
    pub(super) fn space<D: Domain>(&self, domain: &D, components: usize) -> Result<Space, Error> {
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
        if !(self.grading >= 1.0 && self.grading.is_finite()) {
            return Err(Error::invalid("grading", self.grading, "must be finite and at least 1, a uniform mesh"));
        }
        let (degree, basis, step) = match self.shape {
            Shape::Degree(degree) if degree > MOST_DEGREE => {
                return Err(Error::invalid("degree", degree as f64, "must be at most 16"));
            }
            Shape::Degree(degree) => (degree, Basis::gauss(degree + 1), degree + 1),
            Shape::Hats => (1, Basis::hats(), 1),
        };
        let unknowns = |elements: f64| (elements * step as f64 + (basis.len() - step) as f64) * (domain.states() * components) as f64;
        check_size(unknowns(self.elements as f64))?;
        let breaks = self.breaks(domain)?;
        check_size(unknowns((breaks.len() - 1) as f64))?;
        // K ℓ_k is integrated beyond the order of the iterated solution
        Ok(Space { breaks, basis, step, states: domain.states(), degree, pieces: Basis::gauss((degree + 8).max(16)) })
    }

    /// Ends of the elements as coordinates of the map: the elements are shared over the segments by length, at least one each.
    fn breaks<D: Domain>(&self, domain: &D) -> Result<Vec<f64>, Error> {
        let segments = segments_at(domain, &self.breakpoints)?;
        let mut breaks = vec![0.0];
        for ends in segments.windows(2) {
            let (a, length) = (ends[0], ends[1] - ends[0]);
            let count = ((self.elements as f64 * length).round() as usize).max(1);
            breaks.extend((1..count).map(|i| a + length * graded(i as f64 / count as f64, self.grading)));
            breaks.push(ends[1]);
        }
        let shortest = breaks.windows(2).map(|e| e[1] - e[0]).fold(1.0, f64::min);
        if shortest < SHORTEST {
            let requirement = "must be at least 2^-40 of the domain: lower the grading, take fewer elements, or move breakpoints apart";
            return Err(Error::invalid("shortest element", shortest, requirement));
        }
        Ok(breaks)
    }
}

/// [0, 1] onto itself, graded to both ends with exponent q.
fn graded(t: f64, q: f64) -> f64 {
    if t <= 0.5 { 0.5 * (2.0 * t).powf(q) } else { 1.0 - 0.5 * (2.0 - 2.0 * t).powf(q) }
}

/// Piecewise polynomials on a mesh, state by state, element by element.
#[derive(Clone, Debug)]
pub(super) struct Space {
    breaks: Vec<f64>,
    pub(super) basis: Basis,
    /// functions from one element to the next; fewer than an element has where it shares some with the next
    step: usize,
    states: usize,
    pub(super) degree: usize,
    /// rule for a piece of a panel
    pieces: Basis,
}

impl Space {
    /// Elements of all states.
    pub(super) fn elements(&self) -> usize {
        self.states * self.per_state()
    }

    fn per_state(&self) -> usize {
        self.breaks.len() - 1
    }

    /// Functions of all states.
    pub(super) fn len(&self) -> usize {
        self.states * self.functions()
    }

    /// Functions of one state.
    fn functions(&self) -> usize {
        self.per_state() * self.step + self.basis.len() - self.step
    }

    /// Number of the first function that lives on an element.
    pub(super) fn first(&self, element: usize) -> usize {
        element / self.per_state() * self.functions() + element % self.per_state() * self.step
    }

    /// State and ends of an element.
    pub(super) fn ends(&self, element: usize) -> (usize, (f64, f64)) {
        let i = element % self.per_state();
        (element / self.per_state(), (self.breaks[i], self.breaks[i + 1]))
    }

    /// The point at u ∈ [0, 1] of an element, with |dμ/du|.
    pub(super) fn place<D: Domain>(&self, domain: &D, element: usize, u: f64) -> Node<D::Point> {
        let (state, (a, b)) = self.ends(element);
        let placed = domain.place(state, || a + (b - a) * u);
        Node { point: placed.point, weight: placed.weight * (b - a) }
    }

    /// The element of a point, the right one of two, and its place u there.
    pub(super) fn locate<D: Domain>(&self, domain: &D, x: &D::Point) -> (usize, f64) {
        let t = domain.coordinate(x, 0);
        let i = self.breaks.partition_point(|b| *b <= t).clamp(1, self.per_state()) - 1;
        let (a, b) = (self.breaks[i], self.breaks[i + 1]);
        (domain.state(x) * self.per_state() + i, (t - a) / (b - a))
    }

    /// Σ_j φ_j f_j at u ∈ [0, 1] of an element.
    pub(super) fn value<V: Value>(&self, values: &[V], element: usize, u: f64) -> V {
        let mut functions = [0.0; MOST_DEGREE + 1];
        let functions = &mut functions[..self.basis.len()];
        self.basis.values(u, functions);
        let mut sum = V::ZERO;
        values[self.first(element)..].iter().zip(functions).for_each(|(f, v)| sum += f.scale(*v));
        sum
    }

    /// Polynomials of two degrees more on the same elements, free to jump.
    pub(super) fn finer(&self) -> Space {
        let degree = self.degree + 2;
        Space { basis: Basis::gauss(degree + 1), step: degree + 1, degree, ..self.clone() }
    }

    /// Σ_j (T φ_j)(x) f_j.
    pub(super) fn apply<K, V>(&self, kernel: &K, x: &K::Point, values: &[V]) -> Result<V, Error>
    where
        K: Kernel + HasDomain,
        K::Weight: Weight<Value = V>,
        V: Value,
    {
        let (c, width) = (V::COMPONENTS, V::COMPONENTS * values.len());
        let mut row = vec![0.0; c * width];
        self.row(kernel, x, &mut row)?;
        let component = |a: usize| (0..width).map(|j| row[a * width + j] * values[j / c].component(j % c)).sum::<f64>();
        Ok(V::from_components(component))
    }

    /// (T φ_j)(x) for all functions: `out[(a n + j) c + b]` for components a, b and n functions. Returns kernel evaluations.
    pub(super) fn row<K: Kernel + HasDomain>(&self, kernel: &K, x: &K::Point, out: &mut [f64]) -> Result<u64, Error> {
        let (c, n) = (components::<K>(), self.len());
        let kernel_by_values = erased(kernel);
        let target = Target::new(&kernel_by_values, x);
        let mut block = vec![0.0; self.basis.len() * c * c];
        let mut evaluations = 0;
        out.fill(0.0);
        for element in 0..self.elements() {
            let (state, ends) = self.ends(element);
            block.fill(0.0);
            evaluations += target.moments(state, ends, &self.basis, &self.pieces, &mut block)?;
            let first = self.first(element);
            for (i, w) in block.iter().enumerate() {
                let (k, e) = (i / (c * c), i % (c * c));
                out[((e / c) * n + first + k) * c + e % c] += w;
            }
        }
        Ok(evaluations)
    }
}

#[cfg(test)]
mod tests {
    use super::{Mesh, Shape, graded};
    use crate::domain::{Domain, Grouped, Interval};

    #[test]
    fn meshes_meet_breakpoints_and_ends() {
        let mut mesh = Mesh::new(8, Shape::Degree(2));
        let domain = Interval::from(0.0..=4.0);
        assert_eq!(mesh.space(&domain, 1).unwrap().breaks, (0..=8).map(|i| f64::from(i) / 8.0).collect::<Vec<_>>());
        mesh.breakpoints = vec![1.0, 3.96, 1.0];
        mesh.grading = 2.0;
        // 2, 6 and at least 1 elements
        let known = [0.0, 0.125, 0.25, 0.25 + 0.74 / 18.0, 0.25 + 0.74 * 2.0 / 9.0, 0.62];
        let space = mesh.space(&domain, 1).unwrap();
        assert!(space.breaks.len() == 10 && known.iter().zip(&space.breaks).all(|(k, b)| (k - b).abs() < 1e-15), "{:?}", space.breaks);
        assert_eq!(space.breaks[8..], [0.99, 1.0]);
        for q in [1.0, 1.5, 4.0] {
            assert!((0..=10).all(|i| (graded(0.1 * f64::from(i), q) + graded(1.0 - 0.1 * f64::from(i), q) - 1.0).abs() < 1e-15));
        }
    }

    #[test]
    fn functions_are_numbered_state_by_state() {
        let domain = Grouped::new(Interval::from(0.0..=1.0), 2);
        for (shape, functions, firsts) in
            [(Shape::Hats, 4, [0, 1, 2, 4, 5, 6]), (Shape::Degree(0), 3, [0, 1, 2, 3, 4, 5]), (Shape::Degree(2), 9, [0, 3, 6, 9, 12, 15])]
        {
            let space = Mesh::new(3, shape).space(&domain, 1).unwrap();
            assert_eq!((space.len(), space.elements()), (2 * functions, 6));
            assert!((0..6).all(|e| space.first(e) == firsts[e]));
            for e in 0..6 {
                let x = space.place(&domain, e, 0.25);
                let (element, u) = space.locate(&domain, &x.point);
                assert!(element == e && (u - 0.25).abs() < 1e-14 && (x.weight - 1.0 / 3.0).abs() < 1e-15);
            }
            // an end belongs to the right element, the last one to the last
            assert_eq!(space.locate(&domain, &domain.place(1, || 1.0).point), (5, 1.0));
            assert_eq!(space.locate(&domain, &domain.place(0, || 0.0).point), (0, 0.0));
        }
    }
}
