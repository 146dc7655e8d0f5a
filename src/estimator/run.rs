//! Many scores of one cell: cut into chunks by the problem, never by the thread; merged serially in index order.

use super::Estimator;
use crate::error::Error;
use crate::parallel;
use crate::sampling::Sequence;
use crate::statistics::{Estimate, Moments, Pooled, Tail};
use crate::value::Value;
use std::ops::Range;
use std::time::Instant;

/// Scores in a chunk: moments are taken chunk by chunk, so this number is part of the result's bits.
const CHUNK: u64 = 1024;
/// Chunks in flight before they are merged: bounds memory on long runs.
const BATCH: u64 = 4096;

/// Scores of some points, in order, and what they cost together.
#[derive(Clone, Debug)]
pub(crate) struct Block<V> {
    pub(crate) scores: Vec<V>,
    pub(crate) steps: u64,
    pub(crate) evaluations: u64,
}

/// Scores of the points `indices` of (stream, replicate) for one cell; the first that is not finite is an error.
pub(crate) fn score_block<T: Estimator, Q: Sequence>(
    estimator: &T,
    sequence: &Q,
    cell: usize,
    (stream, replicate): (u64, u32),
    indices: Range<u64>,
) -> Result<Block<T::Value>, Error> {
    let mut block = Block { scores: Vec::with_capacity((indices.end - indices.start) as usize), steps: 0, evaluations: 0 };
    let (mut scratch, count) = (T::Scratch::default(), (indices.end - indices.start) as f64);
    for (walk, mut u) in indices.clone().zip(sequence.points(stream, replicate, indices)) {
        let score = estimator.score(cell, &mut u, &mut scratch);
        // a score is also too large if a block of its like has no finite sum
        if !score.value.scale(count).all_finite() {
            let why = estimator.explain(cell, walk, &mut sequence.point(stream, replicate, walk));
            let unexplained = Error::NonFiniteScore { sample: walk, replicate, score: format!("{:?}", score.value) };
            return Err(why.unwrap_or(unexplained));
        }
        block.scores.push(score.value);
        block.steps += score.steps;
        block.evaluations += score.evaluations;
    }
    Ok(block)
}

/// What a chunk leaves.
struct Part<V> {
    moments: Moments<V>,
    tail: Tail,
    steps: u64,
    evaluations: u64,
}

/// The mean of at least `samples` scores, all replicates together, from blocks of (replicate, indices). Behind a vtable: one call a chunk, and the machinery
/// of threads is compiled once a value type.
pub(crate) fn estimate<V: Value>(
    replicates: Option<u32>,
    samples: u64,
    block: &(dyn Fn(u32, Range<u64>) -> Result<Block<V>, Error> + Sync),
) -> Result<Estimate<V>, Error> {
    let clock = Instant::now();
    let rows = u64::from(replicates.unwrap_or(1));
    let count = samples.div_ceil(rows);
    let chunks = count.div_ceil(CHUNK);
    let (mut moments, mut tail, mut steps, mut evaluations) = (vec![Moments::default(); rows as usize], Tail::default(), 0, 0);
    for from in (0..chunks * rows).step_by(BATCH as usize) {
        let to = (from + BATCH).min(chunks * rows);
        let threshold = tail.threshold();
        let parts = parallel::map((to - from) as usize, |i| {
            let task = from + i as u64;
            let start = task % chunks * CHUNK;
            let Block { scores, steps, evaluations } = block((task / chunks) as u32, start..(start + CHUNK).min(count))?;
            let moments = Moments::from_scores(&scores);
            Ok(Part { tail: Tail::of_block(&scores, moments.nonzero, threshold), moments, steps, evaluations })
        });
        let parts = parts.into_iter().collect::<Result<Vec<_>, Error>>()?;
        for (task, part) in (from..).zip(&parts) {
            moments[(task / chunks) as usize].merge(&part.moments);
            steps += part.steps;
            evaluations += part.evaluations;
        }
        tail.merge(parts.iter().map(|part| &part.tail));
    }
    let Pooled { moments, std_error, degrees_of_freedom } = Pooled::of(replicates, &moments);
    let (value, tail, elapsed) = (moments.mean, Some(tail), clock.elapsed());
    Ok(Estimate { value, std_error, degrees_of_freedom, moments, tail, steps, evaluations, truncation: None, elapsed })
}

/// Refuses budgets and replicates that are none.
pub(super) fn check_budget(parameter: &'static str, samples: u64, replicates: Option<u32>) -> Result<(), Error> {
    if samples == 0 {
        return Err(Error::invalid(parameter, 0.0, "must be at least 1"));
    }
    if replicates == Some(0) {
        return Err(Error::invalid("replicates", 0.0, "must be at least 1"));
    }
    Error::held("replicates", replicates.map_or(1, u64::from))
}
