//! The slab's kernel and its analog walk.
//!
//! ```text
//! K(x, y) = (c/2) E₁(|x − y|)                E₁(t) = ∫₀¹ e^{−t/μ} dμ/μ
//! y = x + μ s,   μ ~ U(−1, 1),   s ~ Exp(1)                π(x, y) = (min(c, 1)/2) E₁(|x − y|)
//! ```
//!
//! Derivation: given μ the displacement t = μs has density e^{−t/μ}/|μ| on the side of μ; averaging over μ ∈ (0, 1) gives E₁(t), and each side
//! has probability ½. The flight *is* the kernel: weights are 1, the logarithmic singularity at y = x is sampled without ever being evaluated.
//! Capture (probability 1 − c) and leaving the slab end the walk; for c > 1 nothing is captured and every step weighs c.
//!
//! Reference: Lux, Koblinger, *Monte Carlo particle transport methods* (1991), §2.II; Davison, *Neutron transport theory* (1957), §4.1.

use super::{BeamSource, ImplicitCapture, UniformSource};
use crate::domain::{Domain, Interval};
use crate::error::Error;
use crate::kernel::{
    Absorbing, HasAdjoint, HasDomain, Kernel, Operator, RowMass, Series, Singularity, Split, Step, Transition, TransitionPdf, series_of,
};
use crate::sampling::Sampler;
use crate::source::{SourceFn, source_fn};
use crate::special::{e1, e2};
use std::sync::OnceLock;

/// A slab 0 ≤ x ≤ a, vacuum on both sides: total cross-section 1, isotropic scattering, on average c particles from a collision.
///
/// ```
/// use fredholm::{kernel::{Absorbing, RowMass}, transport::Slab};
/// let slab = Slab::new(2.0).scattering(0.9);
/// // what a walk loses: capture 1 − c and leakage
/// assert!((slab.absorption(&1.0) - (1.0 - slab.mass(&1.0))).abs() < 1e-15);
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct Slab {
    domain: Interval,
    ratio: f64,
    /// min(c, 1): probability that a collision is not a capture
    survival: f64,
    /// 2/min(c, 1): from a uniform number below `survival` to 1 + μ
    spread: f64,
    series: OnceLock<Result<Series<f64>, Error>>,
}

impl Slab {
    /// `thickness` a > 0 in mean free paths; nothing scatters (c = 0) until [`scattering`](Slab::scattering) says so.
    pub fn new(thickness: f64) -> Self {
        Slab { domain: Interval::from(0.0..=thickness), ratio: 0.0, survival: 0.0, spread: f64::INFINITY, series: OnceLock::new() }
    }

    /// Sets c ≥ 0, the mean number of particles from a collision: scattering ratio if c ≤ 1, multiplication beyond.
    pub fn scattering(self, ratio: f64) -> Self {
        let survival = ratio.min(1.0);
        Slab { ratio, survival, spread: 2.0 / survival, series: OnceLock::new(), ..self }
    }

    /// a.
    #[inline]
    #[must_use]
    pub fn thickness(&self) -> f64 {
        self.domain.upper()
    }

    /// c.
    #[inline]
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// S = `strength` everywhere.
    #[must_use]
    pub fn uniform(&self, strength: f64) -> UniformSource {
        UniformSource::new(self.domain, strength)
    }

    /// S = e^{−x/μ₀}: first collisions of a beam of cosine μ₀ = `cosine` ∈ (0, 1] through the face x = 0, one particle per unit area *across the beam*.
    #[must_use]
    pub fn beam(&self, cosine: f64) -> BeamSource {
        BeamSource::new(self.domain, cosine)
    }

    /// S from a closure, sampled uniformly.
    pub fn source<F>(&self, s: F) -> SourceFn<Interval, impl Fn(&f64) -> f64 + Send + Sync + Clone + use<F>, f64>
    where
        F: Fn(f64) -> f64 + Send + Sync + Clone,
    {
        source_fn(self.domain, move |x: &f64| s(*x))
    }

