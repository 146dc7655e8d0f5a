//! Two energy groups, both ways: matrix weights on one walk, or the group as part of the state.
//!
//! Equation: f_i(x) = g_i + Σ_j ∫₀² (β_ij/2) e^{−|x−y|} f_j(y) dy, g = (1, 0), β = (½ 0; 3/10 4/5): group 1 scatters down into group 2.
//! Answer: f = (φ_½, φ_⅘ − φ_½), where φ_λ = 1/(1−λ) + C cosh κ(x−1), κ = √(1−λ), solves the equation of one group with β = λ, g = 1.
//!
//! `cargo run --release --example multigroup -- [--samples 100000]`
#![allow(clippy::print_stdout)]

use fredholm::domain::{Grouped, Interval};
use fredholm::plot::Profile;
use fredholm::{Equation, Error, Estimate, GroupMatrix, Spectrum, Walk};

const BETA: [[f64; 2]; 2] = [[0.5, 0.0], [0.3, 0.8]];
const SOURCE: [f64; 2] = [1.0, 0.0];

fn one_group(lambda: f64, x: f64) -> f64 {
    let (kappa, far) = ((1.0 - lambda).sqrt(), 1.0 / (1.0 - lambda));
    far - (far - 1.0) * (kappa * (x - 1.0)).cosh() / (kappa.cosh() + kappa * kappa.sinh())
}

fn exact(group: usize, x: f64) -> f64 {
    [one_group(0.5, x), one_group(0.8, x) - one_group(0.5, x)][group]
}

fn main() -> Result<(), Error> {
    let n = std::env::args().skip_while(|a| a != "--samples").nth(1).map_or(100_000, |n| n.parse().expect("a whole number"));
    let xs = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0];
    let decay = |x: f64, y: f64| 0.5 * (-(x - y).abs()).exp();

    // 1. f(x) is a pair, K(x, y) a 2 × 2 matrix: one walk estimates both groups
    let matrix = Equation::on_interval(0.0..=2.0, |_| Spectrum(SOURCE), |x, y| GroupMatrix(BETA.map(|row| row.map(|b| b * decay(x, y)))));
    let matrix = matrix.tabulated(64)?;
    let pairs = matrix.on(&xs).solve(&Walk::collision().samples_per_cell(n))?;

    // 2. the state is (x, group), K a number: walks change the group like a coordinate, and their next step prefers the group that counts
    let groups = Grouped::new(Interval::from(0.0..=2.0), 2);
    let states = Equation::on_domain(groups, |(_, i)| SOURCE[*i], |(x, i), (y, j)| BETA[*i][*j] * decay(*x, *y)).tabulated(64)?;
    let states_of = |group| states.on(&xs.map(|x| (x, group))).solve(&Walk::subcritical().samples_per_cell(n));
    let singles: [Vec<Estimate>; 2] = [states_of(0)?, states_of(1)?];

    println!("{:>5} {:>6}{:>12}   {:18}{:>6}   {:18}{:>6}", "x", "group", "exact", "matrix weights", "z", "group in state", "z");
    for (i, x) in xs.iter().enumerate() {
        for (g, single) in singles.iter().map(|s| &s[i]).enumerate() {
            let f = exact(g, *x);
            let pair = pairs[i].component(g);
            let z = |e: &Estimate| e.z_score(f).unwrap_or(0.0);
            println!("{x:5} {:6}{f:12.6}   {pair:18}{:6.2}   {single:18}{:6.2}", g + 1, z(&pair), z(single));
        }
    }
    let mut plot =
        Profile::new("Two groups, down-scattering", 0.0..=2.0).subtitle("β = (½ 0; 3/10 4/5), source in group 1").y_label("f₁, f₂");
    for (g, single) in singles.iter().enumerate() {
        let pair: Vec<_> = pairs.iter().map(|e| e.component(g)).collect();
        plot = plot
            .curve(&format!("group {}, exact", g + 1), move |x| exact(g, x))
            .estimates(&format!("group {}, matrix weights", g + 1), &xs, &pair)
            .estimates(&format!("group {}, group in state", g + 1), &xs, single);
    }
    plot.save("target/plots/multigroup.svg")?;
    println!("wrote target/plots/multigroup.svg");
    Ok(())
}
