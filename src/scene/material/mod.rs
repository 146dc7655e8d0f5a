//! How surfaces scatter: a closed set of laws, `sample`, `eval` and `pdf` side by side.
//!
//! | law | f(ωₒ, ωᵢ) | energy kept |
//! |---|---|---|
//! | [`Bsdf::Lambertian`] | ρ/π | ρ |
//! | [`Bsdf::Mirror`] | Dirac, ρ | ρ |
//! | [`Bsdf::Dielectric`] | two Dirac parts, F and 1 − F | all |
//! | [`Bsdf::Conductor`] | F D G/(4 cos cos), GGX | less at high roughness: single scattering |
//! | [`Bsdf::RoughDielectric`] | Walter's, GGX | as above |
//! | [`Bsdf::MetallicRoughness`] | glTF 2.0, appendix B | as above |
//!
//! All are reciprocal: f(ωₒ, ωᵢ) = f(ωᵢ, ωₒ), for refraction f(ωₒ, ωᵢ)/nᵢ² = f(ωᵢ, ωₒ)/nₒ². The unknown of the equation is the *basic radiance* L/n²,
//! which refraction leaves alone (Nicodemus 1963); outside glass it is the radiance.
//!
//! Directions are in the surface's own frame, point away from it, and z is the normal. Densities are with respect to solid angle; `eval` has the
//! cosine in it.

mod dielectric;
mod fresnel;
mod ggx;
mod metallic;
mod rough;
mod surface;

pub use metallic::MetallicRoughness;
pub(crate) use surface::Law;
pub use surface::{Material, Sides, Textures};

use super::Rgb;
use super::frame::Vec3;
use crate::error::Error;
use crate::sampling::Sampler;
use crate::sampling::distribution::{CosineHemisphere, Distribution};
use crate::value::{Value, Weight};
use std::f64::consts::FRAC_1_PI;

/// A scattering law with its parameters at one point of a surface.
///
/// ```
/// use fredholm::{Spectrum, scene::Bsdf};
/// let (up, low) = ([0.0, 0.0, 1.0], [0.8, 0.0, 0.6]);
/// let paper = Bsdf::Lambertian { albedo: Spectrum([0.5; 3]) };
/// assert!((paper.eval(up, low)[0] * std::f64::consts::PI - 0.5 * 0.6).abs() < 1e-15);
/// assert!((paper.pdf(up, low) * std::f64::consts::PI - 0.6).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Bsdf {
    /// Nothing comes back.
    Black,
    /// Perfectly diffuse: f = albedo/π.
    Lambertian {
        /// ρ ∈ [0, 1].
        albedo: Rgb,
    },
    /// Perfectly specular.
    Mirror {
        /// ρ ∈ [0, 1].
        reflectance: Rgb,
    },
    /// Smooth glass: reflects with Fresnel's F, refracts the rest.
    Dielectric {
        /// Index of refraction behind the surface over that before it.
        index: f64,
        /// Share of refracted light that comes through, 1 for clear glass.
        tint: Rgb,
    },
    /// Rough metal: GGX microfacets with Schlick's Fresnel term.
    Conductor {
        /// Reflectance at normal incidence.
        specular: Rgb,
        /// GGX α > 0; the square of the usual roughness.
        alpha: f64,
    },
    /// Rough glass: GGX microfacets that reflect and refract (Walter et al. 2007).
    RoughDielectric {
        /// Index of refraction behind the surface over that before it.
        index: f64,
        /// Share of refracted light that comes through, 1 for clear glass.
        tint: Rgb,
        /// GGX α > 0.
        alpha: f64,
    },
    /// The material of glTF 2.0.
    MetallicRoughness(MetallicRoughness),
}

/// A direction drawn by a scattering law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// ωᵢ.
    pub incoming: [f64; 3],
    /// f cos/pdf.
    pub weight: Rgb,
    /// Density of ωᵢ per solid angle; infinite for a Dirac part.
    pub pdf: f64,
}

/// As [`Scattered`], with the vector type of this module.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) incoming: Vec3,
    pub(crate) weight: Rgb,
    pub(crate) pdf: f64,
}

impl Bsdf {
    /// Draws ωᵢ for light that leaves along ωₒ; `None` if nothing can come back. Consumes up to three numbers.
    pub fn sample<S: Sampler>(&self, outgoing: [f64; 3], u: &mut S) -> Option<Scattered> {
        self.scatter(&outgoing.into(), u).map(|r| Scattered { incoming: r.incoming.into(), weight: r.weight, pdf: r.pdf })
    }

    /// f(ωₒ, ωᵢ) |cos θᵢ|, Dirac parts left out.
    #[must_use]
    pub fn eval(&self, outgoing: [f64; 3], incoming: [f64; 3]) -> Rgb {
        self.value(&outgoing.into(), &incoming.into())
    }

    /// Density of `sample` at ωᵢ, Dirac parts left out.
    #[must_use]
    pub fn pdf(&self, outgoing: [f64; 3], incoming: [f64; 3]) -> f64 {
        self.density(&outgoing.into(), &incoming.into())
    }

