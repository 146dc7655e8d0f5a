//! Integrals of the solution, ⟨h, f⟩ = ∫ h f dμ.

use super::stated::{SourceText, Unary};
use crate::detector::{Detector, Start};
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::Proposal;
use crate::sampling::Sampler;
use crate::source::{SampleSource, Source, SourceFn, TabulatedSource, source_fn};
use std::fmt;

/// A functional ⟨h, f⟩, and its value if the file knows it.
#[derive(Clone)]
#[non_exhaustive]
pub struct KnownFunctional<D: Domain> {
    /// h as the file writes it.
    pub label: String,
    /// ∫ h f dμ.
    pub value: Option<f64>,
    pub(super) domain: D,
    pub(super) weight: Unary<D>,
}

impl<D: Domain> fmt::Debug for KnownFunctional<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KnownFunctional").field("label", &self.label).field("value", &self.value).finish_non_exhaustive()
    }
}

impl<D: Domain> KnownFunctional<D> {
    pub(super) fn on<E: Domain<Point = D::Point>>(&self, domain: E) -> KnownFunctional<E> {
        KnownFunctional { label: self.label.clone(), value: self.value, domain, weight: self.weight.clone() }
    }

    /// h(x).
    pub fn weight(&self, x: &D::Point) -> f64 {
        (self.weight)(x)
    }

    /// The detector that measures it with walks: starts drawn from a table ∝ |h| on one-dimensional domains, by the domain's map on others.
    ///
    /// # Errors
    /// [`Error::NonFiniteSource`] where h is not finite.
    pub fn detector(&self) -> Result<TextFunctional<'_, D>, Error> {
        let h = source_fn(self.domain.clone(), &*self.weight);
        let starts = if self.domain.dimension() == 1 { Starts::Table(h.tabulated(CELLS)?) } else { Starts::Map(h) };
        Ok(TextFunctional { starts, anywhere: self.domain.place(0, || 0.5).point })
    }
}

/// The detector of a [`KnownFunctional`].
#[derive(Debug)]
pub struct TextFunctional<'a, D: Domain> {
    starts: Starts<'a, D>,
    /// sources are sampled as seen from a point; here the density is the same from all of them
    anywhere: D::Point,
}

#[derive(Debug)]
enum Starts<'a, D: Domain> {
    Table(SourceFn<D, SourceText<'a, D>, f64, TabulatedSource<D>>),
    Map(SourceFn<D, SourceText<'a, D>, f64>),
}

/// Cells of the table that starts are drawn from.
const CELLS: usize = 64;

impl<D: Domain> Detector for TextFunctional<'_, D> {
    type Point = D::Point;
    type Answer<T> = T;
    fn cells(&self) -> usize {
        1
    }
    #[inline]
    fn start<S: Sampler>(&self, _: usize, u: &mut S) -> Start<D::Point> {
        match &self.starts {
            Starts::Table(h) => start(h, &self.anywhere, u),
            Starts::Map(h) => start(h, &self.anywhere, u),
        }
    }
    fn answer<T>(&self, mut cells: Vec<T>) -> T {
        cells.swap_remove(0)
    }
}

#[inline]
fn start<D, Q, S>(h: &SourceFn<D, SourceText<'_, D>, f64, Q>, from: &D::Point, u: &mut S) -> Start<D::Point>
where
    D: Domain,
    Q: Proposal<D::Point>,
    S: Sampler,
{
    match h.sample_for(from, u) {
        Some(n) => Start { point: n.point, weight: h.eval(&n.point) * n.weight },
        // a density always gives a point; a weight of 0 would be right if it did not
        None => Start { point: *from, weight: 0.0 },
    }
}
