//! What you want to know about f: a value, a grid, a functional ⟨h, f⟩, a histogram.

mod bins;
mod functional;
mod points;

pub use bins::Bins;
pub use functional::Functional;
pub use points::{At, Points};

use crate::domain::Point;
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Value;

/// Where a backward walk starts, and the weight h/p₀ it starts with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<X> {
    /// X₀.
    pub point: X,
    /// W₀ = h(X₀)/p₀(X₀).
    pub weight: f64,
}

/// A set of cells, each a linear functional of f: cell j is `E[weight · f(point)]` over `start(j, u)`.
pub trait Detector: Send + Sync {
    /// States x.
    type Point: Point;
    /// One result a cell in this shape: a single one, or a list.
    type Answer<T>;

    /// Number of cells.
    fn cells(&self) -> usize;

    /// Draws the start of a walk for cell `cell`.
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<Self::Point>;

    /// Largest ∫ |h| dμ over the cells, by which a bound for f at a point becomes one for ⟨h, f⟩; `None` if unknown.
    fn norm(&self) -> Option<f64> {
        None
    }

    /// Shapes the results of all cells, in order.
    fn answer<T>(&self, cells: Vec<T>) -> Self::Answer<T>;

    /// Refuses detectors without cells or with invalid numbers.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value.
    fn validate(&self) -> Result<(), Error> {
        if self.cells() == 0 { Err(Error::invalid("cells", 0.0, "a detector needs at least one cell")) } else { Ok(()) }
    }
}

/// A detector whose h can be evaluated at the states of a forward walk, which then scores in every cell it touches.
///
/// Law: with `add` summing over all births and steps of a walk, `E[Σ]` of cell j is ⟨h_j, f⟩ (theory (4.5.3)).
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be hit by forward walks",
    note = "no random walk hits a point: use `Forward::next_event()` for f at points; a detector of your own implements `Score`"
)]
pub trait Score<Z: Point, V: Value>: Detector {
    /// Whether most states touch most cells: scores are then kept as a table, not as a list.
    const EVERY_CELL: bool = false;

    /// Calls `add(j, h_j(z) load)` for every cell j where h_j(z) ≠ 0. `u` is for detectors that look from a random place, such as a lens.
    fn score<S: Sampler>(&self, z: &Z, load: V, u: &mut S, add: impl FnMut(usize, V));

    /// Why a score at z is NaN, where it is no accident: it is refused, not left out.
    fn refusal(&self, z: &Z) -> Option<&'static str> {
        let _ = z;
        None
    }
}

/// A detector whose points can be drawn as seen from a state of a forward walk: what its next event is connected with.
///
/// Law: `E[Σ weight · φ(cell, point)] = Σ_j ∫ h_j(x) φ(j, x) dμ(x)` over what `see` is given, for every φ with K(x, z) ≠ 0.
#[diagnostic::on_unimplemented(
    message = "points of `{Self}` cannot be drawn",
    note = "the next event of a forward walk is a point of the detector: implement `SampleDetector`, or use `Forward::new()`"
)]
pub trait SampleDetector<Z: Point>: Detector {
    /// Whether every call reaches every cell: scores are then kept as a table, not as a list.
    const EVERY_CELL: bool = false;

    /// Calls `see(j, η)` with points η of cells j, their `weight` h_j/r (theory (4.5.5)).
    fn sample_for<S: Sampler>(&self, z: &Z, u: &mut S, see: impl FnMut(usize, Start<Self::Point>));
}

/// A detector that states the density of its starts, so that forward walks may end at it.
///
/// Law: `start(j, u).weight` = h_j/p₀ at its point, and for every set B, `∫_B start_pdf(j, x) dμ(x) = P(start(j, u).point ∈ B)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not state the density of its starts",
    note = "bidirectional walks weigh the strategies of a path by their densities: implement `StartPdf`"
)]
pub trait StartPdf: Detector {
    /// Whether forward walks can end at a cell: not if all are points.
    const EXTENDED: bool = true;

    /// p₀(x) of cell `cell`; infinite for points, which no forward walk can find.
    fn start_pdf(&self, cell: usize, x: &Self::Point) -> f64;

    /// h of cell `cell` at x, where p₀ is finite.
    fn importance(&self, cell: usize, x: &Self::Point) -> f64;

    /// Calls `each` for all cells whose h does not vanish at x, and perhaps for others.
    fn near(&self, x: &Self::Point, each: impl FnMut(usize)) {
        let _ = x;
        (0..self.cells()).for_each(each);
    }
}
