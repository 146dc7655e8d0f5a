//! The strategies one by one.

use super::pair::{Memory, PairEstimator};
use super::{Bidirectional, Connect, Meet};
use crate::contained::contained;
use crate::equation::Query;
use crate::error::Error;
use crate::estimator::Estimator;
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::parallel;
use crate::sampling::Sequence;
use crate::source::EmitPdf;
use crate::statistics::Moments;
use crate::value::{Value, Weight};
use crate::walk::Ending;
use std::ops::Range;

/// What one strategy contributes, alone and in company.
///
/// Moments are those of single pairs, of independent points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Strategy<V = f64> {
    /// Vertices from the source.
    pub s: u64,
    /// Vertices from the detector.
    pub t: u64,
    /// Scores C_{s,t}: their mean is ⟨h, T^{s+t−1} g⟩, if this strategy can find every path.
    pub alone: Moments<V>,
    /// Scores w_{s,t} C_{s,t}: over the strategies of one order their means add up to ⟨h, Tᵐ g⟩.
    pub weighted: Moments<V>,
}

impl<V: Value> Strategy<V> {
    /// m = s + t − 1, edges of the path.
    #[must_use]
    pub fn order(&self) -> u64 {
        self.s + self.t - 1
    }
}

/// Pairs in a chunk: moments are taken chunk by chunk, so this number is part of the result's bits.
const CHUNK: u64 = 1024;
/// Chunks in flight before they are merged: bounds memory.
const BATCH: u64 = 1024;

/// A larger table is refused: orders up to m have (m + 1)(m + 4)/2 strategies, each with two columns of scores.
pub(crate) const MOST_EDGES: u64 = 64;

/// All (s, t) of orders up to `order`, by order, then by s.
pub(super) fn places(order: u64) -> impl Iterator<Item = (u64, u64)> {
    (0..=order).flat_map(|m| (0..=m + 1).map(move |s| (s, m + 1 - s)))
}

/// The place of (s, t) in that order.
pub(super) fn index(s: usize, t: usize) -> usize {
    // orders below m = s + t − 1 have 2 + 3 + … + (m + 1) strategies
    let m = s + t - 1;
    m * (m + 3) / 2 + s
}

impl<G, K, D> Query<'_, G, K, D>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point>,
{
    /// The strategies of paths of up to `order` edges, from the pairs of the detector's cell `cell`: what each finds alone, and with its weight.
    ///
    /// ```
    /// use fredholm::{Bidirectional, Equation};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let table = eq.at(0.5).strategies(&Bidirectional::new(), 0, 2)?;
    /// // (T²g)(½) = 1/48, by every strategy but s = 3, which would have to hit the point
    /// for strategy in table.iter().filter(|strategy| strategy.order() == 2 && strategy.t > 0) {
    ///     assert!((strategy.alone.mean * 48.0 - 1.0).abs() < 0.2);
    /// }
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of a solve; [`Error::Invalid`] for a cell that the detector does not have, orders above 64, and sequences with replicates, whose points say
    /// nothing about the error of a strategy.
    pub fn strategies<E, F, Q>(&self, walks: &Bidirectional<E, F, Q>, cell: usize, order: u64) -> Result<Vec<Strategy<G::Value>>, Error>
    where
        E: Ending<K>,
        F: Ending<K::Adjoint>,
        Q: Sequence,
    {
        contained(|| self.measured(&Bidirectional { pilot: None, ..*walks }, cell, order))
    }

    fn measured<E, F, Q>(&self, walks: &Bidirectional<E, F, Q>, cell: usize, order: u64) -> Result<Vec<Strategy<G::Value>>, Error>
    where
        E: Ending<K>,
        F: Ending<K::Adjoint>,
        Q: Sequence,
    {
        let pairs = self.bidirectional(walks)?;
        if cell >= self.detector().cells() {
            return Err(Error::invalid("cell", cell as f64, "must be below the detector's number of cells"));
        }
        if order > MOST_EDGES {
            return Err(Error::invalid("order", order as f64, "must be at most 64"));
        }
        if let Some(replicates) = walks.sequence.replicates() {
            let why = "the table of strategies takes its errors from independent points: use `Pcg`";
            return Err(Error::invalid("replicates", f64::from(replicates), why));
        }
        let strategy = |(s, t)| Strategy { s, t, alone: Moments::default(), weighted: Moments::default() };
        let mut table: Vec<Strategy<G::Value>> = places(order).map(strategy).collect();
        let chunks = walks.samples.div_ceil(CHUNK);
        for from in (0..chunks).step_by(BATCH as usize) {
            let parts = parallel::map((from + BATCH).min(chunks) as usize - from as usize, |task| {
                let first = (from + task as u64) * CHUNK;
                pairs.columns(&walks.sequence, cell, first..first.saturating_add(CHUNK).min(walks.samples), order)
            });
            for part in parts {
                for (strategy, [alone, weighted]) in table.iter_mut().zip(part?) {
                    strategy.alone.merge(&alone);
                    strategy.weighted.merge(&weighted);
                }
            }
        }
        Ok(table)
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
    /// Moments of C and of w C of every strategy, from a block of pairs.
    fn columns<Q: Sequence>(
        &self,
        sequence: &Q,
        cell: usize,
        indices: Range<u64>,
        order: u64,
    ) -> Result<Vec<[Moments<G::Value>; 2]>, Error> {
        let (size, first) = ((indices.end - indices.start) as usize, indices.start);
        let mut columns = vec![[vec![G::Value::ZERO; size], vec![G::Value::ZERO; size]]; places(order).count()];
        let mut memory = Memory::<G, K>::default();
        for (i, mut u) in sequence.points(cell as u64, 0, indices).enumerate() {
            let mut sum = G::Value::ZERO;
            let done = self.pair(cell, &mut u, &mut memory, |j| {
                let weighted = j.contribution.scale(j.weight);
                sum += weighted;
                if ((j.s + j.t) as u64) <= order + 1 {
                    let [alone, shared] = &mut columns[index(j.s, j.t)];
                    (alone[i], shared[i]) = (j.contribution, weighted);
                }
            });
            if done.is_err() || !sum.all_finite() {
                let walk = first + i as u64;
                let unexplained = Error::NonFiniteScore { sample: walk, replicate: 0, score: format!("{sum:?}") };
                return Err(self.explain(cell, walk, &mut sequence.point(cell as u64, 0, walk)).unwrap_or(unexplained));
            }
        }
        Ok(columns.iter().map(|column| [0, 1].map(|part| Moments::from_scores(&column[part]))).collect())
    }
}
