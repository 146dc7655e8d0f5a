//! Analog slab histories, the library beside a hand-written loop: c = 0.9, a = 10, uniform source, 100 bins, 50 batches, one thread.
//!
//! `cargo bench --bench slab`: the times are for 50 000 histories.

use criterion::{Criterion, criterion_group, criterion_main};
use fredholm::Equation;
use fredholm::Walk;
use fredholm::transport::{CollisionTally, Histories, Slab, TrackTally};
use rand_core::Rng;
use rand_pcg::Pcg64;
use std::hint::black_box;
use std::time::Duration;

const HISTORIES: u64 = 50_000;
const BATCHES: u64 = 50;
const BINS: usize = 100;
const A: f64 = 10.0;
const C: f64 = 0.9;

#[inline]
fn uniform(r: &mut Pcg64) -> f64 {
    (r.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Collisions in each bin, one stream a batch.
fn hand_written(batch: u64) -> [f64; BINS] {
    let mut r = Pcg64::new(42, u128::from(batch));
    let mut bins = [0.0; BINS];
    for _ in 0..HISTORIES / BATCHES {
        let mut x = A * uniform(&mut r);
        loop {
            let mu = 2.0 * uniform(&mut r) - 1.0;
            let y = x - mu * (1.0 - uniform(&mut r)).ln();
            if !(y > 0.0 && y < A) {
                break;
            }
            bins[(y * (BINS as f64 / A)) as usize] += 1.0;
            if uniform(&mut r) >= C {
                break;
            }
            x = y;
        }
    }
    bins
}

fn slab(c: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first use of the pool");
    c.bench_function("collision tally, hand-written", |b| b.iter(|| (0..BATCHES).map(|i| black_box(hand_written(i))).collect::<Vec<_>>()));
    let slab = Slab::new(A).scattering(C);
    let source = slab.uniform(1.0);
    let collision = Histories::new(CollisionTally).bins(BINS).batches(BATCHES).histories(HISTORIES);
    c.bench_function("collision tally, library", |b| b.iter(|| collision.run(&slab, &source).expect("a valid slab")));
    let track = Histories::new(TrackTally).bins(BINS).batches(BATCHES).histories(HISTORIES);
    c.bench_function("track tally, library", |b| b.iter(|| track.run(&slab, &source).expect("a valid slab")));
    let eq = Equation::new(&source, &slab);
    let walk = Walk::collision().samples_per_cell(HISTORIES);
    c.bench_function("backward walks from the middle, library", |b| b.iter(|| eq.at(0.5 * A).solve(&walk).expect("a valid slab")));
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
    targets = slab
}
criterion_main!(benches);
