//! A backward and a forward walk, and what each is to the other.

use super::optimal::Tuned;
use super::path::{Fault, Matrix, Vertex, survival_at, walk};
use super::weights::{Side, accumulate, weight};
use super::{Beyond, Connect, Meet, Strategies};
use crate::equation::Equation;
use crate::error::Error;
use crate::estimator::{Estimator, Score};
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::sampling::{Purpose, Sampler};
use crate::source::{EmitPdf, Source};
use crate::value::{Value, Weight};
use crate::walk::driver::Driver;
use crate::walk::forward::Carried;
use crate::walk::{Ending, Heuristic};

/// The contribution of one strategy to one pair of walks.
pub(super) struct Joined<V> {
    /// Vertices from the source.
    pub(super) s: usize,
    /// Vertices from the detector.
    pub(super) t: usize,
    /// where it scores
    pub(super) cell: usize,
    pub(super) contribution: V,
    pub(super) weight: f64,
}

/// Both walks, and room for the driver; reused from pair to pair.
#[derive(Debug)]
pub struct PairMemory<X, W, Z, V> {
    pub(super) eye: Vec<Vertex<X, Matrix<W>>>,
    pub(super) light: Vec<Vertex<Z, Carried<V>>>,
    ranks: Vec<u32>,
}

impl<X, W, Z, V> Default for PairMemory<X, W, Z, V> {
    fn default() -> Self {
        PairMemory { eye: Vec::new(), light: Vec::new(), ranks: Vec::new() }
    }
}

/// What a pair of walks costs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    pub(super) steps: u64,
    pub(super) joins: u64,
}

/// Bidirectional walks bound to an equation and a detector; see [`Query::bidirectional`](crate::Query::bidirectional).
#[derive(Debug)]
pub struct PairEstimator<'a, G: Source, K: HasAdjoint, D, E, F> {
    pub(super) equation: &'a Equation<G, K>,
    pub(super) adjoint: K::Adjoint,
    pub(super) detector: &'a D,
    pub(super) endings: (E, F),
    pub(super) heuristic: Heuristic,
    pub(super) strategies: Strategies,
    /// forward walks that may end at a cell, for each backward walk that starts there: with several, they score wherever they end
    pub(super) share: u64,
    pub(super) max_steps: u64,
    /// of every cell; none without a pilot
    pub(super) tuned: Vec<Tuned<G::Value>>,
}

/// The memory of a pair.
pub(super) type Memory<G, K> =
    PairMemory<<G as Source>::Point, <K as Operator>::Weight, <<K as HasAdjoint>::Adjoint as Operator>::Point, <G as Source>::Value>;

