//! Moments to the fourth order of a block of scores, beside a plain sum and sum of squares; merging two blocks, beside merging means and variances only.
//!
//! `cargo bench --bench moments`: the throughput is in scores.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fredholm::statistics::Moments;
use std::hint::black_box;
use std::time::Duration;

fn sums(scores: &[f64]) -> (f64, f64) {
    scores.iter().fold((0.0, 0.0), |(s, q), y| (s + y, q + y * y))
}

/// Count, mean, sum of squared deviations of two blocks together (Chan, Golub, LeVeque 1983).
fn merged(a: (f64, f64, f64), b: (f64, f64, f64)) -> (f64, f64, f64) {
    let (n, d) = (a.0 + b.0, b.1 - a.1);
    (n, a.1 + d * b.0 / n, a.2 + b.2 + d * d * a.0 * b.0 / n)
}

fn moments(c: &mut Criterion) {
    let mut group = c.benchmark_group("moments");
    for count in [64usize, 1024, 16_384] {
        let scores: Vec<f64> = (0..count).map(|i| 1.0 + (i as f64 * 0.618).fract()).collect();
        group.throughput(Throughput::Elements(count as u64));
        group.bench_with_input(BenchmarkId::new("four moments", count), &scores, |b, s| b.iter(|| Moments::from_scores(black_box(s))));
        group.bench_with_input(BenchmarkId::new("sum and squares", count), &scores, |b, s| b.iter(|| sums(black_box(s))));
    }
    let (mut all, block) = (Moments::default(), Moments::from_scores(&[1.0, 2.0, 4.0, 8.0]));
    group.throughput(Throughput::Elements(1));
    let (mut two, pair) = ((0.0, 0.0, 0.0), (4.0, 3.75, 28.75));
    group.bench_function("merge, two moments by hand", |b| {
        b.iter(|| {
            two = merged(two, black_box(pair));
            two.1
        });
    });
    group.bench_function("merge", |b| {
        b.iter(|| {
            all.merge(black_box(&block));
            all.mean
        });
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(600));
    targets = moments
}
criterion_main!(benches);
