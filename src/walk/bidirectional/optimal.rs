//! Optimal weights: the heuristic, and controls from the densities of the strategies.
//!
//! ```text
//! r_k(x̄) = p_k(x̄)/Σ_j p_j(x̄),     D_k = Σ_s r_k(x̄_s) − 1{x̄_k was found},     E D_k = ∫ p_k − ∫ p_k = 0                theory (4.4.8)
//! Y = Y_w + Σ_{m ≤ 3} Σ_k α_{m,k} D_{m,k}
//! ```
//!
//! x̄_s is the path of order m that strategy s makes of a pair, whether it scores or not; paths along Dirac parts have no controls, their densities being of
//! other measures in either direction. With the balance heuristic in Y_w this is a change of weights, w_s =
//! r_s (1 + Σ_k α_k p_k/C) − α_s p_s/C with C = h K … K g along the path: negative ones included, Σ w = 1. α comes from the regression of Y on all D in a pilot on points of its
//! own, for every cell and component: the strategies of a pair share their walks, and the regression counts on it. Longer paths keep the heuristic. So
//! do all where what either half of the pilot finds takes no variance from the other: it takes some thousand pairs to see every strategy often enough. Reference: Kondapaneni et al., *Optimal multiple importance sampling*, ACM Trans. Graph. 38 (2019) 37.

use super::pair::{Memory, PairEstimator};
use super::table::{index, places};
use super::weights::Side;
use super::{Beyond, Connect, Meet, Strategies};
use crate::error::Error;
use crate::estimator::{Estimator, Score, coefficients};
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::sampling::{Pcg, Sequence};
use crate::source::EmitPdf;
use crate::value::{Value, Weight};
use crate::walk::Ending;
use std::ops::Range;

/// Paths of so many edges have controls.
const ORDER: u64 = 3;
/// Strategies of these orders.
const CONTROLS: usize = 14;

