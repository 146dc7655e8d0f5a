//! The end of a forward walk at a detector.

use crate::detector::StartPdf;
use crate::domain::Point;
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
/// Where forward walks have the states of backward ones, every detector with densities is one.
#[diagnostic::on_unimplemented(
    message = "forward walks in states `{Z}` do not end at `{Self}`",
    note = "bidirectional walks also hit the detector: implement `StartPdf`, and `walk::Meet` where forward walks have states of their own"
)]
pub trait Meet<Z: Point, V: Value>: StartPdf {
    /// Calls `found` for every cell whose h does not vanish at z; nothing where p₀ is infinite.
    fn meet<S: Sampler>(&self, z: &Z, load: V, u: &mut S, found: impl FnMut(Met<Self::Point, V>));
}

impl<D: StartPdf, V: Value> Meet<D::Point, V> for D {
    #[inline]
    fn meet<S: Sampler>(&self, z: &D::Point, load: V, _: &mut S, mut found: impl FnMut(Met<D::Point, V>)) {
        if !D::EXTENDED {
            return;
        }
        self.near(z, |cell| {
            let pdf = self.start_pdf(cell, z);
            if !pdf.is_infinite() {
                found(Met { cell, point: *z, score: load.scale(self.importance(cell, z)), pdf });
            }
        });
    }
}
