//! The errand of backward walks: a matrix W_n, and a scoring rule that applies it to g.

use super::driver::{At, Errand, Lane};
use super::observer::Observer;
use super::scoring::{Arrival, Scoring, Visit};
use crate::detector::Detector;
use crate::equation::Equation;
use crate::kernel::{Operator, Series};
use crate::sampling::{Purpose, Sampler};
use crate::source::Source;
use crate::value::{Value, Weight};

/// Scores g along the way.
pub(super) struct Backward<'a, G, K, C> {
    pub(super) equation: &'a Equation<G, K>,
    pub(super) scoring: &'a C,
}

impl<G, K, C> Errand<K> for Backward<'_, G, K, C>
where
    G: Source,
    K: Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
{
    type Load = K::Weight;
    type Score = G::Value;
    const NOTHING: G::Value = G::Value::ZERO;

    #[inline]
    fn carry(load: &K::Weight, reciprocal: f64, step: K::Weight) -> K::Weight {
        load.scaled(reciprocal).then(step)
    }

    #[inline]
    fn magnitude(load: &K::Weight) -> f64 {
        load.norm()
    }

    #[inline]
    fn is_sound(load: &K::Weight) -> bool {
        load.entries_finite()
    }

    #[inline]
    fn arrival<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &mut self,
        at: At<'_, K::Point, K::Weight, S>,
        arrival: Arrival<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        observer.vertex(&at.visit.point, &at.visit.weight);
        self.scoring.arrival(self.equation, at.visit, arrival, score, observer);
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &mut self,
        at: At<'_, K::Point, K::Weight, S>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        self.scoring.vertex(self.equation, at.visit, at.u, score, observer);
    }

    #[inline]
    fn end<O: Observer<K::Point, K::Weight>>(
        &mut self,
        _: usize,
        visit: &Visit<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        self.scoring.end(self.equation, visit, score, observer);
    }

    fn poison(&mut self, _: usize, score: &mut G::Value) {
        *score = G::Value::from_components(|_| f64::NAN);
    }
}

/// Whether `score`, that of every walk, is what g alone scores at the start of one, and what T f adds is not known to be nothing, or to drown in its rounding.
pub(super) fn met_nothing<G, K, D, S>(equation: &Equation<G, K>, detector: &D, (cell, mut u): (usize, S), score: G::Value) -> bool
where
    G: Source,
    K: Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
    S: Sampler,
{
    u.seek(0, Purpose::Start);
    let start = detector.start(cell, &mut u);
    let own = equation.source().eval(&start.point).scale(start.weight);
    let rounding = ROUNDINGS * own.magnitude();
    if !((score - own).magnitude() <= rounding) {
        return false;
    }
    // a detector at a point draws nothing: the next start is the same
    if detector.start(cell, &mut u).point == start.point && equation.kernel().vanishes_at(&start.point) {
        return false;
    }
    // |⟨h, T f⟩| ≤ ∫|h| · sup |T f|
    let bound = || {
        let Ok(Series::Known(series)) = equation.kernel().series() else { return None };
        Some(series.truncation_bound(0, |x| equation.source().eval(x))? * detector.norm()?)
    };
    !bound().is_some_and(|b| b <= rounding)
}

/// Rounding of a mean of equal scores, relative.
const ROUNDINGS: f64 = 4.0 * f64::EPSILON;

/// A walk at its start.
#[inline]
pub(super) fn start<K, A, D, S>(detector: &D, cell: usize, walk: usize, mut u: S) -> Lane<K, A, S>
where
    K: Operator,
    A: Errand<K, Load = K::Weight>,
    D: Detector<Point = K::Point>,
    S: Sampler,
{
    u.seek(0, Purpose::Start);
    let start = detector.start(cell, &mut u);
    Lane::new(walk, start.point, K::Weight::ONE.scaled(start.weight), u)
}
