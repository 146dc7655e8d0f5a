//! A split of the unit cube into boxes, and the samplers of its parts.

use super::Integral;
use crate::contained::contained;
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
    axes: Vec<Axis>,
}

/// How one axis is cut.
#[derive(Clone, Debug, PartialEq)]
enum Axis {
    /// into so many equal parts
    Equal(usize),
    /// at the places between the ends 0 and 1
    At(Vec<f64>),
}

impl Axis {
    fn parts(&self) -> usize {
        match self {
            Axis::Equal(k) => *k,
            Axis::At(ends) => ends.len() - 1,
        }
    }

    /// Ends of part `k`.
    #[inline]
    fn side(&self, k: usize) -> (f64, f64) {
        match self {
            Axis::Equal(parts) => (k as f64 / *parts as f64, (k + 1) as f64 / *parts as f64),
            Axis::At(ends) => (ends[k], ends[k + 1]),
        }
    }
}

/// Strata at most.
const MOST: f64 = 1e9;
const LIMITS: &str = "must be at least 1 and at most 1e9";
/// Axes at most, if they are cut at all: more have more than [`MOST`] parts.
const AXES: usize = 64;

impl Strata {
    /// One axis in `k` equal parts.
    pub fn uniform(k: usize) -> Self {
        Strata { axes: vec![Axis::Equal(k)] }
    }

    /// One axis, cut at the given places in (0, 1), ascending.
    pub fn cut_at(places: &[f64]) -> Self {
        Strata { axes: vec![Axis::At([&[0.0], places, &[1.0]].concat())] }
    }

    /// The axes of both, one after the other: every part of the one with every part of the other.
    pub fn times(mut self, other: Strata) -> Self {
        self.axes.extend(other.axes);
        self
    }

    /// A grid of `k`^D equal cells.
    pub fn grid(k: usize, dimensions: usize) -> Self {
        // beyond: too many to be solved with, or axes of one part, which change nothing
        Strata { axes: vec![Axis::Equal(k); dimensions.min(AXES)] }
    }

    /// `k` strata adapted to the shape of a one-dimensional integrand, for [`Plain`](super::Plain) with equal counts: narrow where |f′| is large.
    ///
    /// Derivation: a stratum of width h has σ² ≈ f′²h²/12, so with m samples in each V = Σ h²σ²/m ≈ ∫ f′² ρ⁻³/(12 m) with ρ = 1/h strata a unit
    /// length; least for given ∫ρ = k where ρ ∝ |f′|^½. A tenth of the strata is spread evenly, lest a flat part of f that only looks flat be one stratum.
    ///
    /// # Errors
    /// [`Error::Invalid`] for domains of more than one dimension or `k` = 0; [`Error::NonFiniteIntegrand`].
    pub fn adapted<D: Domain, G: Source<Point = D::Point>>(integral: &Integral<D, G>, k: usize) -> Result<Self, Error> {
        contained(|| {
            let domain = integral.domain();
            domain.validate()?;
            if domain.dimension() != 1 || domain.states() != 1 {
                return Err(Error::invalid(
                    "dimension",
                    domain.dimension() as f64,
                    "adapted strata need a one-dimensional domain of one state",
                ));
            }
            if k == 0 || k as f64 > MOST {
                return Err(Error::invalid("strata", k as f64, LIMITS));
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
            Ok(Strata { axes: vec![Axis::At(axis)] })
        })
    }

    /// Number of strata; the largest number there is where it is larger still.
    #[must_use]
    pub fn count(&self) -> usize {
        self.axes.iter().fold(1, |count: usize, axis| count.saturating_mul(axis.parts()))
    }

    /// v_i.
    pub(super) fn volume(&self, i: usize) -> f64 {
        self.sides(i).map(|(a, b)| b - a).product()
    }

    /// Lower and upper ends of stratum `i` along every axis.
    pub(super) fn sides(&self, i: usize) -> impl Iterator<Item = (f64, f64)> {
        let mut rest = i;
        self.axes.iter().map(move |axis| {
            let k = rest % axis.parts();
            rest /= axis.parts();
            axis.side(k)
        })
    }

    pub(super) fn dimension(&self) -> usize {
        self.axes.len()
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        for axis in &self.axes {
            if let Axis::At(ends) = axis
                && let Some(w) = ends.windows(2).find(|w| !(w[0] < w[1]))
            {
                return Err(Error::invalid("cut", w[1].min(w[0]), "cuts must ascend strictly inside (0, 1)"));
            }
        }
        let count = self.axes.iter().map(|a| a.parts() as f64).product::<f64>();
        if self.axes.is_empty() || !(1.0..=MOST).contains(&count) {
            return Err(Error::invalid("strata", if self.axes.is_empty() { 0.0 } else { count }, LIMITS));
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
        let (lower, upper) = axis.side(self.rest % axis.parts());
        self.rest /= axis.parts();
        self.axis += 1;
        // the sum may round to the upper end, which belongs to the neighbour, or is 1
        (lower + t * (upper - lower)).min(upper.next_down())
    }
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        self.u.seek(vertex, purpose);
    }
}
