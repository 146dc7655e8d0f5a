//! Kernels of x, y *and* x − y.
//!
//! Near the diagonal x − y, computed from x and y, has lost its digits: at a distance of 10⁻¹² four are left, and |x − y|^−α with α ≥ ½ feels it
//! (problems §1.4). Deterministic solves know the distance before they round y, and pass it on to kernels that take it.
//!
//! Who knows more than that, K(x, y) = factor(x, y) S(x − y) + rest(x, y) with S = ln|x − y| or |x − y|^−α and `factor`, `rest` smooth on each side of the
//! diagonal, declares it: S is then integrated exactly (problems §4, algorithm 1), with some ten times fewer values of the kernel.

use super::{HasDomain, Kernel, Operator};
use crate::domain::Domain;
use crate::error::Error;
use crate::value::Weight;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Add;

/// S(x − y): how a kernel is singular on the diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Singularity {
    /// ln|x − y|.
    Logarithm,
    /// |x − y|^−α, α < 1.
    Power {
        /// α.
        exponent: f64,
    },
}

impl Singularity {
    /// S at the difference d = x − y.
    #[must_use]
    pub fn at(self, difference: f64) -> f64 {
        match self {
            Singularity::Logarithm => difference.abs().ln(),
            Singularity::Power { exponent } => difference.abs().powf(-exponent),
        }
    }

    fn validate(self) -> Result<(), Error> {
        match self {
            Singularity::Power { exponent } if !(exponent < 1.0 && exponent.is_finite()) => {
                Err(Error::invalid("exponent", exponent, "must be below 1: |x − y|^−α with α ≥ 1 has no integral"))
            }
            _ => Ok(()),
        }
    }
}

/// K(x, y) = `factor` S(x − y) + `rest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split<W> {
    /// S.
    pub singularity: Singularity,
    /// What multiplies S at (x, y).
    pub factor: W,
    /// What is added at (x, y).
    pub rest: W,
}

impl<W: Weight + Add<Output = W>> Split<W> {
    /// K at the difference x − y.
    #[must_use]
    pub fn value(&self, difference: f64) -> W {
        self.factor.scaled(self.singularity.at(difference)) + self.rest
    }
}

/// A kernel given by a closure of (x, y, x − y); see [`difference_fn`].
#[derive(Clone, Copy)]
pub struct DifferenceFn<D, F, W> {
    domain: D,
    function: F,
    weight: PhantomData<fn() -> W>,
}

/// K(x, y, x − y) from a closure that need not subtract.
///
/// ```
/// use fredholm::{domain::Interval, deterministic::Nystrom, kernel::{difference_fn, Proposed, Uniform}, source::source_fn, Equation};
/// let domain = Interval::from(0.0..=1.0);
/// let kernel = difference_fn(domain, |_: &f64, _: &f64, d: f64| 0.1 * d.abs().powf(-0.5));
/// let eq = Equation::new(source_fn(domain, |_: &f64| 1.0), Proposed::new(kernel, Uniform::on(domain)));
/// let f = eq.solve(&Nystrom::adaptive().tolerance(1e-10))?;
/// assert!((f.eval(0.5) - 1.0 - f.integral_term(0.5)?).abs() < 1e-14);
/// # Ok::<(), fredholm::Error>(())
/// ```
pub fn difference_fn<D, W, F>(domain: D, function: F) -> DifferenceFn<D, F, W>
where
    D: Domain<Point = f64>,
    W: Weight,
    F: Fn(&f64, &f64, f64) -> W + Send + Sync,
{
    DifferenceFn { domain, function, weight: PhantomData }
}

/// A kernel declared as factor · S + rest; see [`split_fn`].
#[derive(Clone, Copy)]
pub struct SplitFn<D, F, R, W> {
    domain: D,
    singularity: Singularity,
    factor: F,
    rest: R,
    weight: PhantomData<fn() -> W>,
}

