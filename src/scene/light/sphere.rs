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
