//! Points of an emitting sphere: uniform in the cone it fills, seen from outside.
//!
//! ```text
//! q = cos θ/(r² Ω) per area,   Ω = 2π (1 − √(1 − R²/d²))
//! ```

use crate::scene::frame::{Frame, Vec3};
use std::f64::consts::TAU;

/// A sphere that emits outwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereLight {
    pub(crate) centre: Vec3,
    pub(crate) radius: f64,
}

impl SphereLight {
    #[inline]
    pub(crate) fn faces(&self, x: &Vec3) -> bool {
        (x - self.centre).norm_squared() > self.radius * self.radius
    }

    /// 1 − cos of the half angle, without its cancellation.
    #[inline]
    fn height(&self, x: &Vec3) -> f64 {
        let sine2 = self.radius * self.radius / (x - self.centre).norm_squared();
        sine2 / (1.0 + (1.0 - sine2).max(0.0).sqrt())
    }

    /// Unit vector from the centre to the point, and 1/q.
    #[inline]
    pub(crate) fn sample(&self, x: &Vec3, [u, v]: [f64; 2]) -> Option<(Vec3, f64)> {
        let axis = self.centre - x;
        let d = axis.norm();
        let h = u * self.height(x);
        let (sine2, (s, c)) = (h * (2.0 - h), (TAU * v).sin_cos());
        // distance to the near side of the sphere along the direction
        let t = d * (1.0 - h) - (self.radius * self.radius - d * d * sine2).max(0.0).sqrt();
        let sine = sine2.sqrt();
        let direction = Frame::around(axis / d).to_world(&Vec3::new(sine * c, sine * s, 1.0 - h));
        let normal = (direction * t - axis).normalize();
        let q = self.pdf(x, &(self.centre + normal * self.radius), &normal);
        (q > 0.0).then(|| (normal, 1.0 / q))
    }

    /// q at the point y with this normal, per area.
    #[inline]
    pub(crate) fn pdf(&self, x: &Vec3, y: &Vec3, normal: &Vec3) -> f64 {
        let d = x - y;
        let r2 = d.norm_squared();
        (d.dot(normal) / (r2 * r2.sqrt() * TAU * self.height(x))).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions are uniform in the cone, so that each sample alone has its solid angle: cos θ/(r² q) = Ω. Far away, near by, and at the surface.
    #[test]
    fn every_sample_has_the_solid_angle() {
        let light = SphereLight { centre: Vec3::new(0.3, -0.2, 0.5), radius: 2.0 };
        for (distance, digits) in [(2e6, 1e-9), (10.0, 1e-12), (2.5, 1e-12), (2.0 + 1e-6, 1e-9)] {
            let x = light.centre + Vec3::new(0.48, -0.6, 0.64) * distance;
            let cone = TAU * light.height(&x);
            let (axis, mut mean) = ((light.centre - x) / distance, 0.0);
            const N: usize = 32;
            for k in 0..N * N {
                let (normal, weight) = light.sample(&x, [k % N, k / N].map(|i| (i as f64 + 0.5) / N as f64)).unwrap();
                let to = light.centre + normal * light.radius - x;
                let cosine = -to.dot(&normal) / to.norm();
                // near the horizon of the sphere cosine and density share their rounding, and little else
                assert!((weight * cosine / to.norm_squared() / cone - 1.0).abs() < digits / cosine, "{distance}: {weight} {cosine}");
                mean += (1.0 - to.dot(&axis) / to.norm()) / (N * N) as f64;
            }
            assert!((mean / (0.5 * light.height(&x)) - 1.0).abs() < 1e-3, "{distance}: {mean}");
        }
        assert!(!light.faces(&light.centre));
    }
}
