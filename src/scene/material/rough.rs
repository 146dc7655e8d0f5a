//! Rough glass: GGX facets, each of which reflects or refracts.
//!
//! ```text
//! reflection  f = F D G/(4 cos θₒ cos θᵢ),                                              h ∥ ωₒ + ωᵢ
//! refraction  f = (1 − F) D G |ωₒ·h| |ωᵢ·h| η²/(cos θₒ cos θᵢ (ωₒ·h + η ωᵢ·h)²),             h ∥ ωₒ + η ωᵢ
//! ```
//!
//! η = index on the side of ωᵢ over that of ωₒ; for the radiance itself, not L/n², the numerator has no η². Walter et al. (2007), eqs. (16), (20), (21).

use super::{Ray, fresnel, ggx};
use crate::sampling::Sampler;
use crate::scene::Rgb;
use crate::scene::frame::Vec3;
use crate::value::{Value, Weight};

/// ωₒ and ωᵢ turned over so that ωₒ has z > 0, and η.
#[inline]
fn before(index: f64, wo: &Vec3, wi: &Vec3) -> (f64, Vec3, Vec3) {
    if wo.z > 0.0 { (index, *wo, *wi) } else { (1.0 / index, -wo, -wi) }
}

/// The facet between two directions, on the side of ωₒ; `None` if none connects them.
#[inline]
fn between(ratio: f64, wo: &Vec3, wi: &Vec3) -> Option<Vec3> {
    if wo.z == 0.0 || wi.z == 0.0 {
        return None;
    }
    let h = if wi.z > 0.0 { wo + wi } else { wo + wi * ratio };
    let norm = h.norm();
    if !(norm > 0.0) {
        return None;
    }
    let h = h / norm.copysign(h.z);
    let faces = wo.dot(&h) > 0.0 && (wi.dot(&h) > 0.0) == (wi.z > 0.0);
    faces.then_some(h)
}

/// dh/dωᵢ of a refraction, over |ωᵢ·h|.
#[inline]
fn jacobian(ratio: f64, wo: &Vec3, wi: &Vec3, h: &Vec3) -> f64 {
    (ratio / (wo.dot(h) + ratio * wi.dot(h))).powi(2)
}

#[inline]
pub(super) fn scatter<S: Sampler>(index: f64, tint: Rgb, alpha: f64, wo: &Vec3, u: &mut S) -> Option<Ray> {
    let (point, choice) = (u.next_2d(), u.next_1d());
    let (ratio, up, _) = before(index, wo, wo);
    if up.z == 0.0 {
        return None;
    }
    let h = ggx::facet(alpha, &up, point);
    let cosine = up.dot(&h);
    let (reflected, refracted) = fresnel::dielectric(cosine, ratio);
    let reflects = choice < reflected;
    let incoming = if reflects { h * (2.0 * cosine) - up } else { h * (cosine / ratio - refracted) - up / ratio };
    let out = if wo.z > 0.0 { incoming } else { -incoming };
    if (incoming.z > 0.0) != reflects {
        return Some(Ray { incoming: out, weight: Rgb::ZERO, pdf: 1.0 });
    }
    let (o, i) = (ggx::lambda(alpha, &up), ggx::lambda(alpha, &incoming));
    let shadowing = (1.0 + o) / (1.0 + o + i);
    let weight = if reflects { Rgb::ONE } else { tint }.scaled(shadowing);
    Some(Ray { incoming: out, weight, pdf: density(index, alpha, wo, &out) })
}

/// f cos θᵢ.
#[inline]
pub(super) fn value(index: f64, tint: Rgb, alpha: f64, wo: &Vec3, wi: &Vec3) -> Rgb {
    let (ratio, wo, wi) = before(index, wo, wi);
    let Some(h) = between(ratio, &wo, &wi) else { return Rgb::ZERO };
    let (reflected, _) = fresnel::dielectric(wo.dot(&h), ratio);
    let shape = ggx::distribution(alpha, &h) / (wo.z * (1.0 + ggx::lambda(alpha, &wo) + ggx::lambda(alpha, &wi)));
    if wi.z > 0.0 {
        Rgb::ONE.scaled(0.25 * reflected * shape)
    } else {
        let bend = wo.dot(&h) * wi.dot(&h).abs() * jacobian(ratio, &wo, &wi, &h);
        tint.scaled((1.0 - reflected) * shape * bend)
    }
}

#[inline]
pub(super) fn density(index: f64, alpha: f64, wo: &Vec3, wi: &Vec3) -> f64 {
    let (ratio, wo, wi) = before(index, wo, wi);
    let Some(h) = between(ratio, &wo, &wi) else { return 0.0 };
    let (reflected, _) = fresnel::dielectric(wo.dot(&h), ratio);
    let facet = ggx::facet_pdf(alpha, &wo, &h);
    if wi.z > 0.0 {
        reflected * facet / (4.0 * wo.dot(&h))
    } else {
        (1.0 - reflected) * facet * wi.dot(&h).abs() * jacobian(ratio, &wo, &wi, &h)
    }
}
