//! Many forward walks: cut into chunks by the problem, never by the thread; merged serially in index order.

use super::errand::{Onward, born};
use super::scores::{Part, Scores};
use super::scoring::ForwardScoring;
use super::trace::{ForwardTrace, Recorder};
use crate::detector::Detector;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasAdjoint, Operator, Transition};
use crate::parallel;
use crate::sampling::Sequence;
use crate::source::Emit;
use crate::statistics::{Estimate, Moments, Pooled, Tail, Truncation};
use crate::value::{Value, Weight};
use crate::walk::checkpoint::{Cell, Checkpoint, Count};
use crate::walk::driver::{Driver, End};
use crate::walk::run::{BATCH, CHUNK, FRONT};
use crate::walk::{Ending, InProgress, Walk};
use std::time::Instant;

/// Numbers in a table of scores: a block of walks is shorter where cells are many.
const TABLE: usize = 1 << 20;
/// Parts a cell of long chunks before they are merged: bounds memory.
const COMPACT: usize = 8;

/// Forward walks in progress. Moments of cells are those of walks that may have scored there; the others scored 0.
pub struct Run<'a, G: Emit, K: HasAdjoint, D, C, E, Q> {
    walk: Walk<C, E, Q>,
    equation: &'a Equation<G, K>,
    detector: &'a D,
    adjoint: K::Adjoint,
    truncation: Option<Truncation>,
    state: Checkpoint<G::Value>,
}

impl<G: Emit, K: HasAdjoint, D, C: std::fmt::Debug, E: std::fmt::Debug, Q: std::fmt::Debug> std::fmt::Debug for Run<'_, G, K, D, C, E, Q> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ForwardRun").field("walk", &self.walk).field("state", &self.state).finish_non_exhaustive()
    }
}

/// What a range of walks found.
pub(crate) struct Chunk<V> {
    pub(super) parts: Vec<Part<V>>,
    pub(crate) count: Count,
}

