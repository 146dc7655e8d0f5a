//! What a forward walk scores.
//!
//! ```text
//! collision     Y_j = Σ_{n=0}^{N} h_j(Z_n) W_n                                                                       theory (4.5.3)
//! next event    Y_j = ⟨h_j, g⟩ + Σ_{n=0}^{N} (h_j/r)(η_n) K(η_n, Z_n) W_n,        η_n ~ r a point of the detector     theory (4.5.5)
//! ```
//!
//! Derivation: Σ W_n δ(Z_n) has the expectation f (theory (4.6.1)), and ⟨h, f⟩ = ⟨h, g⟩ + ⟨h, T f⟩. Loads W_n are values, K acts on them from the left,
//! the new point first.
//!
//! Collision wins where walks come to the detector by themselves. Next event wins where h is concentrated, and is the only way if the detector is a point:
//! with all points of a profile as the detector it is the kernel tally (theory (4.6.2)), unbiased at every x. It fails where K(η, ·) is singular at η:
//! K² must be integrable along the walk. Reference: Coveyou, Cain, Yost, *Adjoint and importance in Monte Carlo application*, NSE 27 (1967) 219.

use crate::detector::{Detector, SampleDetector, Score};
use crate::equation::Equation;
use crate::kernel::{Density, HasAdjoint, Kernel, Operator};
use crate::sampling::Sampler;
use crate::source::{Emit, Source};
use crate::value::{Value, Weight};
use crate::walk::{Arrival, Collision, NextEvent, Observer, Visit};
use std::fmt::Debug;

/// A scoring rule of forward walks; the `weight` of a [`Visit`] is the value W_n that the walk carries.
///
/// Law: with any unbiased ending, E[Σ `add(j, ·)`] = ⟨h_j, f⟩ over a walk; with a fixed depth D, = Σ_{n ≤ D} ⟨h_j, Tⁿg⟩.
pub trait ForwardScoring<G: Emit, K: HasAdjoint, D: Detector>: Copy + Debug + Send + Sync + 'static {
    /// Whether a vertex scores in every cell: scores are then kept as a table, not as a list.
    const EVERY_CELL: bool = false;

    /// Kernel evaluations at every vertex beyond those of the steps.
    fn evaluations(&self, detector: &D) -> u64 {
        let _ = detector;
        0
    }

    /// Scored on arrival at a vertex.
    #[inline]
    fn arrival<S: Sampler, O: Observer<G::State, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        arrival: Arrival<G::State>,
        u: &mut S,
        observer: &mut O,
        add: impl FnMut(usize, G::Value),
    ) {
        let _ = (at, arrival, u, observer, add);
    }

    /// Scored at every vertex before the survival test.
    #[inline]
    fn vertex<S: Sampler, O: Observer<G::State, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        u: &mut S,
        observer: &mut O,
        add: impl FnMut(usize, G::Value),
    ) {
        let _ = (at, u, observer, add);
    }
}

/// A vertex of a forward walk, and who looks at it.
#[derive(Debug)]
pub struct Seen<'a, G: Emit, K, D> {
    /// f = g + Tf.
    pub equation: &'a Equation<G, K>,
    /// Who looks.
    pub detector: &'a D,
    /// Z_n and W_n.
    pub visit: Visit<G::State, G::Value>,
}

impl<G, K, D> ForwardScoring<G, K, D> for Collision
where
    G: Emit,
    K: HasAdjoint,
    K::Weight: Weight<Value = G::Value>,
    D: Score<G::State, G::Value>,
{
    const EVERY_CELL: bool = D::EVERY_CELL;

    #[inline]
    fn arrival<S: Sampler, O: Observer<G::State, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        _: Arrival<G::State>,
        u: &mut S,
        observer: &mut O,
        mut add: impl FnMut(usize, G::Value),
    ) {
        let Visit { point, weight, .. } = at.visit;
        at.detector.score(&point, weight, u, |cell, score| {
            observer.refused(&point, cell, || at.detector.refusal(&point));
            observer.tally(&point, cell, &score);
            add(cell, score);
        });
    }
}

