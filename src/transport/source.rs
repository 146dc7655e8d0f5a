//! Sources of a slab, with exact sampling.

use crate::domain::{Domain, Interval, Node};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::source::{Birth, Emit, EmitPdf, SampleSource, Source};

/// S(x) = strength, everywhere in the slab; see [`Slab::uniform`](super::Slab::uniform).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformSource {
    slab: Interval,
    strength: f64,
}

impl UniformSource {
    pub(super) fn new(slab: Interval, strength: f64) -> Self {
        UniformSource { slab, strength }
    }
}

impl Source for UniformSource {
    type Point = f64;
    type Value = f64;
    #[inline]
    fn eval(&self, _: &f64) -> f64 {
        self.strength
    }
    fn validate(&self) -> Result<(), Error> {
        if !self.strength.is_finite() {
            return Err(Error::invalid("source strength", self.strength, "must be finite"));
        }
        self.slab.validate()
    }
}

impl SampleSource for UniformSource {
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &f64, u: &mut S) -> Option<Node<f64>> {
        Some(self.slab.sample(u))
    }
    #[inline]
    fn pdf_for(&self, _: &f64, y: &f64) -> f64 {
        self.slab.density(y)
    }
}

impl Emit for UniformSource {
    type State = f64;
    #[inline]
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<f64, f64> {
        let n = self.slab.sample(u);
        Birth { point: n.point, weight: self.strength * n.weight }
    }
}

impl EmitPdf for UniformSource {
    #[inline]
    fn emit_pdf(&self, z: &f64) -> f64 {
        self.slab.density(z)
    }
}

/// S(x) = e^{−x/μ₀}: the first collisions of a beam through the face x = 0; see [`Slab::beam`](super::Slab::beam).
///
/// Sampled by inversion of the exponential distribution cut at the slab's far face:
///
/// ```text
/// y = −μ₀ ln(1 − u (1 − e^{−a/μ₀})),        q(y) = e^{−y/μ₀} / (μ₀ (1 − e^{−a/μ₀}))
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamSource {
    slab: Interval,
    cosine: f64,
    /// 1 − e^{−a/μ₀}: probability that a beam particle collides
    collided: f64,
}

impl BeamSource {
    pub(super) fn new(slab: Interval, cosine: f64) -> Self {
        BeamSource { slab, cosine, collided: -(-slab.length() / cosine).exp_m1() }
    }

    /// μ₀.
    #[must_use]
    pub fn cosine(&self) -> f64 {
        self.cosine
    }

    /// The point of distribution value `u`.
    #[inline]
    fn invert(&self, u: f64) -> f64 {
        (-self.cosine * (-u * self.collided).ln_1p()).min(self.slab.upper())
    }

    #[inline]
    fn density(&self, y: f64) -> f64 {
        (-y / self.cosine).exp() / (self.cosine * self.collided)
    }
}

impl Source for BeamSource {
    type Point = f64;
    type Value = f64;
    #[inline]
    fn eval(&self, x: &f64) -> f64 {
        (-x / self.cosine).exp()
    }
    fn validate(&self) -> Result<(), Error> {
        if !(self.cosine > 0.0 && self.cosine <= 1.0) {
            return Err(Error::invalid("beam cosine", self.cosine, "must lie in (0, 1]"));
        }
        self.slab.validate()
    }
}

impl SampleSource for BeamSource {
    #[inline]
    fn sample_for<S: Sampler>(&self, _: &f64, u: &mut S) -> Option<Node<f64>> {
        let y = self.invert(u.next_1d());
        Some(Node { point: y, weight: 1.0 / self.density(y) })
    }
    #[inline]
    fn pdf_for(&self, _: &f64, y: &f64) -> f64 {
        if self.slab.contains(y) { self.density(*y) } else { 0.0 }
    }
}

impl Emit for BeamSource {
    type State = f64;
    #[inline]
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<f64, f64> {
        Birth { point: self.invert(u.next_1d()), weight: self.cosine * self.collided }
    }
}

impl EmitPdf for BeamSource {
    #[inline]
    fn emit_pdf(&self, z: &f64) -> f64 {
        self.pdf_for(z, z)
    }
}
