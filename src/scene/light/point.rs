//! Lights without extent, perhaps with a beam.
//!
//! ```text
//! I(ω) = I₀ s(ω),     s = clamp((cos θ − cos β)/(cos α − cos β), 0, 1)²          θ from the axis of the beam, full within α, nothing beyond β
//! ```
//!
//! glTF extension `KHR_lights_punctual`. Without a beam s = 1.

use crate::scene::Rgb;
use crate::scene::frame::{Frame, Vec3};
use std::f64::consts::TAU;

/// A point that emits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointLight {
    pub(crate) position: Vec3,
    /// I₀
    pub(crate) intensity: Rgb,
    /// unit vector along the beam
    pub(crate) axis: Vec3,
    /// cos α and cos β; −1 and −1 for all directions
    pub(crate) cosines: [f64; 2],
}

impl PointLight {
    /// In all directions alike.
    pub(crate) fn all_around(position: Vec3, intensity: Rgb) -> Self {
        PointLight { position, intensity, axis: Vec3::z(), cosines: [-1.0; 2] }
    }

    /// Whether it has no beam.
    pub(crate) fn is_isotropic(&self) -> bool {
        self.cosines[1] == -1.0
    }

    /// s(ω).
    #[inline]
    pub(crate) fn share(&self, direction: &Vec3) -> f64 {
        let [inner, outer] = self.cosines;
        let cosine = self.axis.dot(direction);
        if cosine >= inner || outer == -1.0 {
            return 1.0;
        }
        let s = ((cosine - outer) / (inner - outer)).max(0.0);
        s * s
    }

    /// Solid angle of the beam, in which photons start uniformly.
    #[inline]
    pub(crate) fn solid_angle(&self) -> f64 {
        TAU * (1.0 - self.cosines[1])
    }

    /// A direction of the beam, uniform.
    #[inline]
    pub(crate) fn sample(&self, [u, v]: [f64; 2]) -> Vec3 {
        let height = u * (1.0 - self.cosines[1]);
        let (sine, (s, c)) = ((height * (2.0 - height)).sqrt(), (TAU * v).sin_cos());
        Frame::around(self.axis).to_world(&Vec3::new(sine * c, sine * s, 1.0 - height))
    }

    /// Density of `sample` per solid angle.
    #[inline]
    pub(crate) fn pdf(&self, direction: &Vec3) -> f64 {
        let inside = self.is_isotropic() || self.axis.dot(direction) >= self.cosines[1];
        if inside { 1.0 / self.solid_angle() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ s dω = 2π (1 − cos α + (cos α − cos β)/3).
    #[test]
    fn the_power_of_a_beam() {
        let light =
            PointLight { cosines: [0.9, 0.5], axis: Vec3::new(0.6, 0.0, 0.8), ..PointLight::all_around(Vec3::zeros(), Rgb::default()) };
        const N: usize = 200;
        let mut power = 0.0;
        for k in 0..N * N {
            let direction = light.sample([(k % N) as f64 + 0.5, (k / N) as f64 + 0.5].map(|c| c / N as f64));
            assert!(light.pdf(&direction) > 0.0);
            power += light.share(&direction) / light.pdf(&direction) / (N * N) as f64;
        }
        assert!((power / (TAU * (0.1 + 0.4 / 3.0)) - 1.0).abs() < 1e-4, "{power}");
        assert_eq!((light.pdf(&-light.axis), light.share(&-light.axis)), (0.0, 0.0));
    }
}
