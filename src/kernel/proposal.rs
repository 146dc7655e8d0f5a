//! Where a walk goes when the kernel can only be evaluated: proposals p(x, y), exchangeable without touching the kernel.
//!
//! The step draws y ~ p(x, ·) and carries the weight K(x, y)/p(x, y). Condition (S) of theory §4.1: p(x, y) > 0 wherever
//! K(x, y) (Σ|T|ⁿ|g|)(y) ≠ 0; [`check::transition`](crate::check) looks for violations.

use super::coarse::vanishes;
use super::series::series_of;
use super::{Absorbing, HasDomain, Kernel, Operator, Series, Split, Step, Transition, TransitionPdf};
use crate::domain::{Domain, Node, Point};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Weight;
use std::sync::OnceLock;

/// A density p(x, ·) from which the next point is drawn.
///
/// Laws: `sample(x).weight == 1/pdf(x, sample(x).point)`, and ∫ pdf(x, y) dμ(y) = 1: survival belongs to the method, absorption to the kernel.
pub trait Proposal<X: Point>: Send + Sync {
    /// y ~ p(x, ·), with `weight` = 1/p(x, y).
    fn sample<S: Sampler>(&self, x: &X, u: &mut S) -> Node<X>;

    /// p(x, y).
    fn pdf(&self, x: &X, y: &X) -> f64;
}

/// The domain's own density, whatever x: uniform where the volume is finite, the map's density on a half line.
#[derive(Clone, Copy, Debug)]
pub struct Uniform<D> {
    domain: D,
}

impl<D: Domain> Uniform<D> {
    /// Uniform on `domain`.
    #[must_use]
    pub fn on(domain: D) -> Self {
        Uniform { domain }
    }

    /// A point and 1/density.
    #[inline]
    pub(crate) fn draw<S: Sampler>(&self, u: &mut S) -> Node<D::Point> {
        self.domain.sample(u)
    }
}

impl<D: Domain> Proposal<D::Point> for Uniform<D> {
    #[inline]
    fn sample<S: Sampler>(&self, _: &D::Point, u: &mut S) -> Node<D::Point> {
        self.domain.sample(u)
    }
    #[inline]
    fn pdf(&self, _: &D::Point, y: &D::Point) -> f64 {
        self.domain.density(y)
    }
}

/// A kernel with the proposal that walks it.
///
/// Never absorbs by itself (theory §4.2: a survival probability hidden in a kernel made the absorption estimator 22 times worse).
#[derive(Debug)]
pub struct Proposed<K: Operator, P> {
    kernel: K,
    proposal: P,
    series: OnceLock<Result<Series<K::Point>, Error>>,
}

impl<K: Operator + Clone, P: Clone> Clone for Proposed<K, P> {
    fn clone(&self) -> Self {
        Proposed { kernel: self.kernel.clone(), proposal: self.proposal.clone(), series: self.series.clone() }
    }
}

impl<K: Operator, P> Proposed<K, P> {
    /// `kernel`, walked by `proposal`.
    pub fn new(kernel: K, proposal: P) -> Self {
        Proposed { kernel, proposal, series: OnceLock::new() }
    }

    /// The kernel.
    pub fn kernel(&self) -> &K {
        &self.kernel
    }

    /// The proposal.
    pub fn proposal(&self) -> &P {
        &self.proposal
    }

    /// The same kernel with another proposal.
    #[must_use]
    pub fn with_proposal<Q>(self, proposal: Q) -> Proposed<K, Q> {
        Proposed { kernel: self.kernel, proposal, series: self.series }
    }
}

impl<K: Kernel + HasDomain, P: Send + Sync> Operator for Proposed<K, P> {
    type Point = K::Point;
    type Weight = K::Weight;
    fn validate(&self) -> Result<(), Error> {
        self.kernel.validate()?;
        self.kernel.domain().validate()
    }
    fn series(&self) -> Result<Series<K::Point>, Error> {
        self.series.get_or_init(|| series_of(&self.kernel)).clone()
    }
    fn vanishes_at(&self, x: &K::Point) -> bool {
        vanishes(&self.kernel, x)
    }
}

impl<K: Kernel + HasDomain, P: Send + Sync> Kernel for Proposed<K, P> {
    #[inline]
    fn eval(&self, x: &K::Point, y: &K::Point) -> K::Weight {
        self.kernel.eval(x, y)
    }
    fn eval_at_difference(&self, x: &K::Point, y: &K::Point, difference: f64) -> Option<K::Weight> {
        self.kernel.eval_at_difference(x, y, difference)
    }
    fn split(&self, x: &K::Point, y: &K::Point, difference: f64) -> Option<Split<K::Weight>> {
        self.kernel.split(x, y, difference)
    }
}

impl<K: Kernel + HasDomain, P: Send + Sync> HasDomain for Proposed<K, P> {
    type Domain = K::Domain;
    fn domain(&self) -> &K::Domain {
        self.kernel.domain()
    }
}

impl<K: Kernel + HasDomain, P: Proposal<K::Point>> Transition for Proposed<K, P> {
    #[inline]
    fn step<S: Sampler>(&self, x: &K::Point, u: &mut S) -> Option<Step<K::Point, K::Weight>> {
        let y = self.proposal.sample(x, u);
        Some(Step::regular(y.point, self.kernel.eval(x, &y.point).scaled(y.weight)))
    }
    fn never_absorbs(&self) -> bool {
        true
    }
}

impl<K: Kernel + HasDomain, P: Proposal<K::Point>> TransitionPdf for Proposed<K, P> {
    #[inline]
    fn pdf(&self, x: &K::Point, y: &K::Point) -> f64 {
        self.proposal.pdf(x, y)
    }
}

impl<K: Kernel + HasDomain, P: Proposal<K::Point>> Absorbing for Proposed<K, P> {
    fn absorption(&self, _: &K::Point) -> f64 {
        0.0
    }
}