/// K(x, y) = factor(x, y) S(x − y) + rest(x, y).
///
/// ```
/// use fredholm::{domain::Interval, deterministic::Nystrom, kernel::{split_fn, Proposed, Singularity, Uniform}, source::source_fn, Equation};
/// // f(x) = 1 + ∫₋₁¹ ln|x − y| f(y) dy
/// let domain = Interval::from(-1.0..=1.0);
/// let kernel = split_fn(domain, Singularity::Logarithm, |_: &f64, _: &f64| 1.0, |_: &f64, _: &f64| 0.0);
/// let eq = Equation::new(source_fn(domain, |_: &f64| 1.0), Proposed::new(kernel, Uniform::on(domain)));
/// let f = eq.solve(&Nystrom::adaptive().tolerance(1e-12))?;
/// assert!((f.eval(0.0) - 0.320_082_831_282_398).abs() < 1e-12);
/// # Ok::<(), fredholm::Error>(())
/// ```
pub fn split_fn<D, W, F, R>(domain: D, singularity: Singularity, factor: F, rest: R) -> SplitFn<D, F, R, W>
where
    D: Domain<Point = f64>,
    W: Weight + Add<Output = W>,
    F: Fn(&f64, &f64) -> W + Send + Sync,
    R: Fn(&f64, &f64) -> W + Send + Sync,
{
    SplitFn { domain, singularity, factor, rest, weight: PhantomData }
}

impl<D, F, W> Operator for DifferenceFn<D, F, W>
where
    D: Domain<Point = f64>,
    W: Weight,
    F: Fn(&f64, &f64, f64) -> W + Send + Sync,
{
    type Point = f64;
    type Weight = W;
    fn validate(&self) -> Result<(), Error> {
        self.domain.validate()
    }
}

impl<D, F, W> Kernel for DifferenceFn<D, F, W>
where
    D: Domain<Point = f64>,
    W: Weight,
    F: Fn(&f64, &f64, f64) -> W + Send + Sync,
{
    #[inline]
    fn eval(&self, x: &f64, y: &f64) -> W {
        (self.function)(x, y, x - y)
    }
    #[inline]
    fn eval_at_difference(&self, x: &f64, y: &f64, difference: f64) -> Option<W> {
        Some((self.function)(x, y, difference))
    }
}

impl<D, F, W> HasDomain for DifferenceFn<D, F, W>
where
    D: Domain<Point = f64>,
    W: Weight,
    F: Fn(&f64, &f64, f64) -> W + Send + Sync,
{
    type Domain = D;
    fn domain(&self) -> &D {
        &self.domain
    }
}

impl<D, F, R, W> Operator for SplitFn<D, F, R, W>
where
    D: Domain<Point = f64>,
    W: Weight + Add<Output = W>,
    F: Fn(&f64, &f64) -> W + Send + Sync,
    R: Fn(&f64, &f64) -> W + Send + Sync,
{
    type Point = f64;
    type Weight = W;
    fn validate(&self) -> Result<(), Error> {
        self.singularity.validate()?;
        self.domain.validate()
    }
}

impl<D, F, R, W> Kernel for SplitFn<D, F, R, W>
where
    D: Domain<Point = f64>,
    W: Weight + Add<Output = W>,
    F: Fn(&f64, &f64) -> W + Send + Sync,
    R: Fn(&f64, &f64) -> W + Send + Sync,
{
    fn eval(&self, x: &f64, y: &f64) -> W {
        (self.factor)(x, y).scaled(self.singularity.at(x - y)) + (self.rest)(x, y)
    }
    fn eval_at_difference(&self, x: &f64, y: &f64, difference: f64) -> Option<W> {
        self.split(x, y, difference).map(|s| s.value(difference))
    }
    fn split(&self, x: &f64, y: &f64, _: f64) -> Option<Split<W>> {
        Some(Split { singularity: self.singularity, factor: (self.factor)(x, y), rest: (self.rest)(x, y) })
    }
}

impl<D, F, R, W> HasDomain for SplitFn<D, F, R, W>
where
    D: Domain<Point = f64>,
    W: Weight + Add<Output = W>,
    F: Fn(&f64, &f64) -> W + Send + Sync,
    R: Fn(&f64, &f64) -> W + Send + Sync,
{
    type Domain = D;
    fn domain(&self) -> &D {
        &self.domain
    }
}

impl<D: fmt::Debug, F, W> fmt::Debug for DifferenceFn<D, F, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DifferenceFn").field("domain", &self.domain).finish_non_exhaustive()
    }
}

impl<D: fmt::Debug, F, R, W> fmt::Debug for SplitFn<D, F, R, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SplitFn").field("domain", &self.domain).field("singularity", &self.singularity).finish_non_exhaustive()
    }
}
