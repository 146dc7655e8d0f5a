//! The whole line (−∞, ∞).

use super::{Domain, Node};
use crate::error::Error;

/// The whole line with Lebesgue measure, covered by a map of (0, 1) that leaves t = a and 1 − t = b to its ends:
///
/// ```text
/// x = centre + (s/4) (1/b − 1/a)                dx/dt = (s/4) (1/a² + 1/b²)           algebraic, the default: f ~ |x|^{−p}
/// x = centre + (s/2) ln(a/b)                    dx/dt = (s/2)/(a b)                   exponential: f ~ e^{−|x|/ℓ}, s about 2ℓ
/// ```
///
/// The algebraic map covers fast decay as well, only with more nodes; the exponential one ends at |x| ≈ 350 s. [`Line::fitted`] measures the decay and chooses.
///
/// ```
/// use fredholm::{domain::{Domain, Line}, Equation, deterministic::Nystrom};
/// assert_eq!(Line::new().volume(), f64::INFINITY);
/// // f = e^{−|x|} + ⅜ ∫ e^{−|x − y|} f = 2 e^{−|x|/2}
/// let eq = Equation::on_domain(Line::new(), |x: &f64| (-x.abs()).exp(), |x, y| 0.375 * (-(x - y).abs()).exp());
/// let f = eq.solve(&Nystrom::adaptive().tolerance(1e-9).breakpoints(&[0.0]))?;
/// assert!((f.eval(1.0) - 2.0 * (-0.5f64).exp()).abs() < 1e-8);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    centre: f64,
    scale: f64,
    map: Map,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Map {
    Algebraic,
    Exponential,
}

impl Default for Line {
    fn default() -> Self {
        Line::new()
    }
}

impl Line {
    /// The algebraic map around 0 with scale 1.
    #[must_use]
    pub fn new() -> Self {
        Line { centre: 0.0, scale: 1.0, map: Map::Algebraic }
    }

    /// Where the map is densest.
    #[must_use]
    pub fn centre(self, centre: f64) -> Self {
        Line { centre, ..self }
    }

    /// Sets the scale s of the map, in units of x.
    #[must_use]
    pub fn scale(self, scale: f64) -> Self {
        Line { scale, ..self }
    }

    /// The exponential map.
    #[must_use]
    pub fn exponential(self) -> Self {
        Line { map: Map::Exponential, ..self }
    }

    /// The map for functions that decay as `phi` does on both sides of `centre`: g, K(x, ·) for some x, or the larger of them.
    ///
    /// ```
    /// use fredholm::domain::Line;
    /// assert_eq!(Line::fitted(0.0, |x| (-3.0 * x.abs()).exp()), Line::fitted(0.0, |x| (-3.0 * x.abs()).exp()).exponential());
    /// assert_ne!(Line::fitted(0.0, |x| 1.0 / (1.0 + x * x)), Line::fitted(0.0, |x| 1.0 / (1.0 + x * x)).exponential());
    /// ```
    #[must_use]
    pub fn fitted(centre: f64, phi: impl Fn(f64) -> f64) -> Self {
        let (map, scale) = fit(|r| phi(centre + r).abs().max(phi(centre - r).abs()));
        Line { centre, scale: if map == Map::Exponential { 2.0 * scale } else { scale }, map }
    }

    /// t and 1 − t at x, both to all their digits.
    fn shares(&self, x: f64) -> (f64, f64) {
        let q = (x - self.centre) / self.scale;
        let far = match self.map {
            // the smaller one first: 1/b − 1/a = 4|q| with a = 1 − b
            Map::Algebraic => {
                let p = 2.0 * q.abs();
                if p.is_infinite() { 0.0 } else { 1.0 / ((1.0 + p) + (1.0f64).hypot(p)) }
            }
            Map::Exponential => {
                let e = (-2.0 * q.abs()).exp();
                e / (1.0 + e)
            }
        };
        if q < 0.0 { (far, 1.0 - far) } else { (1.0 - far, far) }
    }

    fn at(&self, a: f64, b: f64) -> f64 {
        self.centre
            + self.scale
                * match self.map {
                    Map::Algebraic => 0.25 * (1.0 / b - 1.0 / a),
                    Map::Exponential => 0.5 * (a / b).ln(),
                }
    }

