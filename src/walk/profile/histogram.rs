//! Means over cells, from the collisions in them.
//!
//! ```text
//! f̂_j = (1/|B_j|) [ ∫_{B_j} g + Σ_{n ≥ 1} W_n 1(Z_n ∈ B_j) ]                                                  theory (4.6.3)
//! ```
//!
//! Unbiased for the mean over a cell, not for f at its middle: the difference is f″Δ²/24. The integral of g comes from Gauss' rule on panels
//! cut where it changes; what may be missing widens the bands, without end if g does not look integrable. What no
//! node sees (a peak between nodes, a jump within a hundredth of a cell from its end) is missed.

use super::{PlanOf, Tally, source_at};
use crate::detector::{Bins, Detector};
use crate::deterministic::quadrature::unit_rule;
use crate::domain::{Interval, Node};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasAdjoint, Operator};
use crate::source::{Emit, Source};
use crate::statistics::Bias;
use crate::value::{Value, Weight};
use crate::walk::Collided;

/// Equal cells of an interval; the points of the profile are their middles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Histogram(Bins);

impl Histogram {
    /// `cells` equal cells of `interval`.
    #[must_use]
    pub fn new(interval: impl Into<Interval>, cells: usize) -> Self {
        Histogram(Bins::new(interval, cells))
    }

    /// The cells.
    #[must_use]
    pub fn bins(&self) -> &Bins {
        &self.0
    }

    /// Mean of g over a cell, and what it may err by: panels are cut in two until both parts agree with the whole.
    fn mean<G: Source<Point = f64>>(&self, source: &G, cell: usize) -> Result<(G::Value, f64), Error> {
        let rule = unit_rule(8);
        // ∫ g and ∫ |g|
        let panel = |from: f64, width: f64| {
            let points: Vec<_> = rule.iter().map(|n| self.0.place(cell, from + width * n.point)).collect();
            let g = source_at(source, &points)?;
            let add =
                |(sum, size), (g, n): (&G::Value, &Node<f64>)| (sum + g.scale(width * n.weight), size + width * n.weight * g.magnitude());
            Ok(g.iter().zip(&rule).fold((G::Value::ZERO, 0.0), add))
        };
        let whole: (G::Value, f64) = panel(0.0, 1.0)?;
        let (mut mean, mut size, mut error, mut panels) = (G::Value::ZERO, 0.0, 0.0, 0);
        // the outermost nodes of a part, a hundredth of the panel from its ends, are still told from them
        let ends = [0.0, 1.0].map(|t| self.0.place(cell, t));
        let narrowest = (200.0 * f64::EPSILON * ends[0].abs().max(ends[1].abs()) / self.0.width()).max(f64::EPSILON);
        let mut open = vec![(0.0, 1.0, whole)];
        while let Some((from, width, coarse)) = open.pop() {
            let near = SPLIT * width;
            let far = width - near;
            let [a, b] = [panel(from, near)?, panel(from + near, far)?];
            let change = (a.0 + b.0 - coarse.0).magnitude();
            let settled = change <= TOLERANCE * whole.1.max(size);
            panels += 1;
            if !settled && width > narrowest && panels < PANELS {
                open.extend([(from + near, far, b), (from, near, a)]);
            } else {
                (mean, size) = (mean + a.0 + b.0, size + a.1 + b.1);
                error += if settled { change } else { SINGULAR * change };
            }
        }
        error += TOLERANCE * size;
        Ok((mean, if error <= UNSETTLED * size { error } else { f64::INFINITY }))
    }
}

/// Panels are cut here: in the middle no rule has a node near, and a jump there would go unseen.
const SPLIT: f64 = 0.45;
/// Change of the integral by cutting a panel, relative to ∫ |g|, that needs no more cuts.
const TOLERANCE: f64 = 1e-10;
/// Panels of a cell.
const PANELS: usize = 1 << 12;
/// Error left in a narrowest panel over the last change, 1/(0.55^{α−1} − 1) for |x|^{−α}, up to α = 0.9.
const SINGULAR: f64 = 17.0;
/// Relative error of a mean that is no longer known: g may not be integrable.
const UNSETTLED: f64 = 0.1;

impl<G, K> Tally<G, K> for Histogram
where
    G: Emit<State = f64> + Source<Point = f64>,
    K: HasAdjoint + Operator<Point = f64>,
    K::Weight: Weight<Value = G::Value>,
{
    type Point = f64;
    type Detector = Bins;
    type Scoring = Collided;

    fn plan(&self, equation: &Equation<G, K>, _: u64) -> Result<PlanOf<G, K, Self>, Error> {
        self.0.validate()?;
        let means = (0..self.0.cells()).map(|cell| self.mean(equation.source(), cell)).collect::<Result<Vec<_>, Error>>()?;
        let (known, errors): (Vec<_>, Vec<_>) = means.into_iter().unzip();
        let known_error = errors.into_iter().fold(0.0, f64::max);
        let points = (0..self.0.cells()).map(|cell| self.0.centre(cell)).collect();
        let bias = Bias::CellMeans { width: self.0.width() };
        Ok(super::Plan { points, detector: self.0, scoring: Collided, known, known_error, matrix: None, bias })
    }
}