/// Collisions after at least one step: ⟨h, T f⟩, for those who know ⟨h, g⟩.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Collided;

impl<G, K, D> ForwardScoring<G, K, D> for Collided
where
    G: Emit,
    K: HasAdjoint,
    K::Weight: Weight<Value = G::Value>,
    D: Score<G::State, G::Value>,
{
    const EVERY_CELL: bool = D::EVERY_CELL;

    #[inline]
    fn arrival<S: Sampler, O: Observer<G::State, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        arrival: Arrival<G::State>,
        u: &mut S,
        observer: &mut O,
        add: impl FnMut(usize, G::Value),
    ) {
        if matches!(arrival, Arrival::Step { .. }) {
            Collision.arrival(at, arrival, u, observer, add);
        }
    }
}

/// Connections with points of the detector, (h/r)(η) K(η, Z_n) W_n: ⟨h, T f⟩, for those who know ⟨h, g⟩.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Connections;

impl<G, K, D> ForwardScoring<G, K, D> for Connections
where
    G: Emit<State = <G as Source>::Point>,
    K: Kernel + HasAdjoint + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: SampleDetector<G::Point, Point = G::Point>,
{
    const EVERY_CELL: bool = D::EVERY_CELL;

    fn evaluations(&self, detector: &D) -> u64 {
        if D::EVERY_CELL { detector.cells() as u64 } else { 1 }
    }

    #[inline]
    fn arrival<S: Sampler, O: Observer<G::Point, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        arrival: Arrival<G::Point>,
        _: &mut S,
        observer: &mut O,
        mut add: impl FnMut(usize, G::Value),
    ) {
        let Arrival::Step { from, .. } = arrival else { return };
        // no event can find what a Dirac part of the kernel scores: a NaN score, whose cause the replay names
        match arrival.density() {
            Density::Known(_) | Density::Deferred(_) => return,
            Density::Singular => observer.singular(&from, &at.visit.point, "forward next-event estimation"),
            Density::Unstated => observer.unstated(&from, &at.visit.point, "forward next-event estimation"),
        }
        add(0, G::Value::from_components(|_| f64::NAN));
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<G::Point, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        u: &mut S,
        observer: &mut O,
        mut add: impl FnMut(usize, G::Value),
    ) {
        let Visit { point, weight, .. } = at.visit;
        at.detector.sample_for(&point, u, |cell, eta| {
            let k = at.equation.kernel().eval(&eta.point, &point);
            observer.kernel(&eta.point, &point, &k);
            let score = k.apply(weight).scale(eta.weight);
            observer.tally(&point, cell, &score);
            add(cell, score);
        });
    }
}

/// [`Connections`], and ⟨h, g⟩ from points of the detector.
impl<G, K, D> ForwardScoring<G, K, D> for NextEvent
where
    G: Emit<State = <G as Source>::Point>,
    K: Kernel + HasAdjoint + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: SampleDetector<G::Point, Point = G::Point>,
{
    const EVERY_CELL: bool = D::EVERY_CELL;

    fn evaluations(&self, detector: &D) -> u64 {
        <Connections as ForwardScoring<G, K, D>>::evaluations(&Connections, detector)
    }

    #[inline]
    fn arrival<S: Sampler, O: Observer<G::Point, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        arrival: Arrival<G::Point>,
        u: &mut S,
        observer: &mut O,
        mut add: impl FnMut(usize, G::Value),
    ) {
        if matches!(arrival, Arrival::Step { .. }) {
            return Connections.arrival(at, arrival, u, observer, add);
        }
        let z = at.visit.point;
        at.detector.sample_for(&z, u, |cell, eta| {
            let g = at.equation.source().eval(&eta.point);
            observer.source(&eta.point, &g);
            let score = g.scale(eta.weight);
            observer.tally(&z, cell, &score);
            add(cell, score);
        });
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<G::Point, K::Weight>>(
        &self,
        at: Seen<'_, G, K, D>,
        u: &mut S,
        observer: &mut O,
        add: impl FnMut(usize, G::Value),
    ) {
        Connections.vertex(at, u, observer, add);
    }
}
