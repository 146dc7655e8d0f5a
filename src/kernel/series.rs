//! Does Σ |T|ⁿ converge? Known before a walk starts (condition (A) of theory §4.1), from a coarse discretisation of |T|.
//! The discretisation is that of [`coarse`](super::coarse).

use super::coarse::{Level, MASS_ORDERS, ROW_MASS, discretise};
use super::radius::spectral_radius;
use super::{HasDomain, Kernel};
use crate::deterministic::erased;
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::{Pcg, Sequence};
use crate::statistics::Moments;
use crate::value::{Value, Weight};
use std::sync::Arc;

/// A spectral radius with its numerical uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radius {
    /// The estimate.
    pub value: f64,
    /// Half-width of the numerical uncertainty, from two discretisations.
    pub uncertainty: f64,
}

impl Radius {
    /// Whether the radius is at least 1 beyond its uncertainty.
    pub fn diverges(&self) -> bool {
        self.value - self.uncertainty >= 1.0
    }
}

/// What is known about Σ |T|ⁿ before a walk.
#[derive(Clone, Debug)]
pub enum Series<X> {
    /// The kernel cannot be evaluated on a domain.
    Unknown,
    /// A coarse discretisation is at hand.
    Known(Arc<Discretised<X>>),
}

/// |T| on coarse nodes.
#[derive(Clone, Debug)]
pub struct Discretised<X> {
    fine: Level<X>,
    /// half the nodes: the difference tells the error
    coarse: Level<X>,
    radius: Radius,
    mass: f64,
}

impl<X: Point> Discretised<X> {
    /// Spectral radius of the operator with kernel |K|.
    pub fn radius(&self) -> Radius {
        self.radius
    }

    /// Largest row mass seen, an estimate of ‖T‖∞.
    pub fn norm(&self) -> f64 {
        self.mass
    }

    /// sup over nodes, ends and further places of Σ_{n > depth} |T|ⁿ |g|, the bias of walks cut at `depth` (theory (4.2.3)), widened by twice
    /// the difference between two discretisations; `None` if the series diverges.
    pub fn truncation_bound<V: Value>(&self, depth: u64, g: impl Fn(&X) -> V) -> Option<f64> {
        if self.radius.value >= 1.0 {
            return None;
        }
        let (fine, coarse) = (self.fine.remainder(depth, &g)?, self.coarse.remainder(depth, &g)?);
        Some(fine.max(coarse) + 2.0 * (fine - coarse).abs()).filter(|b| b.is_finite())
    }
}

/// Most unknowns of the coarse discretisation.
const UNKNOWNS: usize = 96;
/// Independent sets of random nodes from five dimensions on.
const REPLICATES: u32 = 6;
/// The differences between rules that all miss a narrow peak fall short of their error, by a factor of 2 on a peak of width 10⁻⁴.
const SAFETY: f64 = 3.0;
/// Half-width of the uncertainty in standard errors of their mean.
const SIGMAS: f64 = 3.0;

/// Σ |T|ⁿ of any kernel that can be evaluated on a domain: what [`Operator::series`](super::Operator::series) of such a kernel returns.
pub(crate) fn series_of<K: Kernel + HasDomain>(kernel: &K) -> Result<Series<K::Point>, Error> {
    by_values(&erased(kernel))
}

fn by_values<K: Kernel + HasDomain>(kernel: &K) -> Result<Series<K::Point>, Error> {
    kernel.domain().validate()?;
    let components = <<K::Weight as Weight>::Value as Value>::COMPONENTS;
    let budget = (UNKNOWNS / components.max(1) / kernel.domain().states()).max(12);
    let dimension = kernel.domain().dimension();
    let (fine, coarse, radius) = if dimension > 4 { by_random_nodes(kernel, budget)? } else { by_rules(kernel, budget, dimension)? };
    let mass = fine.matrix.row_iter().map(|r| r.sum()).fold(0.0, f64::max);
    Ok(Series::Known(Arc::new(Discretised { fine, coarse, radius, mass })))
}

/// Two discretisations and the radius.
type Levels<X> = (Level<X>, Level<X>, Radius);

/// Tensor Gauss rules of three sizes without a common factor: where K jumps, the error depends on where the nodes fall, and two sizes can agree by luck.
fn by_rules<K: Kernel + HasDomain>(kernel: &K, budget: usize, dimension: usize) -> Result<Levels<K::Point>, Error> {
    let orders = match dimension {
        1 => [budget, (5 * budget).div_ceil(8) + 1, 3 * budget / 8],
        2 => [19, 16, 11].map(|n| ((n * n * budget) as f64 / UNKNOWNS as f64).sqrt().max(4.0) as usize),
        3 => [7, 5, 4],
        _ => [4, 3, 2],
    };
    let level = |i: usize| discretise(kernel, kernel.domain().rule(1, orders[i]), MASS_ORDERS[i]);
    let (fine, coarse, third) = (level(0)?, level(1)?, level(2)?);
    let value = spectral_radius(&fine.matrix);
    let change = |other: &Level<K::Point>| (spectral_radius(&other.matrix) - value).abs();
    let uncertainty = (ROW_MASS * value).max(SAFETY * change(&coarse).max(change(&third)));
    Ok((fine, coarse, Radius { value, uncertainty }))
}

/// Random nodes: the error of the radius is statistical, O(n^{−1/2}). The diagonal is left out, a product of *two* independent nodes; it would bias
/// the radius upwards by ∫ K(x, x)/n.
fn by_random_nodes<K: Kernel + HasDomain>(kernel: &K, budget: usize) -> Result<Levels<K::Point>, Error> {
    let count = (budget + budget / 3).max(32);
    let replicate = |replicate: u32| {
        let node = |i: usize| {
            let n = kernel.domain().sample(&mut Pcg::default().point(u64::MAX, replicate, i as u64));
            Node { point: n.point, weight: n.weight / (count - 1) as f64 }
        };
        discretise(kernel, (0..count).map(node).collect(), MASS_ORDERS[0])
    };
    let mut levels = (0..REPLICATES).map(replicate).collect::<Result<Vec<_>, _>>()?;
    let radii: Vec<f64> = levels.iter().map(|level| spectral_radius(&level.matrix)).collect();
    let moments = Moments::from_scores(&radii);
    let uncertainty = SIGMAS * moments.std_error().unwrap_or(f64::INFINITY) + 1e-12 * moments.mean;
    let (fine, coarse) = (levels.swap_remove(0), levels.swap_remove(0));
    Ok((fine, coarse, Radius { value: moments.mean, uncertainty }))
}
