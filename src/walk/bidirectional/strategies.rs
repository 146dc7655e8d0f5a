//! The strategies of a pair: where one walk hits the other's start, and the edges that join them.
//!
//! ```text
//! C_{s,t} = α^E_t K(x_{t−1}, x_t) α^L_s  (s, t ≥ 1),      C_{0,t} = α^E_t g(x_{t−1}),      C_{s,0} = h(x_0) α^L_s            theory (4.7.4)
//! ```

use super::pair::{Joined, Memory, PairEstimator};
use super::path::{Matrix, Vertex};
use super::weights::Side;
use super::{Beyond, Connect, Meet, Met};
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::sampling::{Purpose, Sampler};
use crate::source::EmitPdf;
use crate::value::{Value, Weight};
use crate::walk::Ending;
use crate::walk::forward::Carried;

/// Which strategies are summed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategies {
    /// Those of all orders: f.
    #[default]
    All,
    /// Those of paths of m edges: Tᵐ g.
    Order(u64),
    /// s vertices from the source and t from the detector, unweighted: T^{s+t−1} g, if this strategy can find every path.
    One {
        /// Vertices from the source.
        s: u64,
        /// Vertices from the detector.
        t: u64,
    },
}

impl Strategies {
    /// The s to be joined with t vertices of a backward walk, of a forward walk of `light` vertices.
    #[inline]
    pub(super) fn range(self, t: usize, light: usize) -> std::ops::Range<usize> {
        let only = |s: Option<u64>| match s {
            Some(s) if s <= light as u64 => s as usize..s as usize + 1,
            _ => 0..0,
        };
        match self {
            Strategies::All => 0..light + 1,
            Strategies::Order(m) => only(m.checked_add(1).and_then(|vertices| vertices.checked_sub(t as u64))),
            Strategies::One { s, t: own } => only((own == t as u64).then_some(s)),
        }
    }
}

impl<G, K, D, E, F> PairEstimator<'_, G, K, D, E, F>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
    E: Ending<K>,
    F: Ending<K::Adjoint>,
{
    /// The backward walk hits the source: s = 0.
    #[inline]
    fn hit_source(&self, cell: usize, eye: &[Vertex<K::Point, Matrix<K::Weight>>]) -> Option<Joined<G::Value>> {
        let x = eye.last()?;
        let contribution = x.load.weight.apply(self.equation.source().eval(&x.state));
        if contribution == G::Value::ZERO {
            return None;
        }
        let q = self.equation.source().emit_pdf(&self.equation.kernel().forward(&x.state, Beyond::Start));
        let eye_side = self.eye_side(eye, if q.is_infinite() { 0.0 } else { q }, Beyond::Start);
        let weight = self.weigh(&eye_side, &Side::empty());
        Some(Joined { s: 0, t: eye.len(), cell, contribution, weight })
    }

    /// The forward walk hits the detector: t = 0.
    #[inline]
    fn hit_detector<S: Sampler>(
        &self,
        cell: usize,
        light: &[Vertex<G::State, Carried<G::Value>>],
        u: &mut S,
        mut each: impl FnMut(Joined<G::Value>),
    ) {
        let (Some(z), share) = (light.last(), self.share as f64) else { return };
        self.detector.meet(&z.state, z.load.value(), u, |Met { cell: met, point, score, pdf }| {
            if score == G::Value::ZERO || (self.share == 1 && met != cell) {
                return;
            }
            let weight = self.weigh(&Side::empty(), &self.light_side(light, pdf / share, &point));
            each(Joined { s: light.len(), t: 0, cell: met, contribution: score.scale(1.0 / share), weight });
        });
    }

    /// Both walks are joined by an edge.
    #[inline]
    fn join(
        &self,
        cell: usize,
        eye: &[Vertex<K::Point, Matrix<K::Weight>>],
        light: &[Vertex<G::State, Carried<G::Value>>],
    ) -> Option<Joined<G::Value>> {
        let ((x, z), kernel) = ((eye.last()?, light.last()?), self.equation.kernel());
        let contribution = x.load.weight.apply(kernel.join(&x.state, &z.state).apply(z.load.value()));
        if contribution == G::Value::ZERO {
            return None;
        }
        let weight = if let Strategies::One { .. } = self.strategies {
            1.0
        } else {
            let back = z.survival * self.adjoint.pdf(&z.state, &kernel.forward(&x.state, Beyond::Other(&z.state)));
            let y = kernel.backward(&z.state, Beyond::Other(&x.state));
            let forth = x.survival * kernel.pdf(&x.state, &y);
            self.weigh(&self.eye_side(eye, back, Beyond::Other(&z.state)), &self.light_side(light, forth, &y))
        };
        Some(Joined { s: light.len(), t: eye.len(), cell, contribution, weight })
    }

    /// Every strategy of the pair, from the shortest eye walk on.
    #[inline]
    pub(super) fn joined<S: Sampler>(&self, cell: usize, u: &mut S, memory: &Memory<G, K>, mut each: impl FnMut(Joined<G::Value>)) -> u64 {
        let (eye, light) = (&memory.eye[..], &memory.light[..]);
        let mut joins = 0;
        for t in 0..=eye.len() {
            for s in self.strategies.range(t, light.len()) {
                match (s, t) {
                    (0, 0) => {}
                    (0, _) => self.hit_source(cell, &eye[..t]).into_iter().for_each(&mut each),
                    (_, 0) => {
                        // forward walks read no events in their blocks
                        u.seek(2 * s as u64 - 1, Purpose::Event);
                        self.hit_detector(cell, &light[..s], u, &mut each);
                    }
                    _ => {
                        joins += 1;
                        self.join(cell, &eye[..t], &light[..s]).into_iter().for_each(&mut each);
                    }
                }
            }
        }
        joins
    }
}
