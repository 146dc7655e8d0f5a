//! A small source, a small detector, and a kernel with a peak as narrow: walks from one end seldom find the other, and when they do, with large weights.
//!
//! Equation: f = g + ∫ K f on a circle of length 1, K = 0.4 (1 + 1{|x−y| < w}/2w), g = 1/w on [0.8, 0.8 + w], h = 1/w on [0.2, 0.2 + w].
//! Answer: ⟨h, f⟩, near 10/3 whatever w; a strategies table for w = 0.02; the work for an error as w shrinks.
//!
//! `cargo run --release --example bidirectional -- [--samples 65536]`
#![allow(clippy::print_stdout)]

use fredholm::detector::Functional;
use fredholm::domain::{Domain, Interval, Node, Periodic};
use fredholm::kernel::{Both, Proposal, Proposed, kernel_fn};
use fredholm::sampling::Sampler;
use fredholm::walk::{Heuristic, Roulette, Strategy};
use fredholm::{Bidirectional, Equation, Error, Forward, Method, Walk, plot::Convergence, source::source_fn};

/// Half of the steps go anywhere, half within ±w.
#[derive(Clone, Copy, Debug)]
struct Mixture(f64);

fn distance(x: f64, y: f64) -> f64 {
    let d = (x - y).abs();
    d.min(1.0 - d)
}

impl Proposal<f64> for Mixture {
    fn sample<S: Sampler>(&self, x: &f64, u: &mut S) -> Node<f64> {
        let [v, t] = u.next_2d();
        let point = if v < 0.5 { t } else { (x + self.0 * (2.0 * t - 1.0)).rem_euclid(1.0) };
        Node { point, weight: 1.0 / self.pdf(x, &point) }
    }
    fn pdf(&self, x: &f64, y: &f64) -> f64 {
        0.5 + if distance(*x, *y) < self.0 { 0.25 / self.0 } else { 0.0 }
    }
}

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

fn main() -> Result<(), Error> {
    let n = option("--samples", 1 << 16);
    let end = Roulette::constant(0.8);
    let (back, event) = (Walk::collision().roulette(end).samples_per_cell(n), Walk::mis().roulette(end).samples_per_cell(n));
    let (forth, both) = (Forward::new().roulette(end).walks(n), Bidirectional::new().roulette(end).samples_per_cell(n));
    let names = ["collisions", "next event, MIS", "forward", "bidirectional", "its maximum", "its optimum"];
    let mut lines: [Vec<(f64, f64)>; 6] = Default::default();
    println!("{:>8}{}", "w", names.map(|name| format!("{name:>18}")).concat());
    for w in [0.08, 0.04, 0.02, 0.01, 0.005, 0.0025] {
        let lamp = Interval::from(0.8..=0.8 + w);
        let g = source_fn(lamp, move |x: &f64| if lamp.contains(x) { 1.0 / w } else { 0.0 });
        let k = kernel_fn(Periodic::from(0.0..=1.0), move |x: &f64, y: &f64| 0.8 * Mixture(w).pdf(x, y));
        let eq = Equation::new(g, Proposed::new(k, Both::new(Mixture(w), Mixture(w))));
        let h = Functional::new(Interval::from(0.2..=0.2 + w), move |_: &f64| 1.0 / w);
        let query = eq.seen_by(&h);
        let (maximum, optimum) = (both.heuristic(Heuristic::Maximum), both.optimal(n.max(1024) / 16));
        let methods: [&dyn Method<_, _, _, Solution = _>; 6] = [&back, &event, &forth, &both, &maximum, &optimum];
        print!("{w:8}");
        for (method, line) in methods.into_iter().zip(&mut lines) {
            let e = query.solve(method)?;
            line.extend(e.efficiency().map(|efficiency| (w, efficiency.recip().sqrt() / e.value)));
            print!("{e:>18}");
        }
        println!();
        if w == 0.02 {
            println!("\nshare of order m by weight [error of the strategy alone, from one pair], s = 0, …, m + 1");
            let table = query.strategies(&both, 0, 4)?;
            for order in table.chunk_by(|a, b| a.order() == b.order()).skip(1) {
                let total: f64 = order.iter().map(|s| s.weighted.mean).sum();
                let alone = |s: &Strategy| s.alone.variance().map_or(f64::NAN, f64::sqrt) / total;
                let cell = |s: &Strategy| format!("{:5.1} % [{:4.1}]", 100.0 * s.weighted.mean / total, alone(s));
                println!("m = {}: {total:.4} = {}", order[0].order(), order.iter().map(cell).collect::<Vec<_>>().join("  "));
            }
        }
    }
    let plot = Convergence::against("Source, detector and peak shrink", "width w").error_label("relative error of one evaluation");
    let series = names.into_iter().zip(lines);
    series.fold(plot, |plot, (name, line)| plot.series(name, line)).save("target/plots/bidirectional.png")
}
