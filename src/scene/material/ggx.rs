//! GGX microfacets that reflect.
//!
//! ```text
//! f = F(ωₒ·h) D(h) G(ωₒ, ωᵢ)/(4 cos θₒ cos θᵢ),   h ∥ ωₒ + ωᵢ,   D = α²/(π (h_z² (α² − 1) + 1)²),   G = 1/(1 + Λₒ + Λᵢ)
//! ```
//!
//! Facets are drawn as they are seen from ωₒ, so that the weight is F G/G₁ ≤ 1. Walter et al., *Microfacet models for refraction through rough
//! surfaces*, EGSR 2007; Heitz, *Understanding the masking-shadowing function*, JCGT 3 (2014) 2; Dupuy, Benyoub, *Sampling visible GGX normals with
//! spherical caps*, CGF 42 (2023).

use super::Ray;
use crate::sampling::Sampler;
use crate::scene::Rgb;
use crate::scene::frame::Vec3;
use crate::value::{Value, Weight};
use std::f64::consts::{FRAC_1_PI, TAU};

/// Density of facets with normal h, per projected area.
#[inline]
pub(super) fn distribution(alpha: f64, h: &Vec3) -> f64 {
    // h_z² (α² − 1) + 1 without its cancellation at small α
    let denominator = h.x * h.x + h.y * h.y + (alpha * h.z).powi(2);
    let norm2 = h.norm_squared();
    FRAC_1_PI * (alpha * norm2 / denominator).powi(2)
}

/// Λ: hidden area of facets over visible area, seen from w.
#[inline]
pub(super) fn lambda(alpha: f64, w: &Vec3) -> f64 {
    0.5 * ((1.0 + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z)).sqrt() - 1.0)
}

/// A facet normal as seen from `wo`, z > 0.
#[inline]
pub(super) fn facet(alpha: f64, wo: &Vec3, [u, v]: [f64; 2]) -> Vec3 {
    let stretched = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let z = (1.0 - u) * (1.0 + stretched.z) - stretched.z;
    let (r, (s, c)) = (((1.0 - z) * (1.0 + z)).max(0.0).sqrt(), (TAU * v).sin_cos());
    let h = Vec3::new(r * c, r * s, z) + stretched;
    Vec3::new(alpha * h.x, alpha * h.y, h.z.max(0.0)).normalize()
}

/// Density of that normal.
#[inline]
pub(super) fn facet_pdf(alpha: f64, wo: &Vec3, h: &Vec3) -> f64 {
    distribution(alpha, h) * wo.dot(h).max(0.0) / (wo.z * (1.0 + lambda(alpha, wo)))
}

#[inline]
pub(super) fn scatter<S: Sampler>(alpha: f64, fresnel: impl Fn(f64) -> Rgb, wo: &Vec3, u: &mut S) -> Option<Ray> {
    let point = u.next_2d();
    if wo.z <= 0.0 {
        return None;
    }
    let h = facet(alpha, wo, point);
    let cosine = wo.dot(&h);
    let incoming = h * (2.0 * cosine) - wo;
    if incoming.z <= 0.0 {
        // seen by no one after one reflection
        return Some(Ray { incoming: h, weight: Rgb::ZERO, pdf: 1.0 });
    }
    let (o, i) = (lambda(alpha, wo), lambda(alpha, &incoming));
    let weight = fresnel(cosine).scaled((1.0 + o) / (1.0 + o + i));
    Some(Ray { incoming, weight, pdf: density(alpha, wo, &incoming) })
}

/// f cos θᵢ.
#[inline]
pub(super) fn value(alpha: f64, fresnel: impl Fn(f64) -> Rgb, wo: &Vec3, wi: &Vec3) -> Rgb {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return Rgb::ZERO;
    }
    let h = (wo + wi).normalize();
    let shape = distribution(alpha, &h) / (4.0 * wo.z * (1.0 + lambda(alpha, wo) + lambda(alpha, wi)));
    fresnel(wo.dot(&h)).scaled(shape)
}

/// Density of the reflected direction: that of the facet over 4 ωₒ·h.
#[inline]
pub(super) fn density(alpha: f64, wo: &Vec3, wi: &Vec3) -> f64 {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    distribution(alpha, &(wo + wi).normalize()) / (4.0 * wo.z * (1.0 + lambda(alpha, wo)))
}
