//! The two ways to know a kernel, one capability a trait.
//!
//! - A [`Kernel`] can be *evaluated*: K(x, y) with respect to a reference measure μ. Nyström and next-event estimation need it.
//! - A [`Transition`] can be *walked*: a random step whose weight makes `E[weight · φ(point)] = (Tφ)(x)`.
//!
//! A kernel that can only be evaluated gets its walk from a [`Proposal`], exchangeable without touching the kernel ([`Proposed`]).
//!
//! | trait | method | law | needed by |
//! |---|---|---|---|
//! | [`Kernel`] | `eval(x, y)` | K with respect to μ | Nyström, FEM, next event |
//! | [`Transition`] | `step(x, u)` | E[weight · φ(point)] = (Tφ)(x) | all walks |
//! | [`TransitionPdf`] | `pdf(x, y)` | sub-density π of `step` | MIS, variance prediction |
//! | [`Absorbing`] | `absorption(x)` | P(step = None) | absorption estimator |
//! | [`RowMass`] | `mass(x)` | M(x) = ∫ \|K(x, y)\| dμ(y) | subcritical sampling |
//! | [`HasAdjoint`] | `adjoint()` | K†(y, x) = K(x, y)ᵀ | forward and bidirectional walks |
//! | [`HasDomain`] | `domain()` | where x lives, its measure | Nyström, proposals |
//!
//! [`check`](crate::check) tests each law on a kernel of your own.

mod adjoint;
mod closure;
mod coarse;
mod difference;
mod proposal;
mod radius;
mod series;
mod step;
mod tabulated;

pub use adjoint::{AdjointProposal, Both, HasAdjoint, Transposed};
pub use closure::{KernelFn, kernel_fn};
pub use difference::{DifferenceFn, Singularity, Split, SplitFn, difference_fn, split_fn};
pub use proposal::{Proposal, Proposed, Uniform};
pub(crate) use radius::gelfand;
pub(crate) use series::series_of;
pub use series::{Discretised, Radius, Series};
pub use step::{Density, Step};
pub use tabulated::Tabulated;

use crate::domain::{Domain, Point};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Weight;

/// The integral operator T: the points it couples and the weights K(x, y) it couples them with.
pub trait Operator: Send + Sync {
    /// States x.
    type Point: Point;
    /// Kernel values.
    type Weight: Weight;

    /// Refuses parameters outside their range; called before every solve.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value.
    fn validate(&self) -> Result<(), Error> {
        Ok(())
    }

    /// What is known about Σ |T|ⁿ before a walk starts. `Unknown` unless the kernel can be evaluated on a domain.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] if evaluating the kernel found one.
    fn series(&self) -> Result<Series<Self::Point>, Error> {
        Ok(Series::Unknown)
    }

    /// Whether K(x, ·) is zero wherever it was looked at, as at the start of a Volterra equation: f(x) = g(x) then. `false` where that is not known.
    fn vanishes_at(&self, x: &Self::Point) -> bool {
        let _ = x;
        false
    }
}

/// A kernel that can be evaluated: K(x, y) with respect to the reference measure.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be evaluated, only walked",
    note = "Nyström, finite elements and next-event estimation need K(x, y): implement `Kernel`, or use `Walk::collision`"
)]
pub trait Kernel: Operator {
    /// K(x, y). May be infinite at isolated points (x = y), where no method may evaluate it.
    fn eval(&self, x: &Self::Point, y: &Self::Point) -> Self::Weight;

    /// K where x − y is known to more digits than x and y leave of it; `None` from kernels that make no use of it. Law: close to `eval(x, y)`.
    fn eval_at_difference(&self, x: &Self::Point, y: &Self::Point, difference: f64) -> Option<Self::Weight> {
        let _ = (x, y, difference);
        None
    }

    /// The kernel with the same values that this one only wraps, if any: saves a call on the way to it.
    #[doc(hidden)]
    fn behind(&self) -> Option<&dyn Kernel<Point = Self::Point, Weight = Self::Weight>> {
        None
    }

    /// K = factor · S(x − y) + rest, for kernels that declare it, with factor and rest smooth on each side of x = y. Law: close to `eval(x, y)`.
    fn split(&self, x: &Self::Point, y: &Self::Point, difference: f64) -> Option<Split<Self::Weight>> {
        let _ = (x, y, difference);
        None
    }
}

/// A kernel that can be walked.
///
/// Law: `E[step(x).weight · φ(step(x).point)] = (Tφ)(x)`, an absorbed walk (`None`) counting as 0.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no random step",
    note = "walks need `Transition`; a kernel that can be evaluated gets one from a proposal: `Proposed::new(kernel, Uniform::on(domain))`"
)]
pub trait Transition: Operator {
    /// One step from x, or `None` if the walk is absorbed.
    fn step<S: Sampler>(&self, x: &Self::Point, u: &mut S) -> Option<Step<Self::Point, Self::Weight>>;

