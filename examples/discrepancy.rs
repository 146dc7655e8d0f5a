//! Star discrepancy against the number of points, with slopes, and what it is for: the bound of Koksma and Hlawka.
//!
//! Equation: D*(P) = sup |#{x ∈ P: x < y}/n − y₁y₂|, and |Σ f/n − ∫f| ≤ V(f) D* with f = x₁x₂, ∫f = ¼, V = 3. Answer: D* falls as n^(−1/2)
//! for random points, n^(−3/4) for jittered ones, and almost as 1/n for Halton, Hammersley and Sobol' points.
//!
//! `cargo run --release --example discrepancy -- [--points 4096] [--seeds 5]`
#![allow(clippy::print_stdout)]

use fredholm::plot::Convergence;
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, PointSet, Sequence, Sobol, Stratified};
use fredholm::{Error, statistics::Rate};

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// Makes n points by a seed.
type Draw = fn(u64, u64) -> Result<PointSet, Error>;

fn square(sequence: impl Sequence, seed: u64, n: u64) -> Result<PointSet, Error> {
    PointSet::draw(&sequence.with_seed(seed), 2, n)
}

/// Root mean square of D*, and of the error of ∫x₁x₂ over its bound.
fn measure(draw: Draw, n: u64, seeds: u64) -> Result<(f64, f64), Error> {
    let (mut stars, mut used) = (0.0, 0.0);
    for seed in 0..seeds {
        let points = draw(seed, n)?;
        let star = points.star()?;
        let mean = points.iter().map(|x| x[0] * x[1]).sum::<f64>() / n as f64;
        stars += star * star;
        used += ((mean - 0.25) / (3.0 * star)).powi(2);
    }
    Ok(((stars / seeds as f64).sqrt(), (used / seeds as f64).sqrt()))
}

fn main() -> Result<(), Error> {
    let (largest, seeds) = (option("--points", 4096), option("--seeds", 5).max(1));
    let sequences: [(&str, Draw); 7] = [
        ("PCG", |s, n| square(Pcg::new(0), s, n)),
        ("Latin hypercube", |s, n| square(LatinHypercube::new(n)?, s, n)),
        ("jittered", |s, n| square(Stratified::new(n.isqrt(), 2)?, s, n)),
        ("Halton, scrambled", |s, n| square(Halton::new(0), s, n)),
        ("Halton", |_, n| PointSet::draw(&Halton::new(0).unscrambled(), 2, n)),
        ("Hammersley", |_, n| PointSet::draw(&Hammersley::new(n)?.unscrambled(), 2, n)),
        ("Sobol', scrambled", |s, n| square(Sobol::new(0), s, n)),
    ];
    // powers of 4: every sequence has sets of these sizes
    let sizes: Vec<u64> = (2..).map(|k| 1 << (2 * k)).take_while(|n| *n <= largest).collect();
    let caption = format!("the unit square; root mean square over {seeds} seeds where there is a seed");
    let mut plot = Convergence::against("Star discrepancy", "points n").subtitle(&caption).error_label("D*");
    for (name, draw) in sequences {
        let measured = sizes.iter().map(|n| measure(draw, *n, seeds).map(|m| (*n as f64, m))).collect::<Result<Vec<_>, _>>()?;
        let points: Vec<(f64, f64)> = measured.iter().map(|(n, m)| (*n, m.0)).collect();
        let (rate, (n, (star, used))) = (Rate::fit(points.clone())?, measured[measured.len() - 1]);
        println!(
            "{name:20} D* at n = {n}: {star:.2e}   slope {:.3} ± {:.3}   error of ∫x₁x₂ = {:4.1} % of V D*",
            rate.slope,
            rate.std_error,
            100.0 * used
        );
        plot = plot.series(name, points);
    }
    plot.save("target/plots/discrepancy.png")?;
    println!("wrote target/plots/discrepancy.png");
    Ok(())
}
