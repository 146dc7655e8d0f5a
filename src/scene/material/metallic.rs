//! The material of glTF 2.0: a diffuse base under a dielectric coat, mixed with a metal.
//!
//! ```text
//! f = (1 − M(cos θₒ)) (1 − M(cos θᵢ))/(1 − M̄) c/π + F(ωₒ·h) D G/(4 cos θₒ cos θᵢ),     F(x) = F₀ + (F₉₀ − F₀)(1 − x)⁵,   M = max F
//! c = (1 − m) base,   F₀ = (1 − m) min(0.04 s, 1) + m base,   F₉₀ = (1 − m) s + m            m metallic, s specular, α = roughness²
//! ```
//!
//! glTF 2.0, appendix B; `KHR_materials_specular`, `KHR_materials_ior` (0.04 becomes ((n − 1)/(n + 1))²). The appendix suggests 1 − M(ωₒ·h) for the share
//! of the base, with which white plastic gives back 1.07 of what it gets at 66° and more beyond. Instead the base gets what the coat lets in and gives what it
//! lets out, over the mean M̄ = M₀ + (F₉₀ − M₀)/21: base and smooth coat together give back M + (1 − M) c. Kelemen, Szirmay-Kalos, *A microfacet based coupled
//! specular-matte BRDF model with importance sampling*, Eurographics 2001.

use super::{Ray, fresnel, ggx, roughness, share};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::sampling::distribution::{CosineHemisphere, Distribution};
use crate::scene::Rgb;
use crate::scene::frame::Vec3;
use crate::value::{Value, Weight};
use std::f64::consts::FRAC_1_PI;

/// Parameters of glTF's metallic-roughness material, ready to scatter.
///
/// ```
/// use fredholm::{Spectrum, scene::MetallicRoughness};
/// let plastic = MetallicRoughness::new(Spectrum([0.8, 0.1, 0.1]), 0.0, 0.4);
/// assert_eq!(plastic.diffuse, Spectrum([0.8, 0.1, 0.1]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// c: albedo of the base.
    pub diffuse: Rgb,
    /// F₀: reflectance at normal incidence.
    pub specular: Rgb,
    /// F₉₀: reflectance at grazing incidence.
    pub grazing: f64,
    /// GGX α.
    pub alpha: f64,
}

impl MetallicRoughness {
    /// From base colour, metallic ∈ [0, 1] and roughness ∈ [0.01, 1], with an index of 1.5.
    #[must_use]
    pub fn new(base: Rgb, metallic: f64, roughness: f64) -> Self {
        Self::coated(base, metallic, roughness, crate::Spectrum([0.04; 3]), 1.0)
    }

    /// With F₀ and F₉₀ of the dielectric coat.
    #[must_use]
    pub fn coated(base: Rgb, metallic: f64, roughness: f64, coat: Rgb, grazing: f64) -> Self {
        let mix = |a: f64, b: f64| a + metallic * (b - a);
        MetallicRoughness {
            diffuse: base.scaled(1.0 - metallic),
            specular: Rgb::from_components(|i| mix(coat[i], base[i])),
            grazing: mix(grazing, 1.0),
            alpha: roughness * roughness,
        }
    }

    #[inline]
    fn fresnel(&self, cosine: f64) -> Rgb {
        let w = fresnel::fifth(cosine);
        crate::Spectrum(self.specular.0.map(|f| f + (self.grazing - f) * w))
    }

    /// Probability to follow the facets: their share of the light that comes back to ωₒ, about.
    #[inline]
    fn facets(&self, wo: &Vec3) -> f64 {
        let coat = self.fresnel(wo.z).magnitude();
        let base = (1.0 - coat) * self.diffuse.magnitude();
        if base > 0.0 { (coat / (coat + base)).max(0.1 * f64::from(u8::from(coat > 0.0))) } else { 1.0 }
    }

    #[inline]
    pub(super) fn scatter<S: Sampler>(&self, wo: &Vec3, u: &mut S) -> Option<Ray> {
        let (point, choice) = (u.next_2d(), u.next_1d());
        if wo.z <= 0.0 {
            return None;
        }
        let incoming = if choice < self.facets(wo) {
            let h = ggx::facet(self.alpha, wo, point);
            h * (2.0 * wo.dot(&h)) - wo
        } else {
            Vec3::from(CosineHemisphere.sample(point))
        };
        let pdf = self.density(wo, &incoming);
        if !(pdf > 0.0) {
            return Some(Ray { incoming, weight: Rgb::ZERO, pdf: 1.0 });
        }
        Some(Ray { incoming, weight: self.value(wo, &incoming).scaled(1.0 / pdf), pdf })
    }

    /// f cos θᵢ.
    #[inline]
    pub(super) fn value(&self, wo: &Vec3, wi: &Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let h = (wo + wi).normalize();
        let base = self.diffuse.scaled(self.coupling(wo.z, wi.z) * wi.z * FRAC_1_PI);
        base + ggx::value(self.alpha, |_| self.fresnel(wo.dot(&h)), wo, wi)
    }

    /// (1 − M(cos θₒ)) (1 − M(cos θᵢ))/(1 − M̄).
    #[inline]
    fn coupling(&self, out: f64, into: f64) -> f64 {
        let lets = |cosine: f64| 1.0 - self.fresnel(cosine).magnitude();
        let mean = (20.0 * lets(1.0) + 1.0 - self.grazing) / 21.0;
        // nothing passes a coat that mirrors all
        if mean > 0.0 { lets(out) * lets(into) / mean } else { 0.0 }
    }

    #[inline]
    pub(super) fn density(&self, wo: &Vec3, wi: &Vec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let p = self.facets(wo);
        p * ggx::density(self.alpha, wo, wi) + (1.0 - p) * wi.z * FRAC_1_PI
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        share("diffuse albedo", &self.diffuse)?;
        share("specular reflectance", &self.specular)?;
        share("specular reflectance at grazing incidence", &crate::Spectrum([self.grazing; 3]))?;
        roughness(self.alpha)
    }
}
