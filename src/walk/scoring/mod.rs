//! What a walk scores: one formula, one file.

mod absorption;
mod collision;
mod mis;
mod next_event;
mod optimal;

pub use absorption::Absorption;
pub use collision::Collision;
pub use mis::{Heuristic, Mis, Technique};
pub use next_event::NextEvent;
pub use optimal::OptimalMis;

use super::observer::Observer;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{Density, Operator};
use crate::sampling::Sampler;
use crate::source::Source;
use crate::value::{Value, Weight};
use std::fmt::Debug;

/// A vertex X_n of the walk.
#[derive(Clone, Copy, Debug)]
pub struct Visit<X, W> {
    /// X_n.
    pub point: X,
    /// W_n.
    pub weight: W,
    /// P(X_n): the probability that the *method* lets the walk go on.
    pub survival: f64,
}

/// How the walk came to a vertex.
#[derive(Clone, Copy, Debug)]
pub enum Arrival<X, W = ()> {
    /// It starts here.
    Start,
    /// By a step whose sub-density π, the method's survival included, is `pdf` (see [`density`](Arrival::density)).
    Step {
        /// X_{n−1}.
        from: X,
        /// W_{n−1}, where the rule is told.
        carried: W,
        /// NaN if unstated, infinite if singular, −P if deferred.
        pdf: f64,
    },
}

impl<X, W> Arrival<X, W> {
    /// What the step states about its density; a start counts as singular: nothing else could have produced it.
    #[inline]
    pub fn density(&self) -> Density {
        match self {
            Arrival::Start => Density::Singular,
            Arrival::Step { pdf, .. } => Density::decode(*pdf),
        }
    }

    /// The same without W_{n−1}.
    #[inline]
    pub(super) fn unloaded(self) -> Arrival<X> {
        match self {
            Arrival::Start => Arrival::Start,
            Arrival::Step { from, pdf, .. } => Arrival::Step { from, carried: (), pdf },
        }
    }
}

/// A scoring rule.
///
/// Law: with any unbiased ending, E[Σ scores] = f(X₀)·W₀; with a fixed depth D, = Σ_{n ≤ D} (Tⁿg)(X₀)·W₀.
pub trait Scoring<G: Source, K: Operator>: Copy + Debug + Send + Sync + 'static {
    /// Kernel evaluations at every vertex beyond those of the steps.
    const EVALUATIONS: u64 = 0;

    /// Scored on arrival at a vertex.
    #[inline]
    fn arrival<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        arrival: Arrival<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        let _ = (equation, visit, arrival, score, observer);
    }

    /// Scored at every vertex before the survival test.
    #[inline]
    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        u: &mut S,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        let _ = (equation, visit, u, score, observer);
    }

    /// Scored where the walk ended.
    #[inline]
    fn end<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        let _ = (equation, visit, score, observer);
    }

    /// Refuses combinations that would be biased.
    ///
    /// # Errors
    /// [`Error::Invalid`] or [`Error::NeverEnds`].
    fn validate<E: super::Ending<K>>(&self, equation: &Equation<G, K>, ending: &E) -> Result<(), Error> {
        let _ = (equation, ending);
        Ok(())
    }
}

/// W g(x), reported.
#[inline]
fn collide<G, K, O>(equation: &Equation<G, K>, visit: &Visit<K::Point, K::Weight>, factor: f64, observer: &mut O) -> G::Value
where
    G: Source,
    K: Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    O: Observer<K::Point, K::Weight>,
{
    let g = evaluated(equation, visit, observer);
    scored(visit, g, factor, observer)
}

/// g(x), reported.
#[inline]
fn evaluated<G, K, O>(equation: &Equation<G, K>, visit: &Visit<K::Point, K::Weight>, observer: &mut O) -> G::Value
where
    G: Source,
    K: Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    O: Observer<K::Point, K::Weight>,
{
    let g = equation.source().eval(&visit.point);
    observer.source(&visit.point, &g);
    g
}

/// factor · W g, reported.
#[inline]
fn scored<X, W: Weight, O: Observer<X, W>>(visit: &Visit<X, W>, g: W::Value, factor: f64, observer: &mut O) -> W::Value {
    let score = visit.weight.apply(g);
    let score = if factor == 1.0 { score } else { score.scale(factor) };
    observer.score(&score);
    score
}
