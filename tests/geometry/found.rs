//! The tree finds what trying every triangle on its own finds, bit for bit; and that is what a plain solution of the linear system finds.

use crate::random::{Random, along, dot, mesh, minus};
use fredholm::scene::geometry::{Geometry, Hit, Mesh, Ray, Sphere};

type Corners = [[f64; 3]; 3];

fn soup(triangles: &[Corners]) -> Geometry {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh(triangles.iter().flatten().copied().collect(), indices)
}

fn around(centre: [f64; 3], size: f64, random: &mut Random) -> Corners {
    std::array::from_fn(|_| along(centre, size, random.cube()))
}

/// A random triangle of one kind, the i-th of its scene.
fn triangle(kind: &str, i: usize, random: &mut Random) -> Corners {
    let centre = random.cube();
    let pile = [[-0.5, 0.1, -0.5], [0.5, 0.2, -0.5], [0.0, 0.0, 0.5]];
    match kind {
        "plain" => around(centre, 0.2, random),
        "tiny" => around(centre, 1e-6, random),
        "huge" => around(centre, if i.is_multiple_of(10) { 1e5 } else { 0.1 }, random),
        "coplanar" => around(centre, 0.3, random).map(|p| [p[0], 0.25, p[2]]),
        "slivers" => {
            let [a, b, _] = around(centre, 0.5, random);
            [a, b, along(a, 1e-9, b)]
        }
        "nested" => around([0.0; 3], 0.5_f64.powi(i as i32), random),
        // copies of one triangle, and among them triangles without area
        "piled" if i.is_multiple_of(5) => [pile[0], pile[0], pile[i % 3]],
        "piled" => pile,
        _ => unreachable!("{kind}"),
    }
}

/// Rays of every sort: random ones, along axes, in planes of axes, aimed at corners and edges, from corners.
fn rays(triangles: &[Corners], count: usize, random: &mut Random) -> Vec<Ray> {
    let axis = |k: usize| std::array::from_fn(|i| if i == k % 3 { if k < 3 { 1.0 } else { -1.0 } } else { 0.0 });
    (0..count)
        .map(|k| {
            let [a, b, _] = triangles[random.index(triangles.len())];
            let origin = random.cube().map(|x| 2.0 * x);
            let middle = along(a, random.unit(), minus(b, a));
            match k % 7 {
                0 => Ray::new(origin, random.direction()),
                1 => Ray::new(origin, axis(random.index(6))),
                2 => Ray::new(along(a, -3.0, axis(k % 6)), axis(k % 6)),
                3 => Ray::new(origin, minus(a, origin)),
                4 => Ray::new(origin, minus(middle, origin)),
                5 => Ray::new(a, random.direction().map(|x| if x.abs() < 0.3 { 0.0 } else { 1e-7 * x })),
                _ => Ray::new(origin, random.direction().map(|x| 1e9 * x)).until(2e-9 * random.unit()),
            }
        })
        .collect()
}

fn first(alone: &[Geometry], ray: &Ray) -> Option<Hit> {
    let hits = alone.iter().enumerate().filter_map(|(i, g)| g.closest(ray).map(|hit| Hit { primitive: i as u32, ..hit }));
    hits.reduce(|a, b| if b.t < a.t { b } else { a })
}

#[test]
fn the_tree_finds_what_trying_everything_finds() {
    for kind in ["plain", "tiny", "huge", "coplanar", "slivers", "nested", "piled"] {
        for (count, size, shift) in [(3, 1.0, 0.0), (40, 1.0, 0.0), (300, 1e-4, 0.0), (300, 1e6, 0.0), (300, 1.0, 3e4), (700, 1e-3, -0.1)] {
            let mut random = Random::new(count as u64);
            let place = |p: [f64; 3]| p.map(|x| size * x + shift);
            let triangles: Vec<Corners> = (0..count).map(|i| triangle(kind, i, &mut random).map(place)).collect();
            let together = soup(&triangles);
            let alone: Vec<Geometry> = triangles.iter().map(|t| soup(&[*t])).collect();
            for ray in rays(&triangles, 400, &mut random) {
                let expected = first(&alone, &ray);
                assert_eq!(together.closest(&ray), expected, "{kind}, {count} triangles × {size} + {shift}, {ray:?}");
                assert_eq!(together.occluded(&ray), expected.is_some(), "{kind}, {count} triangles × {size} + {shift}, {ray:?}");
            }
        }
    }
}

