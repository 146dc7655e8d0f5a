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
use crate::walk::driver::{Driver, End};
use crate::walk::run::{BATCH, CELLS_WITH_TAILS, CHUNK, FRONT};
use crate::walk::{Ending, Walk};
use std::time::{Duration, Instant};

/// Numbers in a table of scores: a block of walks is shorter where cells are many.
const TABLE: usize = 1 << 20;
/// Parts a cell of long chunks before they are merged: bounds memory.
const COMPACT: usize = 8;

/// What forward walks are made of.
pub(crate) struct Run<'a, G: Emit, K: HasAdjoint, D, C, E, Q> {
    pub(super) walk: Walk<C, E, Q>,
    pub(super) equation: &'a Equation<G, K>,
    pub(super) detector: &'a D,
    adjoint: K::Adjoint,
    truncation: Option<Truncation>,
    state: State<G::Value>,
    elapsed: Duration,
}

/// One detector cell so far. Moments are those of walks that may have scored; the others scored 0.
#[derive(Clone, Debug)]
struct Cell<V> {
    /// one for each replicate; a single one for independent points
    replicates: Vec<Moments<V>>,
    tail: Option<Tail>,
}

/// All walks so far.
#[derive(Clone, Debug)]
struct State<V> {
    cells: Vec<Cell<V>>,
    count: Count,
}

/// Walks and steps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Count {
    pub(crate) walks: u64,
    pub(crate) steps: u64,
    pub(crate) cut: u64,
    pub(crate) truncated: u64,
}

impl Count {
    pub(crate) fn add(&mut self, later: Count) {
        self.walks += later.walks;
        self.steps += later.steps;
        self.cut += later.cut;
        self.truncated += later.truncated;
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
        if cells > u32::MAX as usize {
            return Err(Error::invalid("cells", cells as f64, "must fit into 32 bits"));
        }
        let cell = Cell {
            replicates: vec![Moments::default(); walk.sequence.replicates().unwrap_or(1) as usize],
            tail: (cells <= CELLS_WITH_TAILS).then(Tail::default),
        };
        let state = State { cells: vec![cell; cells], count: Count::default() };
        Ok(Run { walk: *walk, equation, detector, adjoint, truncation, state, elapsed: Duration::ZERO })
    }

    pub(super) fn replicates(&self) -> u64 {
        u64::from(self.walk.sequence.replicates().unwrap_or(1))
    }

    /// All walks of the budget.
    pub(super) fn solve(&mut self) -> Result<Vec<Estimate<G::Value>>, Error> {
        let clock = Instant::now();
        let each = self.walk.samples.div_ceil(self.replicates());
        let (mut done, mut batch) = (0, 8);
        while done < each {
            let chunks = (batch / self.replicates()).max(1);
            let to = (done + chunks * CHUNK).min(each);
            self.batch(done, to)?;
            (done, batch) = (to, (8 * batch).min(BATCH as u64));
        }
        self.elapsed = clock.elapsed();
        Ok(self.estimates())
    }

    fn batch(&mut self, from: u64, to: u64) -> Result<(), Error> {
        let chunks = (to - from).div_ceil(CHUNK);
        let this = &*self;
        let results = parallel::map((self.replicates() * chunks) as usize, |task| {
            let (replicate, first) = (task as u64 / chunks, from + task as u64 % chunks * CHUNK);
            this.chunk(replicate as u32, first, to.min(first + CHUNK))
        });
        let results = results.into_iter().collect::<Result<Vec<_>, Error>>()?;
        results.iter().for_each(|chunk| self.state.count.add(chunk.count));
        self.merge(&results, |task| task / chunks as usize);
        Ok(())
    }

    /// All walks, in so many independent batches of equal size (the replicates, if the sequence has any), and the mean score of each batch in every cell.
    pub(crate) fn batches(&mut self, batches: u64) -> Result<Vec<Vec<G::Value>>, Error> {
        let clock = Instant::now();
        let replicates = self.walk.sequence.replicates().map(u64::from);
        let batches = replicates.unwrap_or(batches.min(self.walk.samples));
        let size = self.walk.samples.div_ceil(batches);
        let this = &*self;
        let results = parallel::map(batches as usize, |b| match replicates {
            Some(_) => this.chunk(b as u32, 0, size),
            None => this.chunk(0, b as u64 * size, (b as u64 + 1) * size),
        });
        let results = results.into_iter().collect::<Result<Vec<_>, Error>>()?;
        results.iter().for_each(|chunk| self.state.count.add(chunk.count));
        self.merge(&results, |batch| if replicates.is_some() { batch } else { 0 });
        self.elapsed = clock.elapsed();
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
        let Count { walks, steps, cut, truncated } = self.state.count;
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
            elapsed: self.elapsed,
        }
    }
}
