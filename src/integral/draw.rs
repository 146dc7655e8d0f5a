//! Many scores of one primary estimator: cut into chunks by the problem, never by the thread; merged serially in index order.

use super::Integral;
use crate::domain::Domain;
use crate::error::Error;
use crate::parallel;
use crate::sampling::Sequence;
use crate::source::Source;
use crate::statistics::{Moments, Tail};
use crate::value::Value;
use std::cell::{Cell, OnceCell};
use std::ops::Range;

/// Scores in a chunk: moments are taken chunk by chunk, so this number is part of the result's bits.
pub(super) const CHUNK: u64 = 1024;
/// Chunks in flight before they are merged: bounds memory on long runs.
pub(super) const BATCH: u64 = 4096;

/// The integrand, watched: how often it was evaluated, and where first it was not finite.
#[derive(Debug)]
pub(super) struct Probe<'a, D: Domain, G: Source> {
    integral: &'a Integral<D, G>,
    count: Cell<u64>,
    fault: OnceCell<(G::Point, G::Value)>,
}

impl<'a, D: Domain, G: Source<Point = D::Point>> Probe<'a, D, G> {
    pub(super) fn new(integral: &'a Integral<D, G>) -> Self {
        Probe { integral, count: Cell::new(0), fault: OnceCell::new() }
    }

    /// f(x) inside the domain, 0 outside.
    #[inline]
    pub(super) fn eval(&self, x: &D::Point) -> G::Value {
        if !self.integral.domain.contains(x) {
            return G::Value::ZERO;
        }
        self.count.set(self.count.get() + 1);
        let f = self.integral.integrand.eval(x);
        if !f.all_finite() {
            self.fault.get_or_init(|| (*x, f));
        }
        f
    }

    /// Refuses if any value was not finite, with the first.
    pub(super) fn check(&self) -> Result<(), Error> {
        match self.fault.get() {
            Some((x, f)) => Err(Error::NonFiniteIntegrand { at: format!("{x:?}"), value: format!("{f:?}") }),
            None => Ok(()),
        }
    }

    pub(super) fn count(&self) -> u64 {
        self.count.get()
    }
}

/// What some scores say.
#[derive(Clone, Debug)]
pub(super) struct Drawn<V> {
    pub(super) moments: Moments<V>,
    pub(super) tail: Tail,
    pub(super) evaluations: u64,
}

/// One score from one cursor, f by the probe.
pub(super) trait Score<D: Domain, G: Source, S>: Fn(&Probe<'_, D, G>, &mut S) -> G::Value + Sync {}
impl<D: Domain, G: Source, S, T: Fn(&Probe<'_, D, G>, &mut S) -> G::Value + Sync> Score<D, G, S> for T {}

/// Scores of the points `indices` of one cell and replicate, at most a chunk of them.
pub(super) fn chunk<D, G, Q>(
    integral: &Integral<D, G>,
    sequence: &Q,
    (cell, replicate): (u64, u32),
    indices: Range<u64>,
    threshold: f64,
    score: &impl Score<D, G, Q::Sampler>,
) -> Result<Drawn<G::Value>, Error>
where
    D: Domain,
    G: Source<Point = D::Point>,
    Q: Sequence,
{
    let probe = Probe::new(integral);
    let first = indices.start;
    let scores: Vec<_> = sequence.points(cell, replicate, indices).map(|mut u| score(&probe, &mut u)).collect();
    probe.check()?;
    let moments = Moments::from_scores(&scores);
    if !moments.mean.all_finite() {
        let count = scores.len() as f64;
        let at = scores.iter().position(|s| !s.scale(count).all_finite()).unwrap_or(0);
        return Err(Error::NonFiniteScore { sample: first + at as u64, replicate, score: format!("{:?}", scores[at]) });
    }
    Ok(Drawn { tail: Tail::of_block(&scores, moments.nonzero, threshold), moments, evaluations: probe.count() })
}

/// The results of many tasks in order, or the first error. Behind a vtable: one call a chunk, and the machinery of threads is compiled once, not for every
/// integrand and estimator.
pub(super) fn all<T: Send>(count: u64, task: &(dyn Fn(u64) -> Result<T, Error> + Sync)) -> Result<Vec<T>, Error> {
    parallel::map(count as usize, |i| task(i as u64)).into_iter().collect()
}

/// `count` scores of one cell in each of `replicates` replicates.
pub(super) fn draw<D, G, Q>(
    integral: &Integral<D, G>,
    sequence: &Q,
    cell: u64,
    (replicates, count): (u32, u64),
    score: &impl Score<D, G, Q::Sampler>,
) -> Result<(Vec<Moments<G::Value>>, Tail, u64), Error>
where
    D: Domain,
    G: Source<Point = D::Point>,
    Q: Sequence,
{
    let (chunks, rows) = (count.div_ceil(CHUNK), u64::from(replicates));
    let (mut moments, mut tail, mut evaluations) = (vec![Moments::default(); replicates as usize], Tail::default(), 0);
    for from in (0..chunks * rows).step_by(BATCH as usize) {
        let to = (from + BATCH).min(chunks * rows);
        let threshold = tail.threshold();
        let drawn = all(to - from, &|i| {
            let task = from + i;
            let start = task % chunks * CHUNK;
            chunk(integral, sequence, (cell, (task / chunks) as u32), start..(start + CHUNK).min(count), threshold, score)
        });
        let drawn = drawn?;
        for (task, part) in (from..).zip(&drawn) {
            moments[(task / chunks) as usize].merge(&part.moments);
            evaluations += part.evaluations;
        }
        tail.merge(drawn.iter().map(|part| &part.tail));
    }
    Ok((moments, tail, evaluations))
}
