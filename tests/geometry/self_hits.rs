//! Rays that leave a surface do not meet it again; segments between surface points touch neither end.

use crate::random::{Random, dot, icosphere, mesh, minus, places};
use fredholm::scene::geometry::{Geometry, Sphere, Surface};

/// A random point of a random primitive, now and then at a corner or an edge.
fn point(geometry: &Geometry, random: &mut Random) -> Surface {
    let primitive = random.index(geometry.primitives() as usize) as u32;
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    match random.index(20) {
        0 => geometry.surface_at(primitive, u, 0.0),
        1 => geometry.surface_at(primitive, 0.0, 0.0),
        _ => geometry.surface_at(primitive, u, v),
    }
}

/// Outside of a convex surface nothing is met, inside always something else.
fn convex(geometry: &Geometry, size: f64, rays: usize) {
    let mut random = Random::new(9);
    for _ in 0..rays {
        let (from, to) = (point(geometry, &mut random), point(geometry, &mut random));
        let d = random.direction();
        let out = if dot(d, from.normal) > 0.0 { d } else { d.map(|x| -x) };
        assert_eq!(geometry.closest(&from.spawn(out)), None, "{from:?} meets itself towards {out:?}");
        let inward = from.spawn(out.map(|x| -x));
        // at an edge, below one triangle may be above the next
        if from.u * from.v == 0.0 && dot(out, from.normal) < 0.5 {
            continue;
        }
        let hit = geometry.closest(&inward).unwrap_or_else(|| panic!("{from:?} leaks: {inward:?}"));
        // a sphere is left at the far end of the chord
        let chord = dot(minus(inward.at(hit.t), from.position), from.normal);
        assert!(hit.primitive != from.primitive || -chord > 1e-9 * size, "{from:?} meets itself: {hit:?}");
        // not in the plane of either end
        let (there, back) = (minus(to.position, from.position), minus(from.position, to.position));
        if dot(there, from.normal) < -1e-6 * size && dot(back, to.normal) < -1e-6 * size {
            assert!(!geometry.occluded(&from.segment_to(&to)), "something between {from:?} and {to:?}");
        }
    }
}

#[test]
fn triangles() {
    for (size, centre) in places() {
        let (vertices, triangles) = icosphere(2, size, centre);
        convex(&mesh(vertices, triangles), size, 110_000);
    }
}

#[test]
fn spheres() {
    for (size, centre) in places() {
        convex(&Geometry::new(vec![Sphere::new(centre, size).expect("a sphere").into()]).expect("a geometry"), size, 30_000);
    }
}

#[test]
fn points_are_within_their_error() {
    // far away a plane: the position is rounded, the distance from the plane is within the bound
    let geometry = mesh(vec![[0.0, 0.1, 1e6], [3e6, 0.1, 0.0], [0.0, 0.1, -1e6]], vec![[0, 1, 2]]);
    let mut random = Random::new(2);
    for _ in 0..1000 {
        let p = point(&geometry, &mut random);
        assert!((p.position[1] - 0.1).abs() <= p.error[1] && p.error[1] < 1e-15 && p.normal == [0.0, 1.0, 0.0], "{p:?}");
        let (above, below) = (p.offset([0.0, 1.0, 0.0]), p.offset([0.0, -1.0, 0.0]));
        assert!(above[1] > 0.1 && below[1] < 0.1 && above[1] - below[1] < 1e-8);
    }
}
