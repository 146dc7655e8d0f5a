//! Disks and triangles.

use super::{Distribution, Inverse};
use crate::error::Error;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4};

/// Uniform on the unit disk, by the concentric map: squares around the centre go to circles (Shirley, Chiu, *A low distortion map between
/// disk and square*, 1997).
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Inverse, UniformDisk};
/// let x = UniformDisk.sample([0.75, 0.5]);
/// assert_eq!((x, UniformDisk.invert(&x)), ([0.5, 0.0], Some([0.75, 0.5])));
/// assert_eq!(UniformDisk.pdf(&[1.0, 1.0]), 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UniformDisk;

impl UniformDisk {
    /// Radius, with a sign, and angle.
    pub(super) fn polar([u, v]: [f64; 2]) -> (f64, f64) {
        let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        if a.abs() > b.abs() {
            (a, FRAC_PI_4 * (b / a))
        } else if b == 0.0 {
            (0.0, 0.0)
        } else {
            (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
        }
    }
}

impl Distribution for UniformDisk {
    type Unit = [f64; 2];
    type Point = [f64; 2];

    fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        let (r, angle) = UniformDisk::polar(u);
        [r * angle.cos(), r * angle.sin()]
    }

    fn pdf(&self, [x, y]: &[f64; 2]) -> f64 {
        if x * x + y * y <= 1.0 { FRAC_1_PI } else { 0.0 }
    }
}

impl Inverse for UniformDisk {
    fn invert(&self, [x, y]: &[f64; 2]) -> Option<[f64; 2]> {
        let r = x.hypot(*y);
        let (a, b) = if x.abs() > y.abs() {
            (r.copysign(*x), r.copysign(*x) * (y / x).atan() / FRAC_PI_4)
        } else if *y == 0.0 {
            (0.0, 0.0)
        } else {
            (r.copysign(*y) * (x / y).atan() / FRAC_PI_4, r.copysign(*y))
        };
        (r <= 1.0).then_some([0.5 + 0.5 * a, 0.5 + 0.5 * b])
    }
}

/// Uniform on a triangle in space, with respect to its area: x = (1 − √u) A + √u (1 − v) B + √u v C.
///
/// ```
/// use fredholm::sampling::distribution::{Distribution, Inverse, UniformTriangle};
/// let t = UniformTriangle::new([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 2.0, 1.0]])?;
/// let x = t.sample([0.25, 0.5]);
/// assert_eq!((x, t.pdf(&x), t.invert(&x)), ([0.5, 0.5, 1.0], 0.5, Some([0.25, 0.5])));
/// assert_eq!(t.pdf(&[2.0, 2.0, 1.0]), 0.0);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformTriangle {
    corner: [f64; 3],
    sides: [[f64; 3]; 2],
    normal: [f64; 3],
    area: f64,
}

impl UniformTriangle {
    /// The triangle with these corners.
    ///
    /// # Errors
    /// [`Error::Invalid`] for coordinates that are not finite, and an area that is 0 or not finite.
    pub fn new([a, b, c]: [[f64; 3]; 3]) -> Result<Self, Error> {
        if let Some(x) = [a, b, c].concat().iter().find(|x| !x.is_finite()) {
            return Err(Error::invalid("coordinate of a corner", *x, "must be finite"));
        }
        let sides = [b, c].map(|p| std::array::from_fn(|i| p[i] - a[i]));
        let normal = cross(sides[0], sides[1]);
        let area = 0.5 * dot(normal, normal).sqrt();
        if !(area > 0.0 && area.is_finite()) {
            return Err(Error::invalid("area", area, "must be positive and finite"));
        }
        Ok(UniformTriangle { corner: a, sides, normal, area })
    }

    /// Its area.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Shares of B and C in a point of the plane; `None` outside, up to rounding.
    fn shares(&self, x: &[f64; 3]) -> Option<[f64; 2]> {
        const ROUNDING: f64 = 1e-9;
        let from: [f64; 3] = std::array::from_fn(|i| x[i] - self.corner[i]);
        let square = dot(self.normal, self.normal);
        let b = dot(cross(from, self.sides[1]), self.normal) / square;
        let c = dot(cross(self.sides[0], from), self.normal) / square;
        (b >= -ROUNDING && c >= -ROUNDING && b + c <= 1.0 + ROUNDING).then_some([b, c])
    }
}

impl Distribution for UniformTriangle {
    type Unit = [f64; 2];
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (b, c) = (u.sqrt() * (1.0 - v), u.sqrt() * v);
        std::array::from_fn(|i| self.corner[i] + b * self.sides[0][i] + c * self.sides[1][i])
    }

    /// 1/area for points of the triangle; x is taken to lie in its plane.
    fn pdf(&self, x: &[f64; 3]) -> f64 {
        self.shares(x).map_or(0.0, |_| 1.0 / self.area)
    }
}

impl Inverse for UniformTriangle {
    fn invert(&self, x: &[f64; 3]) -> Option<[f64; 2]> {
        let [b, c] = self.shares(x)?;
        let root = b + c;
        // all v go to the corner A
        Some([(root * root).clamp(0.0, 1.0), if root > 0.0 { (c / root).clamp(0.0, 1.0) } else { 0.5 }])
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
