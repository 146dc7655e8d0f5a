//! Randomness: sequences of points of the unit cube [0, 1)^∞ and the cursor that reads one of them.
//!
//! A [`Sequence`] is a small value (kind and seed). `sequence.point(cell, replicate, index)` is a *pure function*: any walk can be
//! replayed, and results do not depend on how work is split between threads. A [`Sampler`] is the cursor of one walk.
//!
//! Vertex n of a walk reads block n of its point, purpose by purpose ([`Purpose`]), so that what one decision consumes never shifts
//! the dimensions of another (theory (4.14.1)).
//!
//! | sequence | points | error of a mean of n, smooth f | coordinates |
//! |---|---|---|---|
//! | [`Pcg`], the default | independent | n^(−1/2) | any number |
//! | [`LatinHypercube`] | n, known beforehand | n^(−1/2), without the additive part of f | any number |
//! | [`Stratified`] | m^d, known beforehand | n^(−1/2−1/d) | any number, in groups of d |
//! | [`VanDerCorput`] | any number | n^(−3/2) in one dimension | 1 |
//! | [`Halton`] | any number | about n^(−1) | 1024 |
//! | [`Hammersley`] | n, known beforehand | about n^(−1) | 1025 |
//! | [`Sobol`] | best powers of 2 | n^(−3/2) up to logarithms | 1111 |
//!
//! All but PCG take their error from independent randomisations, 16 by default. What is read beyond the coordinates is drawn independently;
//! nothing is ever repeated. [`Layout`] says which coordinates a walk reads for what, [`PointSet`] measures how even points are, and
//! [`distribution`] turns them into points of other densities. Rank-1 lattices are not offered: no maintained crate carries tested
//! generating vectors for arbitrary dimensions and sizes; [`Coordinates`] shows one with a vector of your own.

mod discrepancy;
pub mod distribution;
pub(crate) mod hash;
mod pcg;
mod sequence;
mod table;

pub use discrepancy::{Bounds, PointSet};
pub(crate) use hash::midpoint;
pub(crate) use pcg::pilot_points;
pub use pcg::{Pcg, PcgSampler};
pub use sequence::{
    Coordinates, Halton, HaltonPoint, Hammersley, HammersleyPoint, LatinHypercube, Layout, PointSampler, Sobol, SobolPoint, Stratified,
    StratifiedSampler, VanDerCorput, VanDerCorputPoint,
};
pub use table::Table;

use std::fmt::Debug;
use std::ops::Range;

/// What a vertex uses its random numbers for. Each purpose owns its own dimensions of the vertex's block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Purpose {
    /// Where the walk starts (detector, source).
    Start = 0,
    /// Whether it goes on.
    Survival = 1,
    /// Where it goes.
    Move = 2,
    /// Next-event estimation: a point of the source.
    Event = 3,
}

/// The cursor of one walk: a point of the infinite-dimensional unit cube, read one coordinate after the other.
///
/// Law: every number is uniform and *strictly inside* (0, 1), so that logarithms and inverses are safe.
pub trait Sampler {
    /// The next coordinate, in (0, 1).
    fn next_1d(&mut self) -> f64;

    /// The next two coordinates.
    #[inline]
    fn next_2d(&mut self) -> [f64; 2] {
        [self.next_1d(), self.next_1d()]
    }

    /// Moves to the dimensions of `purpose` at vertex `vertex`. Independent generators need not do anything.
    #[inline]
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        let _ = (vertex, purpose);
    }
}

impl<S: Sampler + ?Sized> Sampler for &mut S {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        (**self).next_1d()
    }
    #[inline]
    fn next_2d(&mut self) -> [f64; 2] {
        (**self).next_2d()
    }
    #[inline]
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        (**self).seek(vertex, purpose);
    }
}

/// A family of points of [0, 1)^∞, addressed by detector cell, replicate and index.
///
/// Laws: `point` is a pure function; over `index` the points are uniform.
pub trait Sequence: Copy + Debug + Send + Sync + 'static {
    /// The cursor type.
    type Sampler: Sampler + Clone;

    /// Point `index` of replicate `replicate` for detector cell `cell`.
    fn point(&self, cell: u64, replicate: u32, index: u64) -> Self::Sampler;

    /// The points of a range of indices: the same as [`point`](Sequence::point), for sequences that can share work between neighbours.
    #[inline]
    fn points(&self, cell: u64, replicate: u32, indices: Range<u64>) -> impl Iterator<Item = Self::Sampler> {
        let sequence = *self;
        indices.map(move |index| sequence.point(cell, replicate, index))
    }

    /// The first coordinates of the points of a range, point by point: what fresh cursors of [`points`](Sequence::points) read, for
    /// sequences that are faster by the block. `out` holds as many points as there are indices; what does not fit is left as it is.
    ///
    /// ```
    /// use fredholm::sampling::{Sequence, Sobol};
    /// let mut pairs = [0.0; 2 * 4];
    /// Sobol::new(0).unscrambled().fill(0, 0, 0..4, &mut pairs);
    /// assert_eq!(pairs.map(|x| (x * 4.0) as u32), [0, 0, 2, 2, 1, 3, 3, 1]);
    /// ```
    fn fill(&self, cell: u64, replicate: u32, indices: Range<u64>, out: &mut [f64]) {
        let dimension = coordinates_each(&indices, out.len());
        let cursors = self.points(cell, replicate, indices);
        for (mut u, point) in cursors.zip(out.chunks_exact_mut(dimension.max(1))) {
            point.iter_mut().for_each(|x| *x = u.next_1d());
        }
    }

    /// The same kind with another seed: for pilots, which must not share points with the main run.
    #[must_use]
    fn with_seed(self, seed: u64) -> Self;

    /// `None` if the points are independent: the error then comes from all walks. Otherwise the number of independent randomisations,
    /// from which it comes (Student, theory (4.14.4)).
    fn replicates(&self) -> Option<u32> {
        None
    }

    /// Whether cells and replicates differ: `false` for the points of the textbook, which exist only once.
    fn is_randomised(&self) -> bool {
        true
    }

    /// Kind and seed in words, to tell whether a checkpoint belongs to this sequence.
    fn describe(&self) -> String {
        format!("{self:?}")
    }
}

/// How many numbers of a list belong to each of a range of points.
fn coordinates_each(indices: &Range<u64>, numbers: usize) -> usize {
    let points = indices.end.saturating_sub(indices.start);
    (numbers as u64).checked_div(points).unwrap_or(0) as usize
}
