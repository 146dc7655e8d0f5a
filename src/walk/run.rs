//! Many walks: cut into chunks by the problem, never by the thread; merged serially in index order.

use super::backward::{Backward, met_nothing, start};
use super::checkpoint::{CELLS_WITH_TAILS, Cell, Checkpoint, Count};
use super::driver::{Driver, End};
use super::replay::replay;
use super::rounds::InProgress;
use super::scoring::Scoring;
use super::{Ending, Walk};
use crate::detector::Detector;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{Operator, Transition};
use crate::parallel;
use crate::sampling::Sequence;
use crate::source::Source;
use crate::statistics::{Estimate, Moments, Pooled, Tail, Truncation};
use crate::value::{Value, Weight};
use std::ops::Range;
use std::time::Instant;

/// Walks in a chunk: moments are taken chunk by chunk, so this number is part of the result's bits.
pub(super) const CHUNK: u64 = 1024;
/// The same for detectors of many cells: an image has few walks a pixel, and its first round shall come soon.
const SMALL_CHUNK: u64 = 16;
/// Walks abreast: enough to hide latencies, few enough for the first cache where weights are numbers.
pub(super) const FRONT: usize = 128;
/// Chunks in flight before they are merged: bounds memory on long runs.
pub(super) const BATCH: usize = 4096;
/// The same where every cell has one chunk.
const WIDE_BATCH: usize = 1 << 16;
/// Backward walks in progress.
#[derive(Debug)]
pub struct Run<'a, G: Source, K, D, C, E, Q> {
    walk: Walk<C, E, Q>,
    equation: &'a Equation<G, K>,
    detector: &'a D,
    truncation: Option<Truncation>,
    /// walks in a chunk
    chunk: u64,
    state: Checkpoint<G::Value>,
}

#[derive(Clone)]
struct Chunk<V> {
    moments: Moments<V>,
    tail: Tail,
    count: Count,
}

