//! Rays and what they meet.

/// The points origin + t·direction, 0 < t < until.
///
/// The direction may have any length from 10⁻⁷⁵ to 10⁷⁵, and t counts in it: a shadow segment is a ray with `until = 1`. A ray with NaN in it,
/// or without direction, meets nothing.
///
/// ```
/// use fredholm::scene::geometry::Ray;
/// let ray = Ray::new([0.0, 0.0, 1.0], [0.0, 0.0, -2.0]);
/// assert_eq!(ray.at(0.5), [0.0; 3]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes, in units of t.
    pub direction: [f64; 3],
    /// Where it ends; infinite for a ray proper.
    pub until: f64,
}

impl Ray {
    /// A ray without end.
    #[inline]
    #[must_use]
    pub fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        Ray { origin, direction, until: f64::INFINITY }
    }

    /// The part before t = `until`.
    #[inline]
    #[must_use]
    pub fn until(self, until: f64) -> Self {
        Ray { until, ..self }
    }

    /// The point at t.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|i| self.origin[i] + t * self.direction[i])
    }
}

/// The first primitive on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Its number in the geometry.
    pub primitive: u32,
    /// Where on the ray.
    pub t: f64,
    /// Weight of a triangle's second vertex: the point is (1 − u − v)a + u b + v c. 0 on a sphere.
    pub u: f64,
    /// Weight of a triangle's third vertex. 0 on a sphere.
    pub v: f64,
}
