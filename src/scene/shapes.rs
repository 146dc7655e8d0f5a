//! Meshes of simple things.

use super::geometry::Mesh;
use crate::error::Error;

/// A parallelogram with corners a, a + u, a + u + v, a + v; its front sees them counterclockwise.
///
/// # Errors
/// Those of [`Mesh::new`].
pub fn parallelogram(a: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Result<Mesh, Error> {
    let at = |s: f64, t: f64| std::array::from_fn(|i| a[i] + s * u[i] + t * v[i]);
    quad([at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)])
}

/// A quadrilateral; its front sees the corners counterclockwise.
///
/// # Errors
/// Those of [`Mesh::new`].
pub fn quad(corners: [[f64; 3]; 4]) -> Result<Mesh, Error> {
    Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// The box between two corners, fronts outside.
///
/// # Errors
/// Those of [`Mesh::new`].
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Result<Mesh, Error> {
    let corner = |i: u32| std::array::from_fn(|k| if i >> k & 1 == 0 { low[k] } else { high[k] });
    const SIDES: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh::new((0..8).map(corner).collect(), SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// The box between two corners, fronts inside.
///
/// # Errors
/// Those of [`Mesh::new`].
pub fn room(low: [f64; 3], high: [f64; 3]) -> Result<Mesh, Error> {
    let outside = cuboid(low, high)?;
    Mesh::new(outside.vertices().to_vec(), outside.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect())
}