impl<'a, G, K, D, C, E, Q> Run<'a, G, K, D, C, E, Q>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    pub(super) fn new(walk: &Walk<C, E, Q>, equation: &'a Equation<G, K>, detector: &'a D) -> Result<Self, Error> {
        let truncation = walk.prepare(equation, detector)?;
        let cells = detector.cells();
        Error::held("cells × replicates", (cells as u64).saturating_mul(u64::from(walk.sequence.replicates().unwrap_or(1))))?;
        // the budget may change on resume, the method may not
        let method = format!("{:?} {:?} {} {}", walk.scoring, walk.ending, walk.sequence.describe(), walk.max_steps);
        let state = Checkpoint::start(method, cells, &walk.sequence);
        let chunk = if cells <= CELLS_WITH_TAILS { CHUNK } else { SMALL_CHUNK };
        Ok(Run { walk: *walk, equation, detector, truncation, chunk, state })
    }

    /// All estimates in the detector's shape.
    pub(super) fn answer(&self) -> D::Answer<Estimate<G::Value>> {
        self.detector.answer(self.estimates())
    }

    fn replicates(&self) -> u64 {
        u64::from(self.walk.sequence.replicates().unwrap_or(1))
    }

    /// Goes on until every cell has `samples` walks (rounded up to the replicates).
    pub(super) fn advance_to(&mut self, samples: u64) -> Result<(), Error> {
        let clock = Instant::now();
        let replicates = self.replicates();
        let end = samples.div_ceil(replicates);
        let mut batch = 8;
        while self.state.done < end {
            let cells = self.state.cells.len();
            let rows = cells * replicates as usize;
            let chunks = (batch / rows).max(1) as u64;
            let from = self.state.done;
            // whole chunks, so that any schedule of rounds cuts the walks at the same places
            let to = ((from / self.chunk + chunks) * self.chunk).min(end);
            let step = (WIDE_BATCH / replicates as usize).max(1);
            for first in (0..cells).step_by(step) {
                // an error may have left the first groups ahead of the others
                let own = self.state.cells[first].own.walks / replicates;
                if own < to {
                    self.batch(first..(first + step).min(cells), own.max(from), to)?;
                }
            }
            self.state.done = to;
            batch = (8 * batch).min(BATCH);
        }
        self.state.elapsed += clock.elapsed();
        Ok(())
    }

    fn batch(&mut self, cells: Range<usize>, from: u64, to: u64) -> Result<(), Error> {
        let replicates = self.replicates() as usize;
        let (size, first) = (self.chunk, cells.start);
        let chunks = (to.div_ceil(size) - from / size) as usize;
        let tasks = cells.len() * replicates * chunks;
        // group small tasks: an image has many cells of a few walks each
        let group = (CHUNK / (to - from).min(size).max(1)).clamp(1, 64) as usize;
        let this = &*self;
        let results = parallel::map(tasks.div_ceil(group), |g| {
            let one = |task: usize| {
                let (row, chunk) = (task / chunks, (task % chunks) as u64 + from / size);
                let (cell, replicate) = (first + row / replicates, row % replicates);
                this.chunk(cell, replicate as u32, from.max(chunk * size), to.min((chunk + 1) * size))
            };
            (g * group..((g + 1) * group).min(tasks)).map(one).collect::<Result<Vec<_>, Error>>()
        });
        let results = results.into_iter().collect::<Result<Vec<_>, Error>>()?.concat();
        for (cell, results) in self.state.cells[cells].iter_mut().zip(results.chunks(replicates * chunks)) {
            for (task, chunk) in results.iter().enumerate() {
                cell.replicates[task / chunks].merge(&chunk.moments);
                cell.own.add(chunk.count);
            }
            if let Some(tail) = &mut cell.tail {
                tail.merge(results.iter().map(|chunk| &chunk.tail));
            }
        }
        Ok(())
    }

    fn chunk(&self, cell: usize, replicate: u32, from: u64, to: u64) -> Result<Chunk<G::Value>, Error> {
        let mut scores = vec![G::Value::ZERO; (to - from) as usize];
        let mut count = Count { walks: to - from, ..Count::default() };
        let Walk { scoring, ending, max_steps, .. } = &self.walk;
        let mut errand = Backward { equation: self.equation, scoring };
        let driver = Driver { kernel: self.equation.kernel(), ending, max_steps: *max_steps };
        let mut points = self.walk.sequence.points(cell as u64, replicate, from..to);
        let (mut lanes, mut ranks) = (Vec::with_capacity(FRONT.min(scores.len())), Vec::new());
        for (scores, first) in scores.chunks_mut(FRONT).zip((from..).step_by(FRONT)) {
            lanes.clear();
            lanes.extend(points.by_ref().take(FRONT).enumerate().map(|(i, u)| start(self.detector, cell, i, u)));
            let mut too_long = None;
            count.steps += driver.walk(&mut errand, &mut lanes, &mut ranks, &mut (), |walk| {
                match walk.end {
                    End::Cut => {
                        count.cut += 1;
                        count.truncated += u64::from(walk.truncated);
                    }
                    End::TooLong => too_long = too_long.or(Some(walk.walk)),
                    End::Absorbed | End::Roulette => {}
                }
                scores[walk.walk] = walk.score;
            });
            if let Some(i) = too_long {
                return Err(Error::WalkTooLong { cell, walk: first + i as u64, steps: driver.max_steps });
            }
        }
        let moments = Moments::from_scores(&scores);
        if !(moments.mean.all_finite() && moments.m4.all_finite()) {
            self.explain(cell, replicate, from, &scores)?;
        }
        let tail = match &self.state.cells[cell].tail {
            Some(tail) => Tail::of_block(&scores, moments.nonzero, tail.threshold()),
            None => Tail::default(),
        };
        Ok(Chunk { moments, tail, count })
    }

    /// Finds the cause of scores that are not finite by replaying the first such walk.
    #[cold]
    fn explain(&self, cell: usize, replicate: u32, from: u64, scores: &[G::Value]) -> Result<(), Error> {
        // a score is also too large if a block of its like has no finite sum: the mean would be infinite
        let count = scores.len() as f64;
        let Some(i) = scores.iter().position(|s| !s.scale(count).all_finite()) else {
            // finite scores whose fourth power overflows: the moments say ∞, the mean is right
            return Ok(());
        };
        let walk = from + i as u64;
        let (fault, trace) = replay(&self.walk, self.equation, self.detector, cell, replicate, walk);
        let (vertex, last) = (trace.vertices.len() as u64 - 1, trace.vertices.last().expect("a walk has a start"));
        let unexplained = Error::Overflow { cell, walk, vertex, at: format!("{:?}", last.point), weight: format!("{:?}", last.weight) };
        Err(fault.unwrap_or(unexplained))
    }

    pub(super) fn estimates(&self) -> Vec<Estimate<G::Value>> {
        self.state.cells.iter().enumerate().map(|(i, cell)| self.estimate(i, cell)).collect()
    }

    fn estimate(&self, i: usize, cell: &Cell<G::Value>) -> Estimate<G::Value> {
        let Count { steps, cut, truncated, .. } = cell.own;
        let Pooled { moments, std_error, degrees_of_freedom } = Pooled::of(self.walk.sequence.replicates(), &cell.replicates);
        let vertices = steps + moments.count - cut;
        let estimate = Estimate {
            value: moments.mean,
            std_error,
            degrees_of_freedom,
            moments,
            tail: cell.tail.clone(),
            steps,
            evaluations: steps + C::EVALUATIONS * vertices,
            truncation: self.truncation.map(|t| Truncation { walks: truncated, ..t }),
            elapsed: self.state.elapsed,
        };
        let first = || self.walk.sequence.point(i as u64, 0, 0);
        estimate.unless(|score| met_nothing(self.equation, self.detector, (i, first()), score))
    }
}

impl<G, K, D, C, E, Q> InProgress for Run<'_, G, K, D, C, E, Q>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Value = G::Value;
    type Answer = D::Answer<Estimate<G::Value>>;

    fn budget(&self) -> u64 {
        self.walk.samples
    }

    fn first(&self) -> u64 {
        self.chunk
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
        self.answer()
    }
}
