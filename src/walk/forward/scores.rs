//! The scores of a block of forward walks in all cells, walk by walk, until their moments are taken.

use crate::statistics::{Moments, Tail};
use crate::value::Value;

/// Scores by walk and cell.
pub(super) enum Scores<V> {
    /// Where most walks score in most cells: rows of walks.
    Table { cells: usize, values: Vec<V> },
    /// Where a walk scores in few of many cells: cell · 2³² + walk, and what was added.
    List(Vec<(u64, V)>),
}

/// What a block says about one cell: the moments of the walks that may have scored there; all others scored 0.
#[derive(Clone, Debug)]
pub(super) struct Part<V> {
    pub(super) cell: usize,
    pub(super) moments: Moments<V>,
    pub(super) tail: Tail,
}

impl<V: Value> Part<V> {
    /// Merges the parts of each cell, in order.
    pub(super) fn compact(parts: &mut Vec<Self>) {
        parts.sort_by_key(|p| p.cell);
        let merged = parts.chunk_by(|a, b| a.cell == b.cell).map(|of_cell| {
            let mut all = Part { cell: of_cell[0].cell, moments: Moments::default(), tail: Tail::default() };
            of_cell.iter().for_each(|p| all.moments.merge(&p.moments));
            all.tail.merge(of_cell.iter().map(|p| &p.tail));
            all
        });
        *parts = merged.collect();
    }
}

/// A score that is not finite.
pub(super) struct Fault {
    /// Number of the walk in its block.
    pub(super) walk: usize,
    pub(super) cell: usize,
}

/// Cells that are few enough for a table, however seldom a walk touches them.
const FEW: usize = 16;

impl<V: Value> Scores<V> {
    /// Nothing scored yet.
    pub(super) fn new(cells: usize, every_cell: bool) -> Self {
        if every_cell || cells <= FEW { Scores::Table { cells, values: Vec::new() } } else { Scores::List(Vec::new()) }
    }

    /// Makes room for so many walks.
    pub(super) fn clear(&mut self, walks: usize) {
        match self {
            Scores::Table { cells, values } => {
                values.clear();
                values.resize(walks * *cells, V::ZERO);
            }
            Scores::List(list) => list.clear(),
        }
    }

    #[inline]
    pub(super) fn add(&mut self, walk: usize, cell: usize, score: V) {
        match self {
            Scores::Table { cells, values } => values[walk * *cells + cell] += score,
            Scores::List(list) => list.push(((cell as u64) << 32 | walk as u64, score)),
        }
    }

    /// Calls `f(cell, scores, walks)` for every cell that a walk touched, in order: the scores of single walks, and which walks those are.
    fn each_cell(&mut self, mut f: impl FnMut(usize, &[V], &dyn Fn(usize) -> usize)) {
        let mut scores = Vec::new();
        match self {
            Scores::Table { cells: 1, values } => f(0, values, &|i| i),
            Scores::Table { cells, values } => {
                for cell in 0..*cells {
                    scores.clear();
                    scores.extend(values.iter().skip(cell).step_by(*cells));
                    f(cell, &scores, &|i| i);
                }
            }
            Scores::List(list) => {
                list.sort_unstable_by_key(|entry| entry.0);
                for of_cell in list.chunk_by(|a, b| a.0 >> 32 == b.0 >> 32) {
                    let mut walks = Vec::new();
                    scores.clear();
                    for of_walk in of_cell.chunk_by(|a, b| a.0 == b.0) {
                        walks.push((of_walk[0].0 & 0xffff_ffff) as usize);
                        scores.push(of_walk.iter().fold(V::ZERO, |sum, entry| sum + entry.1));
                    }
                    f((of_cell[0].0 >> 32) as usize, &scores, &|i| walks[i]);
                }
            }
        }
    }

    /// Appends the moments of all touched cells; `threshold(cell)` is what a score must exceed to enter the tail of a cell that has one. Returns the
    /// earliest walk whose score in a block of `walks` has no finite sum.
    pub(super) fn fold(&mut self, walks: usize, threshold: impl Fn(usize) -> Option<f64>, parts: &mut Vec<Part<V>>) -> Option<Fault> {
        let mut fault: Option<Fault> = None;
        self.each_cell(|cell, scores, walk| {
            let moments = Moments::from_scores(scores);
            if !(moments.mean.all_finite() && moments.m4.all_finite()) {
                // finite scores whose fourth power overflows are no fault: the moments say ∞, the mean is right
                if let Some(i) = scores.iter().position(|s| !s.scale(walks as f64).all_finite()) {
                    let earlier = fault.as_ref().is_none_or(|f| walk(i) < f.walk);
                    if earlier {
                        fault = Some(Fault { walk: walk(i), cell });
                    }
                }
            }
            let tail = threshold(cell).map_or_else(Tail::default, |t| Tail::of_block(scores, moments.nonzero, t));
            parts.push(Part { cell, moments, tail });
        });
        fault
    }
}
