//! Ω × {0, …, G−1}: a system of equations as one scalar equation.

use super::{Domain, Node};
use crate::error::Error;

/// A domain times `groups` discrete states, with measure μ × counting.
///
/// The system f_i = g_i + Σ_j ∫ K_ij f_j is the scalar equation on points (x, i) with kernel K((x, i), (y, j)) = K_ij(x, y): walks change the
/// group like a coordinate, and weights stay scalar.
///
/// ```
/// use fredholm::domain::{Domain, Grouped, Interval};
/// let d = Grouped::new(Interval::from(0.0..=2.0), 3);
/// assert_eq!(d.volume(), 6.0);
/// assert!(d.contains(&(1.0, 2)) && !d.contains(&(1.0, 3)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grouped<D> {
    domain: D,
    groups: usize,
}

impl<D: Domain> Grouped<D> {
    /// `groups` copies of `domain`.
    #[must_use]
    pub fn new(domain: D, groups: usize) -> Self {
        Grouped { domain, groups }
    }

    /// The continuous part.
    pub fn inner(&self) -> &D {
        &self.domain
    }

    /// Number of groups.
    pub fn groups(&self) -> usize {
        self.groups
    }
}

impl<D: Domain> Domain for Grouped<D> {
    type Point = (D::Point, usize);

    fn validate(&self) -> Result<(), Error> {
        if self.groups == 0 {
            return Err(Error::invalid("groups", 0.0, "must be at least 1"));
        }
        self.domain.validate()
    }

    fn volume(&self) -> f64 {
        self.domain.volume() * self.groups as f64
    }

    fn contains(&self, x: &Self::Point) -> bool {
        x.1 < self.groups && self.domain.contains(&x.0)
    }

    fn dimension(&self) -> usize {
        self.domain.dimension()
    }

    fn states(&self) -> usize {
        self.groups
    }

    fn is_periodic(&self, axis: usize) -> bool {
        self.domain.is_periodic(axis)
    }

    #[inline]
    fn place(&self, state: usize, next: impl FnMut() -> f64) -> Node<Self::Point> {
        let n = self.domain.place(0, next);
        Node { point: (n.point, state), weight: n.weight }
    }

    #[inline]
    fn density(&self, x: &Self::Point) -> f64 {
        if x.1 < self.groups { self.domain.density(&x.0) / self.groups as f64 } else { 0.0 }
    }

    fn locate(&self, x: f64) -> Option<f64> {
        self.domain.locate(x)
    }

    fn coordinate(&self, x: &Self::Point, axis: usize) -> f64 {
        self.domain.coordinate(&x.0, axis)
    }

    fn displaced(&self, x: &Self::Point, state: usize, d: f64) -> Node<Self::Point> {
        let n = self.domain.displaced(&x.0, 0, d);
        Node { point: (n.point, state), weight: n.weight }
    }

    fn separation(&self, x: &Self::Point, y: &Self::Point) -> f64 {
        self.domain.separation(&x.0, &y.0)
    }

    fn state(&self, x: &Self::Point) -> usize {
        x.1
    }
}
