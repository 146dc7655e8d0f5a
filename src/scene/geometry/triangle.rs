//! Where a ray meets a triangle.

use super::Ray;
use super::build::IN_LEAF;
use super::lanes::Lanes;
use std::array::from_fn;

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

    /// Some corners, given by coordinate, in the coordinates of the ray; z is not yet divided by that of the direction.
    #[inline(always)]
    fn sheared<S: Copy + Into<f64>>(&self, corners: &[[S; IN_LEAF]; 3]) -> [Four; 3] {
        let [x, y, z] = self.axes.map(|axis| &corners[axis]);
        let o = self.axes.map(|axis| self.origin[axis]);
        let z: Four = from_fn(|i| z[i].into() - o[2]);
        [from_fn(|i| (x[i].into() - o[0]) - self.shear[0] * z[i]), from_fn(|i| (y[i].into() - o[1]) - self.shear[1] * z[i]), z]
    }

    /// Where the ray meets triangles, given by corner and coordinate, before `until` or little later: the lane, t > 0 and the weights of the
    /// second and third corner.
    ///
    /// A hit whose t is below its rounding error is none: nobody knows on which side of the origin that triangle is. The bound is
    ///
    /// ```text
    /// δt = 3(γ₃ e z + δe z + δz e)/|sum|,   δe = 2(γ₂ x y + δy x + δx y),   δx = γ₅(x + z),   δy = γ₅(y + z),   δz = γ₃ z
    /// ```
    ///
    /// with x, y, z the largest sheared coordinates and e ≤ 2xy the largest edge: z(108 xy + 30 z(x + y))/|sum| units of rounding.
    /// Pharr, Jakob & Humphreys (2023), Physically Based Rendering, 4th edition, §6.8.7.
    #[inline(always)]
    pub(super) fn hits<S: Copy + Into<f64>, L: Lanes>(
        &self,
        lanes: L,
        corners: &[[[S; IN_LEAF]; 3]; 3],
        until: f64,
        mut found: impl FnMut(usize, f64, f64, f64),
    ) {
        let (a, b, c) = (self.sheared(&corners[0]), self.sheared(&corners[1]), self.sheared(&corners[2]));
        let (u, v, w) = (edge(&c, &b), edge(&a, &c), edge(&b, &a));
        let mut met = !lanes.below64(&inside(&u, &v, &w)) & 0xf;
        if met == 0 {
            return;
        }
        let (x, y, z) = (largest(&a[0], &b[0], &c[0]), largest(&a[1], &b[1], &c[1]), largest(&a[2], &b[2], &c[2]));
        let (stretch, until) = (self.stretch.abs(), until * (1.0 + 16.0 * f64::EPSILON));
        let (mut sum, mut depth, mut known) = ([0.0; IN_LEAF], [0.0; IN_LEAF], [0.0; IN_LEAF]);
        for i in 0..IN_LEAF {
            sum[i] = u[i] + v[i] + w[i];
            depth[i] = (u[i] * a[2][i] + v[i] * b[2][i] + w[i] * c[2][i]) * self.stretch.copysign(self.stretch * sum[i]);
            let error = UNIT * z[i] * (108.0 * x[i] * y[i] + 30.0 * z[i] * (x[i] + y[i])) * stretch;
            known[i] = if (depth[i] > error) & (depth[i] <= until * sum[i].abs()) { 1.0 } else { -1.0 };
        }
        met &= !lanes.below64(&known);
        while met != 0 {
            let i = met.trailing_zeros() as usize & (IN_LEAF - 1);
            met &= met - 1;
            let inverse = 1.0 / sum[i];
            found(i, depth[i] * inverse.abs(), v[i] * inverse, w[i] * inverse);
        }
    }
}

/// Of four triangles.
type Four = [f64; IN_LEAF];

/// On which side of the edge from q to p the ray is.
#[inline(always)]
fn edge(p: &[Four; 3], q: &[Four; 3]) -> Four {
    from_fn(|i| p[0][i] * q[1][i] - p[1][i] * q[0][i])
}

/// Whether the ray is on one side of all edges: 1, or −1 where it is not or where a number is NaN.
#[inline(always)]
fn inside(u: &Four, v: &Four, w: &Four) -> Four {
    let min = |a: f64, b: f64| if a < b { a } else { b };
    let max = |a: f64, b: f64| if a > b { a } else { b };
    from_fn(|i| if (min(min(u[i], v[i]), w[i]) >= 0.0) | (max(max(u[i], v[i]), w[i]) <= 0.0) { 1.0 } else { -1.0 })
}

/// The largest absolute value.
#[inline(always)]
fn largest(a: &Four, b: &Four, c: &Four) -> Four {
    let max = |a: f64, b: f64| if a > b { a } else { b };
    from_fn(|i| max(max(a[i].abs(), b[i].abs()), c[i].abs()))
}
