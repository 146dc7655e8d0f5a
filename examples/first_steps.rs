//! First steps: an equation from two closures, one number with its error, every estimator in a list.
//!
//! Equation: f(x) = 1 + ∫₀¹ ½xy f(y) dy. Answer: f(x) = 1 + 3x/10, at x = ½ therefore 1.15.
//!
//! `cargo run --release --example first_steps -- [--samples 65536]`
#![allow(clippy::print_stdout)]

use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Equation, Error, Estimate, Method, Walk, plot::Comparison};

fn main() -> Result<(), Error> {
    let n = std::env::args().skip_while(|a| a != "--samples").nth(1).map_or(1 << 16, |n| n.parse().expect("a whole number"));

    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let f = eq.at(0.5).solve(&Walk::collision().samples_per_cell(n).seed(7))?;
    println!("f(½) = {f:#}\n");

    let methods: [(&str, &dyn Method<_, _, _, Solution = Estimate>); 7] = [
        ("collision", &Walk::collision().samples_per_cell(n)),
        ("collision, P = ½", &Walk::collision().roulette(Roulette::constant(0.5)).samples_per_cell(n)),
        ("absorption, P = ½", &Walk::absorption().roulette(Roulette::constant(0.5)).samples_per_cell(n)),
        ("next event", &Walk::next_event().samples_per_cell(n)),
        ("MIS, balance", &Walk::mis().samples_per_cell(n)),
        ("MIS, maximum", &Walk::mis().heuristic(Heuristic::Maximum).samples_per_cell(n)),
        ("fixed depth 8", &Walk::fixed_depth(8).samples_per_cell(n)),
    ];
    let mut plot =
        Comparison::new("Estimators of f(½)", "efficiency 1/(variance · kernel evaluations)").subtitle("f(x) = 1 + ∫₀¹ ½xy f(y) dy");
    for (name, method) in methods {
        let f = eq.at(0.5).solve(method)?;
        println!("{name:20} {f:14} z = {:+.2}", f.z_score(1.15).unwrap_or(0.0));
        plot = plot.efficiency(name, &f);
    }

    // a kernel tabulated ∝ |K(x, ·)| knows its row mass: walks survive with it, at weights near 1
    let f = eq.clone().tabulated(64)?.at(0.5).solve(&Walk::subcritical().samples_per_cell(n))?;
    println!("{:20} {f:14} z = {:+.2}", "subcritical", f.z_score(1.15).unwrap_or(0.0));
    plot.efficiency("subcritical", &f).save("target/plots/first-steps.svg")?;
    println!("\nwrote target/plots/first-steps.svg");
    Ok(())
}
