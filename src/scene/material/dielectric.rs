//! Smooth glass: Fresnel's F of the light is reflected, the rest refracted (Born, Wolf, *Principles of optics*, §1.5).

use super::{Ray, fresnel};
use crate::sampling::Sampler;
use crate::scene::Rgb;
use crate::scene::frame::Vec3;
use crate::value::Weight;

/// `wo` may lie on either side; z > 0 is before the surface.
#[inline]
pub(super) fn scatter<S: Sampler>(index: f64, tint: Rgb, wo: &Vec3, u: &mut S) -> Option<Ray> {
    let ratio = if wo.z > 0.0 { index } else { 1.0 / index };
    let (reflected, refracted) = fresnel::dielectric(wo.z.abs(), ratio);
    if u.next_1d() < reflected {
        return Some(Ray { incoming: Vec3::new(-wo.x, -wo.y, wo.z), weight: Rgb::ONE, pdf: f64::INFINITY });
    }
    // basic radiance L/n² passes unchanged
    let incoming = Vec3::new(-wo.x / ratio, -wo.y / ratio, -refracted.copysign(wo.z));
    Some(Ray { incoming, weight: tint, pdf: f64::INFINITY })
}
