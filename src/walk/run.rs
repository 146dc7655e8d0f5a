//! Many walks: cut into chunks by the problem, never by the thread; merged serially in index order.

use super::backward::{Backward, start};
use super::driver::{Driver, End};
use super::replay::replay;
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
use std::time::{Duration, Instant};

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
/// Detectors with more cells keep no tails: 256 numbers a cell would outweigh an image.
pub(super) const CELLS_WITH_TAILS: usize = 1024;

/// The state of one detector cell.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Cell<V> {
    /// one for each replicate; a single one for independent points
    replicates: Vec<Moments<V>>,
    tail: Option<Tail>,
    steps: u64,
    cut: u64,
    truncated: u64,
}

/// Everything a run needs to go on bit for bit: save it with `serde`, resume with [`Rounds::resume`](super::Rounds::resume).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Checkpoint<V> {
    method: String,
    done: u64,
    round: u64,
    elapsed: Duration,
    cells: Vec<Cell<V>>,
}

/// A run in progress.
#[derive(Debug)]
pub(super) struct Run<'a, G: Source, K, D, C, E, Q> {
    pub(super) walk: Walk<C, E, Q>,
    equation: &'a Equation<G, K>,
    detector: &'a D,
    truncation: Option<Truncation>,
    /// walks in a chunk
    pub(super) chunk: u64,
    pub(super) state: Checkpoint<G::Value>,
}

impl<V> Checkpoint<V> {
    /// Rounds done.
    pub fn round(&self) -> u64 {
        self.round
    }
}

#[derive(Clone)]
struct Chunk<V> {
    moments: Moments<V>,
    tail: Tail,
    steps: u64,
    cut: u64,
    truncated: u64,
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
        let cell = Cell {
            replicates: vec![Moments::default(); walk.sequence.replicates().unwrap_or(1) as usize],
            tail: (cells <= CELLS_WITH_TAILS).then(Tail::default),
            steps: 0,
            cut: 0,
            truncated: 0,
        };
        // the budget may change on resume, the method may not
        let method = format!("{:?} {:?} {} {}", walk.scoring, walk.ending, walk.sequence.describe(), walk.max_steps);
        let state = Checkpoint { method, done: 0, round: 0, elapsed: Duration::ZERO, cells: vec![cell; cells] };
        let chunk = if cells <= CELLS_WITH_TAILS { CHUNK } else { SMALL_CHUNK };
        Ok(Run { walk: *walk, equation, detector, truncation, chunk, state })
    }

    pub(super) fn resume(&mut self, saved: Checkpoint<G::Value>) -> Result<(), Error> {
        let differ =
            |field, saved: &dyn ToString, now: &dyn ToString| Error::Checkpoint { field, saved: saved.to_string(), now: now.to_string() };
        if saved.method != self.state.method {
            return Err(differ("method", &saved.method, &self.state.method));
        }
        if saved.cells.len() != self.state.cells.len() {
            return Err(differ("number of cells", &saved.cells.len(), &self.state.cells.len()));
        }
        let replicates = self.state.cells[0].replicates.len();
        if let Some(c) = saved.cells.iter().find(|c| c.replicates.len() != replicates) {
            return Err(differ("number of replicates", &c.replicates.len(), &replicates));
        }
        self.state = saved;
        Ok(())
    }

    pub(super) fn equation(&self) -> &'a Equation<G, K> {
        self.equation
    }

    /// One more round, up to `samples` walks a cell.
    pub(super) fn advance_round(&mut self, samples: u64) -> Result<(), Error> {
        self.advance_to(samples)?;
        self.state.round += 1;
        Ok(())
    }

    /// All estimates in the detector's shape.
    pub(super) fn answer(&self) -> D::Answer<Estimate<G::Value>> {
        self.detector.answer(self.estimates())
    }

    /// Walks a cell so far, all replicates together.
    pub(super) fn done(&self) -> u64 {
        self.state.done * self.replicates()
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
                self.batch(first..(first + step).min(cells), from, to)?;
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
                cell.steps += chunk.steps;
                cell.cut += chunk.cut;
                cell.truncated += chunk.truncated;
            }
            if let Some(tail) = &mut cell.tail {
                tail.merge(results.iter().map(|chunk| &chunk.tail));
            }
        }
        Ok(())
    }

    fn chunk(&self, cell: usize, replicate: u32, from: u64, to: u64) -> Result<Chunk<G::Value>, Error> {
        let mut scores = vec![G::Value::ZERO; (to - from) as usize];
        let (mut steps, mut cut, mut truncated) = (0, 0, 0);
        let Walk { scoring, ending, max_steps, .. } = &self.walk;
        let mut errand = Backward { equation: self.equation, scoring };
        let driver = Driver { kernel: self.equation.kernel(), ending, max_steps: *max_steps };
        let mut points = self.walk.sequence.points(cell as u64, replicate, from..to);
        let (mut lanes, mut ranks) = (Vec::with_capacity(FRONT.min(scores.len())), Vec::new());
        for (scores, first) in scores.chunks_mut(FRONT).zip((from..).step_by(FRONT)) {
            lanes.clear();
            lanes.extend(points.by_ref().take(FRONT).enumerate().map(|(i, u)| start(self.detector, cell, i, u)));
            let mut too_long = None;
            steps += driver.walk(&mut errand, &mut lanes, &mut ranks, &mut (), |walk| {
                match walk.end {
                    End::Cut => {
                        cut += 1;
                        truncated += u64::from(walk.truncated);
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
        Ok(Chunk { moments, tail, steps, cut, truncated })
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
        self.state.cells.iter().map(|cell| self.estimate(cell)).collect()
    }

    fn estimate(&self, cell: &Cell<G::Value>) -> Estimate<G::Value> {
        let Pooled { moments, std_error, degrees_of_freedom } = Pooled::of(self.walk.sequence.replicates(), &cell.replicates);
        let vertices = cell.steps + moments.count - cell.cut;
        Estimate {
            value: moments.mean,
            std_error,
            degrees_of_freedom,
            moments,
            tail: cell.tail.clone(),
            steps: cell.steps,
            evaluations: cell.steps + C::EVALUATIONS * vertices,
            truncation: self.truncation.map(|t| Truncation { walks: cell.truncated, ..t }),
            elapsed: self.state.elapsed,
        }
    }
}
