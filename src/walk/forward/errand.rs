//! The errand of forward walks: a value W_n, and a scoring rule that adds to the cells of a detector.

use super::scoring::{ForwardScoring, Seen};
use crate::detector::Detector;
use crate::equation::Equation;
use crate::kernel::{HasAdjoint, Operator};
use crate::sampling::{Purpose, Sampler};
use crate::source::Emit;
use crate::value::{Value, Weight};
use crate::walk::driver::{At, Errand, Lane};
use crate::walk::{Arrival, Observer, Visit};

/// Scores in the cells of a detector along the way: `add(walk, cell, score)`.
pub(super) struct Onward<'a, G: Emit, K, D, C, F> {
    pub(super) equation: &'a Equation<G, K>,
    pub(super) detector: &'a D,
    pub(super) scoring: &'a C,
    pub(super) add: F,
}

/// W_n = |W₀| · (W_n/|W₀|): roulette by throughput asks for |W_n|/|W₀|, which does not depend on the units of g.
#[derive(Clone, Copy, Debug)]
pub(in crate::walk) struct Carried<V> {
    /// W_n/|W₀|: no division at every vertex
    unit: V,
    birth: f64,
}

impl<V: Value> Carried<V> {
    /// W₀.
    #[inline]
    pub(in crate::walk) fn born(value: V) -> Self {
        let birth = value.magnitude();
        // a walk of weight 0 is worth nothing; what is not finite shall be seen as it is
        if birth > 0.0 && birth.is_finite() {
            Carried { unit: value.map(|v| v / birth), birth }
        } else {
            Carried { unit: value, birth: 1.0 }
        }
    }

    /// W_n.
    #[inline]
    pub(in crate::walk) fn value(&self) -> V {
        self.unit.scale(self.birth)
    }

    /// The step's weight is K†(Z_n, Z_{n+1})/π* = K(Z_{n+1}, Z_n)ᵀ/π*.
    #[inline]
    pub(in crate::walk) fn carry<W: Weight<Value = V>>(&self, reciprocal: f64, step: W) -> Self {
        Carried { unit: step.transposed().apply(self.unit.scale(reciprocal)), ..*self }
    }

    /// Whether W_n is finite.
    #[inline]
    pub(in crate::walk) fn is_finite(&self) -> bool {
        self.unit.all_finite()
    }

    /// |W_n|/|W₀|.
    #[inline]
    pub(in crate::walk) fn relative(&self) -> f64 {
        self.unit.magnitude()
    }

    #[inline]
    fn tell<Z, W: Weight<Value = V>, O: Observer<Z, W>>(&self, z: &Z, observer: &mut O) {
        observer.value(z, &self.value());
    }
}

#[inline]
fn seen<'a, G: Emit, K, D>(equation: &'a Equation<G, K>, detector: &'a D, at: &Visit<G::State, Carried<G::Value>>) -> Seen<'a, G, K, D> {
    Seen { equation, detector, visit: Visit { point: at.point, weight: at.weight.value(), survival: at.survival } }
}

impl<G, K, A, D, C, F> Errand<A> for Onward<'_, G, K, D, C, F>
where
    G: Emit,
    K: HasAdjoint<Adjoint = A>,
    K::Weight: Weight<Value = G::Value>,
    A: Operator<Point = G::State, Weight = K::Weight>,
    D: Detector,
    C: ForwardScoring<G, K, D>,
    F: FnMut(usize, usize, G::Value),
{
    type Load = Carried<G::Value>;
    /// kept by whoever adds
    type Score = ();
    const NOTHING: () = ();

    #[inline]
    fn carry(load: &Carried<G::Value>, reciprocal: f64, step: K::Weight) -> Carried<G::Value> {
        load.carry(reciprocal, step)
    }

    #[inline]
    fn magnitude(load: &Carried<G::Value>) -> f64 {
        load.relative()
    }

    #[inline]
    fn is_sound(load: &Carried<G::Value>) -> bool {
        load.is_finite()
    }

    #[inline]
    fn arrival<S: Sampler, O: Observer<A::Point, A::Weight>>(
        &mut self,
        at: At<'_, A::Point, Carried<G::Value>, S>,
        arrival: Arrival<A::Point, Carried<G::Value>>,
        (): &mut (),
        observer: &mut O,
    ) {
        at.visit.weight.tell(&at.visit.point, observer);
        at.u.seek(at.depth, Purpose::Event);
        let Onward { equation, detector, scoring, ref mut add } = *self;
        let add = |cell, score| add(at.walk, cell, score);
        scoring.arrival(seen(equation, detector, at.visit), arrival.unloaded(), at.u, observer, add);
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<A::Point, A::Weight>>(
        &mut self,
        at: At<'_, A::Point, Carried<G::Value>, S>,
        (): &mut (),
        observer: &mut O,
    ) {
        let Onward { equation, detector, scoring, ref mut add } = *self;
        scoring.vertex(seen(equation, detector, at.visit), at.u, observer, |cell, score| add(at.walk, cell, score));
    }

    #[inline]
    fn end<O: Observer<A::Point, A::Weight>>(&mut self, _: usize, _: &Visit<A::Point, Carried<G::Value>>, (): &mut (), _: &mut O) {}

    fn poison(&mut self, walk: usize, (): &mut ()) {
        (self.add)(walk, 0, G::Value::from_components(|_| f64::NAN));
    }
}

/// A walk at its birth.
#[inline]
pub(super) fn born<G, A, E, S>(source: &G, walk: usize, mut u: S) -> Lane<A, E, S>
where
    G: Emit,
    A: Operator<Point = G::State>,
    E: Errand<A, Load = Carried<G::Value>>,
    S: Sampler,
{
    u.seek(0, Purpose::Start);
    let birth = source.emit(&mut u);
    Lane::new(walk, birth.point, Carried::born(birth.weight), u)
}
