//! Where a ray meets a triangle.

use super::Ray;
use super::build::IN_LEAF;
use super::leaves::BLOCK;
use fearless_simd::{Simd, f32x4, f64x4, prelude::*};

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

    /// The corners number k of some triangles, in the coordinates of the ray; z is not yet divided by that of the direction.
    #[inline(always)]
    fn sheared<S: Simd, C: Coordinate>(&self, simd: S, block: &[C; BLOCK], count: usize, k: usize) -> [f64x4<S>; 3] {
        let [i, j, l] = self.axes;
        let x = C::load(simd, block, count * (3 * k + i)) - self.origin[i];
        let y = C::load(simd, block, count * (3 * k + j)) - self.origin[j];
        let z = C::load(simd, block, count * (3 * k + l)) - self.origin[l];
        [x - z * self.shear[0], y - z * self.shear[1], z]
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
    pub(super) fn hits<S: Simd, C: Coordinate>(
        &self,
        simd: S,
        block: &[C; BLOCK],
        count: usize,
        until: f64,
        mut found: impl FnMut(usize, f64, f64, f64),
    ) {
        let (a, b, c) = (self.sheared(simd, block, count, 0), self.sheared(simd, block, count, 1), self.sheared(simd, block, count, 2));
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let inside = u.min(v).min(w).simd_ge(0.0) | u.max(v).max(w).simd_le(0.0);
        if inside.to_bitmask() == 0 {
            return;
        }
        let (x, y, z) = (largest(a[0], b[0], c[0]), largest(a[1], b[1], c[1]), largest(a[2], b[2], c[2]));
        let sum = u + v + w;
        let depth = (u * a[2] + v * b[2] + w * c[2]) * f64x4::splat(simd, self.stretch).copysign(sum * self.stretch);
        let error = z * UNIT * (x * y * 108.0 + z * (x + y) * 30.0) * self.stretch.abs();
        let known = depth.simd_gt(error) & depth.simd_le(sum.abs() * (until * (1.0 + 16.0 * f64::EPSILON)));
        let mut met = (inside & known).to_bitmask() & ((1 << count) - 1);
        while met != 0 {
            let i = met.trailing_zeros() as usize & (IN_LEAF - 1);
            met &= met - 1;
            let inverse = 1.0 / sum[i];
            found(i, depth[i] * inverse.abs(), v[i] * inverse, w[i] * inverse);
        }
    }
}

/// On which side of the edge from q to p the ray is.
#[inline(always)]
fn edge<S: Simd>(p: [f64x4<S>; 3], q: [f64x4<S>; 3]) -> f64x4<S> {
    p[0] * q[1] - p[1] * q[0]
}

/// The largest absolute value.
#[inline(always)]
fn largest<S: Simd>(a: f64x4<S>, b: f64x4<S>, c: f64x4<S>) -> f64x4<S> {
    a.abs().max(b.abs()).max(c.abs())
}

/// A number that a corner can be kept in.
pub(super) trait Coordinate: Copy + Into<f64> + Send + Sync {
    fn from_f64(x: f64) -> Self;
    fn load<S: Simd>(simd: S, block: &[Self; BLOCK], start: usize) -> f64x4<S>;
}

impl Coordinate for f32 {
    #[inline(always)]
    fn load<S: Simd>(simd: S, block: &[f32; BLOCK], start: usize) -> f64x4<S> {
        let (low, high) = f32x4::from_slice(simd, four(block, start)).widen();
        low.combine(high)
    }
    fn from_f64(x: f64) -> f32 {
        x as f32
    }
}

impl Coordinate for f64 {
    #[inline(always)]
    fn load<S: Simd>(simd: S, block: &[f64; BLOCK], start: usize) -> f64x4<S> {
        f64x4::from_slice(simd, four(block, start))
    }
    fn from_f64(x: f64) -> f64 {
        x
    }
}

#[inline(always)]
fn four<C>(block: &[C; BLOCK], start: usize) -> &[C] {
    let start = start.min(BLOCK - IN_LEAF);
    &block[start..start + IN_LEAF]
}