    /// True for kernels that never absorb anywhere: walks then need an ending of the method.
    fn never_absorbs(&self) -> bool {
        false
    }
}

/// The density of a step.
///
/// Law: for every set B, `∫_B pdf(x, y) dμ(y) = P(step(x).point ∈ B)`: a *sub*-density, the kernel's own survival included. Where K(x, y) = 0 weights of
/// multiple importance sampling do not ask what it is: a scene may leave out who hides behind a wall.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not state the density of its steps",
    note = "multiple importance sampling needs `TransitionPdf`; use `Walk::collision` or `Walk::next_event` without it"
)]
pub trait TransitionPdf: Transition {
    /// π(x, y).
    fn pdf(&self, x: &Self::Point, y: &Self::Point) -> f64;

    /// K(x, y) and π(x, y), for kernels whose two share work; where K is 0 any π will do.
    #[inline]
    fn eval_and_pdf(&self, x: &Self::Point, y: &Self::Point) -> (Self::Weight, f64)
    where
        Self: Kernel,
    {
        (self.eval(x, y), self.pdf(x, y))
    }
}

/// How often a step is absorbed.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not state its absorption",
    note = "the absorption estimator divides by the probability that a walk ends: implement `Absorbing`, or use `Walk::collision`"
)]
pub trait Absorbing: Transition {
    /// P(step(x) = None); must be positive where g ≠ 0 unless the method adds a roulette.
    fn absorption(&self, x: &Self::Point) -> f64;
}

/// The mass of a row of |K|.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not know its row mass ∫ |K(x, y)| dμ(y)",
    note = "subcritical sampling survives with that probability: implement `RowMass`, or use a `Tabulated` proposal, which measures it"
)]
pub trait RowMass: Operator {
    /// M(x) = ∫ |K(x, y)| dμ(y), ≥ 0. Used as a survival probability, so an approximation costs variance, never bias.
    fn mass(&self, x: &Self::Point) -> f64;
}

/// The domain Ω an operator acts on.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say on which domain it acts",
    note = "deterministic methods and uniform proposals need `HasDomain`"
)]
pub trait HasDomain: Operator {
    /// Type of the domain.
    type Domain: Domain<Point = Self::Point>;
    /// Ω.
    fn domain(&self) -> &Self::Domain;
}

impl<T: Operator + ?Sized> Operator for &T {
    type Point = T::Point;
    type Weight = T::Weight;
    fn validate(&self) -> Result<(), Error> {
        (**self).validate()
    }
    fn series(&self) -> Result<Series<Self::Point>, Error> {
        (**self).series()
    }
    fn vanishes_at(&self, x: &Self::Point) -> bool {
        (**self).vanishes_at(x)
    }
}

impl<T: Kernel + ?Sized> Kernel for &T {
    #[inline]
    fn eval(&self, x: &Self::Point, y: &Self::Point) -> Self::Weight {
        (**self).eval(x, y)
    }
    fn eval_at_difference(&self, x: &Self::Point, y: &Self::Point, difference: f64) -> Option<Self::Weight> {
        (**self).eval_at_difference(x, y, difference)
    }
    fn split(&self, x: &Self::Point, y: &Self::Point, difference: f64) -> Option<Split<Self::Weight>> {
        (**self).split(x, y, difference)
    }
}

impl<T: Transition> Transition for &T {
    #[inline]
    fn step<S: Sampler>(&self, x: &Self::Point, u: &mut S) -> Option<Step<Self::Point, Self::Weight>> {
        (**self).step(x, u)
    }
    fn never_absorbs(&self) -> bool {
        (**self).never_absorbs()
    }
}

impl<T: TransitionPdf> TransitionPdf for &T {
    #[inline]
    fn pdf(&self, x: &Self::Point, y: &Self::Point) -> f64 {
        (**self).pdf(x, y)
    }
}

impl<T: Absorbing> Absorbing for &T {
    #[inline]
    fn absorption(&self, x: &Self::Point) -> f64 {
        (**self).absorption(x)
    }
}

impl<T: RowMass + ?Sized> RowMass for &T {
    #[inline]
    fn mass(&self, x: &Self::Point) -> f64 {
        (**self).mass(x)
    }
}

impl<T: HasDomain + ?Sized> HasDomain for &T {
    type Domain = T::Domain;
    fn domain(&self) -> &Self::Domain {
        (**self).domain()
    }
}
