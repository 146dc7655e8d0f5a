//! One walk under three kinds of points: independent, a Sobol' point a walk, and Array-RQMC, a fresh Sobol' set a step for sorted walks.
//!
//! Equation: f(x) = 1 + ∫₀ᴸ (c/2) e^{−|x−y|} f(y) dy, c = 0.95, L = 10: a slab whose walks go on for some 18 steps.
//! Answer: f(L/2) = 10.4920… by Nyström.
//!
//! `cargo run --release --example array_rqmc -- [--samples 16384] [--replicates 32]`    (131072: the size of the literature's yardstick)
#![allow(clippy::print_stdout)]

use fredholm::deterministic::Nystrom;
use fredholm::domain::{Domain, Interval};
use fredholm::kernel::{HasDomain, Operator, Step, Transition};
use fredholm::sampling::{Layout, Pcg, Sampler, Sobol};
use fredholm::walk::{ArrayRqmc, Roulette};
use fredholm::{Equation, Error, Estimate, Walk, plot::Convergence, source::source_fn, statistics::Rate};

const C: f64 = 0.95;

/// Free flights with weight c; outside the slab they are lost.
#[derive(Clone, Copy, Debug)]
struct Slab(Interval);

impl Operator for Slab {
    type Point = f64;
    type Weight = f64;
}
impl HasDomain for Slab {
    type Domain = Interval;
    fn domain(&self) -> &Interval {
        &self.0
    }
}
impl Transition for Slab {
    fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        // Laplace's distribution by inversion: one number, and y rises with it
        let u = u.next_1d();
        let y = if u < 0.5 { x + (2.0 * u).ln() } else { x - (2.0 - 2.0 * u).ln() };
        self.0.contains(&y).then(|| Step::new(y, C))
    }
}

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

fn main() -> Result<(), Error> {
    let (largest, replicates, slab) = (option("--samples", 1 << 14), option("--replicates", 32), Interval::from(0.0..=10.0));
    let exact = Equation::on_interval(0.0..=10.0, |_| 1.0, |x: f64, y: f64| 0.5 * C * (-(x - y).abs()).exp());
    let exact = exact.solve(&Nystrom::graded(64, 8))?.eval(5.0);
    let eq = Equation::new(source_fn(slab, |_: &f64| 1.0), Slab(slab));
    let query = eq.at(5.0);
    println!(
        "f(L/2) = {exact:.6} by Nyström; variance of the mean of n walks, {replicates} replicates\n{:>8}  variance, PCG     Sobol' a walk      Array-RQMC",
        "n"
    );
    let names = ["PCG", "Sobol', a point a walk", "Array-RQMC, a set a step"];
    let mut errors: [Vec<(f64, f64)>; 3] = Default::default();
    for n in (8..).map(|k| 1u64 << k).take_while(|n| *n <= largest) {
        let walk = Walk::collision().roulette(Roulette::throughput(0.01)).samples_per_cell(n * replicates);
        // a walk needs one number for roulette and one for its step
        let layout = Layout::of_dimension(1).start(0).event(0);
        let sobol = walk.sequence(Sobol::new(n).replicates(replicates as u32).layout(layout));
        let results: [Estimate; 3] =
            [query.solve(&walk.sequence(Pcg::new(n)))?, query.solve(&sobol)?, query.solve(&ArrayRqmc::new(sobol))?];
        assert!(results.iter().all(|e| e.agrees_with(exact, 6.0)), "{results:?}");
        let variances = results.each_ref().map(|e| e.std_error.unwrap_or(f64::NAN).powi(2) * replicates as f64);
        let gain = |i: usize| format!("{:9.2e} ÷{:<6.1}", variances[i], variances[0] / variances[i]);
        println!("{n:8}  {:9.2e}   {}  {}", variances[0], gain(1), gain(2));
        variances.iter().zip(&mut errors).for_each(|(v, list)| list.push((n as f64, v.sqrt())));
    }
    let mut plot = Convergence::against("A walk in a slab, c = 0.95, L = 10", "walks n a replicate")
        .subtitle(&format!("standard error from {replicates} replicates"))
        .slopes(&[-0.5, -1.0]);
    for (name, points) in names.into_iter().zip(errors) {
        println!("{name:26} slope {:.3}", Rate::fit(points.iter().copied())?.slope);
        plot = plot.series(name, points);
    }
    plot.save("target/plots/array-rqmc.png")
}
