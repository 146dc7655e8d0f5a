//! Two answers that know nothing of each other: random walks and a Nyström solve of the same equation object.
//!
//! Equation (Love 1949, the capacitor of two circular plates one radius apart): f(x) = 1 + (1/π) ∫₋₁¹ f(y)/(1 + (x − y)²) dy.
//! Answer: f(0) = 1.919031993127…; no closed form is known.
//!
//! `cargo run --release --example monte_carlo_against_nystrom -- [--samples 100000]`
#![allow(clippy::print_stdout)]

use fredholm::deterministic::Nystrom;
use fredholm::plot::Profile;
use fredholm::{Equation, Error, Estimate, Walk};
use std::f64::consts::PI;

const XS: [f64; 9] = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];
/// All 27 estimates lie within 4 standard errors with probability 0.998.
const SIGMAS: f64 = 4.0;

fn main() -> Result<(), Error> {
    let n = std::env::args().skip_while(|a| a != "--samples").nth(1).map_or(100_000, |n| n.parse().expect("a whole number"));
    let eq = Equation::on_interval(-1.0..=1.0, |_| 1.0, |x: f64, y: f64| 1.0 / (PI * (1.0 + (x - y).powi(2))));

    let solution = eq.solve(&Nystrom::gauss_legendre(32))?;
    let residual = XS.iter().map(|x| solution.residual(*x).map(f64::abs)).try_fold(0.0, |most: f64, r| r.map(|r| most.max(r)))?;
    println!("Nyström: {} unknowns, |error| ≤ {:.0e} by its residual", solution.unknowns(), solution.inverse_norm() * residual);
    println!(
        "f(0) = {:.15}, |f(0) − 1.919031993126952| = {:.0e}\n",
        solution.eval(0.0),
        (solution.eval(0.0) - 1.919_031_993_126_952_3).abs()
    );

    let tabulated = eq.clone().tabulated(64)?;
    let walks: [(&str, Vec<Estimate>); 3] = [
        ("collision", eq.on(&XS).solve(&Walk::collision().samples_per_cell(n))?),
        ("subcritical", tabulated.on(&XS).solve(&Walk::subcritical().samples_per_cell(n))?),
        ("next event", eq.on(&XS).solve(&Walk::next_event().samples_per_cell(n))?),
    ];
    println!("{:>6}{:>12}   {}", "x", "Nyström", walks.each_ref().map(|(name, _)| format!("{name:14}{:>6}   ", "z")).concat());
    for (i, x) in XS.iter().enumerate() {
        let f = solution.eval(*x);
        let columns = walks.each_ref().map(|(_, e)| format!("{:14}{:6.2}   ", e[i], e[i].z_score(f).unwrap_or(0.0)));
        println!("{x:6}{f:12.6}   {}", columns.concat());
    }
    let agree = walks.iter().flat_map(|(_, e)| e.iter().zip(XS)).filter(|(e, x)| e.agrees_with(solution.eval(*x), SIGMAS)).count();
    println!("\n{agree} of {} estimates within {SIGMAS} standard errors of the Nyström solution", walks.len() * XS.len());

    let mut plot = Profile::new("Love's equation", -1.0..=1.0).subtitle(&format!("{n} walks a point, bars of 95 %"));
    plot = plot.curve("Nyström, 32 nodes", |x| solution.eval(x));
    for (name, estimates) in &walks {
        plot = plot.estimates(name, &XS, estimates);
    }
    plot.save("target/plots/monte-carlo-against-nystrom.svg")?;
    println!("wrote target/plots/monte-carlo-against-nystrom.svg");
    Ok(())
}
