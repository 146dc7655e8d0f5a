//! Next-event estimation.
//!
//! ```text
//! f = g + h,  h = Tg + Th:     Y = g(X₀) + Σ_{n=0}^{N} W_n K(X_n, ζ_n) g(ζ_n) / q(ζ_n given X_n)          theory (4.4.1), (4.4.2)
//! ```
//!
//! Derivation: at every vertex one point ζ of the source estimates (Tg)(X_n) = ∫ K(X_n, ζ) g(ζ) dμ(ζ); the walk carries on for Th. Scored at
//! all N + 1 vertices, the last included, *before* the survival test (theory (2.2.4)); g hit by the walk itself is not scored again.
//!
//! Wins when g is concentrated where q finds it. Fails when K(x, ·) is peaked where q is not (theory (4.4.3)): use MIS. Arrivals along a Dirac part
//! of the kernel are scored by the walk, since no ζ can find them. Reference: Coveyou, Cain, Yost, *Adjoint and importance in Monte Carlo
//! application*, NSE 27 (1967) 219; Kajiya, *The rendering equation*, SIGGRAPH 1986.

use super::{Arrival, Scoring, Visit, collide};
use crate::equation::Equation;
use crate::kernel::{Density, Kernel, Operator};
use crate::sampling::Sampler;
use crate::source::{SampleSource, Source};
use crate::value::{Value, Weight};
use crate::walk::Observer;

/// Score K(x, ζ) g(ζ)/q at every vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NextEvent;

impl<G, K> Scoring<G, K> for NextEvent
where
    G: SampleSource,
    K: Kernel + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    const EVALUATIONS: u64 = 1;

    #[inline]
    fn arrival<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        arrival: Arrival<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        match arrival.density() {
            Density::Known(_) | Density::Deferred(_) => {}
            Density::Singular => *score += collide(equation, visit, 1.0, observer),
            Density::Unstated => *score += unstated::<G, K, O>(visit, arrival, "next-event estimation", observer),
        }
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        u: &mut S,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        if let Some(event) = equation.source().sample_for(&visit.point, u) {
            *score += connect(equation, visit, &event.point, event.weight, observer);
        }
    }
}

/// factor · W K(x, ζ) g(ζ).
#[inline]
pub(super) fn connect<G, K, O>(
    equation: &Equation<G, K>,
    visit: &Visit<K::Point, K::Weight>,
    event: &K::Point,
    factor: f64,
    observer: &mut O,
) -> G::Value
where
    G: SampleSource,
    K: Kernel + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    O: Observer<K::Point, K::Weight>,
{
    let k = edge(equation.kernel(), &visit.point, event, observer);
    along(equation, visit, (event, k), factor, observer)
}

/// K(x, ζ).
#[inline]
pub(super) fn edge<K: Kernel, O: Observer<K::Point, K::Weight>>(kernel: &K, x: &K::Point, event: &K::Point, observer: &mut O) -> K::Weight {
    let k = kernel.eval(x, event);
    observer.kernel(x, event, &k);
    k
}

/// factor · W K(x, ζ) g(ζ), K being known.
#[inline]
pub(super) fn along<G, K, O>(
    equation: &Equation<G, K>,
    visit: &Visit<K::Point, K::Weight>,
    (event, k): (&K::Point, K::Weight),
    factor: f64,
    observer: &mut O,
) -> G::Value
where
    G: SampleSource,
    K: Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    O: Observer<K::Point, K::Weight>,
{
    let g = equation.source().eval(event);
    observer.source(event, &g);
    let score = visit.weight.apply(k.apply(g)).scale(factor);
    observer.score(&score);
    score
}

/// The walk cannot know whether ζ could have found this point: a NaN score, whose cause the replay names.
#[cold]
pub(super) fn unstated<G, K, O>(
    visit: &Visit<K::Point, K::Weight>,
    arrival: Arrival<K::Point, K::Weight>,
    needed_by: &'static str,
    observer: &mut O,
) -> G::Value
where
    G: Source,
    K: Operator,
    O: Observer<K::Point, K::Weight>,
{
    if let Arrival::Step { from, .. } = arrival {
        observer.unstated(&from, &visit.point, needed_by);
    }
    G::Value::from_components(|_| f64::NAN)
}
