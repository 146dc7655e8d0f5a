//! Vectors, and the coordinates in which a surface scatters.

use nalgebra::Vector3;

/// A vector, a point or a direction of space.
pub(crate) type Vec3 = Vector3<f64>;

/// Right-handed orthonormal axes with n for z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    x: Vec3,
    y: Vec3,
    n: Vec3,
}

impl Frame {
    /// Around a unit vector, without a branch: Duff et al., *Building an orthonormal basis, revisited*, JCGT 6 (2017) 1.
    #[inline]
    pub(crate) fn around(n: Vec3) -> Self {
        let sign = 1f64.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Frame { x: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), y: Vec3::new(b, sign + n.y * n.y * a, -n.y), n }
    }

    #[inline]
    pub(crate) fn to_local(self, v: &Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.n.dot(v))
    }

    #[inline]
    pub(crate) fn to_world(self, v: &Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::{Frame, Vec3};

    #[test]
    fn axes_are_orthonormal() {
        for n in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [1.0, 0.0, 0.0], [0.48, -0.6, 0.64], [1e-9, 0.0, -1.0]] {
            let f = Frame::around(Vec3::from(n));
            assert!((f.x.cross(&f.y) - f.n).norm() < 1e-15 && f.x.dot(&f.y).abs() < 1e-15);
            let v = Vec3::new(0.1, -0.2, 0.3);
            assert!((f.to_world(&f.to_local(&v)) - v).norm() < 1e-15);
        }
    }
}
