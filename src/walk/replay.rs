//! One walk again, vertex by vertex.

use super::backward::{Backward, start};
use super::driver::{Driver, End};
use super::observer::{Recorder, Trace};
use super::{Ending, Scoring, Walk};
use crate::detector::Detector;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{Operator, Transition};
use crate::sampling::{Sampler, Sequence};
use crate::source::Source;
use crate::value::{Value, Weight};

/// One walk again, recorded.
pub(super) fn replay<G, K, D, C, E, Q>(
    walk: &Walk<C, E, Q>,
    equation: &Equation<G, K>,
    detector: &D,
    cell: usize,
    replicate: u32,
    index: u64,
) -> (Option<Error>, Trace<K::Point, K::Weight>)
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    replay_on(walk, equation, detector, (cell, index), walk.sequence.point(cell as u64, replicate, index))
}

/// The walk that a point makes, recorded as number `index` of `cell`.
pub(super) fn replay_on<G, K, D, C, E, Q, S>(
    walk: &Walk<C, E, Q>,
    equation: &Equation<G, K>,
    detector: &D,
    (cell, index): (usize, u64),
    u: S,
) -> (Option<Error>, Trace<K::Point, K::Weight>)
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    D: Detector<Point = G::Point>,
    S: Sampler,
{
    let mut recorder = Recorder { vertices: Vec::new(), fault: None, cell, walk: index };
    let mut lane = [start(detector, cell, 0, u)];
    let mut outcome = (G::Value::ZERO, End::TooLong);
    let mut errand = Backward { equation, scoring: &walk.scoring };
    let driver = Driver { kernel: equation.kernel(), ending: &walk.ending, max_steps: walk.max_steps };
    driver.walk(&mut errand, &mut lane, &mut Vec::new(), &mut recorder, |walk| outcome = (walk.score, walk.end));
    (recorder.fault, Trace { vertices: recorder.vertices, score: outcome.0, end: outcome.1 })
}