/// What the pilot of a cell found, and what it cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tuned<V> {
    alpha: [V; CONTROLS],
    pub(super) steps: u64,
    pub(super) evaluations: u64,
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
    /// Finds α for the cells given.
    pub(super) fn tune(&mut self, points: &Pcg, pilot: u64, cells: Range<usize>) -> Result<(), Error> {
        self.can_be_tuned(points, pilot)?;
        self.tuned = cells.map(|cell| self.pilot(points, pilot, cell)).collect::<Result<_, Error>>()?;
        Ok(())
    }

    /// Densities must be those of the walks themselves, and known for paths that do not score.
    fn can_be_tuned(&self, points: &Pcg, pilot: u64) -> Result<(), Error> {
        if pilot < 2 * CONTROLS as u64 {
            return Err(Error::invalid("pilot", pilot as f64, "must be at least 28 pairs: there are 14 coefficients"));
        }
        if K::LOOKS_BEYOND {
            let why = "optimal weights need states that are the same in both directions: use a heuristic";
            return Err(Error::invalid("pilot", pilot as f64, why));
        }
        if let Strategies::One { s, .. } = self.strategies {
            return Err(Error::invalid("strategy", s as f64, "a strategy alone has no weights"));
        }
        let mut u = points.point(0, 0, 0);
        let (x, z) = (self.detector.start(0, &mut u).point, self.equation.source().emit(&mut u).point);
        let known = (self.endings.0.survival_at(self.equation.kernel(), &x)).and(self.endings.1.survival_at(&self.adjoint, &z));
        let why = "optimal weights need survival that depends on the place alone: constant roulette, Subcritical, OwnAbsorption";
        known.map(drop).ok_or_else(|| Error::invalid("ending", f64::NAN, why))
    }

    /// α of one cell.
    fn pilot(&self, points: &Pcg, pilot: u64, cell: usize) -> Result<Tuned<G::Value>, Error> {
        let (mut steps, mut evaluations) = (0, 0);
        let mut memory = Memory::<G, K>::default();
        let (mut scores, mut controls) = (Vec::new(), vec![Vec::new(); CONTROLS]);
        for (walk, mut u) in (0..).zip(points.points(cell as u64, 0, 0..pilot)) {
            let Score { value: score, steps: walked, evaluations: evaluated } = self.score(cell, &mut u, &mut memory);
            (steps, evaluations) = (steps + walked, evaluations + evaluated);
            let found = self.controls(cell, &memory);
            if !score.all_finite() || found.iter().any(|d| !d.is_finite()) {
                let unexplained = Error::NonFiniteScore { sample: walk, replicate: 0, score: format!("{score:?}") };
                return Err(self.explain(cell, walk, &mut points.point(cell as u64, 0, walk)).unwrap_or(unexplained));
            }
            scores.push(score);
            controls.iter_mut().zip(found).for_each(|(column, d)| column.push(d));
        }
        let component = |c: usize| {
            let scores: Vec<f64> = scores.iter().map(|y| y.component(c)).collect();
            let unexplained = || Error::NonFiniteScore { sample: 0, replicate: 0, score: "the pilot's sums".into() };
            coefficients(&controls, &scores).ok_or_else(unexplained)
        };
        let alpha = (0..G::Value::COMPONENTS).map(component).collect::<Result<Vec<_>, Error>>()?;
        let alpha = std::array::from_fn(|k| G::Value::from_components(|c| alpha[c][k]));
        Ok(Tuned { alpha, steps, evaluations })
    }

    /// Σ α D of a pair that has been walked.
    #[inline]
    pub(super) fn controlled(&self, cell: usize, memory: &Memory<G, K>) -> G::Value {
        let Some(tuned) = self.tuned.get(cell) else { return G::Value::ZERO };
        let controls = self.controls(cell, memory);
        tuned.alpha.iter().zip(controls).fold(G::Value::ZERO, |sum, (a, d)| sum + a.scale(d))
    }

    /// D of all strategies, by order, then by s.
    fn controls(&self, cell: usize, memory: &Memory<G, K>) -> [f64; CONTROLS] {
        let mut controls = [0.0; CONTROLS];
        for (s, t) in places(ORDER) {
            let (s, t) = (s as usize, t as usize);
            let wanted = self.strategies == Strategies::All || self.strategies == Strategies::Order((s + t - 1) as u64);
            if wanted && s <= memory.light.len() && t <= memory.eye.len() {
                // those of one order stand together
                let first = index(s, t) - s;
                self.found(cell, (s, t), memory, &mut controls[first..first + s + t + 1]);
            }
        }
        controls
    }

    /// Adds r_k of the path that strategy (s, t) has found to every D_k of its order, and takes 1 from its own; not along Dirac parts.
    fn found(&self, cell: usize, (s, t): (usize, usize), memory: &Memory<G, K>, controls: &mut [f64]) {
        let (eye, light, kernel) = (&memory.eye[..t], &memory.light[..s], self.equation.kernel());
        if !(eye.iter().all(|v| v.regular) && light.iter().all(|v| v.regular)) {
            return;
        }
        let (eye, light) = match (eye.last(), light.last()) {
            (Some(x), None) => {
                let q = self.equation.source().emit_pdf(&kernel.forward(&x.state, Beyond::Start));
                (Side { path: eye, last: if q.is_infinite() { 0.0 } else { q }, before: None }, Side::empty())
            }
            (None, Some(z)) => {
                let pdf = self.detector.start_pdf(cell, &kernel.backward(&z.state, Beyond::Start));
                if pdf.is_infinite() {
                    return; // no walk ends at a point
                }
                (Side::empty(), Side { path: light, last: pdf, before: None })
            }
            (Some(x), Some(z)) => {
                let back = z.survival * self.adjoint.pdf(&z.state, &kernel.forward(&x.state, Beyond::Other(&z.state)));
                let forth = x.survival * kernel.pdf(&x.state, &kernel.backward(&z.state, Beyond::Other(&x.state)));
                (Side { path: eye, last: back, before: None }, Side { path: light, last: forth, before: None })
            }
            (None, None) => return,
        };
        let mut total = 1.0;
        eye.each(|_, ratio| total += ratio);
        light.each(|_, ratio| total += ratio);
        eye.each(|left, ratio| controls[s + left] += ratio / total);
        light.each(|left, ratio| controls[s - left] += ratio / total);
        controls[s] += 1.0 / total - 1.0;
    }
}
