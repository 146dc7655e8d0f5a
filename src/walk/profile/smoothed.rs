//! Density estimation of the collisions, the relative of the photon map.
//!
//! ```text
//! f̂(x) = g(x) + Σ_{n ≥ 1} W_n κ_x((Z_n − x)/b)/b,     κ(u) = ¾ (1 − u²) on |u| ≤ 1                             theory (4.6.4)
//! κ_x(u) = κ(u) (a₂ − a₁ u)/(a₀ a₂ − a₁²),            a_l = ∫ u^l κ(u) du over the u whose Z = x + b u is inside
//! ```
//!
//! Derivation: ∫κ_x = 1 and ∫u κ_x = 0 also next to an end, where plain κ would lose half its mass; so the bias is ½ b² (T f)″ ∫u²κ_x everywhere. The
//! variance is ~ f ∫κ²/(n b): with b ~ n^(−1/5) the mean square error falls as n^(−4/5), slower than that of the other tallies. Consistent, biased, and said
//! so. Reference: Silverman, *Density estimation* (1986), §3.3; Jones, *Simple boundary correction for kernel density estimation*, Stat. Comput. 3 (1993) 135;
//! Jensen, *Realistic image synthesis using photon mapping* (2001).

use super::{PlanOf, Tally, check_points, source_at};
use crate::detector::{Detector, Score, Start};
use crate::domain::{Domain, Interval};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasAdjoint, Operator};
use crate::sampling::Sampler;
use crate::source::{Emit, Source};
use crate::statistics::Bias;
use crate::value::{Value, Weight};
use crate::walk::Collided;

/// Collisions smoothed over ± b around points of an interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    interval: Interval,
    points: Vec<f64>,
    bandwidth: Bandwidth,
}

/// b.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bandwidth {
    /// factor · length · n^(−1/5)
    Shrinking(f64),
    Fixed(f64),
}

impl Smoothed {
    /// At these points, with b = ½ · length · walks^(−1/5).
    #[must_use]
    pub fn at(interval: impl Into<Interval>, points: &[f64]) -> Self {
        Smoothed { interval: interval.into(), points: points.to_vec(), bandwidth: Bandwidth::Shrinking(0.5) }
    }

    /// b = `factor` · length · walks^(−1/5).
    #[must_use]
    pub fn shrinking(self, factor: f64) -> Self {
        Smoothed { bandwidth: Bandwidth::Shrinking(factor), ..self }
    }

    /// b whatever the number of walks: not consistent.
    #[must_use]
    pub fn bandwidth(self, b: f64) -> Self {
        Smoothed { bandwidth: Bandwidth::Fixed(b), ..self }
    }

    fn width(&self, walks: u64) -> Result<f64, Error> {
        let (b, parameter) = match self.bandwidth {
            Bandwidth::Shrinking(factor) => (factor * self.interval.length() * (walks.max(1) as f64).powf(-0.2), "bandwidth factor"),
            Bandwidth::Fixed(b) => (b, "bandwidth"),
        };
        if b > 0.0 && b.is_finite() { Ok(b) } else { Err(Error::invalid(parameter, b, "must be positive and finite")) }
    }
}

/// The smoothing kernels κ_x of a list of points, as cells.
#[derive(Clone, Debug)]
pub struct SmoothingKernels {
    interval: Interval,
    bandwidth: f64,
    /// ascending in x
    bumps: Vec<Bump>,
}

#[derive(Clone, Copy, Debug)]
struct Bump {
    x: f64,
    cell: usize,
    /// ends of the u inside
    support: [f64; 2],
    /// κ_x(u) = κ(u) (c₀ + c₁ u)
    linear: [f64; 2],
}

impl Bump {
    fn new(interval: Interval, bandwidth: f64, cell: usize, x: f64) -> Self {
        let support = [((interval.lower() - x) / bandwidth).max(-1.0), ((interval.upper() - x) / bandwidth).min(1.0)];
        let moment = |l: i32| {
            let primitive = |u: f64| 0.75 * (u.powi(l + 1) / f64::from(l + 1) - u.powi(l + 3) / f64::from(l + 3));
            primitive(support[1]) - primitive(support[0])
        };
        let [a0, a1, a2] = [0, 1, 2].map(moment);
        let determinant = a0 * a2 - a1 * a1;
        Bump { x, cell, support, linear: [a2 / determinant, -a1 / determinant] }
    }

    #[inline]
    fn at(&self, u: f64) -> f64 {
        0.75 * (1.0 - u * u) * (self.linear[0] + self.linear[1] * u)
    }
}

impl SmoothingKernels {
    fn new(interval: Interval, bandwidth: f64, points: &[f64]) -> Self {
        let mut bumps: Vec<_> = points.iter().enumerate().map(|(cell, x)| Bump::new(interval, bandwidth, cell, *x)).collect();
        bumps.sort_by(|a, b| a.x.total_cmp(&b.x));
        SmoothingKernels { interval, bandwidth, bumps }
    }
}

impl Detector for SmoothingKernels {
    type Point = f64;
    type Answer<T> = Vec<T>;
    fn cells(&self) -> usize {
        self.bumps.len()
    }
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<f64> {
        let bump = self.bumps.iter().find(|b| b.cell == cell).expect("a cell below the number of cells");
        let [from, to] = bump.support;
        let at = from + (to - from) * u.next_1d();
        Start { point: bump.x + self.bandwidth * at, weight: bump.at(at) * (to - from) }
    }
    /// Boundary kernels are negative in part: ∫ |κ_x| ≤ 3.
    fn norm(&self) -> Option<f64> {
        Some(3.0)
    }
    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
}

impl<V: Value> Score<f64, V> for SmoothingKernels {
    #[inline]
    fn score<S: Sampler>(&self, z: &f64, load: V, _: &mut S, mut add: impl FnMut(usize, V)) {
        if !self.interval.contains(z) {
            return;
        }
        let first = self.bumps.partition_point(|b| b.x <= z - self.bandwidth);
        for bump in self.bumps[first..].iter().take_while(|b| b.x < z + self.bandwidth) {
            add(bump.cell, load.scale(bump.at((z - bump.x) / self.bandwidth) / self.bandwidth));
        }
    }
}

impl<G, K> Tally<G, K> for Smoothed
where
    G: Emit<State = f64> + Source<Point = f64>,
    K: HasAdjoint + Operator<Point = f64>,
    K::Weight: Weight<Value = G::Value>,
{
    type Point = f64;
    type Detector = SmoothingKernels;
    type Scoring = Collided;

    fn plan(&self, equation: &Equation<G, K>, walks: u64) -> Result<PlanOf<G, K, Self>, Error> {
        check_points(self.interval, &self.points)?;
        let bandwidth = self.width(walks)?;
        let detector = SmoothingKernels::new(self.interval, bandwidth, &self.points);
        let known = source_at(equation.source(), &self.points)?;
        let (points, bias) = (self.points.clone(), Bias::Smoothing { bandwidth });
        Ok(super::Plan { points, detector, scoring: Collided, known, known_error: 0.0, matrix: None, bias })
    }
}
