//! Boxes in D dimensions.

use super::{Domain, Interval, Node};
use crate::error::Error;

/// The box [a₁, b₁] × … × [a_D, b_D] with Lebesgue measure.
///
/// ```
/// use fredholm::domain::{Cuboid, Domain};
/// let square = Cuboid::from([0.0..=1.0, -1.0..=1.0]);
/// assert_eq!(square.volume(), 2.0);
/// assert_eq!(square.rule(1, 4).len(), 16);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid<const D: usize> {
    sides: [Interval; D],
}

impl<const D: usize> Cuboid<D> {
    /// The unit cube [0, 1]^D.
    #[must_use]
    pub fn unit() -> Self {
        Cuboid { sides: std::array::from_fn(|_| Interval::from(0.0..=1.0)) }
    }

    /// The sides.
    pub fn sides(&self) -> &[Interval; D] {
        &self.sides
    }
}

impl<const D: usize> From<[std::ops::RangeInclusive<f64>; D]> for Cuboid<D> {
    fn from(ranges: [std::ops::RangeInclusive<f64>; D]) -> Self {
        Cuboid { sides: ranges.map(Interval::from) }
    }
}

impl<const D: usize> Domain for Cuboid<D> {
    type Point = [f64; D];

    fn validate(&self) -> Result<(), Error> {
        if D == 0 {
            return Err(Error::invalid("dimension", 0.0, "must be at least 1"));
        }
        self.sides.iter().try_for_each(Interval::validate)
    }

    #[inline]
    fn volume(&self) -> f64 {
        self.sides.iter().map(Interval::length).product()
    }

    fn contains(&self, x: &[f64; D]) -> bool {
        self.sides.iter().zip(x).all(|(s, x)| s.contains(x))
    }

    fn dimension(&self) -> usize {
        D
    }

    #[inline]
    fn place(&self, _: usize, mut next: impl FnMut() -> f64) -> Node<[f64; D]> {
        Node { point: std::array::from_fn(|i| self.sides[i].at(next())), weight: self.volume() }
    }

    fn density(&self, x: &[f64; D]) -> f64 {
        if self.contains(x) { 1.0 / self.volume() } else { 0.0 }
    }

    fn coordinate(&self, x: &[f64; D], axis: usize) -> f64 {
        self.sides[axis].coordinate(&x[axis], 0)
    }
}
