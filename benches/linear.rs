//! Dense systems: Love's kernel, d = 0.1, at N nodes, from the kernel to the factors, beside nalgebra's own LU of the same matrix; and one more
//! source for the same factors, beside nalgebra's.
//!
//! `cargo bench --bench linear`: `fredholm` includes assembly and the estimate of the condition number, `nalgebra` neither; all cores
//! (RAYON_NUM_THREADS=1 for one).

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use fredholm::Equation;
use fredholm::deterministic::Nystrom;
use nalgebra::{DMatrix, DVector};
use std::time::Duration;

const SIZES: [usize; 4] = [64, 256, 1000, 2000];

fn love(x: f64, y: f64) -> f64 {
    0.1 / (std::f64::consts::PI * (0.01 + (x - y) * (x - y)))
}

/// I − T at the mid-points of N panels.
fn matrix(n: usize) -> DMatrix<f64> {
    let h = 2.0 / n as f64;
    DMatrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 } - h * love(i as f64 * h, j as f64 * h))
}

fn factorisation(c: &mut Criterion) {
    let mut group = c.benchmark_group("LU");
    let eq = Equation::on_interval(-1.0..=1.0, |_| 1.0, love);
    for n in SIZES {
        group.bench_with_input(BenchmarkId::new("fredholm", n), &n, |b, n| {
            b.iter(|| eq.factorise(&Nystrom::composite(*n, 1)).expect("well conditioned"))
        });
        let a = matrix(n);
        group.bench_function(BenchmarkId::new("nalgebra", n), |b| b.iter_batched(|| a.clone(), DMatrix::lu, BatchSize::LargeInput));
    }
    group.finish();
}

fn solution(c: &mut Criterion) {
    let mut group = c.benchmark_group("one more source");
    let eq = Equation::on_interval(-1.0..=1.0, |_| 1.0, love);
    for n in SIZES {
        let factors = eq.factorise(&Nystrom::composite(n, 1)).expect("well conditioned");
        group.bench_function(BenchmarkId::new("fredholm", n), |b| b.iter(|| factors.solve(eq.source()).expect("finite")));
        let (lu, g) = (matrix(n).lu(), DVector::from_element(n, 1.0));
        group.bench_function(BenchmarkId::new("nalgebra", n), |b| b.iter(|| lu.solve(&g).expect("well conditioned")));
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
    targets = factorisation, solution
}
criterion_main!(benches);
