//! The transposed kernel, along which walks go from the source to the detector.
//!
//! ```text
//! K†(y, x) = K(x, y)ᵀ,        ⟨h, T f⟩ = ⟨T† h, f⟩,        ⟨h, f⟩ = ⟨φ, g⟩ with φ = h + T†φ                theory (4.5.1)
//! ```
//!
//! A kernel that can be evaluated on a domain needs no work from its author: [`Transposed`] swaps the arguments, and the proposal says how the adjoint
//! is walked ([`AdjointProposal`]). Kernels that are only walked implement [`HasAdjoint`] by a transition of their own.

use super::{HasDomain, Kernel, Operator, Proposal, Proposed, RowMass, Split, Tabulated, Uniform};
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Weight;

/// An operator whose adjoint can be walked, or evaluated.
///
/// Law: K†(y, x) = K(x, y)ᵀ; for a transition, `E[Σ weightᵀ · φ(point)]` over `adjoint().step(y)` is ∫ K(x, y) φ(x) dμ(x).
///
/// The adjoint may act on states of its own (light arrives in a direction where eye paths leave in one); for kernels on a domain they are its points.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no adjoint",
    note = "forward and bidirectional walks go along the transposed kernel: implement `HasAdjoint`",
    note = "a kernel with a proposal of your own has one if the proposal implements `AdjointProposal`: pair it with `kernel::Both::new(proposal, Uniform::on(domain))`"
)]
pub trait HasAdjoint: Operator {
    /// K†.
    type Adjoint: Operator<Weight = Self::Weight>;

    /// The adjoint; called once a solve.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] if tabulating it met one.
    fn adjoint(&self) -> Result<Self::Adjoint, Error>;
}

impl<T: HasAdjoint + ?Sized> HasAdjoint for &T {
    type Adjoint = T::Adjoint;
    fn adjoint(&self) -> Result<T::Adjoint, Error> {
        (**self).adjoint()
    }
}

/// A kernel with its arguments swapped and its values transposed.
///
/// ```
/// use fredholm::{domain::Interval, kernel::{kernel_fn, Kernel, Transposed}};
/// let k = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| x - 2.0 * y);
/// assert_eq!(Transposed(k).eval(&0.25, &1.0), k.eval(&1.0, &0.25));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Transposed<K>(pub K);

impl<K: Operator> Operator for Transposed<K> {
    type Point = K::Point;
    type Weight = K::Weight;
    fn validate(&self) -> Result<(), Error> {
        self.0.validate()
    }
}

impl<K: Kernel> Kernel for Transposed<K> {
    #[inline]
    fn eval(&self, y: &K::Point, x: &K::Point) -> K::Weight {
        self.0.eval(x, y).transposed()
    }
    fn eval_at_difference(&self, y: &K::Point, x: &K::Point, difference: f64) -> Option<K::Weight> {
        self.0.eval_at_difference(x, y, -difference).map(Weight::transposed)
    }
    /// S depends on the distance alone.
    fn split(&self, y: &K::Point, x: &K::Point, difference: f64) -> Option<Split<K::Weight>> {
        let Split { singularity, factor, rest } = self.0.split(x, y, -difference)?;
        Some(Split { singularity, factor: factor.transposed(), rest: rest.transposed() })
    }
}

impl<K: HasDomain> HasDomain for Transposed<K> {
    type Domain = K::Domain;
    fn domain(&self) -> &K::Domain {
        self.0.domain()
    }
}

/// A proposal that knows one for the adjoint walk.
#[diagnostic::on_unimplemented(
    message = "the proposal `{Self}` does not say how to walk the transposed kernel",
    note = "implement `AdjointProposal`, or pair it with another: `kernel::Both::new(proposal, Uniform::on(domain))`"
)]
pub trait AdjointProposal<K: Operator>: Proposal<K::Point> {
    /// The proposal of adjoint walks.
    type Adjoint: Proposal<K::Point>;

    /// A proposal for walks along `transposed`.
    ///
    /// # Errors
    /// [`Error::NonFiniteKernel`] if tabulating it met one.
    fn adjoint(&self, transposed: &Transposed<&K>) -> Result<Self::Adjoint, Error>;
}

/// The domain's own density serves both directions.
impl<K: Operator, D: Domain<Point = K::Point>> AdjointProposal<K> for Uniform<D> {
    type Adjoint = Uniform<D>;
    fn adjoint(&self, _: &Transposed<&K>) -> Result<Self, Error> {
        Ok(self.clone())
    }
}

/// A table ∝ |K(·, y)| of as many cells, guided if the table is.
impl<K, D> AdjointProposal<K> for Tabulated<D>
where
    K: Kernel + HasDomain<Domain = D> + Operator<Point = D::Point>,
    D: Domain,
{
    type Adjoint = Tabulated<D>;
    fn adjoint(&self, transposed: &Transposed<&K>) -> Result<Self, Error> {
        self.again(transposed)
    }
}

impl<K, P> HasAdjoint for Proposed<K, P>
where
    K: Kernel + HasDomain + Clone,
    P: AdjointProposal<K>,
{
    type Adjoint = Proposed<Transposed<K>, P::Adjoint>;
    fn adjoint(&self) -> Result<Self::Adjoint, Error> {
        let proposal = self.proposal().adjoint(&Transposed(self.kernel()))?;
        Ok(Proposed::new(Transposed(self.kernel().clone()), proposal))
    }
}

/// Two proposals: one for walks along the kernel, the other for walks along its transpose.
///
/// ```
/// use fredholm::{Equation, Forward, detector::Bins, domain::Interval, kernel::{Both, Tabulated, Transposed, Uniform}};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// // backward walks by the uniform proposal, forward ones by a table of |K(·, y)|
/// let table = Tabulated::new(&Transposed(eq.kernel().kernel()), 32)?;
/// let eq = eq.with_proposal(Both::new(Uniform::on(Interval::from(0.0..=1.0)), table));
/// let means = eq.seen_by(&Bins::new(0.0..=1.0, 2)).solve(&Forward::new())?;       // f = 1 + 3x/10
/// assert!(means[0].agrees_with(1.075, 5.0) && means[1].agrees_with(1.225, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Both<P, Q> {
    backward: P,
    forward: Q,
}

impl<P, Q> Both<P, Q> {
    /// `backward` for walks along K, `forward` for walks along its transpose.
    #[must_use]
    pub fn new(backward: P, forward: Q) -> Self {
        Both { backward, forward }
    }
}

impl<X: Point, P: Proposal<X>, Q: Send + Sync> Proposal<X> for Both<P, Q> {
    #[inline]
    fn sample<S: Sampler>(&self, x: &X, u: &mut S) -> Node<X> {
        self.backward.sample(x, u)
    }
    #[inline]
    fn pdf(&self, x: &X, y: &X) -> f64 {
        self.backward.pdf(x, y)
    }
}

impl<K: Operator, P: Proposal<K::Point>, Q: Proposal<K::Point> + Clone> AdjointProposal<K> for Both<P, Q> {
    type Adjoint = Q;
    fn adjoint(&self, _: &Transposed<&K>) -> Result<Q, Error> {
        Ok(self.forward.clone())
    }
}

/// The row mass of the backward table.
impl<K: Kernel + HasDomain, D: Domain<Point = K::Point>, Q: Send + Sync> RowMass for Proposed<K, Both<Tabulated<D>, Q>> {
    #[inline]
    fn mass(&self, x: &K::Point) -> f64 {
        self.proposal().backward.mass(x)
    }
}
