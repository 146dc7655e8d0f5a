//! Closures as kernels.

use super::{HasDomain, Kernel, Operator};
use crate::domain::Domain;
use crate::error::Error;
use crate::value::Weight;
use std::marker::PhantomData;

/// A kernel given by a closure on a domain; see [`kernel_fn`].
#[derive(Clone, Copy)]
pub struct KernelFn<D, F, W> {
    domain: D,
    function: F,
    weight: PhantomData<fn() -> W>,
}

impl<D: std::fmt::Debug, F, W> std::fmt::Debug for KernelFn<D, F, W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("KernelFn").field("domain", &self.domain).finish_non_exhaustive()
    }
}

/// K(x, y) from a closure on references to points.
///
/// ```
/// use fredholm::{domain::Cuboid, kernel::{kernel_fn, Kernel}};
/// let k = kernel_fn(Cuboid::<2>::unit(), |x, y| 0.1 * (x[0] * y[0] + x[1] * y[1]));
/// assert_eq!(k.eval(&[1.0, 1.0], &[1.0, 1.0]), 0.2);
/// ```
pub fn kernel_fn<D, W, F>(domain: D, function: F) -> KernelFn<D, F, W>
where
    D: Domain,
    W: Weight,
    F: Fn(&D::Point, &D::Point) -> W + Send + Sync,
{
    KernelFn { domain, function, weight: PhantomData }
}

impl<D, F, W> Operator for KernelFn<D, F, W>
where
    D: Domain,
    W: Weight,
    F: Fn(&D::Point, &D::Point) -> W + Send + Sync,
{
    type Point = D::Point;
    type Weight = W;
    fn validate(&self) -> Result<(), Error> {
        self.domain.validate()
    }
}

impl<D, F, W> Kernel for KernelFn<D, F, W>
where
    D: Domain,
    W: Weight,
    F: Fn(&D::Point, &D::Point) -> W + Send + Sync,
{
    #[inline]
    fn eval(&self, x: &D::Point, y: &D::Point) -> W {
        (self.function)(x, y)
    }
}

impl<D, F, W> HasDomain for KernelFn<D, F, W>
where
    D: Domain,
    W: Weight,
    F: Fn(&D::Point, &D::Point) -> W + Send + Sync,
{
    type Domain = D;
    fn domain(&self) -> &D {
        &self.domain
    }
}
