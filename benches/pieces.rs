//! The pieces that have no bench of their own, each beside a loop written by hand or what a library offers.
//!
//! | group | piece | baseline |
//! |---|---|---|
//! | table | a point of a tabulated density | binary search in the cumulative sums |
//! | assembly | matrix and solution by Gauss nodes | the same loop by hand with nalgebra's LU |
//! | singular panels | a logarithmic kernel and the slab's on graded panels | so many bare values of the kernel |
//! | path | one path of the Cornell box, next event and MIS | as many bare rays and shadow rays through the same geometry |
//!
//! `cargo bench --bench pieces`: one thread.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fredholm::deterministic::{Nystrom, quadrature};
use fredholm::kernel::Kernel;
use fredholm::sampling::{Pcg, Sampler, Sequence, Table};
use fredholm::scene::{geometry::Ray, load};
use fredholm::transport::Slab;
use fredholm::walk::Roulette;
use fredholm::{Equation, Walk};
use nalgebra::{DMatrix, DVector};
use std::hint::black_box;
use std::time::Duration;

const DRAWS: u64 = 1 << 14;

fn table(c: &mut Criterion) {
    let mut group = c.benchmark_group("table");
    group.throughput(Throughput::Elements(DRAWS));
    for cells in [64usize, 4096] {
        let weights: Vec<f64> = (0..cells).map(|i| 1.0 + (i as f64 * 0.618).fract()).collect();
        let table = Table::new(&weights).expect("positive weights");
        let total: f64 = weights.iter().sum();
        let sums = weights.iter().scan(0.0, |sum, w| {
            *sum += w / total;
            Some(*sum)
        });
        let cumulative: Vec<f64> = sums.collect();
        let draws = |draw: &dyn Fn(f64) -> f64| {
            let mut u = Pcg::new(black_box(1)).point(0, 0, 0);
            (0..DRAWS).map(|_| draw(u.next_1d())).sum::<f64>()
        };
        group.bench_function(BenchmarkId::new("table", cells), |b| b.iter(|| draws(&|u| table.sample(u).0)));
        group.bench_function(BenchmarkId::new("binary search", cells), |b| {
            b.iter(|| {
                draws(&|u| {
                    let i = cumulative.partition_point(|s| *s <= u).min(cells - 1);
                    let below = if i == 0 { 0.0 } else { cumulative[i - 1] };
                    (i as f64 + (u - below) / (cumulative[i] - below)) / cells as f64
                })
            });
        });
    }
    group.finish();
}

fn assembly(c: &mut Criterion) {
    let mut group = c.benchmark_group("assembly");
    let kernel = |x: f64, y: f64| 0.5 * (x * y).exp();
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, kernel);
    for n in [16usize, 64, 256] {
        group.bench_function(BenchmarkId::new("Nyström", n), |b| b.iter(|| eq.solve(&Nystrom::gauss_legendre(n)).expect("smooth")));
        let rule = quadrature::unit_rule(n);
        group.bench_function(BenchmarkId::new("by hand", n), |b| {
            b.iter(|| {
                let entry = |i: usize, j: usize| f64::from(u8::from(i == j)) - rule[j].weight * kernel(rule[i].point, rule[j].point);
                DMatrix::from_fn(n, n, entry).lu().solve(&DVector::from_element(n, 1.0))
            });
        });
    }
    group.finish();
}

fn singular(c: &mut Criterion) {
    let mut group = c.benchmark_group("singular panels");
    let kernel = |x: f64, y: f64| -0.3 * (x - y).abs().ln();
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, kernel);
    let log = || eq.solve(&Nystrom::graded(2, 12)).expect("a logarithm").evaluations();
    beside(&mut group, "−0.3 ln|x − y|, 2 × 12", log, kernel);
    let slab = Slab::new(10.0).scattering(0.9);
    let transport = Equation::new(slab.uniform(1.0), slab.clone());
    let solve = || transport.solve(&Nystrom::graded(8, 12)).expect("a valid slab").evaluations();
    beside(&mut group, "slab c = 0.9, a = 10, 8 × 12", solve, |x, y| slab.eval(&(10.0 * x), &(10.0 * y)));
    group.finish();
}

/// A solve that tells its evaluations of the kernel, and as many of them alone.
fn beside(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, solve: impl Fn() -> u64, kernel: impl Fn(f64, f64) -> f64) {
    let values = solve();
    group.throughput(Throughput::Elements(values));
    group.bench_function(BenchmarkId::new("Nyström", name), |b| b.iter(&solve));
    group.bench_function(BenchmarkId::new("as many values of K", name), |b| {
        b.iter(|| {
            let mut u = Pcg::new(black_box(1)).point(0, 0, 0);
            let x = u.next_1d();
            (0..values).map(|i| kernel(x, (i as f64 + 0.5) / values as f64)).sum::<f64>()
        });
    });
}

fn path(c: &mut Criterion) {
    const SIZE: usize = 32;
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/scenes/cornell.gltf");
    let loaded = load(file).expect("the Cornell box");
    let scene = loaded.builder.build().expect("a scene");
    let film = scene.film(loaded.cameras[0].0, SIZE, SIZE);
    let walk = Walk::mis().roulette(Roulette::throughput(0.5).after(1)).samples_per_cell(4);
    let (counted, counters) = scene.counted();
    counted.seen_by(&film).solve(&walk).expect("an image");
    let paths = (4 * SIZE * SIZE) as u64;
    let (rays, shadows) = (paths + counters.rays(), counters.shadow_rays());
    let mut group = c.benchmark_group("path");
    group.throughput(Throughput::Elements(paths));
    let equation = scene.light_transport();
    group.bench_function("Cornell box, MIS", |b| b.iter(|| equation.seen_by(&film).solve(&walk).expect("an image")));
    // the same numbers of rays from random points of the room, which is 550 wide, in random directions
    let mut u = Pcg::new(1).point(0, 0, 0);
    let mut cube = || -> [f64; 3] { std::array::from_fn(|_| u.next_1d()) };
    let bare: Vec<Ray> = (0..rays.max(shadows)).map(|_| Ray::new(cube().map(|x| 550.0 * x), cube().map(|x| x - 0.5))).collect();
    let geometry = scene.geometry();
    group.bench_function("as many bare rays", |b| {
        b.iter(|| {
            let hits = bare.iter().take(rays as usize).filter(|r| geometry.closest(r).is_some()).count();
            hits + bare.iter().take(shadows as usize).filter(|r| geometry.occluded(r)).count()
        });
    });
    group.finish();
}

fn pieces(c: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first use of the pool");
    table(c);
    assembly(c);
    singular(c);
    path(c);
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(15).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(800));
    targets = pieces
}
criterion_main!(benches);
