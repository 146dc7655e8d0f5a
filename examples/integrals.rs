//! One integral, every technique: what each promises by its formula, what it delivers, and what it costs.
//!
//! Integrals: ∫₀¹ x² dx = 1/3, ∫₀^π sin x dx = 2, ∫₀¹ eˣ dx = e − 1, and I = ∫₀¹ f dx for a spiky f with I = 0.6364….
//!
//! `cargo run --release --example integrals -- [--samples 16384]`
#![allow(clippy::print_stdout)]

use fredholm::integral::{
    Allocation, Coefficient, Combined, Control, Gauss, Integral, Plain, Roulette, Secondary, Strata, Stratified, inverse,
};
use fredholm::{Error, Estimate, plot::Comparison, walk::Heuristic};
use std::f64::consts::{E, PI};

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// Solves by each method, prints the estimate and its squared error beside the prediction, and keeps the row.
macro_rules! table {
    ($integral:expr, $rule:expr, $rows:expr, $($name:expr => $method:expr),+ $(,)?) => {
        $({
            let method = $method;
            let (e, predicted) = ($integral.solve(&method)?, $integral.predict(&method, &$rule)?);
            let (measured, efficiency) = (e.std_error.map_or(f64::NAN, |s| s * s), e.efficiency().unwrap_or(f64::NAN));
            println!("{:30}{e:>22}   V measured {measured:9.2e}  predicted {predicted:9.2e}   1/(V·n) {efficiency:9.2e}", $name);
            $rows.push(($name, e));
        })+
    };
}

fn main() -> Result<(), Error> {
    let n = option("--samples", 1 << 14);
    let rule = Gauss::legendre(256, 8);
    let mut rows = Vec::<(&str, Estimate)>::new();
    let square = Integral::on_interval(0.0..=1.0, |x| x * x);
    let line = inverse(|u: f64| u.sqrt(), |x: &f64| 2.0 * x);
    table!(square, rule, rows, "∫x², uniform" => Secondary::plain().samples(n), "∫x², p = 2x" => Secondary::importance(line.clone()).samples(n));
    let exp = Integral::on_interval(0.0..=1.0, f64::exp);
    let zero = inverse(|u: f64| (u * (E - 1.0)).ln_1p(), |x: &f64| x.exp() / (E - 1.0));
    table!(exp, rule, rows, "∫eˣ, uniform" => Secondary::plain().samples(n), "∫eˣ, p = eˣ/(e−1): exact" => Secondary::importance(zero).samples(n));
    let sine = Integral::on_interval(0.0..=PI, f64::sin);
    let half = inverse(|u: f64| (1.0 - 2.0 * u).acos(), |x: &f64| x.sin() / 2.0);
    table!(sine, rule, rows, "∫sin, uniform" => Secondary::plain().samples(n), "∫sin, p = sin/2: exact" => Secondary::importance(half).samples(n));

    let spiky = Integral::on_interval(0.0..=1.0, |x: f64| (1.0 + (30.0 * x).sin()) / 2.0 * (0.03 / (0.0009 + (x - 0.4).powi(2)) / 3.0 + x));
    println!("\nI = {:.10} by quadrature", spiky.solve(&rule)?);
    let (a, b) = (-(0.4f64 / 0.03).atan(), (0.6f64 / 0.03).atan());
    let peak = inverse(move |u: f64| 0.4 + 0.03 * (a + u * (b - a)).tan(), move |x: &f64| 0.03 / ((b - a) * (0.0009 + (x - 0.4).powi(2))));
    let two = |c: Combined<f64>| Secondary::combined(c.technique(peak.clone(), 1).technique(line.clone(), 1)).samples(n / 2);
    let g = move |x: &f64| 0.5 * (0.03 / (0.0009 + (x - 0.4).powi(2)) / 3.0 + x);
    rows.clear();
    table!(spiky, rule, rows,
        "uniform" => Secondary::plain().samples(n),
        "Russian roulette, P = ½" => Secondary::new(Roulette::new(Plain, 0.5)).samples(n),
        "importance, peak alone" => Secondary::importance(peak.clone()).samples(n),
        "importance, line alone" => Secondary::importance(line.clone()).samples(n),
        "combined, average" => two(Combined::new(Heuristic::Average)),
        "combined, maximum" => two(Combined::new(Heuristic::Maximum)),
        "combined, balance" => two(Combined::new(Heuristic::Balance)),
        "combined, power 2" => two(Combined::new(Heuristic::Power(2.0))),
        "combined, optimal" => two(Combined::optimal(512)),
        "control, best α" => Secondary::new(Control::new(Plain, g, 0.5 * ((b - a) / 3.0 + 0.5), Coefficient::Pilot(512))).samples(n),
        "32 strata" => Stratified::new(Strata::uniform(32)).samples(n),
        "32 strata, Neyman" => Stratified::new(Strata::uniform(32)).allocation(Allocation::Neyman { pilot: 16 }).samples(n),
        "adapted strata" => Stratified::new(Strata::adapted(&spiky, 256)?).allocation(Allocation::Equal).samples(n),
        "jittered, 8 replicates" => Stratified::jittered(Strata::uniform(n as usize / 8), 8),
    );
    let plot = Comparison::new("A spiky integrand", "efficiency 1/(variance · evaluations)");
    rows.iter().fold(plot, |plot, (name, e)| plot.efficiency(name, e)).save("target/plots/integrals.png")?;
    println!("wrote target/plots/integrals.png");
    Ok(())
}
