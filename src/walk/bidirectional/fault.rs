//! Why a pair of walks has no finite score.

use super::pair::{Memory, PairEstimator};
use super::path::Fault;
use super::{Connect, Meet};
use crate::error::Error;
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::source::EmitPdf;
use crate::value::{Value, Weight};
use crate::walk::Ending;

impl<G, K, D, E, F> PairEstimator<'_, G, K, D, E, F>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
    E: Ending<K>,
    F: Ending<K::Adjoint>,
{
    /// The first fault of a pair: in the walks, then in what joins them.
    #[cold]
    pub(super) fn fault(&self, cell: usize, walk: u64, fault: Option<Fault>, memory: &Memory<G, K>) -> Option<Error> {
        if fault == Some(Fault::TooLong) {
            return Some(Error::WalkTooLong { cell, walk, steps: self.max_steps });
        }
        let found = self.survival(memory).or_else(|| self.eye_fault(cell, walk, memory));
        found.or_else(|| self.light_fault(cell, walk, memory)).or_else(|| self.edge_fault(memory))
    }

    fn survival(&self, memory: &Memory<G, K>) -> Option<Error> {
        let backward = memory.eye.iter().map(|v| (format!("{:?}", v.state), v.survival));
        let forward = memory.light.iter().map(|v| (format!("{:?}", v.state), v.survival));
        let (at, value) = backward.chain(forward).find(|v| !(v.1 >= 0.0))?;
        Some(Error::InvalidProbability { at, value })
    }

    fn eye_fault(&self, cell: usize, walk: u64, memory: &Memory<G, K>) -> Option<Error> {
        for (n, v) in memory.eye.iter().enumerate() {
            let (at, weight) = (format!("{:?}", v.state), v.load.weight);
            if !weight.entries_finite() && n == 0 {
                return Some(Error::NonFiniteStart { cell, walk, at, weight: format!("{weight:?}") });
            }
            if !weight.entries_finite() {
                return Some(Error::Overflow { cell, walk, vertex: n as u64, at, weight: format!("{weight:?}") });
            }
            if v.rarity.is_nan() {
                let x = format!("{:?}", memory.eye[n.saturating_sub(1)].state);
                return Some(Error::UnstatedDensity { x, y: at, needed_by: NEEDED_BY });
            }
            let g = self.equation.source().eval(&v.state);
            if !g.all_finite() {
                return Some(Error::non_finite_source(&v.state, &g));
            }
        }
        None
    }

    fn light_fault(&self, cell: usize, walk: u64, memory: &Memory<G, K>) -> Option<Error> {
        for (n, v) in memory.light.iter().enumerate() {
            let (at, value) = (format!("{:?}", v.state), v.load.value());
            if !value.all_finite() && n == 0 {
                return Some(Error::non_finite_source(&v.state, &value));
            }
            if !value.all_finite() {
                return Some(Error::Overflow { cell, walk, vertex: n as u64, at, weight: format!("{value:?}") });
            }
            if v.rarity.is_nan() {
                let x = format!("{:?}", memory.light[n.saturating_sub(1)].state);
                return Some(Error::UnstatedDensity { x, y: at, needed_by: NEEDED_BY });
            }
        }
        None
    }

    fn edge_fault(&self, memory: &Memory<G, K>) -> Option<Error> {
        for x in &memory.eye {
            for z in &memory.light {
                let k = self.equation.kernel().join(&x.state, &z.state);
                if !k.entries_finite() {
                    return Some(Error::NonFiniteKernel {
                        x: format!("{:?}", x.state),
                        y: format!("{:?}", z.state),
                        value: format!("{k:?}"),
                    });
                }
            }
        }
        None
    }
}

const NEEDED_BY: &str = "the weight of a bidirectional strategy";
