//! The cursor on a point of finitely many coordinates.

use super::Layout;
use crate::sampling::hash::{open_unit, word};
use crate::sampling::{Purpose, Sampler};
use std::fmt::Debug;

/// A point of finitely many coordinates, each a pure function of its number. Implement it for point sets of your own.
///
/// Law: coordinates are strictly inside (0, 1).
///
/// ```
/// use fredholm::sampling::{Coordinates, Layout, PointSampler, Sampler, Sequence};
/// use std::f64::consts::TAU;
///
/// /// A rank-1 lattice with a generating vector of your own, randomly shifted: {i z/n + Δ}.
/// #[derive(Clone, Copy, Debug)]
/// struct Lattice { points: u64, seed: u64 }
///
/// #[derive(Clone, Debug)]
/// struct LatticePoint { index: u64, points: u64, shift: [f64; 3], key: u64 }
///
/// impl Coordinates for LatticePoint {
///     fn count(&self) -> u32 { 3 }
///     fn coordinate(&self, j: u32) -> f64 {
///         let z = [1, 182_667, 469_891][j as usize];
///         let x = (self.index * z % self.points) as f64 / self.points as f64 + self.shift[j as usize];
///         x.fract().max(f64::EPSILON)
///     }
///     fn key(&self) -> u64 { self.key }
/// }
///
/// impl Sequence for Lattice {
///     type Sampler = PointSampler<LatticePoint>;
///     fn point(&self, cell: u64, replicate: u32, index: u64) -> Self::Sampler {
///         let mut u = fredholm::sampling::Pcg::new(self.seed).point(cell, replicate, u64::MAX);
///         let shift = std::array::from_fn(|_| u.next_1d());
///         let key = (u.next_1d() * 1e18) as u64 ^ index;
///         PointSampler::new(LatticePoint { index, points: self.points, shift, key }, Layout::of_dimension(1))
///     }
///     fn with_seed(self, seed: u64) -> Self { Lattice { seed, ..self } }
///     fn replicates(&self) -> Option<u32> { Some(8) }
/// }
/// let mean = (0..1024).map(|i| {
///     let mut u = Lattice { points: 1024, seed: 1 }.point(0, 0, i);
///     (TAU * u.next_1d()).sin() * (TAU * u.next_1d()).cos()
/// }).sum::<f64>() / 1024.0;
/// assert!(mean.abs() < 1e-12);
/// ```
pub trait Coordinates: Clone + Debug {
    /// How many there are.
    fn count(&self) -> u32;

    /// Number `j` < `count`, in (0, 1).
    fn coordinate(&self, j: u32) -> f64;

    /// A hash of everything that tells this point from others: coordinates beyond the last one are drawn from it.
    fn key(&self) -> u64;
}

/// The cursor of one walk on a [point](Coordinates).
///
/// Fresh, it stands at coordinate 0 and reads all of them in order. [`seek`](Sampler::seek) moves it to the coordinates that the [`Layout`]
/// gives to a purpose, and confines it to them. Whatever is read beyond (a rejection loop, a late vertex) is an independent random number,
/// a pure function of the point, the vertex and the purpose: no coordinate is ever used twice.
#[derive(Clone, Debug)]
pub struct PointSampler<P> {
    point: P,
    layout: Layout,
    next: u32,
    end: u32,
    /// vertex and purpose, told apart
    block: u64,
    /// numbers read beyond the coordinates
    beyond: u64,
}

impl<P: Coordinates> PointSampler<P> {
    /// A fresh cursor.
    #[inline]
    #[must_use]
    pub fn new(point: P, layout: Layout) -> Self {
        PointSampler { next: 0, end: point.count(), point, layout, block: 0, beyond: 0 }
    }

    #[inline]
    fn independent(&mut self) -> f64 {
        self.beyond += 1;
        open_unit(word(word(self.point.key(), self.block), self.beyond))
    }
}

/// A number for each vertex and purpose, none of them 0.
#[inline]
pub(super) fn block(vertex: u64, purpose: Purpose) -> u64 {
    vertex.wrapping_mul(4).wrapping_add(purpose as u64).wrapping_add(1)
}

impl<P: Coordinates> Sampler for PointSampler<P> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        if self.next < self.end {
            self.next += 1;
            self.point.coordinate(self.next - 1)
        } else {
            self.independent()
        }
    }

    #[inline]
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        let range = self.layout.coordinates(vertex, purpose, self.point.count());
        (self.next, self.end) = (range.start, range.end);
        (self.block, self.beyond) = (block(vertex, purpose), 0);
    }
}
