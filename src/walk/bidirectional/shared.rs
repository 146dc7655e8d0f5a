//! Pairs for all cells of a detector at once: where a forward walk ends at a cell, it scores there, whosever pair it belongs to.
//!
//! ```text
//! round   one pair for each of the N cells                    Y_j = Σ_{t ≥ 1} w C, of the pair of cell j, + Σ over all N pairs of w_{s,0} C_{s,0}/N in cell j
//! ```
//!
//! A strategy without a vertex from the detector has N walks where the others have one: p_{s,0} counts N-fold (theory (4.4.5), n_i). Rounds are independent;
//! the cells of one round are not, and no one says so.

use super::pair::{Cost, Memory, PairEstimator};
use super::{Connect, Meet};
use crate::error::Error;
use crate::estimator::Estimator;
use crate::kernel::{HasAdjoint, Operator, TransitionPdf};
use crate::parallel;
use crate::sampling::Sequence;
use crate::source::EmitPdf;
use crate::statistics::{Estimate, Moments, Pooled, Tail};
use crate::value::{Value, Weight};
use crate::walk::Ending;
use crate::walk::checkpoint::CELLS_WITH_TAILS;
use std::ops::Range;
use std::time::Instant;

/// Scores in a block of rounds: moments are taken block by block, so this number is part of the result's bits.
const TABLE: usize = 1 << 15;
/// Moments in flight before they are merged: bounds memory.
const BATCH: usize = 1 << 19;

/// What a block of rounds leaves.
struct Part<V> {
    cells: Vec<(Moments<V>, Tail)>,
    steps: u64,
    evaluations: u64,
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
    /// At least `samples` rounds, all replicates together.
    pub(super) fn all_cells<Q: Sequence>(&self, sequence: &Q, samples: u64) -> Result<Vec<Estimate<G::Value>>, Error> {
        let (clock, cells) = (Instant::now(), self.detector.cells());
        let replicates = u64::from(sequence.replicates().unwrap_or(1));
        Error::held("cells × replicates", (cells as u64).saturating_mul(replicates))?;
        let (count, size) = (samples.div_ceil(replicates), (TABLE / cells).clamp(1, 1024) as u64);
        let (blocks, batch) = (count.div_ceil(size), (BATCH / cells).clamp(4, 4096));
        // of budgets that nobody will see spent
        let tasks = blocks.saturating_mul(replicates);
        let mut moments = vec![vec![Moments::default(); replicates as usize]; cells];
        let mut tails = vec![Tail::default(); if cells <= CELLS_WITH_TAILS { cells } else { 0 }];
        let (mut steps, mut evaluations) = (0, 0);
        for from in (0..tasks).step_by(batch) {
            let to = from.saturating_add(batch as u64).min(tasks);
            let parts = parallel::map((to - from) as usize, |i| {
                let (replicate, start) = ((from + i as u64) / blocks, (from + i as u64) % blocks * size);
                self.block(sequence, replicate as u32, start..(start + size).min(count), &tails)
            });
            let parts = parts.into_iter().collect::<Result<Vec<_>, Error>>()?;
            for (task, part) in (from..).zip(&parts) {
                moments.iter_mut().zip(&part.cells).for_each(|(cell, (m, _))| cell[(task / blocks) as usize].merge(m));
                (steps, evaluations) = (steps + part.steps, evaluations + part.evaluations);
            }
            tails.iter_mut().enumerate().for_each(|(j, tail)| tail.merge(parts.iter().map(|part| &part.cells[j].1)));
        }
        let elapsed = clock.elapsed();
        let estimate = |(j, parts): (usize, &Vec<Moments<G::Value>>)| {
            let Pooled { moments, std_error, degrees_of_freedom } = Pooled::of(sequence.replicates(), parts);
            let (value, tail) = (moments.mean, tails.get(j).cloned());
            Estimate { value, std_error, degrees_of_freedom, moments, tail, steps, evaluations, truncation: None, elapsed }
        };
        Ok(moments.iter().enumerate().map(estimate).collect())
    }

    /// Some rounds of a replicate.
    fn block<Q: Sequence>(&self, sequence: &Q, replicate: u32, rounds: Range<u64>, tails: &[Tail]) -> Result<Part<G::Value>, Error> {
        let (cells, size) = (self.detector.cells(), (rounds.end - rounds.start) as usize);
        let mut scores = vec![G::Value::ZERO; cells * size];
        let mut memory = Memory::<G, K>::default();
        let (mut steps, mut evaluations) = (0, 0);
        for cell in 0..cells {
            for (i, mut u) in sequence.points(cell as u64, replicate, rounds.clone()).enumerate() {
                let mut sum = G::Value::ZERO;
                let done = self.pair(cell, &mut u, &mut memory, |j| {
                    let score = j.contribution.scale(j.weight);
                    sum += score;
                    scores[j.cell * size + i] += score;
                });
                let walk = rounds.start + i as u64;
                match done {
                    // a score is also too large if a block of its like has no finite sum
                    Ok(cost) if sum.scale((cells * size) as f64).all_finite() => {
                        let Cost { steps: taken, joins } = cost;
                        (steps, evaluations) = (steps + taken, evaluations + taken + joins);
                    }
                    _ => {
                        let unexplained = Error::NonFiniteScore { sample: walk, replicate, score: format!("{sum:?}") };
                        let why = self.explain(cell, walk, &mut sequence.point(cell as u64, replicate, walk));
                        return Err(why.unwrap_or(unexplained));
                    }
                }
            }
        }
        let part = |(cell, scores): (usize, &[G::Value])| {
            let moments = Moments::from_scores(scores);
            let tail = tails.get(cell).map_or_else(Tail::default, |t| Tail::of_block(scores, moments.nonzero, t.threshold()));
            (moments, tail)
        };
        Ok(Part { cells: scores.chunks(size).enumerate().map(part).collect(), steps, evaluations })
    }
}
