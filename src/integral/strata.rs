//! A split of the unit cube into boxes, and the samplers of its parts.

use super::Integral;
use crate::domain::Domain;
use crate::error::Error;
use crate::sampling::{Purpose, Sampler};
use crate::source::Source;
use crate::value::Value;

/// Strata: the first coordinates of the cube, each cut at some places.
///
/// Strata live in the cube that a primary estimator reads. For [`Plain`](super::Plain) on an interval or a box they are parts of the domain; for importance
/// sampling by inversion they are parts of equal probability, narrow where the density is large.
///
/// ```
/// use fredholm::integral::Strata;
/// let grid = Strata::uniform(4).times(Strata::cut_at(&[0.1]));
/// assert_eq!(grid.count(), 8);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Strata {
    /// ends and cuts of every axis, ascending from 0 to 1
    axes: Vec<Vec<f64>>,
}

impl Strata {
    /// One axis in `k` equal parts.
    pub fn uniform(k: usize) -> Self {
        Strata { axes: vec![(0..=k).map(|i| i as f64 / k as f64).collect()] }
    }

    /// One axis, cut at the given places in (0, 1), ascending.
    pub fn cut_at(places: &[f64]) -> Self {
        Strata { axes: vec![[&[0.0], places, &[1.0]].concat()] }
    }

    /// The axes of both, one after the other: every part of the one with every part of the other.
    pub fn times(mut self, other: Strata) -> Self {
        self.axes.extend(other.axes);
        self
    }

    /// A grid of `k`^D equal cells.
    pub fn grid(k: usize, dimensions: usize) -> Self {
        let axis = Strata::uniform(k).axes.swap_remove(0);
        Strata { axes: vec![axis; dimensions] }
    }

    /// `k` strata adapted to the shape of a one-dimensional integrand, for [`Plain`](super::Plain) with equal counts: narrow where |f′| is large.
    ///
    /// Derivation: a stratum of width h has σ² ≈ f′²h²/12, so with m samples in each V = Σ h²σ²/m ≈ ∫ f′² ρ⁻³/(12 m) with ρ = 1/h strata a unit
    /// length; least for given ∫ρ = k where ρ ∝ |f′|^½. A tenth of the strata is spread evenly, lest a flat part of f that only looks flat be one stratum.
    ///
    /// # Errors
    /// [`Error::Invalid`] for domains of more than one dimension or `k` = 0; [`Error::NonFiniteIntegrand`].
    pub fn adapted<D: Domain, G: Source<Point = D::Point>>(integral: &Integral<D, G>, k: usize) -> Result<Self, Error> {
        let domain = integral.domain();
        domain.validate()?;
        if domain.dimension() != 1 || domain.states() != 1 {
            return Err(Error::invalid(
                "dimension",
                domain.dimension() as f64,
                "adapted strata need a one-dimensional domain of one state",
            ));
        }
        if k == 0 {
            return Err(Error::invalid("strata", 0.0, "must be at least 1"));
        }
        let cells = 16 * k;
        let mut values = Vec::with_capacity(cells + 1);
        for i in 0..=cells {
            // the ends themselves may be singular
            let node = domain.place(0, || (i as f64 / cells as f64).clamp(0.5 / cells as f64, 1.0 - 0.5 / cells as f64));
            let f = integral.integrand().eval(&node.point);
            if !f.all_finite() {
                return Err(Error::NonFiniteIntegrand { at: format!("{:?}", node.point), value: format!("{f:?}") });
            }
            values.push(f.scale(node.weight));
        }
        let slopes: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).magnitude().sqrt()).collect();
        let total: f64 = slopes.iter().sum();
        let share = |s: f64| if total > 0.0 { 0.1 / cells as f64 + 0.9 * s / total } else { 1.0 / cells as f64 };
        let (mut axis, mut sum) = (vec![0.0], 0.0);
        for (i, s) in slopes.iter().enumerate() {
            let (before, step) = (sum, share(*s));
            sum += step;
            while axis.len() < k && axis.len() as f64 / k as f64 <= sum {
                axis.push((i as f64 + (axis.len() as f64 / k as f64 - before) / step) / cells as f64);
            }
        }
        axis.push(1.0);
        Ok(Strata { axes: vec![axis] })
    }

    /// Number of strata.
    #[must_use]
    pub fn count(&self) -> usize {
        self.axes.iter().map(|a| a.len() - 1).product()
    }

    /// v_i.
    pub(super) fn volume(&self, i: usize) -> f64 {
        self.sides(i).map(|(a, b)| b - a).product()
    }

    /// Lower and upper ends of stratum `i` along every axis.
    pub(super) fn sides(&self, i: usize) -> impl Iterator<Item = (f64, f64)> {
        let mut rest = i;
        self.axes.iter().map(move |axis| {
            let parts = axis.len() - 1;
            let k = rest % parts;
            rest /= parts;
            (axis[k], axis[k + 1])
        })
    }

    pub(super) fn dimension(&self) -> usize {
        self.axes.len()
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        for axis in &self.axes {
            if axis.len() < 2 {
                return Err(Error::invalid("strata", 0.0, "must be at least 1"));
            }
            if let Some(w) = axis.windows(2).find(|w| !(w[0] < w[1])) {
                return Err(Error::invalid("cut", w[1].min(w[0]), "cuts must ascend strictly inside (0, 1)"));
            }
        }
        let count = self.axes.iter().map(|a| (a.len() - 1) as f64).product::<f64>();
        if self.axes.is_empty() || count > 1e9 {
            return Err(Error::invalid("strata", count, "must be at least 1 and at most 1e9"));
        }
        Ok(())
    }

    /// A sampler confined to stratum `i`.
    #[inline]
    pub(super) fn confine<S: Sampler>(&self, i: usize, u: S) -> Confined<'_, S> {
        Confined { strata: self, rest: i, axis: 0, u }
    }
}

/// A sampler whose first coordinates fall into one stratum.
#[derive(Debug)]
pub(super) struct Confined<'a, S> {
    strata: &'a Strata,
    /// the stratum's number, the axes read so far divided out
    rest: usize,
    axis: usize,
    u: S,
}

impl<S: Sampler> Sampler for Confined<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let t = self.u.next_1d();
        let Some(axis) = self.strata.axes.get(self.axis) else { return t };
        let parts = axis.len() - 1;
        let k = self.rest % parts;
        self.rest /= parts;
        self.axis += 1;
        // the sum may round to the upper end, which belongs to the neighbour, or is 1
        (axis[k] + t * (axis[k + 1] - axis[k])).min(axis[k + 1].next_down())
    }
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        self.u.seek(vertex, purpose);
    }
}
