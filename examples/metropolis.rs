//! Metropolis in primary sample space: a walk that seldom scores, seen by many cells.
//!
//! Equation: f(x) = g(x) + ½ ∫₀¹ e^{−2|x−y|} f(y) dy, g a peak of width 0.002 at 0.8; the mean of f over each of 256 cells of [0, 0.6], from walks that must hit the peak.
//! Answer: by Nyström; errors of plain walks and of Metropolis' walk at equal work, cell by cell, and for the sum of all cells, where nothing is gained.
//!
//! `cargo run --release --example metropolis -- [--mutations 4096]`
#![allow(clippy::print_stdout)]

use fredholm::detector::Bins;
use fredholm::deterministic::{Nystrom, quadrature::composite_unit_rule};
use fredholm::estimator::{LargeSteps, Metropolis};
use fredholm::{Equation, Error, Estimate, Walk, plot::Profile};

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// Root mean square of the true errors of all cells, and their mean stated error.
fn judge(cells: &[Estimate], exact: &[f64]) -> (f64, f64) {
    let n = cells.len() as f64;
    let square = cells.iter().zip(exact).map(|(e, f)| (e.value - f).powi(2)).sum::<f64>() / n;
    (square.sqrt(), cells.iter().map(|e| e.std_error.unwrap_or(f64::NAN)).sum::<f64>() / n)
}

fn main() -> Result<(), Error> {
    let mutations = option("--mutations", 1 << 12);
    let peak = |x: f64| (-0.5 * ((x - 0.8) / 0.002f64).powi(2)).exp() / 0.005;
    let eq = Equation::on_interval(0.0..=1.0, peak, |x: f64, y: f64| 0.5 * (-2.0 * (x - y).abs()).exp());
    let f = eq.solve(&Nystrom::graded(500, 4))?;
    let bins = Bins::new(0.0..=0.6, 256);
    let rule = composite_unit_rule(16, 4);
    let mean = |cell: usize| rule.iter().map(|n| n.weight * f.eval(0.6 * (cell as f64 + n.point) / 256.0)).sum::<f64>();
    let exact: Vec<f64> = (0..256).map(mean).collect();
    let query = eq.seen_by(&bins);
    let walk = Walk::collision();
    let estimator = query.estimator(&walk)?;
    let metropolis = Metropolis::new().mutations(mutations).pool(mutations).small_steps(1e-4, 0.3).large_step_probability(0.1);
    let chains = metropolis.solve(&estimator)?;
    let combined = metropolis.large_steps(LargeSteps::Combined).solve(&estimator)?;
    // as many walks as mutations and points of pools together, of 32 chains
    let plain = query.solve(&walk.samples_per_cell(2 * mutations * 32 / 256))?;
    println!(
        "acceptance: {:.2} of small steps, {:.3} of fresh points; b = {}",
        chains.acceptance.unwrap_or(f64::NAN),
        chains.large_acceptance.unwrap_or(f64::NAN),
        chains.normalisation
    );
    println!("{:>24}  true error (rms)  stated", "");
    for (name, cells) in [("plain walks", &plain), ("Metropolis", &chains.cells), ("Metropolis, combined", &combined.cells)] {
        let (error, stated) = judge(cells, &exact);
        let sum = cells.iter().map(|e| e.value).sum::<f64>() / exact.iter().sum::<f64>() - 1.0;
        println!("{name:>24}  {error:16.4}  {stated:6.4}   sum of all cells off by {:+.2} %", 100.0 * sum);
    }
    let every_eighth = |cells: &[Estimate]| cells.iter().step_by(8).cloned().collect::<Vec<_>>();
    let centres: Vec<f64> = (0..256).step_by(8).map(|cell| bins.centre(cell)).collect();
    let step = |x: f64| exact[((x / 0.6 * 256.0) as usize).min(255)];
    Profile::new("A peak that walks seldom hit, seen by 256 cells", 0.0..=0.6)
        .subtitle("equal numbers of walks; every eighth cell")
        .y_label("mean of f over the cell")
        .curve("Nyström, means of cells", step)
        .estimates("plain walks", &centres, &every_eighth(&plain))
        .estimates("Metropolis", &centres, &every_eighth(&chains.cells))
        .save("target/plots/metropolis.png")
}
