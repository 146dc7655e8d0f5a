//! The state of a run between two rounds.

use crate::error::Error;
use crate::sampling::Sequence;
use crate::statistics::{Moments, Tail};
use crate::value::Value;
use std::time::Duration;

/// Everything a run needs to go on bit for bit: save it with `serde`, resume with [`Rounds::resume`](super::Rounds::resume).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = "V: Value"))]
pub struct Checkpoint<V> {
    /// what may not change on resume; the budget may
    method: String,
    /// walks of every replicate, of each cell or of all together
    pub(super) done: u64,
    pub(super) round: u64,
    pub(super) elapsed: Duration,
    pub(super) cells: Vec<Cell<V>>,
    /// of walks that serve all cells
    pub(super) common: Count,
}

/// The state of one detector cell.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(bound = "V: Value"))]
pub(super) struct Cell<V> {
    /// one for each replicate; a single one for independent points
    pub(super) replicates: Vec<Moments<V>>,
    pub(super) tail: Option<Tail>,
    /// of walks that start in this cell
    pub(super) own: Count,
}

/// Walks and steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// Detectors with more cells keep no tails: 256 numbers a cell would outweigh an image.
pub(super) const CELLS_WITH_TAILS: usize = 1024;

impl<V: Value> Checkpoint<V> {
    /// Before the first walk.
    pub(super) fn start(method: String, cells: usize, sequence: &impl Sequence) -> Self {
        let cell = Cell {
            replicates: vec![Moments::default(); sequence.replicates().unwrap_or(1) as usize],
            tail: (cells <= CELLS_WITH_TAILS).then(Tail::default),
            own: Count::default(),
        };
        Checkpoint { method, done: 0, round: 0, elapsed: Duration::ZERO, cells: vec![cell; cells], common: Count::default() }
    }

    /// Goes on from a state that was saved, if it is one of the same method and of as many cells.
    pub(super) fn resume(&mut self, saved: Self) -> Result<(), Error> {
        let differ =
            |field, saved: &dyn ToString, now: &dyn ToString| Error::Checkpoint { field, saved: saved.to_string(), now: now.to_string() };
        if saved.method != self.method {
            return Err(differ("method", &saved.method, &self.method));
        }
        if saved.cells.len() != self.cells.len() {
            return Err(differ("number of cells", &saved.cells.len(), &self.cells.len()));
        }
        let replicates = self.cells[0].replicates.len();
        if let Some(c) = saved.cells.iter().find(|c| c.replicates.len() != replicates) {
            return Err(differ("number of replicates", &c.replicates.len(), &replicates));
        }
        *self = saved;
        Ok(())
    }
}

impl<V> Checkpoint<V> {
    /// Rounds done.
    pub fn round(&self) -> u64 {
        self.round
    }
}
