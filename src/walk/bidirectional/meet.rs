//! The end of a forward walk at a detector.

use crate::detector::{At, Bins, Functional, Points, StartPdf};
use crate::domain::{Domain, Point};
use crate::sampling::Sampler;
use crate::value::Value;

/// A cell that a forward walk has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met<X, V> {
    /// The cell j.
    pub cell: usize,
    /// What the place is to a backward walk that starts there from this cell.
    pub point: X,
    /// h_j times the load.
    pub score: V,
    /// Density p₀ of that start.
    pub pdf: f64,
}

/// A detector that forward walks may end at, in any of its cells: strategies without a vertex from the detector.
///
/// Law: `score` is what [`Score`](crate::detector::Score) adds, and `pdf` the [`start_pdf`](StartPdf::start_pdf) of `point`. A detector that looks from a
/// random place, such as a lens, draws it from `u` as its starts do, and both densities leave it out.
///
/// Where forward walks have the states of backward ones, [`meet_by_density`] is all there is to it.
#[diagnostic::on_unimplemented(
    message = "forward walks in states `{Z}` do not end at `{Self}`",
    note = "bidirectional walks also hit the detector: implement `StartPdf` and `walk::Meet`"
)]
pub trait Meet<Z: Point, V: Value>: StartPdf {
    /// Calls `found` for every cell whose h does not vanish at z; nothing where p₀ is infinite.
    fn meet<S: Sampler>(&self, z: &Z, load: V, u: &mut S, found: impl FnMut(Met<Self::Point, V>));
}

/// [`Meet::meet`] of a detector whose starts forward walks come to in the same state: by `importance` and `start_pdf`.
#[inline]
pub fn meet_by_density<D: StartPdf, V: Value>(detector: &D, z: &D::Point, load: V, mut found: impl FnMut(Met<D::Point, V>)) {
    detector.near(z, |cell| {
        let pdf = detector.start_pdf(cell, z);
        if !pdf.is_infinite() {
            found(Met { cell, point: *z, score: load.scale(detector.importance(cell, z)), pdf });
        }
    });
}

/// No walk ends at a point.
impl<Z: Point, X: Point, V: Value> Meet<Z, V> for At<X> {
    fn meet<S: Sampler>(&self, _: &Z, _: V, _: &mut S, _: impl FnMut(Met<X, V>)) {}
}

/// No walk ends at a point.
impl<Z: Point, X: Point, V: Value> Meet<Z, V> for Points<X> {
    fn meet<S: Sampler>(&self, _: &Z, _: V, _: &mut S, _: impl FnMut(Met<X, V>)) {}
}

impl<V: Value> Meet<f64, V> for Bins {
    #[inline]
    fn meet<S: Sampler>(&self, z: &f64, load: V, _: &mut S, found: impl FnMut(Met<f64, V>)) {
        meet_by_density(self, z, load, found);
    }
}

impl<D: Domain, H: Fn(&D::Point) -> f64 + Send + Sync, V: Value> Meet<D::Point, V> for Functional<D, H> {
    #[inline]
    fn meet<S: Sampler>(&self, z: &D::Point, load: V, _: &mut S, found: impl FnMut(Met<D::Point, V>)) {
        meet_by_density(self, z, load, found);
    }
}
