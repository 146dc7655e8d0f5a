//! The kernel tally, also called expected-value tally.
//!
//! ```text
//! f̂(x) = g(x) + Σ_n K(x, Z_n) W_n                                                                              theory (4.6.2)
//! ```
//!
//! Derivation: E Σ W_n δ(Z_n) = f, and T f is the integral of K(x, ·) against it. Unbiased at every x, without bins, as smooth as K; costs one
//! evaluation of K a vertex and point. The variance is finite if that of Σ W_n K(x, Z_n) is: a bounded K suffices, |x − y|^(−α) needs α < ½. Reference: Lux,
//! Koblinger (1991), §6.II; Keller, *Instant radiosity* (1997), in rendering: every vertex is a light.

use super::{PlanOf, Tally, source_at};
use crate::detector::Points;
use crate::domain::Point;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasAdjoint, Kernel, Operator};
use crate::source::{Emit, Source};
use crate::statistics::Bias;
use crate::value::Weight;
use crate::walk::Connections;

/// Σ W_n K(x, Z_n) at points x of any domain.
#[derive(Clone, Debug, PartialEq)]
pub struct KernelTally<X>(Points<X>);

impl<X: Point> KernelTally<X> {
    /// At these points.
    #[must_use]
    pub fn at(points: &[X]) -> Self {
        KernelTally(Points(points.to_vec()))
    }
}

impl<G, K> Tally<G, K> for KernelTally<G::Point>
where
    G: Emit<State = <G as Source>::Point>,
    K: Kernel + HasAdjoint + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    type Point = G::Point;
    type Detector = Points<G::Point>;
    type Scoring = Connections;

    fn plan(&self, equation: &Equation<G, K>, _: u64) -> Result<PlanOf<G, K, Self>, Error> {
        let points = self.0.0.clone();
        let known = source_at(equation.source(), &points)?;
        let (detector, scoring) = (self.0.clone(), Connections);
        Ok(super::Plan { points, detector, scoring, known, known_error: 0.0, matrix: None, bias: Bias::None })
    }
}
