//! Means over cells, from the collisions in them.
//!
//! ```text
//! f̂_j = (1/|B_j|) [ ∫_{B_j} g + Σ_{n ≥ 1} W_n 1(Z_n ∈ B_j) ]                                                  theory (4.6.3)
//! ```
//!
//! Unbiased for the mean over a cell, not for f at its middle: the difference is f″Δ²/24. The integral of g comes from two Gauss rules, whose difference
//! widens the bands.

use super::{PlanOf, Tally, source_at};
use crate::detector::{Bins, Detector};
use crate::deterministic::quadrature::composite_unit_rule;
use crate::domain::Interval;
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

    /// Means of g over the cells by a composite rule.
    fn means<G: Source<Point = f64>>(&self, source: &G, panels: usize, order: usize) -> Result<Vec<G::Value>, Error> {
        let rule = composite_unit_rule(panels, order);
        let mean = |cell: usize| {
            let points: Vec<_> = rule.iter().map(|n| self.0.place(cell, n.point)).collect();
            let g = source_at(source, &points)?;
            Ok(g.iter().zip(&rule).fold(G::Value::ZERO, |sum, (g, n)| sum + g.scale(n.weight)))
        };
        (0..self.0.cells()).map(mean).collect()
    }
}

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
        let known = self.means(equation.source(), 2, 8)?;
        let other = self.means(equation.source(), 3, 5)?;
        let known_error = known.iter().zip(&other).map(|(a, b)| (*a - *b).magnitude()).fold(0.0, f64::max);
        let points = (0..self.0.cells()).map(|cell| self.0.centre(cell)).collect();
        let bias = Bias::CellMeans { width: self.0.width() };
        Ok(super::Plan { points, detector: self.0, scoring: Collided, known, known_error, matrix: None, bias })
    }
}