    /// The same kernel, walked without capture: survival biasing.
    pub fn implicit_capture(&self) -> ImplicitCapture {
        ImplicitCapture::new(self.clone())
    }

    /// Probability that an isotropic flight from x ends inside: 1 − (E₂(x) + E₂(a − x))/2.
    #[inline]
    #[must_use]
    pub fn containment(&self, x: f64) -> f64 {
        1.0 - 0.5 * (e2(x.max(0.0)) + e2((self.thickness() - x).max(0.0)))
    }

    /// ½ E₁(|x − y|): density of the end of an isotropic flight from x.
    #[inline]
    pub(super) fn flight_pdf(&self, x: f64, y: f64) -> f64 {
        if self.domain.contains(&y) { 0.5 * e1((x - y).abs()) } else { 0.0 }
    }

    /// The direction cosine after a collision, or `None` for a capture: one coordinate decides both, since v/c given v < c is uniform again.
    #[inline]
    pub(super) fn scatter<S: Sampler>(&self, u: &mut S) -> Option<f64> {
        let v = u.next_1d();
        (v < self.survival).then_some(v * self.spread - 1.0)
    }

    /// Where a flight of cosine μ from x ends, if inside.
    #[inline]
    pub(super) fn fly<S: Sampler>(&self, x: f64, cosine: f64, u: &mut S) -> Option<f64> {
        let y = x - cosine * u.next_1d().ln();
        (y > 0.0 && y < self.thickness()).then_some(y)
    }
}

impl Operator for Slab {
    type Point = f64;
    type Weight = f64;

    fn validate(&self) -> Result<(), Error> {
        let a = self.thickness();
        if !(a > 0.0 && a.is_finite()) {
            return Err(Error::invalid("slab thickness", a, "must be positive and finite, in mean free paths"));
        }
        if !(self.ratio >= 0.0 && self.ratio.is_finite()) {
            return Err(Error::invalid("scattering ratio", self.ratio, "must be at least 0 and finite"));
        }
        Ok(())
    }

    fn series(&self) -> Result<Series<f64>, Error> {
        self.series.get_or_init(|| series_of(self)).clone()
    }
}

impl Kernel for Slab {
    #[inline]
    fn eval(&self, x: &f64, y: &f64) -> f64 {
        // 0 · E₁(0) would be NaN
        if self.ratio == 0.0 { 0.0 } else { 0.5 * self.ratio * e1((x - y).abs()) }
    }

    fn eval_at_difference(&self, _: &f64, _: &f64, difference: f64) -> Option<f64> {
        Some(self.eval(&difference, &0.0))
    }

    /// E₁(r) = −ln r + (−γ + r − …).
    fn split(&self, _: &f64, _: &f64, difference: f64) -> Option<Split<f64>> {
        let (r, half) = (difference.abs(), 0.5 * self.ratio);
        Some(Split { singularity: Singularity::Logarithm, factor: -half, rest: half * (e1(r) + r.ln()) })
    }
}

impl HasDomain for Slab {
    type Domain = Interval;
    fn domain(&self) -> &Interval {
        &self.domain
    }
}

/// Symmetric in x and y, the flight too: its own adjoint.
impl HasAdjoint for Slab {
    type Adjoint = Slab;
    fn adjoint(&self) -> Result<Slab, Error> {
        Ok(self.clone())
    }
}

impl Transition for Slab {
    #[inline]
    fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        let cosine = self.scatter(u)?;
        self.fly(*x, cosine, u).map(|y| Step::regular(y, self.ratio.max(1.0)))
    }
}

impl TransitionPdf for Slab {
    #[inline]
    fn pdf(&self, x: &f64, y: &f64) -> f64 {
        if self.survival == 0.0 { 0.0 } else { self.survival * self.flight_pdf(*x, *y) }
    }
}

impl Absorbing for Slab {
    /// Capture and leakage.
    #[inline]
    fn absorption(&self, x: &f64) -> f64 {
        1.0 - self.survival * self.containment(*x)
    }
}

impl RowMass for Slab {
    #[inline]
    fn mass(&self, x: &f64) -> f64 {
        self.ratio * self.containment(*x)
    }
}