    #[inline]
    pub(crate) fn scatter<S: Sampler>(&self, wo: &Vec3, u: &mut S) -> Option<Ray> {
        match self {
            Bsdf::Black => None,
            Bsdf::Lambertian { albedo } => {
                let incoming = Vec3::from(CosineHemisphere.sample(u.next_2d()));
                (wo.z > 0.0).then(|| Ray { incoming, weight: *albedo, pdf: incoming.z * FRAC_1_PI })
            }
            Bsdf::Mirror { reflectance } => {
                (wo.z > 0.0).then(|| Ray { incoming: Vec3::new(-wo.x, -wo.y, wo.z), weight: *reflectance, pdf: f64::INFINITY })
            }
            Bsdf::Dielectric { index, tint } => dielectric::scatter(*index, *tint, wo, u),
            Bsdf::Conductor { specular, alpha } => ggx::scatter(*alpha, |c| fresnel::schlick(*specular, c), wo, u),
            Bsdf::RoughDielectric { index, tint, alpha } => rough::scatter(*index, *tint, *alpha, wo, u),
            Bsdf::MetallicRoughness(m) => m.scatter(wo, u),
        }
    }

    #[inline]
    pub(crate) fn value(&self, wo: &Vec3, wi: &Vec3) -> Rgb {
        match self {
            Bsdf::Black | Bsdf::Mirror { .. } | Bsdf::Dielectric { .. } => Rgb::ZERO,
            Bsdf::Lambertian { albedo } if wo.z > 0.0 && wi.z > 0.0 => albedo.scaled(wi.z * FRAC_1_PI),
            Bsdf::Lambertian { .. } => Rgb::ZERO,
            Bsdf::Conductor { specular, alpha } => ggx::value(*alpha, |c| fresnel::schlick(*specular, c), wo, wi),
            Bsdf::RoughDielectric { index, tint, alpha } => rough::value(*index, *tint, *alpha, wo, wi),
            Bsdf::MetallicRoughness(m) => m.value(wo, wi),
        }
    }

    #[inline]
    pub(crate) fn density(&self, wo: &Vec3, wi: &Vec3) -> f64 {
        match self {
            Bsdf::Black | Bsdf::Mirror { .. } | Bsdf::Dielectric { .. } => 0.0,
            Bsdf::Lambertian { .. } if wo.z > 0.0 => wi.z.max(0.0) * FRAC_1_PI,
            Bsdf::Lambertian { .. } => 0.0,
            Bsdf::Conductor { alpha, .. } => ggx::density(*alpha, wo, wi),
            Bsdf::RoughDielectric { index, alpha, .. } => rough::density(*index, *alpha, wo, wi),
            Bsdf::MetallicRoughness(m) => m.density(wo, wi),
        }
    }

    /// (nᵢ/nₒ)², by which light that is refracted from ωᵢ to ωₒ multiplies beside what reciprocity says: the unknown is L/n².
    #[inline]
    pub(crate) fn adjoint_factor(&self, wi: &Vec3, wo: &Vec3) -> f64 {
        match self {
            Bsdf::Dielectric { index, .. } | Bsdf::RoughDielectric { index, .. } if wi.z * wo.z < 0.0 => {
                let ratio = if wi.z > 0.0 { 1.0 / index } else { *index };
                ratio * ratio
            }
            _ => 1.0,
        }
    }

    /// Whether only Dirac parts scatter: no other point of the scene can then be connected to this one.
    #[inline]
    #[must_use]
    pub fn is_singular(&self) -> bool {
        matches!(self, Bsdf::Black | Bsdf::Mirror { .. } | Bsdf::Dielectric { .. })
    }

    /// Whether light passes through the surface.
    #[inline]
    #[must_use]
    pub fn transmits(&self) -> bool {
        matches!(self, Bsdf::Dielectric { .. } | Bsdf::RoughDielectric { .. })
    }

    /// Refuses albedos outside [0, 1], indices and roughnesses that are none.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        match self {
            Bsdf::Black => Ok(()),
            Bsdf::Lambertian { albedo } => share("albedo", albedo),
            Bsdf::Mirror { reflectance } => share("reflectance", reflectance),
            Bsdf::Dielectric { index, tint } => positive("index of refraction", *index).and_then(|()| share("tint", tint)),
            Bsdf::Conductor { specular, alpha } => share("specular reflectance", specular).and_then(|()| roughness(*alpha)),
            Bsdf::RoughDielectric { index, tint, alpha } => {
                positive("index of refraction", *index)?;
                share("tint", tint)?;
                roughness(*alpha)
            }
            Bsdf::MetallicRoughness(m) => m.validate(),
        }
    }
}

/// Smallest GGX α: below it a microfacet is a mirror to all purposes, and powers of it leave the digits of a double.
pub(crate) const SMOOTHEST: f64 = 1e-4;

fn share(parameter: &'static str, values: &Rgb) -> Result<(), Error> {
    match values.0.iter().find(|v| !(**v >= 0.0 && **v <= 1.0)) {
        Some(v) => Err(Error::invalid(parameter, *v, "must lie in [0, 1]: a surface gives back no more than it gets")),
        None => Ok(()),
    }
}

fn positive(parameter: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(Error::invalid(parameter, value, "must be positive and finite")) }
}

fn roughness(alpha: f64) -> Result<(), Error> {
    if (SMOOTHEST..=1.0).contains(&alpha) { Ok(()) } else { Err(Error::invalid("GGX alpha", alpha, "must lie in [0.0001, 1]")) }
}
