//! Nanoseconds a coordinate: every sequence beside the bare generator, on one thread.
//!
//! `cargo bench --bench sampling`: the throughput is in coordinates. «walk order» reads 32 coordinates of one point after the other, as a
//! walk does. The laws: a PCG uniform within 10 % of the bare generator, a Sobol' coordinate at most 5 PCG ones. `examples/peers rng` times
//! the same beside other programs.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, Sampler, Sequence, Sobol, Stratified, VanDerCorput};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;
use std::hint::black_box;
use std::time::Duration;

const POINTS: u64 = 1 << 12;
const COORDINATES: u64 = 32;

/// Sum of 32 coordinates of 4096 points from the 2²⁰th on.
fn sum<Q: Sequence>(sequence: &Q, coordinates: u64) -> f64 {
    let first = 1 << 20;
    let mut sum = 0.0;
    for mut u in sequence.points(0, 0, first..first + POINTS) {
        for _ in 0..coordinates {
            sum += u.next_1d();
        }
    }
    sum
}

fn bare(numbers: u64) -> f64 {
    let (mut r, mut sum) = (Pcg64Mcg::new(42), 0.0);
    for _ in 0..numbers {
        sum += (r.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64);
    }
    sum
}

fn sampling(c: &mut Criterion) {
    let mut group = c.benchmark_group("coordinate");
    group.throughput(Throughput::Elements(POINTS * COORDINATES));
    group.bench_function("bare Pcg64Mcg", |b| b.iter(|| bare(black_box(POINTS * COORDINATES))));
    group.bench_function("one long PCG stream", |b| {
        b.iter(|| {
            let mut u = Pcg::new(black_box(1)).point(0, 0, 0);
            (0..POINTS * COORDINATES).map(|_| u.next_1d()).sum::<f64>()
        });
    });
    macro_rules! walk_order {
        ($($name:literal: $sequence:expr),* $(,)?) => {
            $(group.bench_function(concat!("walk order, ", $name), |b| b.iter(|| sum(&$sequence, black_box(COORDINATES))));)*
        };
    }
    walk_order! {
        "PCG": Pcg::new(1),
        "Sobol'": Sobol::new(1),
        "Sobol' unscrambled": Sobol::new(1).unscrambled(),
        "Halton": Halton::new(1),
        "Halton unscrambled": Halton::new(1).unscrambled(),
        "Hammersley": Hammersley::new(POINTS).expect("some points"),
        "Latin hypercube": LatinHypercube::new(POINTS).expect("some points"),
        "stratified in pairs": Stratified::new(64, 2).expect("some strata"),
    }
    group.throughput(Throughput::Elements(POINTS));
    group.bench_function("first alone, PCG", |b| b.iter(|| sum(&Pcg::new(1), black_box(1))));
    group.bench_function("first alone, Sobol'", |b| b.iter(|| sum(&Sobol::new(1), black_box(1))));
    group.bench_function("first alone, van der Corput", |b| {
        let sequence = VanDerCorput::new(2).expect("a base");
        b.iter(|| sum(&sequence, black_box(1)));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(600));
    targets = sampling
}
criterion_main!(benches);
