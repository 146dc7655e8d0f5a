//! Densities to sample an integrand by.

use crate::domain::{Domain, Node, Point};
use crate::kernel::{Proposal, Uniform};
use crate::sampling::Sampler;
use crate::sampling::distribution::Distribution;
use crate::source::TabulatedSource;
use std::fmt::Debug;

/// A probability density p that can be sampled.
///
/// Laws: `sample(u).weight == 1/pdf(sample(u).point)`, ∫ pdf dμ = 1; and to integrate f by it, pdf > 0 wherever f ≠ 0. Points outside the domain of an
/// integral score 0 there.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a density of these points",
    note = "implement `integral::Density`, or use `inverse(|u| …, |x| …)` or `warp(|[u, v]: [f64; 2]| …, |x| …)`"
)]
pub trait Density<X>: Send + Sync {
    /// x ~ p, with `weight` = 1/p(x).
    fn sample<S: Sampler + ?Sized>(&self, u: &mut S) -> Node<X>;

    /// p(x).
    fn pdf(&self, x: &X) -> f64;
}

/// What a distribution draws from: one uniform number, or two.
pub trait Unit {
    /// Reads it.
    fn read<S: Sampler + ?Sized>(u: &mut S) -> Self;
}

impl Unit for f64 {
    #[inline]
    fn read<S: Sampler + ?Sized>(u: &mut S) -> f64 {
        u.next_1d()
    }
}

impl Unit for [f64; 2] {
    #[inline]
    fn read<S: Sampler + ?Sized>(u: &mut S) -> [f64; 2] {
        u.next_2d()
    }
}

/// Every [`Distribution`] is a density: tables, powers, exponentials, disks, hemispheres.
impl<T: Distribution<Unit: Unit> + Send + Sync> Density<T::Point> for T {
    #[inline]
    fn sample<S: Sampler + ?Sized>(&self, u: &mut S) -> Node<T::Point> {
        let point = Distribution::sample(self, T::Unit::read(u));
        let weight = 1.0 / Distribution::pdf(self, &point);
        Node { point, weight }
    }
    #[inline]
    fn pdf(&self, x: &T::Point) -> f64 {
        Distribution::pdf(self, x)
    }
}

impl<D: Domain> Density<D::Point> for Uniform<D> {
    #[inline]
    fn sample<S: Sampler + ?Sized>(&self, mut u: &mut S) -> Node<D::Point> {
        self.draw(&mut u)
    }
    #[inline]
    fn pdf(&self, x: &D::Point) -> f64 {
        // a proposal whatever the place it starts from
        Proposal::pdf(self, x, x)
    }
}

impl<D: Domain> Density<D::Point> for TabulatedSource<D> {
    #[inline]
    fn sample<S: Sampler + ?Sized>(&self, mut u: &mut S) -> Node<D::Point> {
        self.draw(&mut u)
    }
    #[inline]
    fn pdf(&self, x: &D::Point) -> f64 {
        Proposal::pdf(self, x, x)
    }
}

/// A map from the cube and the density it makes: see [`inverse`] and [`warp`].
#[derive(Clone, Copy)]
pub struct Warp<const N: usize, T, P> {
    map: T,
    pdf: P,
}

impl<const N: usize, T, P> Debug for Warp<N, T, P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Warp").field("coordinates", &N).finish_non_exhaustive()
    }
}

/// The density p of a distribution function F on the line, sampled by inversion: x = F⁻¹(u).
///
/// ```
/// use fredholm::integral::{Density, inverse};
/// let exponential = inverse(|u: f64| -(-u).ln_1p(), |x: &f64| (-x).exp());
/// assert_eq!(exponential.pdf(&0.0), 1.0);
/// ```
pub fn inverse<X, Q, P>(quantile: Q, pdf: P) -> Warp<1, impl Fn([f64; 1]) -> X + Clone + Send + Sync, P>
where
    Q: Fn(f64) -> X + Clone + Send + Sync,
    P: Fn(&X) -> f64 + Clone + Send + Sync,
{
    warp(move |[u]: [f64; 1]| quantile(u), pdf)
}

/// The density that a map x = T(u₁, …, u_N) of uniform coordinates makes.
///
/// ```
/// use fredholm::integral::{Density, warp};
/// // uniform on the unit disk
/// let disk = warp(
///     |[u, v]: [f64; 2]| { let (s, c) = (std::f64::consts::TAU * v).sin_cos(); [u.sqrt() * c, u.sqrt() * s] },
///     |x: &[f64; 2]| if x[0].hypot(x[1]) <= 1.0 { std::f64::consts::FRAC_1_PI } else { 0.0 },
/// );
/// assert_eq!(disk.pdf(&[2.0, 0.0]), 0.0);
/// ```
pub fn warp<const N: usize, X, T, P>(map: T, pdf: P) -> Warp<N, T, P>
where
    T: Fn([f64; N]) -> X + Clone + Send + Sync,
    P: Fn(&X) -> f64 + Clone + Send + Sync,
{
    Warp { map, pdf }
}

impl<const N: usize, X: Point, T, P> Density<X> for Warp<N, T, P>
where
    T: Fn([f64; N]) -> X + Send + Sync,
    P: Fn(&X) -> f64 + Send + Sync,
{
    #[inline]
    fn sample<S: Sampler + ?Sized>(&self, u: &mut S) -> Node<X> {
        let point = (self.map)(std::array::from_fn(|_| u.next_1d()));
        Node { point, weight: 1.0 / (self.pdf)(&point) }
    }
    #[inline]
    fn pdf(&self, x: &X) -> f64 {
        (self.pdf)(x)
    }
}

/// A density behind a vtable, for lists of several kinds.
pub(super) trait Erased<X>: Send + Sync {
    fn sample(&self, u: &mut dyn Sampler) -> Node<X>;
    fn pdf(&self, x: &X) -> f64;
}

impl<X, T: Density<X>> Erased<X> for T {
    fn sample(&self, u: &mut dyn Sampler) -> Node<X> {
        Density::sample(self, u)
    }
    fn pdf(&self, x: &X) -> f64 {
        Density::pdf(self, x)
    }
}
