//! The source g, and how to sample it for next-event estimation.

use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::kernel::Uniform;
use crate::sampling::{Sampler, Table};
use crate::value::Value;
use std::marker::PhantomData;

/// The source g of f = g + Tf.
#[diagnostic::on_unimplemented(message = "`{Self}` is not a source", note = "implement `Source`, or use `source_fn(domain, |x| …)`")]
pub trait Source: Send + Sync {
    /// Where g is evaluated.
    type Point: Point;
    /// What g is.
    type Value: Value;

    /// g(x).
    fn eval(&self, x: &Self::Point) -> Self::Value;

    /// Refuses parameters outside their range; called before every solve.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value.
    fn validate(&self) -> Result<(), Error> {
        Ok(())
    }
}

/// Draws points of the source as seen from x.
///
/// Laws: `sample_for(x).weight == 1/pdf_for(x, sample_for(x).point)`; ∫ pdf_for(x, y) dμ(y) = 1; `pdf_for(x, y) > 0` wherever K(x, y) g(y) ≠ 0.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be sampled",
    note = "next-event estimation and MIS draw points of the source: implement `SampleSource`, or use `source_fn(domain, g)`"
)]
pub trait SampleSource: Source {
    /// A point y ~ q(· given x) with `weight` = 1/q; `None` where nothing can be seen from x.
    fn sample_for<S: Sampler>(&self, x: &Self::Point, u: &mut S) -> Option<Node<Self::Point>>;

    /// q(y given x).
    fn pdf_for(&self, x: &Self::Point, y: &Self::Point) -> f64;
}

/// Where a forward (adjoint) walk starts, with its weight g/q₀.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Birth<X, V> {
    /// X₀ ~ q₀.
    pub point: X,
    /// g(X₀)/q₀(X₀).
    pub weight: V,
}

/// Starts forward walks.
///
/// Law: `E[weight · φ(point)] = ∫ g φ dμ` for every φ; q₀ > 0 wherever g ≠ 0.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot start a forward walk",
    note = "forward walks begin at a point of the source: implement `Emit`, or use `source_fn(domain, g)`"
)]
pub trait Emit: Source {
    /// States of forward walks: points of the source, unless [adjoint](crate::kernel::HasAdjoint) walks live elsewhere.
    type State: Point;

    /// A birth.
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<Self::State, Self::Value>;
}

impl<T: Emit> Emit for &T {
    type State = T::State;
    #[inline]
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<Self::State, Self::Value> {
        (**self).emit(u)
    }
}

impl<T: Source + ?Sized> Source for &T {
    type Point = T::Point;
    type Value = T::Value;
    #[inline]
    fn eval(&self, x: &Self::Point) -> Self::Value {
        (**self).eval(x)
    }
    fn validate(&self) -> Result<(), Error> {
        (**self).validate()
    }
}

impl<T: SampleSource> SampleSource for &T {
    #[inline]
    fn sample_for<S: Sampler>(&self, x: &Self::Point, u: &mut S) -> Option<Node<Self::Point>> {
        (**self).sample_for(x, u)
    }
    #[inline]
    fn pdf_for(&self, x: &Self::Point, y: &Self::Point) -> f64 {
        (**self).pdf_for(x, y)
    }
}

/// The density of births.
///
/// Law: for every set B, `∫_B emit_pdf(z) dμ(z) = P(emit().point ∈ B)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not state the density of its births",
    note = "bidirectional walks weigh the strategies of a path by their densities: implement `EmitPdf`, or use `source_fn(domain, g)`"
)]
pub trait EmitPdf: Emit {
    /// q₀(z); infinite for sources of no extent, which no backward walk can find.
    fn emit_pdf(&self, z: &Self::State) -> f64;
}

impl<T: EmitPdf> EmitPdf for &T {
    #[inline]
    fn emit_pdf(&self, z: &T::State) -> f64 {
        (**self).emit_pdf(z)
    }
}

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
        let density = TabulatedSource::new(&self.domain, &self.function, cells)?;
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
    Q: crate::kernel::Proposal<D::Point>,
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

/// A density tabulated ∝ |g| with a share of the domain's own density, whatever x.
#[derive(Clone, Debug)]
pub struct TabulatedSource<D> {
    domain: D,
    table: Option<Table>,
}

/// Share of the domain's own density: a cell whose samples of g all vanish may still hold g ≠ 0.
const DEFENSIVE: f64 = 0.1;

impl<D: Domain> TabulatedSource<D> {
    pub(crate) fn new<V: Value>(domain: &D, g: impl Fn(&D::Point) -> V, cells: usize) -> Result<Self, Error> {
        domain.validate()?;
        if cells == 0 {
            return Err(Error::invalid("cells", 0.0, "must be at least 1"));
        }
        if domain.dimension() != 1 {
            return Err(Error::invalid("dimension", domain.dimension() as f64, "tabulated sources need a one-dimensional domain"));
        }
        let h = 1.0 / cells as f64;
        let mut weights = Vec::with_capacity(domain.states() * cells);
        for i in 0..domain.states() * cells {
            let mut mean = 0.0;
            for offset in [0.125, 0.375, 0.625, 0.875] {
                let y = domain.place(i / cells, || ((i % cells) as f64 + offset) * h);
                let value = g(&y.point);
                if !value.all_finite() {
                    return Err(Error::non_finite_source(&y.point, &value));
                }
                mean += 0.25 * value.magnitude() * y.weight;
            }
            weights.push(mean);
        }
        Ok(TabulatedSource { domain: domain.clone(), table: Table::new(&weights) })
    }

    /// A point and 1/density.
    #[inline]
    pub(crate) fn draw<S: Sampler>(&self, u: &mut S) -> Node<D::Point> {
        let v = u.next_1d();
        let Some(table) = &self.table else { return self.domain.sample(u) };
        let y = if v < DEFENSIVE {
            self.domain.sample(u).point
        } else {
            let states = self.domain.states();
            let t = table.sample((v - DEFENSIVE) / (1.0 - DEFENSIVE)).0 * states as f64;
            let state = (t as usize).min(states - 1);
            self.domain.place(state, || (t - state as f64).clamp(f64::EPSILON / 2.0, 1.0 - f64::EPSILON / 2.0)).point
        };
        Node { point: y, weight: 1.0 / self.density(&y) }
    }

    /// Density at y.
    #[inline]
    pub(crate) fn density(&self, y: &D::Point) -> f64 {
        let own = self.domain.density(y);
        let Some(table) = &self.table else { return own };
        let t = (self.domain.state(y) as f64 + self.domain.coordinate(y, 0)) / self.domain.states() as f64;
        own * (DEFENSIVE + (1.0 - DEFENSIVE) * table.pdf(t))
    }
}

impl<D: Domain> crate::kernel::Proposal<D::Point> for TabulatedSource<D> {
    #[inline]
    fn sample<S: Sampler>(&self, _: &D::Point, u: &mut S) -> Node<D::Point> {
        self.draw(u)
    }

    #[inline]
    fn pdf(&self, _: &D::Point, y: &D::Point) -> f64 {
        self.density(y)
    }
}
