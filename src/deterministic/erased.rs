//! Kernels and sources behind one type for a domain, so that what chooses panels, integrates towards the diagonal and checks answers is compiled once and not
//! for every closure. A call costs 1–2 ns more; rows of plain rules keep the type of the kernel.

use crate::domain::Domain;
use crate::equation::Equation;
use crate::kernel::{HasDomain, Kernel, Operator, Split};
use crate::source::Source;
use crate::value::{Value, Weight};
use std::fmt;

/// A kernel by its values.
pub(crate) struct Erased<'a, D: Domain, W: Weight> {
    kernel: &'a dyn Kernel<Point = D::Point, Weight = W>,
    domain: &'a D,
}

/// `kernel` by its values; what is erased already stays as it is.
pub(crate) fn erased<K: Kernel + HasDomain>(kernel: &K) -> Erased<'_, K::Domain, K::Weight> {
    Erased { kernel: kernel.behind().unwrap_or(kernel), domain: kernel.domain() }
}

impl<D: Domain, W: Weight> Clone for Erased<'_, D, W> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D: Domain, W: Weight> Copy for Erased<'_, D, W> {}

impl<D: Domain, W: Weight> fmt::Debug for Erased<'_, D, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Erased").field("domain", self.domain).finish_non_exhaustive()
    }
}

impl<D: Domain, W: Weight> Operator for Erased<'_, D, W> {
    type Point = D::Point;
    type Weight = W;
}

impl<D: Domain, W: Weight> Kernel for Erased<'_, D, W> {
    #[inline]
    fn eval(&self, x: &D::Point, y: &D::Point) -> W {
        self.kernel.eval(x, y)
    }
    fn eval_at_difference(&self, x: &D::Point, y: &D::Point, difference: f64) -> Option<W> {
        self.kernel.eval_at_difference(x, y, difference)
    }
    fn split(&self, x: &D::Point, y: &D::Point, difference: f64) -> Option<Split<W>> {
        self.kernel.split(x, y, difference)
    }
    fn behind(&self) -> Option<&dyn Kernel<Point = D::Point, Weight = W>> {
        Some(self.kernel)
    }
}

impl<D: Domain, W: Weight> HasDomain for Erased<'_, D, W> {
    type Domain = D;
    fn domain(&self) -> &D {
        self.domain
    }
}

/// A source by its values.
pub(crate) struct ErasedSource<'a, X, V> {
    source: &'a dyn Source<Point = X, Value = V>,
}

impl<X, V> Clone for ErasedSource<'_, X, V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<X, V> Copy for ErasedSource<'_, X, V> {}

impl<X: crate::domain::Point, V: Value> Source for ErasedSource<'_, X, V> {
    type Point = X;
    type Value = V;
    fn eval(&self, x: &X) -> V {
        self.source.eval(x)
    }
}

/// An equation by its values.
pub(crate) type ErasedEquation<'a, D, W> = Equation<ErasedSource<'a, <D as Domain>::Point, <W as Weight>::Value>, Erased<'a, D, W>>;

/// The same equation, with the types of its closures forgotten.
pub(crate) fn by_values<G, K>(equation: &Equation<G, K>) -> ErasedEquation<'_, K::Domain, K::Weight>
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    Equation::new(ErasedSource { source: equation.source() }, erased(equation.kernel()))
}
