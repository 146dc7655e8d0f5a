//! The half line [a, ∞).

use super::line::{Map, fit};
use super::{Domain, Node};
use crate::error::Error;

/// The half line [start, ∞) with Lebesgue measure, covered by the algebraic map x = start + s·t/(1 − t), t ∈ [0, 1), or the exponential one,
/// x = start − s ln(1 − t), which ends at x ≈ 37 s.
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
    map: Map,
}

impl HalfLine {
    /// [start, ∞) with scale 1.
    #[must_use]
    pub fn new(start: f64) -> Self {
        HalfLine { start, scale: 1.0, map: Map::Algebraic }
    }

    /// Sets the scale s of the map, in units of x.
    #[must_use]
    pub fn scale(self, scale: f64) -> Self {
        HalfLine { scale, ..self }
    }

    /// The exponential map, for functions that fall as e^{−x/s} or faster.
    #[must_use]
    pub fn exponential(self) -> Self {
        HalfLine { map: Map::Exponential, ..self }
    }

    /// The map for functions that decay as `phi` does: g, K(x, ·) for some x, or the larger of them.
    ///
    /// ```
    /// use fredholm::domain::{Domain, HalfLine};
    /// let fast = HalfLine::fitted(0.0, |x| (-5.0 * x).exp());
    /// assert_eq!(fast, fast.exponential());
    /// assert!((fast.density(&0.0) / 5.0 - 1.0).abs() < 0.2);                    // s ≈ 1/5
    /// ```
    #[must_use]
    pub fn fitted(start: f64, phi: impl Fn(f64) -> f64) -> Self {
        let (map, scale) = fit(|r| phi(start + r).abs());
        HalfLine { start, scale, map }
    }

    /// 1 − t: far out t rounds to 1, where x still has all its digits.
    #[inline]
    fn rest(&self, x: f64) -> f64 {
        let r = x - self.start;
        match self.map {
            Map::Algebraic => self.scale / (self.scale + r),
            Map::Exponential => (-r / self.scale).exp(),
        }
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
        match self.map {
            Map::Algebraic => Node { point: self.start + self.scale * t / rest, weight: self.scale / (rest * rest) },
            Map::Exponential => Node { point: self.start - self.scale * (-t).ln_1p(), weight: self.scale / rest },
        }
    }

    #[inline]
    fn density(&self, x: &f64) -> f64 {
        if !self.contains(x) {
            return 0.0;
        }
        match self.map {
            Map::Algebraic => {
                let d = self.scale + (x - self.start);
                self.scale / (d * d)
            }
            Map::Exponential => self.rest(*x) / self.scale,
        }
    }

    fn locate(&self, x: f64) -> Option<f64> {
        self.contains(&x).then(|| self.coordinate(&x, 0))
    }

    #[inline]
    fn coordinate(&self, x: &f64, _: usize) -> f64 {
        let r = x - self.start;
        match self.map {
            Map::Algebraic => r / (self.scale + r),
            Map::Exponential => -(-r / self.scale).exp_m1(),
        }
    }

    fn displaced(&self, x: &f64, _: usize, d: f64) -> Node<f64> {
        let here = self.rest(*x);
        let rest = here - d;
        // a short way is added to x, which may be far out; a long one starts from the end
        let short = d.abs() < 0.5 * here;
        let (y, weight) = match self.map {
            Map::Algebraic => {
                let far = self.scale + (x - self.start);
                let y = if short { x + far * (d / rest) } else { self.start + self.scale * ((1.0 - rest) / rest) };
                (y, self.scale / (rest * rest))
            }
            Map::Exponential => {
                let y = if short { x - self.scale * (-d / here).ln_1p() } else { self.start - self.scale * rest.ln() };
                (y, self.scale / rest)
            }
        };
        Node { point: y.max(self.start), weight }
    }

    fn difference(&self, x: &f64, d: f64) -> Option<f64> {
        let far = self.scale + (x - self.start);
        Some(-far * (d / (self.scale / far - d)))
    }

    fn separation(&self, x: &f64, y: &f64) -> f64 {
        match self.map {
            // two quotients: the product of far denominators could overflow
            Map::Algebraic => self.rest(*x) * ((y - x) / (self.scale + (y - self.start))),
            Map::Exponential => self.rest(*x) * -(-(y - x) / self.scale).exp_m1(),
        }
    }
}
