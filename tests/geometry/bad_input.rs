//! Every input has an answer or an error with its name.

use crate::random::{icosphere, mesh};
use fredholm::Error;
use fredholm::scene::geometry::{Geometry, Mesh, Ray, Sphere};

#[test]
fn vertices_and_indices() {
    for x in [f64::NAN, f64::INFINITY, -1e76] {
        let error = Mesh::new(vec![[0.0; 3], [0.0, x, 0.0]], vec![]).expect_err("not finite");
        assert!(matches!(error, Error::Vertex { vertex: 1, .. }) && error.to_string().contains("vertex 1"), "{error}");
    }
    let error = Mesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2], [0, 3, 1]]).expect_err("out of range");
    assert_eq!(error, Error::VertexIndex { triangle: 1, index: 3, vertices: 3 });
}

#[test]
fn spheres() {
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-80] {
        let error = Sphere::new([0.0; 3], radius).expect_err("no radius");
        assert!(matches!(error, Error::Invalid { parameter: "sphere radius", .. }), "{error}");
    }
    assert!(matches!(Sphere::new([0.0, f64::NAN, 0.0], 1.0), Err(Error::Invalid { parameter: "sphere centre", .. })));
}

#[test]
fn nothing_at_all() {
    let ray = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
    for geometry in [Geometry::new(vec![]).expect("empty"), mesh(vec![], vec![])] {
        assert_eq!((geometry.primitives(), geometry.closest(&ray), geometry.occluded(&ray)), (0, None, false));
    }
}

#[test]
fn rays_that_are_none() {
    let (vertices, triangles) = icosphere(2, 1.0, [0.0; 3]);
    let shapes = vec![Mesh::new(vertices, triangles).expect("a mesh").into(), Sphere::new([0.0; 3], 0.5).expect("a sphere").into()];
    let geometry = Geometry::new(shapes).expect("a geometry");
    for (origin, direction) in [([0.0; 3], [0.0; 3]), ([0.0; 3], [f64::NAN, 1.0, 0.0]), ([f64::NAN; 3], [0.0, 0.0, 1.0])] {
        let ray = Ray::new(origin, direction);
        assert_eq!((geometry.closest(&ray), geometry.occluded(&ray)), (None, false));
    }
    assert_eq!(geometry.closest(&Ray::new([0.0; 3], [1.0, 0.0, 0.0]).until(f64::NAN)), None);
}

#[test]
fn triangles_without_area_are_counted_and_not_hit() {
    let (a, b, c) = ([0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]);
    let flat = [[0, 0, 1], [0, 1, 2], [2, 2, 2], [1, 0, 2]];
    let geometry = mesh(vec![a, b, c], flat.repeat(50));
    assert_eq!((geometry.degenerate(), geometry.primitives()), (200, 200));
    for x in [0.0, 0.25, 0.5, 1.0] {
        assert_eq!(geometry.closest(&Ray::new([x, 1.0, 0.0], [0.0, -1.0, 0.0])), None);
        assert_eq!(geometry.closest(&Ray::new([x, -1.0, 1.0], [0.0, 1.0, -1.0])), None);
    }
    assert_eq!(geometry.surface_at(0, 0.5, 0.0).normal, [0.0; 3]);
}

#[test]
fn absurd_sizes() {
    for size in [1e-70, 1e-30, 1e30, 1e70] {
        let row: Vec<[f64; 3]> =
            (0..60).flat_map(|i| [[0.0, 0.0], [0.9, 0.0], [0.0, 1.0]].map(|[x, y]| [size * (f64::from(i) + x), size * y, 0.0])).collect();
        let geometry = mesh(row, (0..60).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
        for i in 0..60 {
            let ray = Ray::new([size * (f64::from(i) + 0.2), size * 0.3, size], [0.0, 0.0, -1.0]);
            let hit = geometry.closest(&ray).expect("a hit");
            assert!(hit.primitive == i && (hit.t / size - 1.0).abs() < 1e-12, "{size} {hit:?}");
            assert!(!geometry.occluded(&ray.until(0.99 * size)) && geometry.occluded(&ray.until(1.01 * size)));
            // from far away, in small steps
            let far = Ray::new([size * (f64::from(i) + 0.2), size * 0.3, 1e5 * size], [0.0, 0.0, -1e-10 * size]);
            assert_eq!(geometry.closest(&far).map(|h| h.primitive), Some(i), "{size}");
        }
    }
}
