//! One of the two walks, vertex by vertex.

use crate::kernel::{Density, TransitionPdf};
use crate::sampling::{Purpose, Sampler};
use crate::value::Weight;
use crate::walk::driver::{At, Driver, End, Errand, Lane};
use crate::walk::forward::Carried;
use crate::walk::{Arrival, Ending, Observer, Visit};

/// A vertex, with what multiple importance sampling needs of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex<X, L> {
    pub(super) state: X,
    /// α of theory (4.7.3)
    pub(super) load: L,
    /// 1/density of the walk's own arrival, survival included; 0 for a start that no other walk can find. NaN if the walk does not state it
    pub(super) rarity: f64,
    /// whether the arrival has a density: walks cannot be joined along a Dirac part, whose edges count as density 1 in both directions
    pub(super) regular: bool,
    /// whether walks can be joined by the edge before this vertex, once the walk goes on
    pub(super) joinable: bool,
    /// survival probability here, as far as it depends on the place alone
    pub(super) survival: f64,
    /// density with which a walk in the opposite direction arrives here from the next vertex
    pub(super) reverse: f64,
    /// Σ_k Π (reverse/own)^β over the strategies that leave this vertex, k − 1 before it, … to the other walk
    pub(super) sum: f64,
}

impl<X, L> Vertex<X, L> {
    /// reverse density/own density.
    #[inline]
    pub(super) fn ratio(&self, reverse: f64) -> f64 {
        reverse * self.rarity
    }
}

/// What a walk carries.
pub(super) trait Burden<W: Weight>: Copy {
    fn carry(&self, reciprocal: f64, step: W) -> Self;
    /// |α|/|α at the start|, which does not depend on the units of h and g
    fn size(&self) -> f64;
    fn is_finite(&self) -> bool;
}

/// A matrix, backward.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matrix<W> {
    pub(super) weight: W,
    pub(super) start: f64,
}

impl<W: Weight> Burden<W> for Matrix<W> {
    #[inline]
    fn carry(&self, reciprocal: f64, step: W) -> Self {
        Matrix { weight: self.weight.scaled(reciprocal).then(step), ..*self }
    }
    #[inline]
    fn size(&self) -> f64 {
        let here = self.weight.norm();
        // 0/0: a walk of weight 0 is worth nothing
        if here == 0.0 { 0.0 } else { here / self.start }
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.weight.entries_finite()
    }
}

/// A value, forward.
impl<W: Weight> Burden<W> for Carried<W::Value> {
    #[inline]
    fn carry(&self, reciprocal: f64, step: W) -> Self {
        Carried::carry(self, reciprocal, step)
    }
    #[inline]
    fn size(&self) -> f64 {
        self.relative()
    }
    #[inline]
    fn is_finite(&self) -> bool {
        Carried::is_finite(self)
    }
}

/// P at a place, 1 where it depends on more: weights of techniques may be functions of the path alone, and need not be more than that.
#[inline]
pub(super) fn survival_at<K: TransitionPdf, E: Ending<K>>(kernel: &K, ending: &E, x: &K::Point) -> f64 {
    ending.survival_at(kernel, x).unwrap_or(1.0)
}

/// Keeps every vertex.
struct Keeper<'a, K: TransitionPdf, E, L> {
    kernel: &'a K,
    ending: &'a E,
    start: f64,
    vertices: &'a mut Vec<Vertex<K::Point, L>>,
    poisoned: bool,
}

impl<K: TransitionPdf, E: Ending<K>, L: Burden<K::Weight>> Errand<K> for Keeper<'_, K, E, L> {
    type Load = L;
    type Score = ();
    const NOTHING: () = ();

    #[inline]
    fn carry(load: &L, reciprocal: f64, step: K::Weight) -> L {
        load.carry(reciprocal, step)
    }

    #[inline]
    fn magnitude(load: &L) -> f64 {
        load.size()
    }

    #[inline]
    fn is_sound(load: &L) -> bool {
        load.is_finite()
    }

    #[inline]
    fn arrival<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &mut self,
        at: At<'_, K::Point, L, S>,
        arrival: Arrival<K::Point, L>,
        (): &mut (),
        _: &mut O,
    ) {
        let state = at.visit.point;
        let survived = self.vertices.last().map_or(1.0, |v| v.survival);
        let (pdf, regular) = match (arrival.density(), arrival) {
            (_, Arrival::Start) => (self.start, true),
            (Density::Singular, _) => (survived, false),
            (Density::Unstated, _) => (f64::NAN, true),
            (_, Arrival::Step { from, .. }) => (survived * self.kernel.pdf(&from, &state), true),
        };
        // a step that denies its own arrival breaks the law of its density: its scores must not pass for 0
        let rarity = if pdf > 0.0 { 1.0 / pdf } else { f64::NAN };
        let survival = survival_at(self.kernel, self.ending, &state);
        let joinable = regular;
        self.vertices.push(Vertex { state, load: at.visit.weight, rarity, regular, joinable, survival, reverse: f64::NAN, sum: f64::NAN });
    }

    #[inline]
    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(&mut self, _: At<'_, K::Point, L, S>, (): &mut (), _: &mut O) {}

    #[inline]
    fn end<O: Observer<K::Point, K::Weight>>(&mut self, _: usize, _: &Visit<K::Point, L>, (): &mut (), _: &mut O) {}

    fn poison(&mut self, _: usize, (): &mut ()) {
        self.poisoned = true;
    }
}

/// Vertices of both walks take turns in the blocks of the cube.
struct Turns<'a, S> {
    u: &'a mut S,
    offset: u64,
}

impl<S: Sampler> Sampler for Turns<'_, S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        self.u.next_1d()
    }
    #[inline]
    fn next_2d(&mut self) -> [f64; 2] {
        self.u.next_2d()
    }
    #[inline]
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        self.u.seek(2 * vertex + self.offset, purpose);
    }
}

/// How a walk ended that has no score.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    TooLong,
    /// a survival probability or a load that is none
    Lost,
}

/// The walk from `start`, a state with its load and density, in the blocks of one parity; returns its steps, and why it has no score.
pub(super) fn walk<K, E, L, S>(
    driver: &Driver<'_, K, E>,
    (state, load, pdf): (K::Point, L, f64),
    (u, offset): (&mut S, u64),
    vertices: &mut Vec<Vertex<K::Point, L>>,
    ranks: &mut Vec<u32>,
) -> (u64, Option<Fault>)
where
    K: TransitionPdf,
    E: Ending<K>,
    L: Burden<K::Weight>,
    S: Sampler,
{
    vertices.clear();
    let mut keeper = Keeper { kernel: driver.kernel, ending: driver.ending, start: pdf, vertices, poisoned: false };
    let mut end = End::Roulette;
    let steps = driver.walk(&mut keeper, &mut [Lane::new(0, state, load, Turns { u, offset })], ranks, &mut (), |walk| end = walk.end);
    let too_long = (end == End::TooLong).then_some(Fault::TooLong);
    (steps, if keeper.poisoned { Some(Fault::Lost) } else { too_long })
}
