//! The whole of f at 100 points: one set of forward walks and the kernel tally, beside backward walks from every point, on one thread.
//!
//! f(x) = 1 + ∫₀¹ ½e^{−|x−y|} f(y) dy, roulette ½. `cargo bench --bench profile`: the times are for 2¹² forward walks, and for 2¹² backward walks in all; the
//! efficiencies 1/(V·T) that are printed first, V the mean squared standard error over the points, do not depend on how many there are.

#![allow(clippy::print_stdout)]

use criterion::{Criterion, criterion_group, criterion_main};
use fredholm::walk::{KernelTally, Roulette};
use fredholm::{Equation, Forward, Walk};
use std::time::{Duration, Instant};

const POINTS: usize = 100;
const WALKS: u64 = 1 << 12;

/// The seconds that `solve` takes, best of five, and the mean square of the errors it states.
fn measured(mut solve: impl FnMut() -> Vec<f64>) -> (f64, f64) {
    let mut best = f64::INFINITY;
    let mut square = f64::NAN;
    for _ in 0..5 {
        let clock = Instant::now();
        let errors = solve();
        best = best.min(clock.elapsed().as_secs_f64());
        square = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
    }
    (best, square)
}

fn profile(c: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first use of the pool");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * f64::exp(-f64::abs(x - y)));
    let xs: Vec<f64> = (0..POINTS).map(|i| (i as f64 + 0.5) / POINTS as f64).collect();
    let roulette = Roulette::constant(0.5);
    let forward = |walks| Forward::new().roulette(roulette).walks(walks).profile(KernelTally::at(&xs));
    let backward = |walks: u64| Walk::collision().roulette(roulette).samples_per_cell(walks / POINTS as u64);

    let tally = measured(|| eq.solve(&forward(1 << 16)).expect("a valid equation").std_errors().expect("batches").to_vec());
    let each = measured(|| {
        let cells = eq.on(&xs).solve(&backward(100 << 14)).expect("a valid equation");
        cells.iter().filter_map(|e| e.std_error).collect()
    });
    let [ours, theirs] = [tally, each].map(|(seconds, square)| 1.0 / (seconds * square));
    println!("efficiency 1/(V·T): kernel tally {ours:.2e}, backward walks {theirs:.2e}: ratio {:.2}", ours / theirs);

    c.bench_function("kernel tally, 100 points", |b| b.iter(|| eq.solve(&forward(WALKS)).expect("a valid equation")));
    c.bench_function("backward walks, 100 points", |b| b.iter(|| eq.on(&xs).solve(&backward(WALKS)).expect("a valid equation")));
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    targets = profile
}
criterion_main!(benches);