impl<'a, G, K, D, C, E, Q> Run<'a, G, K, D, C, E, Q>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: ForwardScoring<G, K, D>,
    E: Ending<K::Adjoint>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    pub(crate) fn new(walk: &Walk<C, E, Q>, equation: &'a Equation<G, K>, detector: &'a D) -> Result<Self, Error> {
        equation.validate()?;
        detector.validate()?;
        let adjoint = equation.kernel().adjoint()?;
        let truncation = walk.budgeted(equation, &adjoint, || detector.norm())?;
        let cells = detector.cells();
        Error::held("cells × replicates", (cells as u64).saturating_mul(u64::from(walk.sequence.replicates().unwrap_or(1))))?;
        // the budget may change on resume, the method may not
        let method = format!("forward {:?} {:?} {} {}", walk.scoring, walk.ending, walk.sequence.describe(), walk.max_steps);
        let state = Checkpoint::start(method, cells, &walk.sequence);
        Ok(Run { walk: *walk, equation, detector, adjoint, truncation, state })
    }

    pub(super) fn replicates(&self) -> u64 {
        u64::from(self.walk.sequence.replicates().unwrap_or(1))
    }

    /// Goes on until there are `samples` walks (rounded up to the replicates).
    pub(super) fn advance_to(&mut self, samples: u64) -> Result<(), Error> {
        let clock = Instant::now();
        let end = samples.div_ceil(self.replicates());
        let mut batch = 8;
        while self.state.done < end {
            let (from, chunks) = (self.state.done, (batch / self.replicates()).max(1));
            // whole chunks, so that any schedule of rounds cuts the walks at the same places
            let to = ((from / CHUNK + chunks) * CHUNK).min(end);
            self.batch(from, to)?;
            self.state.done = to;
            batch = (8 * batch).min(BATCH as u64);
        }
        self.state.elapsed += clock.elapsed();
        Ok(())
    }

    fn batch(&mut self, from: u64, to: u64) -> Result<(), Error> {
        let (first, chunks) = (from / CHUNK, to.div_ceil(CHUNK) - from / CHUNK);
        let this = &*self;
        let results = parallel::map((self.replicates() * chunks) as usize, |task| {
            let (replicate, chunk) = (task as u64 / chunks, first + task as u64 % chunks);
            this.chunk(replicate as u32, from.max(chunk * CHUNK), to.min((chunk + 1) * CHUNK))
        });
        let results = results.into_iter().collect::<Result<Vec<_>, Error>>()?;
        results.iter().for_each(|chunk| self.state.common.add(chunk.count));
        self.merge(&results, |task| task / chunks as usize);
        Ok(())
    }

    /// All walks, in so many independent batches of equal size (the replicates, if the sequence has any), and the mean score of each batch in every cell.
    pub(crate) fn batches(&mut self, batches: u64) -> Result<Vec<Vec<G::Value>>, Error> {
        let clock = Instant::now();
        let replicates = self.walk.sequence.replicates().map(u64::from);
        let batches = replicates.unwrap_or(batches.min(self.walk.samples));
        Error::held("batches", batches)?;
        let size = self.walk.samples.div_ceil(batches);
        let this = &*self;
        let results = parallel::map(batches as usize, |b| match replicates {
            Some(_) => this.chunk(b as u32, 0, size),
            None => this.chunk(0, (b as u64).saturating_mul(size), (b as u64 + 1).saturating_mul(size)),
        });
        let results = results.into_iter().collect::<Result<Vec<_>, Error>>()?;
        results.iter().for_each(|chunk| self.state.common.add(chunk.count));
        self.merge(&results, |batch| if replicates.is_some() { batch } else { 0 });
        self.state.elapsed = clock.elapsed();
        let means = |chunk: &Chunk<G::Value>| {
            let mut means = vec![G::Value::ZERO; self.state.cells.len()];
            chunk.parts.iter().for_each(|p| means[p.cell] += p.moments.mean.scale(p.moments.count as f64 / size as f64));
            means
        };
        Ok(results.iter().map(means).collect())
    }

    /// Joins the parts of chunks in order; `replicate` tells to which a chunk belongs.
    fn merge(&mut self, results: &[Chunk<G::Value>], replicate: impl Fn(usize) -> usize) {
        let mut parts = vec![Vec::new(); self.state.cells.len()];
        for (task, chunk) in results.iter().enumerate() {
            chunk.parts.iter().for_each(|part| parts[part.cell].push((replicate(task), part)));
        }
        for (cell, parts) in self.state.cells.iter_mut().zip(parts) {
            parts.iter().for_each(|(replicate, part)| cell.replicates[*replicate].merge(&part.moments));
            if let Some(tail) = cell.tail.as_mut().filter(|_| !parts.is_empty()) {
                tail.merge(parts.iter().map(|(_, part)| &part.tail));
            }
        }
    }

    /// Walks `from` to `to` of a replicate.
    pub(crate) fn chunk(&self, replicate: u32, from: u64, to: u64) -> Result<Chunk<G::Value>, Error> {
        let cells = self.detector.cells();
        let block = if C::EVERY_CELL { (TABLE / cells).clamp(FRONT, CHUNK as usize) } else { CHUNK as usize };
        let mut scores = Scores::new(cells, C::EVERY_CELL);
        let mut chunk = Chunk { parts: Vec::new(), count: Count::default() };
        let mut thresholds: Vec<_> = self.state.cells.iter().map(|c| c.tail.as_ref().map(Tail::threshold)).collect();
        for first in (from..to).step_by(block) {
            let last = to.min(first + block as u64);
            chunk.count.add(self.block(replicate, (first, last), &mut scores)?);
            if let Some(fault) = scores.fold((last - first) as usize, |cell| thresholds[cell], &mut chunk.parts) {
                let walk = first + fault.walk as u64;
                return Err(self.replay(replicate, walk).0.cause(fault.cell));
            }
            if chunk.parts.len() > COMPACT * cells {
                Part::compact(&mut chunk.parts);
                chunk.parts.iter().for_each(|p| thresholds[p.cell] = thresholds[p.cell].map(|t| t.max(p.tail.threshold())));
            }
        }
        Ok(chunk)
    }

    /// Walks up to a table of scores.
    fn block(&self, replicate: u32, (from, to): (u64, u64), scores: &mut Scores<G::Value>) -> Result<Count, Error> {
        scores.clear((to - from) as usize);
        let Walk { scoring, ending, max_steps, sequence, .. } = &self.walk;
        let driver = Driver { kernel: &self.adjoint, ending, max_steps: *max_steps };
        let mut points = sequence.points(0, replicate, from..to).enumerate();
        let add = |walk, cell, score| scores.add(walk, cell, score);
        let mut errand = Onward { equation: self.equation, detector: self.detector, scoring, add };
        let (mut lanes, mut ranks) = (Vec::with_capacity(FRONT), Vec::new());
        let (mut count, mut too_long) = (Count { walks: to - from, ..Count::default() }, None);
        for _ in (from..to).step_by(FRONT) {
            lanes.clear();
            lanes.extend(points.by_ref().take(FRONT).map(|(i, u)| born(self.equation.source(), i, u)));
            count.steps += driver.walk(&mut errand, &mut lanes, &mut ranks, &mut (), |walk| match walk.end {
                End::Cut => {
                    count.cut += 1;
                    count.truncated += u64::from(walk.truncated);
                }
                End::TooLong => too_long = too_long.or(Some(from + walk.walk as u64)),
                End::Absorbed | End::Roulette => {}
            });
            if let Some(walk) = too_long {
                return Err(Error::WalkTooLong { cell: 0, walk, steps: *max_steps });
            }
        }
        Ok(count)
    }

    /// One walk again, recorded.
    #[cold]
    pub(super) fn replay(&self, replicate: u32, walk: u64) -> (Recorder<G::State, K::Weight>, End) {
        let mut scores = Scores::new(self.detector.cells(), false);
        scores.clear(1);
        let Walk { scoring, ending, max_steps, sequence, .. } = &self.walk;
        let mut recorder = Recorder::new(walk);
        let mut lane = [born(self.equation.source(), 0, sequence.point(0, replicate, walk))];
        let mut end = End::TooLong;
        let add = |walk, cell, score| scores.add(walk, cell, score);
        let mut errand = Onward { equation: self.equation, detector: self.detector, scoring, add };
        let driver = Driver { kernel: &self.adjoint, ending, max_steps: *max_steps };
        driver.walk(&mut errand, &mut lane, &mut Vec::new(), &mut recorder, |walk| end = walk.end);
        (recorder, end)
    }

    pub(super) fn trace(&self, walk: u64) -> ForwardTrace<G::State, G::Value> {
        let (Recorder { vertices, scores, .. }, end) = self.replay(0, walk);
        ForwardTrace { vertices, scores, end }
    }

    pub(crate) fn estimates(&self) -> Vec<Estimate<G::Value>> {
        self.state.cells.iter().map(|cell| self.estimate(cell)).collect()
    }

    /// The walks that touched a cell and those that did not.
    fn estimate(&self, cell: &Cell<G::Value>) -> Estimate<G::Value> {
        let Count { walks, steps, cut, truncated } = self.state.common;
        let each = walks / self.replicates();
        let padded = |touched: &Moments<G::Value>| {
            let mut all = *touched;
            all.merge(&Moments { count: each - touched.count, ..Moments::default() });
            all
        };
        let parts: Vec<_> = cell.replicates.iter().map(padded).collect();
        let Pooled { moments, std_error, degrees_of_freedom } = Pooled::of(self.walk.sequence.replicates(), &parts);
        Estimate {
            value: moments.mean,
            // what no walk has reached is unknown, not 0 ± 0
            std_error,
            degrees_of_freedom,
            moments,
            tail: cell.tail.clone(),
            steps,
            evaluations: steps + self.walk.scoring.evaluations(self.detector) * (steps + walks - cut),
            truncation: self.truncation.map(|t| Truncation { walks: truncated, ..t }),
            elapsed: self.state.elapsed,
        }
    }
}

impl<G, K, D, C, E, Q> InProgress for Run<'_, G, K, D, C, E, Q>
where
    G: Emit,
    K: HasAdjoint<Adjoint: Transition + Operator<Point = G::State>> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: ForwardScoring<G, K, D>,
    E: Ending<K::Adjoint>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Value = G::Value;
    type Answer = D::Answer<Estimate<G::Value>>;

    fn budget(&self) -> u64 {
        self.walk.samples
    }

    fn first(&self) -> u64 {
        CHUNK
    }

    fn done(&self) -> u64 {
        self.state.done * self.replicates()
    }

    fn advance(&mut self, samples: u64) -> Result<(), Error> {
        self.advance_to(samples)
    }

    fn state(&self) -> &Checkpoint<G::Value> {
        &self.state
    }

    fn state_mut(&mut self) -> &mut Checkpoint<G::Value> {
        &mut self.state
    }

    fn answer(&self) -> Self::Answer {
        self.detector.answer(self.estimates())
    }
}
