//! Stratified (jittered) points and Latin hypercubes.
//!
//! n = m^g points: coordinates come in groups of g, and in each group every cell of an m × … × m grid holds one point, uniform in its cell.
//! Groups are shuffled independently. g = 1 is the Latin hypercube, or N rooks (McKay, Beckman, Conover 1979): every single coordinate is
//! stratified into n.
//!
//! ```text
//! Var ≤ σ²/(n − 1)                  Latin hypercube, any f (Owen 1997); theory (4.14.5)
//! Var = O(n^{−1−2/g})               f smooth, of g variables
//! ```

use super::cursor::block;
use super::permutation::permuted;
use crate::error::Error;
use crate::sampling::hash::{self, midpoint, mix, open_unit, word};
use crate::sampling::{Purpose, Sampler, Sequence};
use std::ops::Range;

/// Jittered points: `strata` cells along each of the `axes` coordinates of a group, strata^axes points in each replicate.
///
/// Any number of coordinates. Points beyond strata^axes begin another, independent set. A purpose of a walk begins a group: choose as many
/// axes as a step consumes numbers.
///
/// ```
/// use fredholm::sampling::{Sampler, Sequence, Stratified};
/// let jittered = Stratified::new(8, 2)?;
/// let mut cells: Vec<_> = (0..64).map(|i| jittered.point(0, 0, i).next_2d().map(|x| (8.0 * x) as u32)).collect();
/// cells.sort();
/// cells.dedup();
/// assert_eq!(cells.len(), 64);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stratified {
    grid: Grid,
    seed: u64,
    replicates: u32,
}

/// Latin hypercubes: every coordinate alone is stratified into `points` cells. [`Stratified`] with one axis, by its usual name.
///
/// ```
/// use fredholm::sampling::{LatinHypercube, Sampler, Sequence};
/// let rooks = LatinHypercube::new(5)?;
/// let mut rows: Vec<_> = (0..5).map(|i| (5.0 * rooks.point(0, 0, i).next_2d()[1]) as u32).collect();
/// rows.sort();
/// assert_eq!(rows, [0, 1, 2, 3, 4]);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatinHypercube(Stratified);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Grid {
    strata: u64,
    axes: u32,
    cells: u64,
}

impl Stratified {
    /// A grid of `strata` cells along each of `axes` coordinates; seed 0, 16 replicates.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one of them is 0, or strata^axes exceeds 2⁵³.
    pub fn new(strata: u64, axes: u32) -> Result<Self, Error> {
        if strata == 0 {
            return Err(Error::invalid("strata", 0.0, "must be at least 1"));
        }
        if axes == 0 {
            return Err(Error::invalid("axes", 0.0, "must be at least 1"));
        }
        match strata.checked_pow(axes).filter(|cells| *cells <= 1 << 53) {
            Some(cells) => Ok(Stratified { grid: Grid { strata, axes, cells }, seed: 0, replicates: 16 }),
            None => Err(Error::invalid("strata", strata as f64, "strata^axes must not exceed 2⁵³")),
        }
    }

    /// Independent randomisations, from which the error comes (theory (4.14.4)).
    #[must_use]
    pub fn replicates(self, replicates: u32) -> Self {
        Stratified { replicates, ..self }
    }
}

impl LatinHypercube {
    /// Sets of `points` points; seed 0, 16 replicates.
    ///
    /// # Errors
    /// [`Error::Invalid`] for no points, or more than 2⁵³.
    pub fn new(points: u64) -> Result<Self, Error> {
        if points == 0 || points > 1 << 53 {
            return Err(Error::invalid("points", points as f64, "must lie between 1 and 2⁵³"));
        }
        Stratified::new(points, 1).map(LatinHypercube)
    }

    /// Independent randomisations, from which the error comes (theory (4.14.4)).
    #[must_use]
    pub fn replicates(self, replicates: u32) -> Self {
        LatinHypercube(self.0.replicates(replicates))
    }
}

impl Sequence for Stratified {
    type Sampler = StratifiedSampler;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> StratifiedSampler {
        StratifiedSampler::new(self.grid, hash::key(self.seed, cell, replicate), index)
    }

    #[inline]
    fn points(&self, cell: u64, replicate: u32, indices: Range<u64>) -> impl Iterator<Item = StratifiedSampler> {
        let (grid, key) = (self.grid, hash::key(self.seed, cell, replicate));
        indices.map(move |index| StratifiedSampler::new(grid, key, index))
    }

    fn with_seed(self, seed: u64) -> Self {
        Stratified { seed, ..self }
    }

    fn replicates(&self) -> Option<u32> {
        Some(self.replicates)
    }
}

impl Sequence for LatinHypercube {
    type Sampler = StratifiedSampler;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> StratifiedSampler {
        self.0.point(cell, replicate, index)
    }

    #[inline]
    fn points(&self, cell: u64, replicate: u32, indices: Range<u64>) -> impl Iterator<Item = StratifiedSampler> {
        self.0.points(cell, replicate, indices)
    }

    fn with_seed(self, seed: u64) -> Self {
        LatinHypercube(self.0.with_seed(seed))
    }

    fn replicates(&self) -> Option<u32> {
        Some(self.0.replicates)
    }
}

/// The cursor of one walk on a stratified point.
#[derive(Clone, Debug)]
pub struct StratifiedSampler {
    grid: Grid,
    /// of this set of points
    set: u64,
    /// of this point
    point: u64,
    /// number in the set
    index: u64,
    /// names the group: vertex, purpose, and how many groups before
    group: u64,
    axis: u32,
    /// the cell in this group, whose lowest digit in base m is the next coordinate's
    cell: u64,
}

impl StratifiedSampler {
    #[inline]
    fn new(grid: Grid, key: u64, index: u64) -> Self {
        let set = word(key, index / grid.cells);
        StratifiedSampler { grid, set, point: word(!key, index), index: index % grid.cells, group: 0, axis: 0, cell: 0 }
    }
}

impl Sampler for StratifiedSampler {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let Grid { strata, axes, cells } = self.grid;
        if self.axis == 0 {
            self.cell = permuted(self.index, cells, word(self.set, self.group));
        }
        let (rest, stratum) = (self.cell / strata, self.cell % strata);
        let jitter = open_unit(word(word(self.point, self.group), u64::from(self.axis)));
        (self.cell, self.axis) = (rest, self.axis + 1);
        if self.axis == axes {
            (self.group, self.axis) = (self.group.wrapping_add(1), 0);
        }
        midpoint((stratum as f64 + jitter) / strata as f64)
    }

    #[inline]
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        // hashed: however many groups a purpose reads, they are not those of the next
        (self.group, self.axis) = (mix(block(vertex, purpose)), 0);
    }
}
