//! Assembly and solution by Nyström: smooth kernels with Gauss nodes, the slab's logarithmic kernel on graded panels.
//!
//! `cargo bench --bench nystrom`: the times are for a whole solve, all cores.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use fredholm::Equation;
use fredholm::deterministic::Nystrom;
use fredholm::transport::Slab;
use std::time::Duration;

fn smooth(c: &mut Criterion) {
    let mut group = c.benchmark_group("exp(xy)/2, Gauss nodes");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * f64::exp(x * y));
    for n in [16, 64, 256] {
        group.bench_with_input(BenchmarkId::from_parameter(n), &n, |b, n| {
            b.iter(|| eq.solve(&Nystrom::gauss_legendre(*n)).expect("smooth"))
        });
    }
    group.finish();
}

fn slab(c: &mut Criterion) {
    let mut group = c.benchmark_group("slab c = 0.9, graded panels of 12");
    for (a, panels) in [(1.0, 4), (10.0, 8)] {
        let slab = Slab::new(a).scattering(0.9);
        let eq = Equation::new(slab.uniform(1.0), slab);
        group.bench_function(format!("a = {a}"), |b| b.iter(|| eq.solve(&Nystrom::graded(panels, 12)).expect("a valid slab")));
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
    targets = smooth, slab
}
criterion_main!(benches);
