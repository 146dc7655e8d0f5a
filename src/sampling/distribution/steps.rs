//! A piecewise-constant density on cells of any width.

use super::{Distribution, Inverse, bin, cumulative, increasing, matching};
use crate::domain::{Domain, Interval};
use crate::error::Error;

/// Density ∝ `values[i]` on the cell from `edges[i]` to `edges[i + 1]`; logarithmic time. [`Table`](crate::sampling::Table) does equal
/// cells in constant expected time.
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Inverse, PiecewiseConstant};
/// let d = PiecewiseConstant::new(&[0.0, 1.0, 3.0, 4.0], &[2.0, 0.0, 6.0])?;
/// assert_eq!((d.sample(0.125), d.sample(0.5)), (0.5, 3.0 + 1.0 / 3.0));
/// assert_eq!((d.pdf(&0.5), d.pdf(&2.0), d.integral()), (0.25, 0.0, 8.0));
/// assert!((d.invert(&3.5).unwrap() - 0.625).abs() < 1e-15);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseConstant {
    edges: Vec<f64>,
    /// cumulative probabilities at the edges
    sums: Vec<f64>,
    integral: f64,
}

impl PiecewiseConstant {
    /// Cells between `edges`, one value fewer.
    ///
    /// # Errors
    /// [`Error::Invalid`] for edges that do not increase, values that are negative or not finite or all zero, and lists that do not match.
    pub fn new(edges: &[f64], values: &[f64]) -> Result<Self, Error> {
        matching("number of values", values.len(), edges.len().saturating_sub(1), "must be one less than that of the edges")?;
        increasing("edge", edges)?;
        if let Some(v) = values.iter().find(|v| !(**v >= 0.0)) {
            return Err(Error::invalid("value", *v, "must be finite and not negative"));
        }
        let (sums, integral) = cumulative("mass of a cell", edges.windows(2).zip(values).map(|(e, v)| (e[1] - e[0]) * v))?;
        Ok(PiecewiseConstant { edges: edges.to_vec(), sums, integral })
    }

    /// Equal cells of an interval.
    ///
    /// # Errors
    /// As [`new`](Self::new), and whatever is wrong with the interval.
    pub fn on(interval: impl Into<Interval>, values: &[f64]) -> Result<Self, Error> {
        let interval = interval.into();
        interval.validate()?;
        let n = values.len();
        let edges: Vec<f64> = (0..=n).map(|i| if i == n { interval.upper() } else { interval.at(i as f64 / n as f64) }).collect();
        Self::new(&edges, values)
    }

    /// Integral of the values: what the density was divided by.
    #[must_use]
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// The cell that holds x; the last one is closed.
    pub(super) fn cell(&self, x: f64) -> Option<usize> {
        let (first, last) = (self.edges[0], self.edges[self.edges.len() - 1]);
        (x >= first && x <= last).then(|| self.edges.partition_point(|e| *e <= x).min(self.edges.len() - 1) - 1)
    }

    fn width(&self, k: usize) -> f64 {
        self.edges[k + 1] - self.edges[k]
    }

    fn probability(&self, k: usize) -> f64 {
        self.sums[k + 1] - self.sums[k]
    }
}

impl Distribution for PiecewiseConstant {
    type Unit = f64;
    type Point = f64;

    fn sample(&self, u: f64) -> f64 {
        let k = bin(&self.sums, u);
        let x = self.edges[k] + self.width(k) * ((u - self.sums[k]) / self.probability(k));
        // the upper edge belongs to the next cell, perhaps one of density 0
        x.clamp(self.edges[k], self.edges[k + 1].next_down())
    }

    fn pdf(&self, x: &f64) -> f64 {
        // from the sums, not from the values: the density of what is sampled, rounding included
        self.cell(*x).map_or(0.0, |k| self.probability(k) / self.width(k))
    }
}

impl Inverse for PiecewiseConstant {
    fn invert(&self, x: &f64) -> Option<f64> {
        let k = self.cell(*x).filter(|k| self.probability(*k) > 0.0)?;
        Some(self.sums[k] + self.probability(k) * ((x - self.edges[k]) / self.width(k)))
    }
}
