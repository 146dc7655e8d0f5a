//! Plain integrals I = ∫_Ω f dμ: what random walks stand on.
//!
//! A **primary** estimator turns one point of the unit cube into one unbiased score of I; the **secondary** estimator is the mean of n of them.
//! Everything that reduces variance is a better primary estimator, a better set of points, or a split of the cube.
//!
//! | method | score | variance |
//! |---|---|---|
//! | [`Secondary::plain`] | f(ξ)/p(ξ), ξ by the domain's map | (∫f²/p − I²)/n |
//! | [`Secondary::importance`] | f(ξ)/p(ξ), ξ ~ any [`Density`] p | (∫f²/p − I²)/n |
//! | [`Secondary::combined`] | Σ w_i f/(n_i p_i): average, maximum, balance, power weights | theory (4.4.6) |
//! | [`Combined::optimal`] | the same with α from a pilot: never worse than balance | theory (4.4.8) |
//! | [`Control`] | any of these for f − αg, plus α∫g | falls by the squared correlation |
//! | [`Roulette`] | any of these with probability P, divided by P | rises, cost falls |
//! | [`Stratified`] | any of these in every cell of a split cube | Σ v_i² σ_i²/n_i |
//! | [`Gauss`] | – | deterministic |
//!
//! All work with any [`Sequence`](crate::sampling::Sequence), with errors from independent points or from independent randomisations. The variance
//! of a method can be [predicted](Integral::predict) by quadrature beside the measured one.
//!
//! ```
//! use fredholm::integral::{Gauss, Integral, Secondary, inverse};
//! let integral = Integral::on_interval(0.0..=1.0, |x| x * x);
//! let plain = Secondary::plain().samples(1 << 14).seed(1);
//! let importance = Secondary::importance(inverse(|u: f64| u.sqrt(), |x| 2.0 * x)).samples(1 << 14).seed(1);
//! let (a, b) = (integral.solve(&plain)?, integral.solve(&importance)?);
//! assert!(a.agrees_with(1.0 / 3.0, 4.0) && b.agrees_with(1.0 / 3.0, 4.0));
//! // 4/45 and 1/72 for one sample, measured and predicted
//! let rule = Gauss::legendre(4, 8);
//! assert!((integral.predict(&importance, &rule)? * (1 << 14) as f64 - 1.0 / 72.0).abs() < 1e-12);
//! assert!((b.variance().unwrap() * 72.0 - 1.0).abs() < 0.1);
//! # Ok::<(), fredholm::Error>(())
//! ```

mod allocation;
mod combined;
mod control;
mod density;
mod draw;
mod gauss;
mod importance;
mod optimal;
mod plain;
mod predict;
mod roulette;
mod secondary;
mod strata;
mod stratified;
mod stratified_variance;

pub use allocation::Allocation;
pub use combined::Combined;
pub use control::{Coefficient, Control};
pub use density::{Density, Unit, Warp, inverse, warp};
pub use gauss::Gauss;
pub use importance::Importance;
pub use plain::Plain;
pub use predict::{Predict, Predictable};
pub use roulette::Roulette;
pub use secondary::{Primary, Secondary};
pub use strata::Strata;
pub use stratified::Stratified;

use crate::contained::contained;
use crate::domain::{Domain, Interval};
use crate::error::Error;
use crate::source::{Source, SourceFn, TabulatedSource, source_fn};
use crate::value::Value;

/// The integral ∫_Ω f dμ of an integrand over a domain.
///
/// ```
/// use fredholm::{Integral, domain::Cuboid, integral::Secondary};
/// let integral = Integral::on(Cuboid::<2>::unit(), |x| x[0] * x[1]);
/// assert!(integral.solve(&Secondary::plain())?.agrees_with(0.25, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Integral<D, G> {
    domain: D,
    integrand: G,
}

impl Integral<(), ()> {
    /// f as a closure of numbers on an interval.
    pub fn on_interval<V, F>(
        interval: impl Into<Interval>,
        f: F,
    ) -> Integral<Interval, SourceFn<Interval, impl Fn(&f64) -> V + Send + Sync + Clone, V>>
    where
        V: Value,
        F: Fn(f64) -> V + Send + Sync + Clone,
    {
        Integral::on(interval.into(), move |x: &f64| f(*x))
    }

    /// f as a closure of points of any [`Domain`].
    pub fn on<D, V, F>(domain: D, f: F) -> Integral<D, SourceFn<D, F, V>>
    where
        D: Domain,
        V: Value,
        F: Fn(&D::Point) -> V + Send + Sync,
    {
        Integral { integrand: source_fn(domain.clone(), f), domain }
    }
}

impl<D: Domain, G: Source<Point = D::Point>> Integral<D, G> {
    /// Any [`Source`] over a domain.
    pub fn new(domain: D, integrand: G) -> Self {
        Integral { domain, integrand }
    }

    /// Solves with one method.
    ///
    /// # Errors
    /// Those of the method; [`Error::Panicked`].
    pub fn solve<M: Integrator<D, G> + ?Sized>(&self, method: &M) -> Result<M::Solution, Error> {
        contained(|| method.solve(self))
    }

    /// The variance that `method` will have, by the exact formula with `rule` for its integrals; infinite where the density misses a node with f ≠ 0.
    ///
    /// # Errors
    /// Those of the method and of the rule.
    pub fn predict<M: Predictable<D, G>>(&self, method: &M, rule: &Gauss) -> Result<G::Value, Error> {
        contained(|| method.predict(self, rule))
    }

    /// A density ∝ |f| from a table of `cells` cells, with a tenth of the domain's own density (one-dimensional domains).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a domain of more than one dimension or no cells; [`Error::NonFiniteIntegrand`] with the place.
    pub fn tabulated(&self, cells: usize) -> Result<TabulatedSource<D>, Error> {
        contained(|| TabulatedSource::new(&self.domain, |x| self.integrand.eval(x), cells)).map_err(|error| match error {
            Error::NonFiniteSource { at, value } => Error::NonFiniteIntegrand { at, value },
            other => other,
        })
    }

    /// Ω.
    pub fn domain(&self) -> &D {
        &self.domain
    }

    /// f.
    pub fn integrand(&self) -> &G {
        &self.integrand
    }

    fn validate(&self) -> Result<(), Error> {
        self.domain.validate()?;
        self.integrand.validate()
    }
}

/// A way to find an integral. Object-safe: dispatch happens once a solve and nowhere deeper.
pub trait Integrator<D, G> {
    /// What it finds: an [`Estimate`](crate::Estimate), or a value.
    type Solution;

    /// Solves.
    ///
    /// # Errors
    /// See [`Error`]: nothing is clamped, dropped or regularised silently.
    fn solve(&self, integral: &Integral<D, G>) -> Result<Self::Solution, Error>;
}
