//! What a ray meets: meshes and spheres.
//!
//! ```
//! use fredholm::scene::geometry::{Geometry, Mesh, Ray, Sphere};
//! let floor = Mesh::new(vec![[-9.0, 0.0, -9.0], [-9.0, 0.0, 9.0], [9.0, 0.0, 0.0]], vec![[0, 1, 2]])?;
//! let geometry = Geometry::new(vec![floor.into(), Sphere::new([0.0, 3.0, 0.0], 1.0)?.into()])?;
//! // from above, the sphere is first
//! let ray = Ray::new([0.0, 9.0, 0.0], [0.0, -1.0, 0.0]);
//! let hit = geometry.closest(&ray).expect("the sphere");
//! let point = geometry.surface(&ray, &hit);
//! assert_eq!((geometry.shape_of(hit.primitive), point.position), (1, [0.0, 4.0, 0.0]));
//! // it is between the floor and the sky
//! let shaded = geometry.surface_at(0, 0.5, 0.3);
//! assert!(!geometry.occluded(&shaded.spawn([0.0, 1.0, 0.0])));
//! assert!(geometry.occluded(&geometry.surface_at(0, 0.25, 0.5).spawn([0.0, 1.0, 0.0])));
//! # Ok::<(), fredholm::Error>(())
//! ```

mod ray;
mod shape;
mod sphere;
mod surface;
mod triangle;

use crate::error::Error;
use crate::scene::vector;
pub use ray::{Hit, Ray};
pub use shape::{Mesh, Shape, Sphere};
pub use surface::Surface;

/// Shapes, ready to be hit.
///
/// Primitives are numbered through: the triangles of the first mesh, of the second, …; a sphere is one. Of two primitives hit at the same t the
/// one with the lower number counts, so that answers do not depend on how they are found.
#[derive(Clone, Debug)]
pub struct Geometry {
    shapes: Vec<Shape>,
    /// number of each shape's first primitive
    first: Vec<u32>,
    primitives: u32,
    degenerate: usize,
}

impl Geometry {
    /// All shapes, in order.
    ///
    /// # Errors
    ///
    /// [`Error::TooManyPrimitives`] beyond 2³² − 2.
    pub fn new(shapes: Vec<Shape>) -> Result<Self, Error> {
        let (mut first, mut total) = (Vec::with_capacity(shapes.len()), 0_usize);
        for shape in &shapes {
            first.push(u32::try_from(total).unwrap_or(u32::MAX));
            total += shape.primitives();
        }
        let primitives = u32::try_from(total).ok().filter(|&n| n < u32::MAX).ok_or(Error::TooManyPrimitives { primitives: total })?;
        let degenerate = shapes.iter().map(Shape::degenerate).sum();
        Ok(Geometry { shapes, first, primitives, degenerate })
    }

    /// The shapes, in order.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// How many primitives there are.
    pub fn primitives(&self) -> u32 {
        self.primitives
    }

    /// Triangles without area: no ray hits them.
    pub fn degenerate(&self) -> usize {
        self.degenerate
    }

    /// Index of the shape that a primitive belongs to.
    #[inline]
    pub fn shape_of(&self, primitive: u32) -> usize {
        self.first.partition_point(|&f| f <= primitive) - 1
    }

    /// Number of a shape's first primitive.
    #[inline]
    pub fn first_of(&self, shape: usize) -> u32 {
        self.first[shape]
    }

    /// What the ray meets first, if anything.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.each_hit(ray, |hit| {
            if best.is_none_or(|b| (hit.t, hit.primitive) < (b.t, b.primitive)) {
                best = Some(hit);
            }
        });
        best
    }

    /// Whether the ray meets anything.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.closest(ray).is_some()
    }

    fn each_hit(&self, ray: &Ray, mut f: impl FnMut(Hit)) {
        let frame = triangle::Frame::new(ray);
        for (shape, &first) in self.shapes.iter().zip(&self.first) {
            match shape {
                Shape::Mesh(mesh) => {
                    for k in 0..mesh.triangles().len() {
                        if let Some((t, u, v)) = frame.hit(&mesh.corners(k)).filter(|h| h.0 < ray.until) {
                            f(Hit { primitive: first + k as u32, t, u, v });
                        }
                    }
                }
                Shape::Sphere(sphere) => {
                    if let Some(t) = sphere.hit(ray) {
                        f(Hit { primitive: first, t, u: 0.0, v: 0.0 });
                    }
                }
            }
        }
    }

    /// The point where the ray hit.
    #[must_use]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        match &self.shapes[self.shape_of(hit.primitive)] {
            Shape::Mesh(_) => self.surface_at(hit.primitive, hit.u, hit.v),
            Shape::Sphere(sphere) => sphere.surface(vector::sub(ray.at(hit.t), sphere.centre()), hit.primitive),
        }
    }

    /// The point of a triangle at (1 − u − v)a + u b + v c, or of a sphere at longitude 2πu and height r(1 − 2v): uniform on the unit square
    /// is uniform on the sphere.
    ///
    /// # Panics
    ///
    /// If there is no such primitive.
    #[must_use]
    pub fn surface_at(&self, primitive: u32, u: f64, v: f64) -> Surface {
        let shape = self.shape_of(primitive);
        match &self.shapes[shape] {
            Shape::Mesh(mesh) => mesh.surface((primitive - self.first[shape]) as usize, u, v, primitive),
            Shape::Sphere(sphere) => sphere.surface(sphere::direction(u, v), primitive),
        }
    }
}