#[test]
fn hits_solve_the_linear_system() {
    let mut random = Random::new(3);
    let mut hits = 0;
    for _ in 0..20_000 {
        let t: Corners = std::array::from_fn(|_| random.cube());
        let ray = Ray::new(random.cube(), random.cube());
        // Cramer's rule for o + t d = a + u (b − a) + v (c − a)
        let (e, f, s) = (minus(t[1], t[0]), minus(t[2], t[0]), minus(ray.origin, t[0]));
        let det = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            dot(a, [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]])
        };
        let d = ray.direction.map(|x| -x);
        let whole = det(d, e, f);
        let (at, u, v) = (det(s, e, f) / whole, det(d, s, f) / whole, det(d, e, s) / whole);
        let inside = [at, u, v, 1.0 - u - v].iter().fold(f64::INFINITY, |m: f64, x| m.min(*x));
        if whole.abs() < 1e-3 || inside.abs() < 1e-9 {
            continue;
        }
        let hit = soup(&[t]).closest(&ray);
        assert_eq!(hit.is_some(), inside > 0.0, "{t:?} {ray:?}");
        if let Some(hit) = hit {
            hits += 1;
            assert!((hit.t - at).abs() < 1e-10 && (hit.u - u).abs() < 1e-10 && (hit.v - v).abs() < 1e-10, "{hit:?} {at} {u} {v}");
        }
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn spheres_among_triangles() {
    let mut random = Random::new(8);
    let spheres: Vec<Sphere> = (0..200).map(|_| Sphere::new(random.cube(), 0.02 + 0.1 * random.unit()).expect("a sphere")).collect();
    let triangle = || Mesh::new(vec![[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.0, 0.1, 0.5]], vec![[0, 1, 2]]).expect("a mesh").into();
    let mut shapes = vec![triangle()];
    shapes.extend(spheres.iter().map(|&s| s.into()));
    let together = Geometry::new(shapes).expect("a geometry");
    let mut alone = vec![Geometry::new(vec![triangle()]).expect("a geometry")];
    alone.extend(spheres.iter().map(|&s| Geometry::new(vec![s.into()]).expect("a geometry")));
    for k in 0..20_000 {
        let origin = random.cube().map(|x| 1.5 * x);
        let ray = Ray::new(origin, random.direction()).until(if k % 2 == 0 { f64::INFINITY } else { random.unit() });
        let (expected, hit) = (first(&alone, &ray), together.closest(&ray));
        assert_eq!(hit, expected);
        assert_eq!(together.occluded(&ray), expected.is_some());
        if let Some((hit, sphere)) = hit.filter(|h| h.primitive > 0).map(|h| (h, spheres[h.primitive as usize - 1])) {
            let point = together.surface(&ray, &hit);
            let out = minus(point.position, sphere.centre());
            assert!(
                (dot(out, out).sqrt() - sphere.radius()).abs() < 1e-15 && dot(minus(point.position, ray.at(hit.t)), [1.0; 3]).abs() < 1e-12
            );
        }
    }
}

#[test]
fn the_tree_is_the_same_for_any_number_of_threads() {
    // more than a task looks at, many of them in one place
    let mut random = Random::new(8);
    let triangles: Vec<Corners> = (0..70_000).map(|i| triangle(if i % 4 == 0 { "piled" } else { "plain" }, i, &mut random)).collect();
    let tree = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        format!("{:?}", pool.install(|| soup(&triangles)))
    };
    assert!(tree(1) == tree(3));
}
