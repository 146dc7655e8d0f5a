//! Points on surfaces, with their rounding errors, and rays that leave them.

use super::Ray;
use crate::scene::vector::{dot, scale, sub};

/// A point on a surface, known up to `error`.
///
/// Rays that leave it start where no rounding can put them back on the surface: shifted along the normal by a few units in the last place of
/// the coordinates, and by no fixed epsilon. The shift is the sum of the errors, which is more than their projection |n|·error on any normal:
/// near an edge it clears the neighbouring triangle too.
/// After Pharr, Jakob & Humphreys (2023), Physically Based Rendering, 4th edition, §6.8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Where it is.
    pub position: [f64; 3],
    /// Bound of each coordinate's distance from the true surface.
    pub error: [f64; 3],
    /// Unit normal on the front side.
    pub normal: [f64; 3],
    /// The primitive.
    pub primitive: u32,
    /// As in [`Hit`](super::Hit).
    pub u: f64,
    /// As in [`Hit`](super::Hit).
    pub v: f64,
}

impl Surface {
    /// A point beside the surface, certainly on the side that `towards` points to.
    #[inline]
    #[must_use]
    pub fn offset(&self, towards: [f64; 3]) -> [f64; 3] {
        let n = self.normal;
        let distance = self.error[0] + self.error[1] + self.error[2];
        let shift = scale(distance.copysign(dot(n, towards)), n);
        std::array::from_fn(|i| {
            // the sum is rounded: one number further away
            let p = self.position[i] + shift[i];
            if shift[i] > 0.0 {
                p.next_up()
            } else if shift[i] < 0.0 {
                p.next_down()
            } else {
                p
            }
        })
    }

    /// The ray that leaves in a direction.
    #[inline]
    #[must_use]
    pub fn spawn(&self, direction: [f64; 3]) -> Ray {
        Ray::new(self.offset(direction), direction)
    }

    /// The segment to a point in the open, 0 < t < 1.
    #[inline]
    #[must_use]
    pub fn segment_to_point(&self, point: [f64; 3]) -> Ray {
        let origin = self.offset(sub(point, self.position));
        Ray::new(origin, sub(point, origin)).until(1.0)
    }

    /// The segment to another surface point, 0 < t < 1: it touches neither surface.
    #[inline]
    #[must_use]
    pub fn segment_to(&self, other: &Surface) -> Ray {
        let direction = sub(other.position, self.position);
        let (origin, end) = (self.offset(direction), other.offset(scale(-1.0, direction)));
        Ray::new(origin, sub(end, origin)).until(1.0)
    }
}
