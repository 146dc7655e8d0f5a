//! Where a ray meets a sphere.

use super::triangle::UNIT;
use super::{Ray, Sphere, Surface};
use crate::scene::vector::{dot, scale, sub, unit};
use std::f64::consts::TAU;

/// The unit vector at longitude 2πu, height 1 − 2v.
pub(super) fn direction(u: f64, v: f64) -> [f64; 3] {
    let z = 1.0 - 2.0 * v;
    let r = 2.0 * (v * (1.0 - v)).max(0.0).sqrt();
    let (sin, cos) = (TAU * u).sin_cos();
    [r * cos, r * sin, z]
}

impl Sphere {
    pub(super) fn hit(&self, ray: &Ray) -> Option<f64> {
        let o = sub(ray.origin, self.centre());
        let d = ray.direction;
        let (a, b) = (dot(d, d), -dot(o, d));
        // the point of the ray nearest to the centre
        let f = std::array::from_fn(|i| o[i] + b / a * d[i]);
        let r = self.radius();
        let half = a * (r * r - dot(f, f));
        if !(half >= 0.0) {
            return None;
        }
        let q = b + half.sqrt().copysign(b);
        let (near, far) = ((dot(o, o) - r * r) / q, q / a);
        let (near, far) = if near < far { (near, far) } else { (far, near) };
        let error = 16.0 * UNIT * (dot(o, o) + r * r) / q.abs();
        let within = |t: f64| t > error && t < ray.until;
        [near, far].into_iter().find(|&t| within(t))
    }

    pub(super) fn bounds(&self) -> [[f64; 3]; 2] {
        // a little more than the sphere, for the rounding of hits
        let r = self.radius() * (1.0 + 16.0 * UNIT);
        [self.centre().map(|c| (c - r).next_down()), self.centre().map(|c| (c + r).next_up())]
    }

    /// The point in a direction from the centre.
    pub(super) fn surface(&self, direction: [f64; 3], primitive: u32) -> Surface {
        let normal = unit(direction);
        let (c, r) = (self.centre(), scale(self.radius(), normal));
        let z = 0.5 * (1.0 - normal[2]);
        Surface {
            position: std::array::from_fn(|i| c[i] + r[i]),
            error: std::array::from_fn(|i| 8.0 * UNIT * (c[i].abs() + self.radius())),
            normal,
            primitive,
            u: (normal[1].atan2(normal[0]) / TAU).rem_euclid(1.0),
            v: z,
        }
    }
}
