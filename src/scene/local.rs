//! How a surface scatters at a state, and the way from one state to another.

use super::Rgb;
use super::frame::{Frame, Vec3};
use super::material::Bsdf;
use super::state::{Place, State};
use crate::value::{Value, Weight};
use std::f64::consts::FRAC_1_PI;

/// The scattering law at a state.
pub(super) struct Local {
    pub(super) bsdf: Bsdf,
    pub(super) outgoing: Vec3,
    /// true unit normal; on opaque surfaces on the side of ωₒ
    pub(super) normal: Vec3,
    /// the one to shade with
    pub(super) smooth: Vec3,
}

impl Local {
    /// Whether ωᵢ is on the same side of the interpolated normal and of the true one: light on no other way.
    #[inline]
    pub(super) fn agree(&self, wi: &Vec3) -> bool {
        self.smooth.dot(wi) * self.normal.dot(wi) > 0.0
    }

    /// f |cos θᵢ|.
    #[inline]
    pub(super) fn value(&self, wi: &Vec3) -> Rgb {
        match self.bsdf {
            _ if !self.agree(wi) => Rgb::ZERO,
            // no frame is needed for the most frequent law
            Bsdf::Lambertian { albedo } => albedo.scaled(self.smooth.dot(wi).max(0.0) * FRAC_1_PI),
            bsdf => {
                let frame = Frame::around(self.smooth);
                bsdf.value(&frame.to_local(&self.outgoing), &frame.to_local(wi))
            }
        }
    }

    /// π to a point in a direction.
    #[inline]
    pub(super) fn pdf(&self, y: &State, way: &Connection) -> f64 {
        if matches!(y.place, Place::Light(_)) { 0.0 } else { self.density(&way.direction) * way.solid_angle }
    }

    /// pdf(ωᵢ).
    #[inline]
    pub(super) fn density(&self, wi: &Vec3) -> f64 {
        match self.bsdf {
            _ if !self.agree(wi) => 0.0,
            Bsdf::Lambertian { .. } => self.smooth.dot(wi).max(0.0) * FRAC_1_PI,
            bsdf => {
                let frame = Frame::around(self.smooth);
                bsdf.density(&frame.to_local(&self.outgoing), &frame.to_local(wi))
            }
        }
    }
}

/// From x to y: the direction, and dω/dμ = |cos θ_y|/r².
pub(super) struct Connection {
    pub(super) direction: Vec3,
    pub(super) solid_angle: f64,
}
