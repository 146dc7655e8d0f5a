//! The finite interval [a, b].

use super::{Domain, Node};
use crate::error::Error;
use std::ops::RangeInclusive;

/// Length over |end| at which points of the interval are rounded to some 10⁻⁶ of it: K(x, y) would be that of other points, in every method alike.
const COARSEST: f64 = (1u64 << 20) as f64 * f64::EPSILON;

/// A finite interval [a, b] with Lebesgue measure.
///
/// ```
/// use fredholm::domain::{Domain, Interval};
/// let i = Interval::from(0.0..=2.0);
/// assert_eq!(i.volume(), 2.0);
/// assert!(Interval::from(1.0..=0.0).validate().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lower: f64,
    upper: f64,
    length: f64,
}

impl Interval {
    /// a.
    #[inline]
    pub fn lower(&self) -> f64 {
        self.lower
    }

    /// b.
    #[inline]
    pub fn upper(&self) -> f64 {
        self.upper
    }

    /// b − a.
    #[inline]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// a + t (b − a), kept inside [a, b] against rounding.
    #[inline]
    pub(crate) fn at(&self, t: f64) -> f64 {
        // the sum can round past b by one ulp; b itself is the correctly rounded point then
        let x = self.lower + t * self.length;
        if x > self.upper { self.upper } else { x }
    }
}

impl From<RangeInclusive<f64>> for Interval {
    fn from(range: RangeInclusive<f64>) -> Self {
        let (lower, upper) = range.into_inner();
        Interval { lower, upper, length: upper - lower }
    }
}

impl Domain for Interval {
    type Point = f64;

    fn validate(&self) -> Result<(), Error> {
        if !self.lower.is_finite() {
            return Err(Error::invalid("interval start", self.lower, "must be finite"));
        }
        if !self.upper.is_finite() {
            return Err(Error::invalid("interval end", self.upper, "must be finite"));
        }
        if self.upper <= self.lower {
            return Err(Error::invalid("interval end", self.upper, "must be greater than the start"));
        }
        if !self.length().is_finite() {
            return Err(Error::invalid("interval length", self.length(), "must be finite"));
        }
        if self.length() < COARSEST * self.lower.abs().max(self.upper.abs()) {
            return Err(Error::invalid(
                "interval length",
                self.length(),
                "holds less than 2^20 floating-point numbers so far from 0: move the interval to the origin",
            ));
        }
        Ok(())
    }

    #[inline]
    fn volume(&self) -> f64 {
        self.length()
    }

    #[inline]
    fn contains(&self, x: &f64) -> bool {
        (self.lower..=self.upper).contains(x)
    }

    fn dimension(&self) -> usize {
        1
    }

    #[inline]
    fn place(&self, _: usize, mut next: impl FnMut() -> f64) -> Node<f64> {
        Node { point: self.at(next()), weight: self.length() }
    }

    #[inline]
    fn density(&self, x: &f64) -> f64 {
        if self.contains(x) { 1.0 / self.length() } else { 0.0 }
    }

    fn locate(&self, x: f64) -> Option<f64> {
        self.contains(&x).then(|| self.coordinate(&x, 0))
    }

    #[inline]
    fn coordinate(&self, x: &f64, _: usize) -> f64 {
        (x - self.lower) / self.length()
    }

    fn displaced(&self, x: &f64, _: usize, d: f64) -> Node<f64> {
        Node { point: (x + d * self.length).clamp(self.lower, self.upper), weight: self.length }
    }

    fn separation(&self, x: &f64, y: &f64) -> f64 {
        (y - x) / self.length()
    }

    fn difference(&self, _: &f64, d: f64) -> Option<f64> {
        Some(-d * self.length())
    }

    fn stretch(&self) -> Option<f64> {
        Some(self.length())
    }
}
