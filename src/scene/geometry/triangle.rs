//! Where a ray meets a triangle.

use super::Ray;
use crate::scene::vector::sub;

/// 2⁻⁵³, the relative error of one operation.
pub(super) const UNIT: f64 = f64::EPSILON / 2.0;

/// A ray's own coordinates: it runs along z from the origin, after a permutation and a shear.
///
/// An edge of the triangle, seen along the ray, has the ray on one side: Pₓ Q_y − P_y Qₓ ≥ 0. The two triangles that share the edge compute the
/// same two products, so that none of them can lose the ray: the sum of two rounded numbers has the sign of the exact one or is 0, which counts
/// as inside. For that reason no product is fused with the difference.
/// Woop, Benthin & Wald (2013), Watertight ray/triangle intersection, JCGT 2(1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) origin: [f64; 3],
    pub(super) direction: [f64; 3],
    pub(super) axes: [usize; 3],
    pub(super) shear: [f64; 2],
    /// 1/z of the direction
    pub(super) stretch: f64,
    /// largest coordinate of the direction
    pub(super) length: f64,
}

impl Frame {
    #[inline]
    pub(super) fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let k = if d[1].abs() > d[0].abs() { 1 } else { 0 };
        let z = if d[2].abs() > d[k].abs() { 2 } else { k };
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z];
        let stretch = 1.0 / d[z];
        Frame { origin: ray.origin, direction: d, axes, shear: [d[axes[0]] * stretch, d[axes[1]] * stretch], stretch, length: d[z].abs() }
    }

    /// The ray, without its end.
    #[inline(always)]
    pub(super) fn ray(&self) -> Ray {
        Ray::new(self.origin, self.direction)
    }

    #[inline(always)]
    fn sheared(&self, p: [f64; 3]) -> [f64; 3] {
        let p = sub(p, self.origin);
        let z = p[self.axes[2]];
        [p[self.axes[0]] - self.shear[0] * z, p[self.axes[1]] - self.shear[1] * z, z]
    }

    /// t > 0 and the weights of the second and third corner.
    #[inline(always)]
    pub(super) fn hit(&self, corners: &[[f64; 3]; 3]) -> Option<(f64, f64, f64)> {
        let [a, b, c] = corners.map(|p| self.sheared(p));
        let edges = [c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]];
        if !(edges.iter().all(|&e| e >= 0.0) || edges.iter().all(|&e| e <= 0.0)) {
            return None;
        }
        let sum = edges[0] + edges[1] + edges[2];
        let t = (edges[0] * a[2] + edges[1] * b[2] + edges[2] * c[2]) * self.stretch / sum;
        // NaN where the triangle is seen edge-on
        (t > self.error(&[a, b, c], &edges, sum)).then(|| (t, edges[1] / sum, edges[2] / sum))
    }

    /// A bound of the rounding error of t: below it, nobody knows on which side of the origin the triangle is.
    /// Pharr, Jakob & Humphreys (2023), Physically Based Rendering, 4th edition, §6.8.7.
    #[inline(always)]
    fn error(&self, corners: &[[f64; 3]; 3], edges: &[f64; 3], sum: f64) -> f64 {
        let over = |i: usize| corners.iter().fold(0.0_f64, |m, p| m.max(p[i].abs()));
        let (x, y, z, e) = (over(0), over(1), over(2), edges.iter().fold(0.0_f64, |m, e| m.max(e.abs())));
        let gamma = |n: f64| n * UNIT * (1.0 + 1e-15 * n);
        let (dx, dy, dz) = (gamma(5.0) * (x + z), gamma(5.0) * (y + z), gamma(3.0) * z);
        let de = 2.0 * (gamma(2.0) * x * y + dy * x + dx * y);
        3.0 * (gamma(3.0) * e * z + de * z + dz * e) * self.stretch.abs() / sum.abs()
    }
}
