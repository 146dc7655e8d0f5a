//! Rays a second against a landscape of 180 000 triangles, and the time to build its tree.
//!
//! `cargo bench --bench bvh`: the baseline is the crate `obvhs`, in single precision and not watertight. `examples/peers rays` asks the same rays as other programs do.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fredholm::sampling::{Pcg, Sampler, Sequence};
use fredholm::scene::geometry::{Geometry, Mesh, Ray};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::{ray::RayHit, rt_triangle::RtTriangle, triangle::Triangle};
use std::hint::black_box;
use std::time::Duration;

const CELLS: u32 = 300;
const RAYS: usize = 1 << 14;

/// Hills over the unit square.
fn hills() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let across = CELLS + 1;
    let at = |k: u32| f64::from(k) / f64::from(CELLS);
    let height = |x: f64, y: f64| 0.05 * ((9.0 * x).sin() * (7.0 * y).cos() + 0.1 * (90.0 * x).sin() * (80.0 * y).sin());
    let vertices = (0..across * across).map(|i| (at(i % across), at(i / across))).map(|(x, y)| [x, y, height(x, y)]).collect();
    let cell = |i: u32| i % CELLS + across * (i / CELLS);
    let halves = |k: u32| [[k, k + 1, k + across], [k + 1, k + across + 1, k + across]];
    (vertices, (0..CELLS * CELLS).flat_map(|i| halves(cell(i))).collect())
}

fn geometry() -> Geometry {
    let (vertices, triangles) = hills();
    Geometry::new(vec![Mesh::new(vertices, triangles).expect("a mesh").into()]).expect("a geometry")
}

/// From random points above the hills, in random directions.
fn rays() -> Vec<Ray> {
    let mut u = Pcg::new(1).point(0, 0, 0);
    let mut cube = || -> [f64; 3] { std::array::from_fn(|_| u.next_1d()) };
    (0..RAYS).map(|_| (cube(), cube())).map(|(p, d)| Ray::new([p[0], p[1], 0.1 * p[2]], d.map(|x| x - 0.5))).collect()
}

fn single(p: [f64; 3]) -> [f32; 3] {
    p.map(|x| x as f32)
}

fn baseline() -> (Bvh2, Vec<RtTriangle>) {
    let (vertices, triangles) = hills();
    let corner = |i: u32| single(vertices[i as usize]).into();
    let triangles: Vec<Triangle> = triangles.iter().map(|&[a, b, c]| Triangle { v0: corner(a), v1: corner(b), v2: corner(c) }).collect();
    let tree = build_bvh2_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
    let ordered = tree.primitive_indices.iter().map(|&i| RtTriangle::from(&triangles[i as usize])).collect();
    (tree, ordered)
}

fn bvh(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10).throughput(Throughput::Elements(u64::from(2 * CELLS * CELLS)));
    group.bench_function("obvhs, medium", |b| b.iter(baseline));
    group.bench_function("geometry", |b| b.iter(geometry));
    group.finish();

    let (geometry, rays, (tree, triangles)) = (geometry(), rays(), baseline());
    let theirs: Vec<obvhs::ray::Ray> =
        rays.iter().map(|r| obvhs::ray::Ray::new_inf(single(r.origin).into(), single(r.direction).into())).collect();
    let mut group = c.benchmark_group("rays");
    group.throughput(Throughput::Elements(RAYS as u64));
    let first = |ray: &obvhs::ray::Ray| tree.ray_traverse(*ray, &mut RayHit::none(), |ray, i| triangles[i].intersect(ray));
    group.bench_function("obvhs, first hit", |b| b.iter(|| black_box(&theirs).iter().filter(|r| first(r)).count()));
    group.bench_function("first hit", |b| b.iter(|| black_box(&rays).iter().filter_map(|r| geometry.closest(r)).count()));
    let any = |ray: &obvhs::ray::Ray| !tree.ray_traverse_miss(*ray, |ray, i| triangles[i].intersect(ray));
    group.bench_function("obvhs, any hit", |b| b.iter(|| black_box(&theirs).iter().filter(|r| any(r)).count()));
    group.bench_function("any hit", |b| b.iter(|| black_box(&rays).iter().filter(|r| geometry.occluded(r)).count()));
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    targets = bvh
}
criterion_main!(benches);