    fn slope(&self, a: f64, b: f64) -> f64 {
        self.scale
            * match self.map {
                Map::Algebraic => 0.25 * (1.0 / (a * a) + 1.0 / (b * b)),
                Map::Exponential => 0.5 / (a * b),
            }
    }
}

/// The map and the length over which a function of r ≥ 0 decays: exponential if its share of an octave, r φ(r), falls to 10⁻⁶ of its maximum within 2.6
/// times the distance at which it has fallen to 10⁻³.
pub(super) fn fit(phi: impl Fn(f64) -> f64) -> (Map, f64) {
    /// Places an octave, and octaves on each side of 1.
    const FINE: i32 = 8;
    const OCTAVES: i32 = 60;
    let places: Vec<f64> = (-OCTAVES * FINE..=OCTAVES * FINE).map(|k| 2f64.powf(f64::from(k) / f64::from(FINE))).collect();
    let values: Vec<f64> = places.iter().map(|r| r * phi(*r)).map(|v| if v.is_finite() { v } else { 0.0 }).collect();
    let largest = values.iter().fold(0.0f64, |m, v| m.max(*v));
    let last = |share: f64| values.iter().rposition(|v| *v > share * largest).map_or(1.0, |i| places[i]);
    let (half, first, second) = (last(0.5), last(1e-3), last(1e-6));
    let ends = places[places.len() - 1];
    if largest == 0.0 || second >= ends {
        return (Map::Algebraic, if half < ends { half } else { 1.0 });
    }
    if second <= 2.6 * first { (Map::Exponential, (second - first) / 1e3f64.ln()) } else { (Map::Algebraic, half) }
}

impl Domain for Line {
    type Point = f64;

    fn validate(&self) -> Result<(), Error> {
        if !self.centre.is_finite() {
            return Err(Error::invalid("line centre", self.centre, "must be finite"));
        }
        if !(self.scale.is_finite() && self.scale > 0.0) {
            return Err(Error::invalid("line scale", self.scale, "must be positive and finite"));
        }
        Ok(())
    }

    fn volume(&self) -> f64 {
        f64::INFINITY
    }

    #[inline]
    fn contains(&self, x: &f64) -> bool {
        x.is_finite()
    }

    fn dimension(&self) -> usize {
        1
    }

    #[inline]
    fn place(&self, _: usize, mut next: impl FnMut() -> f64) -> Node<f64> {
        let t = next();
        Node { point: self.at(t, 1.0 - t), weight: self.slope(t, 1.0 - t) }
    }

    #[inline]
    fn density(&self, x: &f64) -> f64 {
        if !self.contains(x) {
            return 0.0;
        }
        let (a, b) = self.shares(*x);
        1.0 / self.slope(a, b)
    }

    fn locate(&self, x: f64) -> Option<f64> {
        self.contains(&x).then(|| self.coordinate(&x, 0))
    }

    #[inline]
    fn coordinate(&self, x: &f64, _: usize) -> f64 {
        self.shares(*x).0
    }

    fn displaced(&self, x: &f64, _: usize, d: f64) -> Node<f64> {
        let (a, b) = self.shares(*x);
        let (c, e) = ((a + d).max(0.0), (b - d).max(0.0));
        let weight = self.slope(c, e);
        // a short way is added to x, which may be far out; a long one starts from the ends
        let short = x.is_finite() && d.abs() < 0.5 * a.min(b);
        let step = match self.map {
            _ if !short => return Node { point: self.at(c, e), weight },
            Map::Algebraic => 0.25 * d * (1.0 / (b * e) + 1.0 / (a * c)),
            Map::Exponential => 0.5 * ((d / a).ln_1p() - (-d / b).ln_1p()),
        };
        Node { point: x + self.scale * step, weight }
    }

    fn separation(&self, x: &f64, y: &f64) -> f64 {
        let ((a, b), (c, e)) = (self.shares(*x), self.shares(*y));
        if x.is_infinite() || y.is_infinite() {
            return if *x > 0.0 && *y > 0.0 { b - e } else { c - a };
        }
        let q = (y - x) / self.scale;
        match self.map {
            Map::Algebraic => 4.0 * q / (1.0 / (b * e) + 1.0 / (a * c)),
            // of the two forms the one whose exponential stays below 1
            Map::Exponential if q >= 0.0 => c * b * -(-2.0 * q).exp_m1(),
            Map::Exponential => -(a * e) * -(2.0 * q).exp_m1(),
        }
    }
}
