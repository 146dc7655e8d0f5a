//! Where x lives: the domain Ω of an equation, its measure μ and a map from the unit cube.
//!
//! | domain | point | measure |
//! |---|---|---|
//! | [`Interval`] | `f64` | length |
//! | [`HalfLine`], [`Line`] | `f64` | length (infinite) |
//! | [`Periodic`] | `f64` | length of the period |
//! | [`Disk`] | `[f64; 2]` | area |
//! | [`Cuboid<D>`] | `[f64; D]` | volume |
//! | [`Grouped`] | `(point, usize)` | measure × counting: systems as one scalar equation |

mod cuboid;
mod disk;
mod grouped;
mod half_line;
mod interval;
mod line;
mod periodic;

pub use cuboid::Cuboid;
pub use disk::Disk;
pub use grouped::Grouped;
pub use half_line::HalfLine;
pub use interval::Interval;
pub use line::Line;
pub use periodic::Periodic;

use crate::deterministic::quadrature::composite_unit_rule;
use crate::error::Error;
use crate::sampling::Sampler;
use std::fmt::Debug;

/// A state of a walk: small, copyable, printable.
pub trait Point: Copy + Debug + PartialEq + Send + Sync + 'static {}
impl<T: Copy + Debug + PartialEq + Send + Sync + 'static> Point for T {}

/// A point and the measure it stands for: `weight` is the Jacobian of the map from the cube, or the weight of a quadrature node.
///
/// `∫ φ dμ = E[weight · φ(point)]` for random points, `≈ Σ weight · φ(point)` for nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<X> {
    /// Where.
    pub point: X,
    /// How much measure, in units of μ.
    pub weight: f64,
}

/// A set Ω with a measure μ, covered by a map from the unit cube (times finitely many discrete states).
///
/// Law: `density` is the density of `sample` with respect to μ: positive inside, ∫ density dμ = 1.
pub trait Domain: Clone + Debug + Send + Sync + 'static {
    /// Points of Ω.
    type Point: Point;

    /// Refuses empty, reversed or non-finite domains.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the offending number.
    fn validate(&self) -> Result<(), Error>;

    /// μ(Ω); infinity for a half line.
    fn volume(&self) -> f64;

    /// Whether x ∈ Ω.
    fn contains(&self, x: &Self::Point) -> bool;

    /// Number of continuous coordinates.
    fn dimension(&self) -> usize;

    /// Number of discrete states; 1 unless the domain is [`Grouped`].
    fn states(&self) -> usize {
        1
    }

    /// The map: coordinates in (0, 1) are read from `next` in order. `weight` is the Jacobian |dμ/dt|.
    fn place(&self, state: usize, next: impl FnMut() -> f64) -> Node<Self::Point>;

    /// The inverse of the map: coordinate `axis` of x, in [0, 1].
    fn coordinate(&self, x: &Self::Point, axis: usize) -> f64;

    /// The point of a state at coordinate `t + d`, t that of x on a one-dimensional domain; found from x where adding d to t would cost digits.
    fn displaced(&self, x: &Self::Point, state: usize, d: f64) -> Node<Self::Point> {
        self.place(state, || self.coordinate(x, 0) + d)
    }

    /// Coordinate 0 of y minus that of x, without the cancellation of the difference where x and y are close.
    fn separation(&self, x: &Self::Point, y: &Self::Point) -> f64 {
        self.coordinate(y, 0) - self.coordinate(x, 0)
    }

    /// x − y for the y at coordinate distance d from x, before y is rounded; `None` where points are no real numbers.
    fn difference(&self, x: &Self::Point, d: f64) -> Option<f64> {
        let _ = (x, d);
        None
    }

    /// x − y for a y at coordinate distance 1, where x − y is proportional to the distance.
    fn stretch(&self) -> Option<f64> {
        None
    }

    /// The coordinate of the real number x on a one-dimensional domain; `None` if x is outside, or the domain is not a part of the real line.
    fn locate(&self, x: f64) -> Option<f64> {
        let _ = x;
        None
    }

    /// Whether functions continue periodically along a coordinate: its rules are trapezoidal then.
    fn is_periodic(&self, axis: usize) -> bool {
        let _ = axis;
        false
    }

    /// A rule for functions that are singular or have a kink at x, with none of its nodes there; `None` where there is none.
    fn around(&self, x: &Self::Point, order: usize) -> Option<Vec<Node<Self::Point>>> {
        let _ = (x, order);
        None
    }

    /// The discrete state of x.
    fn state(&self, x: &Self::Point) -> usize {
        let _ = x;
        0
    }

    /// Density of [`sample`](Domain::sample) with respect to μ at x ∈ Ω; 0 outside.
    fn density(&self, x: &Self::Point) -> f64;

    /// A random point by the domain's map; uniform where μ(Ω) is finite. `weight` is 1/density.
    #[inline]
    fn sample<S: Sampler>(&self, u: &mut S) -> Node<Self::Point> {
        let states = self.states();
        let state = if states == 1 { 0 } else { ((u.next_1d() * states as f64) as usize).min(states - 1) };
        let node = self.place(state, || u.next_1d());
        Node { point: node.point, weight: node.weight * states as f64 }
    }

    /// A tensor rule with `panels` equal panels of `order` Gauss–Legendre nodes along each coordinate of the map, for every state; as many equidistant nodes
    /// along periodic coordinates.
    fn rule(&self, panels: usize, order: usize) -> Vec<Node<Self::Point>> {
        let unit = composite_unit_rule(panels, order);
        let n = unit.len();
        let equidistant = |k: usize| Node { point: (k as f64 + 0.5) / n as f64, weight: 1.0 / n as f64 };
        let count = n.pow(self.dimension() as u32);
        let node = |state: usize, index: usize| {
            let (mut rest, mut weight, mut axis) = (index, 1.0, 0);
            let placed = self.place(state, || {
                let k = rest % n;
                let along = if self.is_periodic(axis) { equidistant(k) } else { unit[k] };
                rest /= n;
                axis += 1;
                weight *= along.weight;
                along.point
            });
            Node { point: placed.point, weight: placed.weight * weight }
        };
        (0..self.states()).flat_map(|s| (0..count).map(move |i| (s, i))).map(|(s, i)| node(s, i)).collect()
    }
}
