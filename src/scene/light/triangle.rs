//! Points of an emitting triangle: uniform in the solid angle it fills, or in its area where it is far away and both are alike.
//!
//! ```text
//! near   q = |cos θ|/(r² Ω) per area,   Ω = 2 atan2(|a·(b × c)|, 1 + a·b + b·c + c·a)         a, b, c unit vectors to the corners
//! far    q = 1/A
//! ```
//!
//! With the first, K g/q stays bounded however close the triangle is: area sampling has infinite variance in corners (theory (4.4.3)).
//! Arvo, *Stratified sampling of spherical triangles*, SIGGRAPH 1995; Van Oosterom, Strackee, *The solid angle of a plane triangle*, IEEE Trans.
//! Biomed. Eng. 30 (1983) 125.

use crate::scene::frame::Vec3;
/// A triangle ready to be sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleLight {
    pub(crate) corner: Vec3,
    pub(crate) sides: [Vec3; 2],
    /// unit normal on the emitting side
    pub(crate) normal: Vec3,
    pub(crate) area: f64,
    centre: Vec3,
    /// squared distance of the farthest corner from the centre
    radius2: f64,
}

/// A triangle is near within so many squared radii. Beyond, cos θ/r² varies over it by half at most, and its exact density is not worth its price.
const NEAR: f64 = 16.0;

impl TriangleLight {
    pub(crate) fn new([a, b, c]: [[f64; 3]; 3]) -> Self {
        let [a, b, c] = [a, b, c].map(Vec3::from);
        let cross = (b - a).cross(&(c - a));
        let centre = (a + b + c) / 3.0;
        let radius2 = [a, b, c].iter().fold(0.0, |m: f64, p| m.max((p - centre).norm_squared()));
        TriangleLight { corner: a, sides: [b - a, c - a], normal: cross.normalize(), area: 0.5 * cross.norm(), centre, radius2 }
    }

    /// Whether `x` sees the emitting side.
    #[inline]
    pub(crate) fn faces(&self, x: &Vec3) -> bool {
        (x - self.corner).dot(&self.normal) > 0.0
    }

    #[inline]
    fn is_near(&self, x: &Vec3) -> bool {
        (self.centre - x).norm_squared() < NEAR * self.radius2
    }

    fn corners_from(&self, x: &Vec3) -> [Vec3; 3] {
        let a = self.corner - x;
        [a, a + self.sides[0], a + self.sides[1]].map(|v| v.normalize())
    }

    /// Barycentric weights of the second and third corner, and 1/q; `None` where nothing can be seen.
    #[inline]
    pub(crate) fn sample(&self, x: &Vec3, [u, v]: [f64; 2]) -> Option<([f64; 2], f64)> {
        if !self.is_near(x) {
            let root = u.sqrt();
            return Some(([root * (1.0 - v), root * v], self.area));
        }
        let corners = self.corners_from(x);
        let solid = solid_angle(&corners);
        let direction = spherical(&corners, solid, [u, v])?;
        let weights = self.meet(x, &direction)?;
        let y = self.corner + self.sides[0] * weights[0] + self.sides[1] * weights[1];
        // a triangle seen edge-on, or a point in its plane: rounding leaves no solid angle
        let q = self.density(x, &y, solid);
        (q > 0.0 && q < f64::INFINITY).then(|| (weights, 1.0 / q))
    }

    /// q at the point y of the triangle, per area.
    #[inline]
    pub(crate) fn pdf(&self, x: &Vec3, y: &Vec3) -> f64 {
        if self.is_near(x) { self.density(x, y, solid_angle(&self.corners_from(x))) } else { 1.0 / self.area }
    }

    #[inline]
    fn density(&self, x: &Vec3, y: &Vec3, solid: f64) -> f64 {
        let d = y - x;
        let r2 = d.norm_squared();
        -d.dot(&self.normal) / (r2 * r2.sqrt() * solid)
    }

    /// Where a direction from x meets the triangle; rounding may not leave it.
    #[inline]
    fn meet(&self, x: &Vec3, direction: &Vec3) -> Option<[f64; 2]> {
        let [ab, ac] = &self.sides;
        let p = direction.cross(ac);
        let scale = 1.0 / ab.dot(&p);
        let from = x - self.corner;
        let (b, c) = (from.dot(&p) * scale, direction.dot(&from.cross(ab)) * scale);
        if !(b.is_finite() && c.is_finite()) {
            return None;
        }
        let b = b.clamp(0.0, 1.0);
        Some([b, c.clamp(0.0, 1.0 - b)])
    }
}

/// Ω of a spherical triangle.
#[inline]
fn solid_angle([a, b, c]: &[Vec3; 3]) -> f64 {
    let volume = a.dot(&b.cross(c)).abs();
    2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// A direction uniform in a spherical triangle of this Ω; `None` if it has degenerated.
#[inline]
fn spherical([a, b, c]: &[Vec3; 3], solid: f64, [u, v]: [f64; 2]) -> Option<Vec3> {
    let [ab, ca] = [a.cross(b), c.cross(a)].map(|n| n.normalize());
    // of the angle α at a
    let (sine, cosine) = (ab.cross(&ca).norm(), -ab.dot(&ca));
    // u cuts off a triangle of area φ = uΩ: p = cos(φ − α) − cos α without its cancellation, s and t the sine and cosine of φ − α
    let (half_sine, half_cosine) = (0.5 * u * solid).sin_cos();
    let (rise, drop) = (2.0 * half_sine * half_cosine, 2.0 * half_sine * half_sine);
    let (s, p) = (rise * cosine - (1.0 - drop) * sine, rise * sine - drop * cosine);
    let (t, q) = (cosine + p, s + sine * a.dot(b));
    let numerator = (q * t - p * s) * cosine - q;
    let cos_cut = (numerator / ((q * s + p * t) * sine)).clamp(-1.0, 1.0);
    let cut = a * cos_cut + orthogonal(c, a) * (1.0 - cos_cut * cos_cut).sqrt();
    let z = 1.0 - v * (1.0 - cut.dot(b));
    let direction = b * z + orthogonal(&cut, b) * (1.0 - z * z).max(0.0).sqrt();
    direction.iter().all(|x| x.is_finite()).then_some(direction)
}

/// The part of v orthogonal to w, of length 1.
#[inline]
fn orthogonal(v: &Vec3, w: &Vec3) -> Vec3 {
    let part = v - w * v.dot(w);
    let norm = part.norm();
    if norm > 0.0 { part / norm } else { Vec3::zeros() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The octant of the sphere has Ω = π/2, and uniform directions in it have the mean of the octant, ½ in each coordinate.
    #[test]
    fn the_octant() {
        let t = TriangleLight::new([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
        let x = Vec3::zeros();
        let corners = t.corners_from(&x);
        assert!((solid_angle(&corners) - PI / 2.0).abs() < 1e-15);
        const N: usize = 64;
        let mut mean = Vec3::zeros();
        for i in 0..N * N {
            let uv = [(i % N) as f64 + 0.5, (i / N) as f64 + 0.5].map(|c| c / N as f64);
            mean += spherical(&corners, PI / 2.0, uv).unwrap() / (N * N) as f64;
            let (w, weight) = t.sample(&x, uv).unwrap();
            let y = t.corner + t.sides[0] * w[0] + t.sides[1] * w[1];
            assert!((weight * t.pdf(&x, &y) - 1.0).abs() < 1e-12);
        }
        assert!((mean - Vec3::repeat(0.5)).norm() < 1e-3, "{mean}");
    }
}
