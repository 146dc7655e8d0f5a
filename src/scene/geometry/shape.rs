//! What geometry is made of: triangle meshes and spheres.

use super::Surface;
use super::triangle::UNIT;
use crate::error::Error;
use crate::scene::vector::{cross, sub, unit};

/// Coordinates beyond this are refused: products of three of them must stay in the range of numbers.
pub(super) const LARGEST: f64 = 1e75;

/// Triangles with shared vertices. The front of a triangle sees its vertices counterclockwise.
///
/// ```
/// use fredholm::scene::geometry::Mesh;
/// let square = Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2], [0, 2, 3]])?;
/// assert_eq!(square.normal(0), Some([0.0, 0.0, 1.0]));
/// assert_eq!(square.area(1), 0.5);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Each triangle names its vertices by their index.
    ///
    /// # Errors
    ///
    /// [`Error::Vertex`] for a vertex that is not finite or beyond 10⁷⁵, [`Error::VertexIndex`] for an index out of range. Triangles without
    /// area are allowed, never hit, and counted by [`Geometry::degenerate`](super::Geometry::degenerate).
    pub fn new(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        if let Some((vertex, &at)) = vertices.iter().enumerate().find(|(_, v)| !v.iter().all(|x| x.abs() <= LARGEST)) {
            return Err(Error::Vertex { vertex, at });
        }
        let outside = |t: &[u32; 3]| t.iter().copied().find(|&i| i as usize >= vertices.len());
        if let Some((triangle, index)) = triangles.iter().enumerate().find_map(|(k, t)| outside(t).map(|i| (k, i))) {
            return Err(Error::VertexIndex { triangle, index, vertices: vertices.len() });
        }
        Ok(Mesh { vertices, triangles })
    }

    /// The vertices.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// The triangles, as indices of vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.triangles[triangle].map(|i| self.vertices[i as usize])
    }

    /// Unit normal on the front side; `None` if the triangle has no area.
    #[inline]
    pub fn normal(&self, triangle: usize) -> Option<[f64; 3]> {
        normal(&self.corners(triangle))
    }

    /// The point (1 − u − v)a + u b + v c of a triangle.
    pub(super) fn surface(&self, triangle: usize, u: f64, v: f64, primitive: u32) -> Surface {
        let corners = self.corners(triangle);
        let [a, b, c] = corners;
        let w = 1.0 - u - v;
        Surface {
            position: std::array::from_fn(|i| w * a[i] + u * b[i] + v * c[i]),
            // three products and two sums; and w itself is rounded
            error: std::array::from_fn(|i| UNIT * (6.0 * ((w * a[i]).abs() + (u * b[i]).abs() + (v * c[i]).abs()) + 3.0 * a[i].abs())),
            normal: normal(&corners).unwrap_or([0.0; 3]),
            primitive,
            u,
            v,
        }
    }

    /// Area of a triangle.
    pub fn area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * crate::scene::vector::length(cross(sub(b, a), sub(c, a)))
    }
}

/// (b − a) × (c − a), of length 1.
#[inline]
pub(super) fn normal(&[a, b, c]: &[[f64; 3]; 3]) -> Option<[f64; 3]> {
    let n = unit(cross(sub(b, a), sub(c, a)));
    n.iter().all(|x| x.is_finite()).then_some(n)
}

/// A sphere; its front is outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    centre: [f64; 3],
    radius: f64,
}

impl Sphere {
    /// All points at `radius` from `centre`.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the radius is not positive or a number is not finite or beyond 10⁷⁵.
    pub fn new(centre: [f64; 3], radius: f64) -> Result<Self, Error> {
        if let Some(&c) = centre.iter().find(|c| !(c.abs() <= LARGEST)) {
            return Err(Error::invalid("sphere centre", c, "must be finite and within ±1e75"));
        }
        if !(1.0 / LARGEST..=LARGEST).contains(&radius) {
            return Err(Error::invalid("sphere radius", radius, "must be between 1e-75 and 1e75"));
        }
        Ok(Sphere { centre, radius })
    }

    /// The centre.
    pub fn centre(&self) -> [f64; 3] {
        self.centre
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

/// A mesh or a sphere.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// As many primitives as triangles.
    Mesh(Mesh),
    /// One primitive.
    Sphere(Sphere),
}

impl From<Mesh> for Shape {
    fn from(mesh: Mesh) -> Self {
        Shape::Mesh(mesh)
    }
}

impl From<Sphere> for Shape {
    fn from(sphere: Sphere) -> Self {
        Shape::Sphere(sphere)
    }
}

impl Shape {
    /// How many primitives it is made of.
    pub fn primitives(&self) -> usize {
        match self {
            Shape::Mesh(mesh) => mesh.triangles.len(),
            Shape::Sphere(_) => 1,
        }
    }
}
