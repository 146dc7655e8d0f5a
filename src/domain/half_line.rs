//! The half line [a, ∞).

use super::{Domain, Node};
use crate::error::Error;

/// The half line [start, ∞) with Lebesgue measure, covered by the algebraic map x = start + s·t/(1 − t), t ∈ [0, 1).
///
/// The scale `s` is where half of the random points fall; choose it near the length over which f varies.
///
/// ```
/// use fredholm::domain::{Domain, HalfLine};
/// let h = HalfLine::new(0.0).scale(2.0);
/// assert_eq!(h.volume(), f64::INFINITY);
/// assert!((h.density(&0.0) - 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfLine {
    start: f64,
    scale: f64,
}

impl HalfLine {
    /// [start, ∞) with scale 1.
    #[must_use]
    pub fn new(start: f64) -> Self {
        HalfLine { start, scale: 1.0 }
    }

    /// Sets the scale s of the map, in units of x.
    #[must_use]
    pub fn scale(self, scale: f64) -> Self {
        HalfLine { scale, ..self }
    }

    /// The end point a.
    pub fn start(&self) -> f64 {
        self.start
    }
}

impl Domain for HalfLine {
    type Point = f64;

    fn validate(&self) -> Result<(), Error> {
        if !self.start.is_finite() {
            return Err(Error::invalid("half-line start", self.start, "must be finite"));
        }
        if !(self.scale.is_finite() && self.scale > 0.0) {
            return Err(Error::invalid("half-line scale", self.scale, "must be positive and finite"));
        }
        Ok(())
    }

    fn volume(&self) -> f64 {
        f64::INFINITY
    }

    #[inline]
    fn contains(&self, x: &f64) -> bool {
        *x >= self.start && x.is_finite()
    }

    fn dimension(&self) -> usize {
        1
    }

    #[inline]
    fn place(&self, _: usize, mut next: impl FnMut() -> f64) -> Node<f64> {
        let t = next();
        let rest = 1.0 - t;
        Node { point: self.start + self.scale * t / rest, weight: self.scale / (rest * rest) }
    }

    #[inline]
    fn density(&self, x: &f64) -> f64 {
        if !self.contains(x) {
            return 0.0;
        }
        let d = self.scale + (x - self.start);
        self.scale / (d * d)
    }

    fn locate(&self, x: f64) -> Option<f64> {
        self.contains(&x).then(|| self.coordinate(&x, 0))
    }

    #[inline]
    fn coordinate(&self, x: &f64, _: usize) -> f64 {
        let r = x - self.start;
        r / (self.scale + r)
    }

    fn displaced(&self, x: &f64, _: usize, d: f64) -> Node<f64> {
        // 1 − t = s/(s + r): far out t rounds to 1, where x still has all its digits
        let far = self.scale + (x - self.start);
        let rest = self.scale / far - d;
        let y = (x + far * (d / rest)).max(self.start);
        Node { point: y, weight: self.scale / (rest * rest) }
    }

    fn difference(&self, x: &f64, d: f64) -> Option<f64> {
        let far = self.scale + (x - self.start);
        Some(-far * (d / (self.scale / far - d)))
    }

    fn separation(&self, x: &f64, y: &f64) -> f64 {
        let denominator = |x: f64| self.scale + (x - self.start);
        // two quotients: the product of far denominators could overflow
        self.scale / denominator(*x) * ((y - x) / denominator(*y))
    }
}
