//! A closed mesh keeps every ray, wherever it is aimed.

use crate::random::{Random, along, icosphere, mesh, minus, places};
use fredholm::scene::geometry::Ray;

#[test]
fn no_ray_leaves_a_closed_mesh() {
    for (size, centre) in places() {
        let mut random = Random::new(5);
        let (vertices, triangles) = icosphere(3, size, centre);
        let geometry = mesh(vertices.clone(), triangles.clone());
        for k in 0..30_000 {
            let origin = along(centre, 0.3 * size, random.cube());
            let [a, b, _] = triangles[random.index(triangles.len())].map(|i| vertices[i as usize]);
            let target = match k % 3 {
                0 => a,
                1 => along(a, random.unit(), minus(b, a)),
                _ => along(origin, size, random.direction()),
            };
            let ray = Ray::new(origin, minus(target, origin));
            let hit = geometry.closest(&ray).unwrap_or_else(|| panic!("size {size} at {centre:?}: {ray:?} leaks"));
            assert!(geometry.occluded(&ray) && hit.t > 0.5);
        }
    }
}
