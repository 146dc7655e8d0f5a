//! Random scenes and rays from one stream, and a closed mesh.

use fredholm::sampling::{Pcg, Sampler, Sequence};
use fredholm::scene::geometry::{Geometry, Mesh};

/// A stream of random numbers.
pub(crate) struct Random(<Pcg as Sequence>::Sampler);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Random(Pcg::new(seed).point(0, 0, 0))
    }

    /// In (0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.next_1d()
    }

    pub(crate) fn index(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// In the cube (−1, 1)³.
    pub(crate) fn cube(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| 2.0 * self.unit() - 1.0)
    }

    /// A unit vector.
    pub(crate) fn direction(&mut self) -> [f64; 3] {
        loop {
            let d = self.cube();
            let r2 = dot(d, d);
            if r2 > 0.01 && r2 < 1.0 {
                return d.map(|x| x / r2.sqrt());
            }
        }
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// a + s·b.
pub(crate) fn along(a: [f64; 3], s: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + s * b[i])
}

/// A sphere of radius `size` around `centre`, of 20·4ⁿ triangles that share their vertices; seen from outside its front is seen.
pub(crate) fn icosphere(splits: usize, size: f64, centre: [f64; 3]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        vertices.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
    }
    let mut triangles = convex_hull(&vertices);
    for _ in 0..splits {
        let mut middles = std::collections::HashMap::new();
        let old = std::mem::take(&mut triangles);
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push(along(vertices[a as usize], 1.0, vertices[b as usize]));
                vertices.len() as u32 - 1
            })
        };
        for [a, b, c] in old {
            let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
            triangles.extend([[a, x, z], [b, y, x], [c, z, y], [x, y, z]]);
        }
        vertices.iter_mut().for_each(|v| *v = v.map(|x| x / dot(*v, *v).sqrt()));
    }
    let vertices = vertices.iter().map(|v| along(centre, size / dot(*v, *v).sqrt(), *v)).collect();
    (vertices, triangles)
}

/// The faces of an icosahedron: all triples at the smallest distance, turned outward.
fn convex_hull(vertices: &[[f64; 3]]) -> Vec<[u32; 3]> {
    let near = |a: usize, b: usize| {
        let d = minus(vertices[a], vertices[b]);
        (dot(d, d) - 4.0).abs() < 1e-9
    };
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let [p, q, r] = [a, b, c].map(|i| vertices[i]);
                    let (u, v) = (minus(q, p), minus(r, p));
                    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                    faces.push(if dot(n, p) > 0.0 { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
    }
    faces
}

pub(crate) fn mesh(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Geometry {
    Geometry::new(vec![Mesh::new(vertices, triangles).expect("a mesh").into()]).expect("a geometry")
}

/// Scales from 1e-4 to 1e6, and places: at the origin and far from it.
pub(crate) fn places() -> Vec<(f64, [f64; 3])> {
    let mut places: Vec<_> = [1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6].map(|size| (size, [0.0; 3])).into();
    places.extend([(1.0, [1e6, -3e5, 7.0]), (1e-4, [0.1, 100.0, -0.3]), (0.3, [1.0 / 3.0, 0.7, -0.9])]);
    places
}
