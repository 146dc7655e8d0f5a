//! A piecewise-linear density.

use super::{Distribution, Inverse, bin, cumulative, increasing, matching};
use crate::error::Error;

/// Density ∝ the polygon through (`knots[i]`, `values[i]`).
///
/// In a cell of width h from value a to b, the mass r left of x_i + t h is h (a t + (b − a) t²/2); the root of this quadratic without
/// cancellation is t = 2q/(a + √(a² + 2 (b − a) q)), q = r/h.
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Inverse, PiecewiseLinear};
/// let tent = PiecewiseLinear::new(&[0.0, 1.0, 2.0], &[0.0, 3.0, 0.0])?;
/// assert_eq!((tent.sample(0.125), tent.pdf(&0.5)), (0.5, 0.5));
/// assert_eq!((tent.invert(&1.5), tent.invert(&2.5)), (Some(0.875), None));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseLinear {
    knots: Vec<f64>,
    /// densities at the knots
    density: Vec<f64>,
    sums: Vec<f64>,
    integral: f64,
}

impl PiecewiseLinear {
    /// The polygon through the points (knot, value).
    ///
    /// # Errors
    /// [`Error::Invalid`] for knots that do not increase, values that are negative or not finite or all zero, and lists that do not match.
    pub fn new(knots: &[f64], values: &[f64]) -> Result<Self, Error> {
        matching("number of values", values.len(), knots.len(), "must be that of the knots")?;
        increasing("knot", knots)?;
        if let Some(v) = values.iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
            return Err(Error::invalid("value", *v, "must be finite and not negative"));
        }
        let masses = knots.windows(2).zip(values.windows(2)).map(|(x, v)| (x[1] - x[0]) * (0.5 * v[0] + 0.5 * v[1]));
        let (sums, integral) = cumulative("mass of a cell", masses)?;
        let density: Vec<f64> = values.iter().map(|v| v / integral).collect();
        match density.iter().find(|d| !d.is_finite()) {
            Some(d) => Err(Error::invalid("density", *d, "the largest value is too large for the sum of all masses")),
            None => Ok(PiecewiseLinear { knots: knots.to_vec(), density, sums, integral }),
        }
    }

    /// Integral of the polygon: what the density was divided by.
    #[must_use]
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// The cell that holds x, and where in it.
    fn cell(&self, x: f64) -> Option<(usize, f64)> {
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        (x >= first && x <= last).then(|| {
            let k = self.knots.partition_point(|e| *e <= x).min(self.knots.len() - 1) - 1;
            (k, (x - self.knots[k]) / self.width(k))
        })
    }

    fn width(&self, k: usize) -> f64 {
        self.knots[k + 1] - self.knots[k]
    }
}

impl Distribution for PiecewiseLinear {
    type Unit = f64;
    type Point = f64;

    fn sample(&self, u: f64) -> f64 {
        let k = bin(&self.sums, u);
        let (a, b) = (self.density[k], self.density[k + 1]);
        let q = (u - self.sums[k]).clamp(0.0, self.sums[k + 1] - self.sums[k]) / self.width(k);
        let root = (a * a + 2.0 * (b - a) * q).max(0.0).sqrt();
        let t = if q == 0.0 { 0.0 } else { 2.0 * q / (a + root) };
        // strictly inside the cell, where the density is positive even if it vanishes at a knot
        let x = self.knots[k] + self.width(k) * t;
        let (least, most) = (self.knots[k].next_up(), self.knots[k + 1].next_down());
        if least <= most { x.clamp(least, most) } else { self.knots[k] }
    }

    fn pdf(&self, x: &f64) -> f64 {
        self.cell(*x).map_or(0.0, |(k, t)| self.density[k] * (1.0 - t) + self.density[k + 1] * t)
    }
}

impl Inverse for PiecewiseLinear {
    fn invert(&self, x: &f64) -> Option<f64> {
        let (k, t) = self.cell(*x).filter(|(k, _)| self.sums[k + 1] > self.sums[*k])?;
        let (a, b) = (self.density[k], self.density[k + 1]);
        Some((self.sums[k] + self.width(k) * t * (a + 0.5 * (b - a) * t)).min(1.0))
    }
}
