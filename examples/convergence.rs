//! How fast do random walks converge? As N^(−1/2), whatever the estimator; the estimators differ in the constant and in the cost of a walk.
//!
//! Equation: f(x) = g(x) + ∫₀¹ ½e^{−|x−y|} f(y) dy, g = 1. Answer: f(x) = 3/2 + x(1 − x)/2, at x = ½ therefore 1.625.
//! Root mean square of the true error over repetitions with seeds of their own, for N = 64, 128, … walks.
//!
//! `cargo run --release --example convergence -- [--samples 65536] [--repetitions 100]`
#![allow(clippy::print_stdout)]

use fredholm::statistics::Rate;
use fredholm::walk::Roulette;
use fredholm::{Equation, Error, Estimate, Walk, plot::Convergence};
use std::fmt::Write;

const EXACT: f64 = 1.625;

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// N, median seconds a solve, root mean square error.
type Point = (f64, f64, f64);

/// Takes N and a seed.
type Solve<'a> = &'a dyn Fn(u64, u64) -> Result<Estimate, Error>;

fn errors(samples: u64, repetitions: u64, solve: Solve<'_>) -> Result<Vec<Point>, Error> {
    let at = |n: u64| {
        let (mut squares, mut seconds) = (0.0, Vec::new());
        for repetition in 1..=repetitions {
            // no seed twice: errors that share walks would make the slope look better known than it is
            let f = solve(n, n * repetitions + repetition)?;
            squares += (f.value - EXACT).powi(2);
            seconds.push(f.elapsed.as_secs_f64());
        }
        seconds.sort_by(f64::total_cmp);
        Ok((n as f64, seconds[seconds.len() / 2], (squares / repetitions as f64).sqrt()))
    };
    (6..).map(|k| 1 << k).take_while(|n| *n <= samples).map(at).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (samples, repetitions) = (option("--samples", 1 << 16), option("--repetitions", 100).max(1));
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (-(x - y).abs()).exp());
    let tabulated = eq.clone().tabulated(64)?;
    let (uniform, tabulated, roulette) = (eq.at(0.5), tabulated.at(0.5), Roulette::constant(0.5));
    let methods: [(&str, Solve<'_>); 6] = [
        ("collision", &|n, seed| uniform.solve(&Walk::collision().samples_per_cell(n).seed(seed))),
        ("absorption, P = ½", &|n, seed| uniform.solve(&Walk::absorption().roulette(roulette).samples_per_cell(n).seed(seed))),
        ("subcritical, tabulated", &|n, seed| tabulated.solve(&Walk::subcritical().samples_per_cell(n).seed(seed))),
        ("next event", &|n, seed| uniform.solve(&Walk::next_event().samples_per_cell(n).seed(seed))),
        ("MIS, tabulated", &|n, seed| tabulated.solve(&Walk::mis().samples_per_cell(n).seed(seed))),
        ("fixed depth 4 (biased)", &|n, seed| uniform.solve(&Walk::fixed_depth(4).samples_per_cell(n).seed(seed))),
    ];
    let title = "f(½) for K = ½exp(−|x−y|), g = 1";
    let caption = format!("root mean square of the true error over {repetitions} repetitions");
    let mut by_samples = Convergence::against_samples(title).subtitle(&caption).error_label("error of f(½)");
    let mut by_time = Convergence::against_time(title).subtitle(&caption).error_label("error of f(½)");
    let mut csv = String::from("method,walks,seconds,rms_error\n");
    for (name, solve) in methods {
        let points = errors(samples, repetitions, solve)?;
        let rate = Rate::fit(points.iter().map(|p| (p.0, p.2)))?;
        println!(
            "{name:24} error at N = {}: {:.2e}   slope {:.3} ± {:.3}",
            points.last().unwrap().0,
            points.last().unwrap().2,
            rate.slope,
            rate.std_error
        );
        points.iter().try_for_each(|(n, s, e)| writeln!(csv, "\"{name}\",{n},{s:e},{e:e}"))?;
        by_samples = by_samples.series(name, points.iter().map(|p| (p.0, p.2)));
        by_time = by_time.series(name, points.iter().map(|p| (p.1, p.2)));
    }
    by_samples.save("target/plots/convergence-samples.svg")?;
    by_time.save("target/plots/convergence-time.svg")?;
    std::fs::write("target/plots/convergence.csv", csv).map_err(|e| format!("target/plots/convergence.csv: {e}"))?;
    println!("wrote target/plots/convergence-samples.svg, convergence-time.svg, convergence.csv");
    Ok(())
}
