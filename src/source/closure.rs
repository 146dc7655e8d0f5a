//! Sources given by closures.

use super::{Birth, Emit, EmitPdf, SampleSource, Source, TabulatedSource};
use crate::contained::contained;
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::kernel::{Proposal, Uniform};
use crate::sampling::Sampler;
use crate::value::Value;
use std::marker::PhantomData;

/// A source given by a closure on a domain and a density to sample it from; see [`source_fn`].
#[derive(Clone, Copy)]
pub struct SourceFn<D, F, V, Q = Uniform<D>> {
    domain: D,
    function: F,
    density: Q,
    value: PhantomData<fn() -> V>,
}

impl<D: std::fmt::Debug, F, V, Q: std::fmt::Debug> std::fmt::Debug for SourceFn<D, F, V, Q> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SourceFn").field("domain", &self.domain).field("density", &self.density).finish_non_exhaustive()
    }
}

/// g from a closure on references to points, sampled uniformly on the domain.
///
/// ```
/// use fredholm::{domain::Cuboid, source::{source_fn, Source}};
/// let g = source_fn(Cuboid::<3>::unit(), |x| x[0] + x[1] * x[2]);
/// assert_eq!(g.eval(&[1.0, 2.0, 0.5]), 2.0);
/// ```
pub fn source_fn<D, V, F>(domain: D, function: F) -> SourceFn<D, F, V>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
{
    SourceFn { density: Uniform::on(domain.clone()), domain, function, value: PhantomData }
}

impl<D, F, V, Q> SourceFn<D, F, V, Q>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
{
    /// The same source, sampled from a table ∝ |g| on `cells` cells (one-dimensional domains).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a domain of more than one dimension or `cells` = 0; [`Error::NonFiniteSource`] with the place.
    pub fn tabulated(self, cells: usize) -> Result<SourceFn<D, F, V, TabulatedSource<D>>, Error> {
        let density = contained(|| TabulatedSource::new(&self.domain, &self.function, cells))?;
        Ok(SourceFn { domain: self.domain, function: self.function, density, value: PhantomData })
    }
}

impl<D, F, V, Q> Source for SourceFn<D, F, V, Q>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
    Q: Send + Sync,
{
    type Point = D::Point;
    type Value = V;
    #[inline]
    fn eval(&self, x: &D::Point) -> V {
        (self.function)(x)
    }
    fn validate(&self) -> Result<(), Error> {
        self.domain.validate()
    }
}

impl<D, F, V, Q> SampleSource for SourceFn<D, F, V, Q>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
    Q: Proposal<D::Point>,
{
    #[inline]
    fn sample_for<S: Sampler>(&self, x: &D::Point, u: &mut S) -> Option<Node<D::Point>> {
        Some(self.density.sample(x, u))
    }
    #[inline]
    fn pdf_for(&self, x: &D::Point, y: &D::Point) -> f64 {
        self.density.pdf(x, y)
    }
}

/// Births by the domain's own density.
impl<D, F, V> Emit for SourceFn<D, F, V, Uniform<D>>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
{
    type State = D::Point;
    #[inline]
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<D::Point, V> {
        let n = self.domain.sample(u);
        Birth { point: n.point, weight: (self.function)(&n.point).scale(n.weight) }
    }
}

impl<D, F, V> EmitPdf for SourceFn<D, F, V, Uniform<D>>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
{
    #[inline]
    fn emit_pdf(&self, z: &D::Point) -> f64 {
        self.domain.density(z)
    }
}

/// Births by the table.
impl<D, F, V> Emit for SourceFn<D, F, V, TabulatedSource<D>>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
{
    type State = D::Point;
    #[inline]
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<D::Point, V> {
        let n = self.density.draw(u);
        Birth { point: n.point, weight: (self.function)(&n.point).scale(n.weight) }
    }
}

impl<D, F, V> EmitPdf for SourceFn<D, F, V, TabulatedSource<D>>
where
    D: Domain,
    V: Value,
    F: Fn(&D::Point) -> V + Send + Sync,
{
    #[inline]
    fn emit_pdf(&self, z: &D::Point) -> f64 {
        self.density.density(z)
    }
}
