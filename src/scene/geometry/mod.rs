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

mod binary;
mod build;
mod lanes;
mod leaves;
mod ray;
mod shape;
mod sphere;
mod surface;
mod tree;
mod triangle;

use crate::error::Error;
use crate::parallel;
use crate::scene::vector;
use fearless_simd::Simd;
use lanes::{Machine, Task};
use leaves::{Forest, Leaf, Nearest, Spheres, Triangles};
pub use ray::{Hit, Ray};
pub use shape::{Mesh, Shape, Sphere};
pub use surface::Surface;
use triangle::Frame;

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
    triangles: Kept,
    spheres: Forest<Spheres>,
    machine: Machine,
}

/// Triangles in the precision that their corners need.
#[derive(Clone, Debug)]
enum Kept {
    Single(Forest<Triangles<f32>>),
    Double(Forest<Triangles<f64>>),
}

impl Geometry {
    /// All shapes, in order.
    ///
    /// # Errors
    ///
    /// [`Error::TooManyPrimitives`] beyond 2²⁹.
    pub fn new(shapes: Vec<Shape>) -> Result<Self, Error> {
        let (mut first, mut total) = (Vec::with_capacity(shapes.len()), 0_usize);
        for shape in &shapes {
            first.push(u32::try_from(total).unwrap_or(u32::MAX));
            total += shape.primitives();
        }
        let primitives = u32::try_from(total).ok().filter(|_| total <= Leaf::END).ok_or(Error::TooManyPrimitives { primitives: total })?;
        let ((triangles, degenerate), spheres) = (kept(&shapes, &first), spheres(&shapes, &first));
        Ok(Geometry { shapes, first, primitives, degenerate, triangles, spheres, machine: Machine::detect() })
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
    #[inline]
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.machine.run(First { geometry: self, ray })
    }

    /// Whether the ray meets anything.
    #[inline]
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.machine.run(Anything { geometry: self, ray })
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

/// Primitives that are tried one by one rather than by a tree. Rays a second without one over with one, primary, bounce, shadow, on random triangles and
/// on rectangles: 4 of them 2.5, 2.0, 3.5 and 1.4, 1.3, 1.2; 8 of them 2.3, 2.1, 2.4 and 1.2, 0.8, 1.2; 16 of them 1.4, 0.8, 0.9 and 1.3, 0.8, 0.7.
const PLAIN: usize = 8;

/// Triangles with an area, and how many have none.
fn kept(shapes: &[Shape], first: &[u32]) -> (Kept, usize) {
    let (mut all, mut degenerate) = (Vec::new(), 0);
    for (shape, &first) in shapes.iter().zip(first) {
        if let Shape::Mesh(mesh) = shape {
            let count = mesh.triangles().len();
            let solid = |k: usize| mesh.normal(k).map(|_| (first + k as u32, mesh.corners(k)));
            let before = all.len();
            all.extend(parallel::map_short(count, solid).into_iter().flatten());
            degenerate += count - (all.len() - before);
        }
    }
    let bounds = parallel::map_short(all.len(), |i| build::around(all[i].1.map(|p| [p, p])));
    let of = |i: u32| all[i as usize];
    let single = all.iter().all(|(_, corners)| corners.iter().flatten().all(|&x| f64::from(x as f32) == x));
    let kept = if single {
        Kept::Single(Forest::new(&bounds, PLAIN, |leaves, order| Triangles::new(leaves, order, of)))
    } else {
        Kept::Double(Forest::new(&bounds, PLAIN, |leaves, order| Triangles::new(leaves, order, of)))
    };
    (kept, degenerate)
}

fn spheres(shapes: &[Shape], first: &[u32]) -> Forest<Spheres> {
    let all: Vec<(u32, Sphere)> =
        shapes.iter().zip(first).filter_map(|(shape, &p)| if let Shape::Sphere(s) = shape { Some((p, *s)) } else { None }).collect();
    let bounds: Vec<_> = all.iter().map(|(_, s)| s.bounds()).collect();
    Forest::new(&bounds, PLAIN, |_, order| Spheres(order.iter().map(|&i| all[i as usize]).collect()))
}

struct First<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
}

impl Task for First<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Hit> {
        let (frame, mut nearest) = (Frame::new(self.ray), Nearest { hit: None, until: self.ray.until });
        match &self.geometry.triangles {
            Kept::Single(forest) => forest.nearest(simd, &frame, &mut nearest),
            Kept::Double(forest) => forest.nearest(simd, &frame, &mut nearest),
        }
        if !self.geometry.spheres.is_empty() {
            self.geometry.spheres.nearest(simd, &frame, &mut nearest);
        }
        nearest.hit
    }
}

struct Anything<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
}

impl Task for Anything<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let frame = Frame::new(self.ray);
        let met = match &self.geometry.triangles {
            Kept::Single(forest) => forest.any(simd, &frame, self.ray.until),
            Kept::Double(forest) => forest.any(simd, &frame, self.ray.until),
        };
        met || (!self.geometry.spheres.is_empty() && self.geometry.spheres.any(simd, &frame, self.ray.until))
    }
}
