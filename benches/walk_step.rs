//! Nanoseconds a step of the library's walks, each beside a hand-written loop of the same arithmetic and generator, on one thread.
//!
//! f(x) = 1 + ∫₀¹ ½e^{−|x−y|} f(y) dy at ½: (A) closures, uniform proposal, roulette ½; (B) the kernel's own Laplace step, absorbed outside; (C) as A but
//! forward, for ∫ x f(x) dx; (D) both ways, joined, balance heuristic: the time is that of a step or a join.
//!
//! `cargo bench --bench walk_step`: the times are per *step*; the ratio of a pair is what the abstraction costs.

use criterion::{Criterion, criterion_group, criterion_main};
use fredholm::detector::Functional;
use fredholm::domain::Interval;
use fredholm::kernel::{Operator, Step, Transition};
use fredholm::sampling::Sampler;
use fredholm::source::source_fn;
use fredholm::walk::{Collision, OwnAbsorption, Roulette};
use fredholm::{Bidirectional, Equation, Forward, Walk};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;
use std::hint::black_box;
use std::time::{Duration, Instant};

const WALKS: u64 = 1 << 18;

#[inline]
fn uniform(r: &mut Pcg64Mcg) -> f64 {
    (r.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Sum and sum of squares of the scores, steps.
type Sums = (f64, f64, u64);

fn loop_a(walks: u64) -> Sums {
    let mut r = Pcg64Mcg::new(42);
    let (mut sum, mut squares, mut steps) = (0.0, 0.0, 0);
    for _ in 0..walks {
        let (mut x, mut w, mut s) = (0.5f64, 1.0f64, 1.0f64);
        while uniform(&mut r) < 0.5 {
            let y = uniform(&mut r);
            w *= (-(x - y).abs()).exp();
            x = y;
            s += w;
            steps += 1;
        }
        sum += s;
        squares += s * s;
    }
    (sum, squares, steps)
}

fn loop_c(walks: u64) -> Sums {
    let mut r = Pcg64Mcg::new(42);
    let (mut sum, mut squares, mut steps) = (0.0, 0.0, 0);
    for _ in 0..walks {
        let mut z = uniform(&mut r);
        let (mut w, mut s) = (1.0f64, z);
        while uniform(&mut r) < 0.5 {
            let y = uniform(&mut r);
            w *= (-(y - z).abs()).exp();
            z = y;
            s += w * z;
            steps += 1;
        }
        sum += s;
        squares += s * s;
    }
    (sum, squares, steps)
}

/// A walk of (point, load, sum of the weights' recursion); the reverse density of every vertex is ½, its own too, but for the first.
fn walk_d(r: &mut Pcg64Mcg, first: (f64, f64), density: f64, path: &mut Vec<(f64, f64, f64)>) {
    let (mut x, mut w) = first;
    let mut sum = 0.5 / density;
    path.clear();
    path.push((x, w, sum));
    while uniform(r) < 0.5 {
        let y = uniform(r);
        w *= (-(x - y).abs()).exp();
        x = y;
        sum += 1.0;
        path.push((x, w, sum));
    }
}

fn loop_d(walks: u64) -> Sums {
    let mut r = Pcg64Mcg::new(42);
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0);
    let (mut eye, mut light) = (Vec::new(), Vec::new());
    for _ in 0..walks {
        walk_d(&mut r, (0.5, 1.0), f64::INFINITY, &mut eye);
        let z = uniform(&mut r);
        walk_d(&mut r, (z, 1.0), 1.0, &mut light);
        let mut s = 0.0;
        for (t, (x, w, beyond)) in eye.iter().enumerate() {
            // the source is hit: q₀/π = 2 in place of the reverse density over the own
            let hit = if t == 0 { 0.0 } else { 2.0 * (1.0 + eye[t - 1].2) };
            s += w / (1.0 + hit);
            for (z, load, before) in &light {
                s += w * 0.5 * (-(x - z).abs()).exp() * load / (1.0 + beyond + before);
            }
        }
        count += (eye.len() + light.len() - 2 + eye.len() * light.len()) as u64;
        sum += s;
        squares += s * s;
    }
    (sum, squares, count)
}

#[inline]
fn laplace(x: f64, v: f64) -> f64 {
    x + if v < 0.5 { (2.0 * v).ln() } else { -(2.0 - 2.0 * v).ln() }
}

fn loop_b(walks: u64) -> Sums {
    let mut r = Pcg64Mcg::new(42);
    let (mut sum, mut squares, mut steps) = (0.0, 0.0, 0);
    for _ in 0..walks {
        let (mut x, mut s) = (0.5f64, 1.0f64);
        loop {
            x = laplace(x, uniform(&mut r));
            steps += 1;
            if !(0.0..=1.0).contains(&x) {
                break;
            }
            s += 1.0;
        }
        sum += s;
        squares += s * s;
    }
    (sum, squares, steps)
}

struct Laplace;

impl Operator for Laplace {
    type Point = f64;
    type Weight = f64;
}

impl Transition for Laplace {
    #[inline]
    fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        let y = laplace(*x, u.next_1d());
        (0.0..=1.0).contains(&y).then(|| Step::new(y, 1.0))
    }
}

/// Time of a step: `run` makes all walks once and says how many steps they had.
fn per_step(c: &mut Criterion, name: &str, mut run: impl FnMut() -> u64) {
    c.bench_function(name, |b| {
        b.iter_custom(|iterations| {
            let (clock, mut steps) = (Instant::now(), 0);
            // criterion counts steps: one iteration is one step, walked WALKS walks at a time
            while steps < iterations {
                steps += run();
            }
            Duration::from_secs_f64(clock.elapsed().as_secs_f64() * iterations as f64 / steps as f64)
        });
    });
}

fn pairs(c: &mut Criterion) {
    per_step(c, "A step, hand-written", || black_box(loop_a(black_box(WALKS))).2);
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * f64::exp(-f64::abs(x - y)));
    let walk = Walk::collision().roulette(Roulette::constant(0.5)).samples_per_cell(WALKS);
    per_step(c, "A step, library", || eq.at(0.5).solve(&walk).expect("a valid equation").steps);

    per_step(c, "C step, hand-written", || black_box(loop_c(black_box(WALKS))).2);
    let first = Functional::new(Interval::from(0.0..=1.0), |x| *x);
    let forward = Forward::new().roulette(Roulette::constant(0.5)).walks(WALKS);
    per_step(c, "C step, library", || eq.seen_by(&first).solve(&forward).expect("a valid equation").steps);

    per_step(c, "D step or join, hand-written", || black_box(loop_d(black_box(WALKS / 4))).2);
    let both = Bidirectional::new().roulette(Roulette::constant(0.5)).samples_per_cell(WALKS / 4);
    per_step(c, "D step or join, library", || eq.at(0.5).solve(&both).expect("a valid equation").evaluations);

    per_step(c, "B step, hand-written", || black_box(loop_b(black_box(WALKS))).2);
    let eq = Equation::new(source_fn(Interval::from(0.0..=1.0), |_: &f64| 1.0), Laplace);
    let walk = Walk::new(Collision, OwnAbsorption).samples_per_cell(WALKS);
    // the loop counts the step that leaves, the library does not
    per_step(c, "B step, library", || eq.at(0.5).solve(&walk).map(|e| e.steps + e.samples()).expect("a valid equation"));
}

fn on_one_thread(c: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first use of the pool");
    pairs(c);
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    targets = on_one_thread
}
criterion_main!(benches);