impl<G, K, D, E, F> PairEstimator<'_, G, K, D, E, F>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
    E: Ending<K>,
    F: Ending<K::Adjoint>,
{
    /// Both walks of the point `u`, ready to be joined.
    pub(super) fn walk<S: Sampler>(&self, cell: usize, u: &mut S, memory: &mut Memory<G, K>) -> (u64, Option<Fault>) {
        let PairMemory { eye, light, ranks } = memory;
        let kernel = self.equation.kernel();
        u.seek(0, Purpose::Start);
        let start = self.detector.start(cell, u);
        let load = Matrix { weight: K::Weight::ONE.scaled(start.weight), start: start.weight.abs() };
        let pdf = self.detector.start_pdf(cell, &start.point) / self.share as f64;
        let driver = Driver { kernel, ending: &self.endings.0, max_steps: self.max_steps };
        let (back, fault) = walk(&driver, (start.point, load, pdf), (u, 0), eye, ranks);
        // nothing else reads the first vertex's next event
        u.seek(0, Purpose::Event);
        let birth = self.equation.source().emit(u);
        let load = Carried::born(birth.weight);
        let pdf = self.equation.source().emit_pdf(&birth.point);
        let driver = Driver { kernel: &self.adjoint, ending: &self.endings.1, max_steps: self.max_steps };
        let (forth, other) = walk(&driver, (birth.point, load, pdf), (u, 1), light, ranks);
        self.retrace(memory);
        (back + forth, fault.or(other))
    }

    /// Densities of arrival in the opposite direction, where the walk itself tells them.
    fn retrace(&self, memory: &mut Memory<G, K>) {
        let PairMemory { eye, light, .. } = memory;
        let ahead = 1 + usize::from(K::LOOKS_BEYOND);
        for i in 0..eye.len().saturating_sub(ahead) {
            let from = eye.get(i + 2).map_or(Beyond::Start, |v| Beyond::Own(&v.state));
            eye[i].reverse = self.eye_reverse(&eye[i], &eye[i + 1], eye[i + ahead].regular, from);
        }
        for j in 0..light.len().saturating_sub(ahead) {
            let from = light.get(j + 2).map_or(Beyond::Start, |v| Beyond::Own(&v.state));
            let x = self.equation.kernel().backward(&light[j + 1].state, from);
            light[j].reverse = self.light_reverse(&light[j], &light[j + 1], light[j + ahead].regular, &x);
        }
        if K::LOOKS_BEYOND {
            mark(eye);
            mark(light);
        }
        let known = |n: usize| n.saturating_sub(ahead);
        let (n, m) = (known(eye.len()), known(light.len()));
        accumulate(self.heuristic, &mut eye[..n]);
        accumulate(self.heuristic, &mut light[..m]);
    }

    /// Density with which a forward walk that comes from beyond `next` arrives at the eye vertex before it, if it has one (`regular`).
    #[inline]
    fn eye_reverse(
        &self,
        vertex: &Vertex<K::Point, Matrix<K::Weight>>,
        next: &Vertex<K::Point, Matrix<K::Weight>>,
        regular: bool,
        from: Beyond<'_, K::Point, G::State>,
    ) -> f64 {
        let kernel = self.equation.kernel();
        let z = kernel.forward(&next.state, from);
        let survival = survival_at(&self.adjoint, &self.endings.1, &z);
        if regular { survival * self.adjoint.pdf(&z, &kernel.forward(&vertex.state, Beyond::Own(&next.state))) } else { survival }
    }

    /// Density with which a backward walk that is at x, the place of `next`, arrives at the light vertex before it, if it has one (`regular`).
    #[inline]
    fn light_reverse(
        &self,
        vertex: &Vertex<G::State, Carried<G::Value>>,
        next: &Vertex<G::State, Carried<G::Value>>,
        regular: bool,
        x: &K::Point,
    ) -> f64 {
        let kernel = self.equation.kernel();
        let survival = survival_at(kernel, &self.endings.0, x);
        if regular { survival * kernel.pdf(x, &kernel.backward(&vertex.state, Beyond::Own(&next.state))) } else { survival }
    }

    /// The eye walk's first t vertices, as seen from where it is joined.
    #[inline]
    pub(super) fn eye_side<'m>(
        &self,
        eye: &'m [Vertex<K::Point, Matrix<K::Weight>>],
        last: f64,
        from: Beyond<'_, K::Point, G::State>,
    ) -> Side<'m, K::Point, Matrix<K::Weight>> {
        let before = match eye {
            [.., vertex, next] if K::LOOKS_BEYOND => Some(self.eye_reverse(vertex, next, true, from)),
            _ => None,
        };
        Side { path: eye, last, before }
    }

    /// The forward walk's first s vertices, as seen from where it is joined; x is what its last vertex is to the backward walk.
    #[inline]
    pub(super) fn light_side<'m>(
        &self,
        light: &'m [Vertex<G::State, Carried<G::Value>>],
        last: f64,
        x: &K::Point,
    ) -> Side<'m, G::State, Carried<G::Value>> {
        let before = match light {
            [.., vertex, next] if K::LOOKS_BEYOND => Some(self.light_reverse(vertex, next, true, x)),
            _ => None,
        };
        Side { path: light, last, before }
    }

    #[inline]
    pub(super) fn weigh(&self, eye: &Side<'_, K::Point, Matrix<K::Weight>>, light: &Side<'_, G::State, Carried<G::Value>>) -> f64 {
        match self.strategies {
            Strategies::One { .. } => 1.0,
            Strategies::All | Strategies::Order(_) => weight(self.heuristic, eye, light),
        }
    }

    /// The strategies of one point of the cube, and what they cost.
    #[inline]
    pub(super) fn pair<S: Sampler>(
        &self,
        cell: usize,
        u: &mut S,
        memory: &mut Memory<G, K>,
        each: impl FnMut(Joined<G::Value>),
    ) -> Result<Cost, Fault> {
        let (steps, fault) = self.walk(cell, u, memory);
        fault.map_or_else(|| Ok(Cost { steps, joins: self.joined(cell, u, memory, each) }), Err)
    }
}

/// Kernels that look beyond have Dirac parts at places, not along edges: nothing is joined to such a place either.
fn mark<X, L>(path: &mut [Vertex<X, L>]) {
    for i in 1..path.len() {
        path[i - 1].joinable = path[i - 1].regular && path[i].regular;
    }
}

impl<G, K, D, E, F> Estimator for PairEstimator<'_, G, K, D, E, F>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
    E: Ending<K>,
    F: Ending<K::Adjoint>,
{
    type Value = G::Value;
    type Scratch = Memory<G, K>;

    fn cells(&self) -> usize {
        self.detector.cells()
    }

    #[inline]
    fn score<S: Sampler>(&self, cell: usize, u: &mut S, memory: &mut Memory<G, K>) -> Score<G::Value> {
        let mut value = G::Value::ZERO;
        match self.pair(cell, u, memory, |j| value += j.contribution.scale(j.weight)) {
            Ok(Cost { steps, joins }) => Score { value: value + self.controlled(cell, memory), steps, evaluations: steps + joins },
            Err(_) => Score { value: G::Value::from_components(|_| f64::NAN), steps: 0, evaluations: 0 },
        }
    }

    fn explain<S: Sampler>(&self, cell: usize, walk: u64, u: &mut S) -> Option<Error> {
        let mut memory = Memory::<G, K>::default();
        let (_, fault) = self.walk(cell, u, &mut memory);
        self.fault(cell, walk, fault, &memory)
    }
}
