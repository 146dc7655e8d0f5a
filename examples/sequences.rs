//! How fast do sequences converge? −1/2 for random points, −1 for low-discrepancy points, −3/2 for scrambled nets and jittered points on a line.
//!
//! Integrals: ∫₀¹ eˣ dx = e − 1, and ∫ e^{x+y} cos(x−y) over the unit square, by quadrature. Root mean square of the true error over seeds.
//!
//! `cargo run --release --example sequences -- [--samples 4096] [--repetitions 100]`
#![allow(clippy::print_stdout)]

use fredholm::domain::Cuboid;
use fredholm::integral::{Gauss, Integral, Secondary};
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, Sobol, Stratified};
use fredholm::{Error, Estimate, plot::Convergence, statistics::Sweep};

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// Takes n and a seed: one randomisation of n points.
type Solve<'a> = &'a (dyn Fn(u64, u64) -> Result<Estimate, Error> + Sync);

fn study(title: &str, file: &str, truth: f64, rows: &[(&str, Solve<'_>)]) -> Result<(), Error> {
    let (largest, repetitions) = (option("--samples", 1 << 12), option("--repetitions", 100));
    // powers of four: whole squares for the jittered grid
    let sizes: Vec<u64> = (2..).map(|k| 1 << (2 * k)).take_while(|n| *n <= largest).collect();
    let mut plot = Convergence::against(title, "points n")
        .subtitle(&format!("root mean square of the true error over {repetitions} randomisations"))
        .slopes(&[-0.5, -1.0, -1.5]);
    println!("{title}");
    for (name, solve) in rows {
        let sweep = Sweep::run(truth, &sizes, repetitions, solve)?;
        let rate = sweep.rate()?;
        println!(
            "  {name:18} slope {:6.3} ± {:.3}   error at n = {largest}: {:.1e}",
            rate.slope,
            rate.std_error,
            sweep.errors().last().map_or(0.0, |p| p.1)
        );
        plot = plot.series(name, sweep.errors());
    }
    plot.save(file)
}

fn main() -> Result<(), Error> {
    let line = Integral::on_interval(0.0..=1.0, f64::exp);
    let square = Integral::on(Cuboid::<2>::unit(), |x| (x[0] + x[1]).exp() * (x[0] - x[1]).cos());
    let plain = Secondary::plain;
    study(
        "∫eˣ dx",
        "target/plots/sequences-line.png",
        1f64.exp() - 1.0,
        &[
            ("PCG", &|n, s| line.solve(&plain().samples(n).sequence(Pcg::new(s)))),
            ("jittered", &|n, s| line.solve(&plain().samples(n).sequence(Stratified::new(n, 1)?.replicates(1)).seed(s))),
            ("Halton", &|n, s| line.solve(&plain().samples(n).sequence(Halton::new(s).replicates(1)))),
            ("Sobol', scrambled", &|n, s| line.solve(&plain().samples(n).sequence(Sobol::new(s).replicates(1)))),
        ],
    )?;
    let truth = square.solve(&Gauss::legendre(2, 16))?;
    study(
        "∫∫e^(x+y) cos(x−y) dx dy",
        "target/plots/sequences-square.png",
        truth,
        &[
            ("PCG", &|n, s| square.solve(&plain().samples(n).sequence(Pcg::new(s)))),
            ("Latin hypercube", &|n, s| square.solve(&plain().samples(n).sequence(LatinHypercube::new(n)?.replicates(1)).seed(s))),
            ("jittered", &|n, s| square.solve(&plain().samples(n).sequence(Stratified::new(n.isqrt(), 2)?.replicates(1)).seed(s))),
            ("Halton", &|n, s| square.solve(&plain().samples(n).sequence(Halton::new(s).replicates(1)))),
            ("Hammersley", &|n, s| square.solve(&plain().samples(n).sequence(Hammersley::new(n)?.replicates(1)).seed(s))),
            ("Sobol', scrambled", &|n, s| square.solve(&plain().samples(n).sequence(Sobol::new(s).replicates(1)))),
        ],
    )?;
    println!("wrote target/plots/sequences-line.png, sequences-square.png");
    Ok(())
}
