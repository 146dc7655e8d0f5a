//! Your own kernel and source as traits: each capability is one method, and each lets more estimators in.
//!
//! Equation: f(x) = 1 + ∫₀¹ ½e^{−|x−y|} f(y) dy. Answer: f(x) = 3/2 + x(1 − x)/2.
//! A walk flies an exponential distance to the left or right; that samples K exactly, so weights are 1 and leaving [0, 1] is the absorption.
//!
//! `cargo run --release --example own_kernel -- [--samples 65536]`
#![allow(clippy::print_stdout)]

use fredholm::domain::{Domain, Interval, Node};
use fredholm::kernel::{Absorbing, HasDomain, Kernel, Operator, RowMass, Step, Transition, TransitionPdf};
use fredholm::sampling::Sampler;
use fredholm::source::{SampleSource, Source};
use fredholm::{Equation, Error, Estimate, Method, Walk, check};

/// ½e^{−|x−y|}, the flight of a particle through matter that always scatters.
struct Flight(Interval);

#[rustfmt::skip]
mod capabilities {
    use super::*;
    impl Operator for Flight { type Point = f64; type Weight = f64; }
    // collision, fixed depth
    impl Transition for Flight {
        fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
            let [side, distance] = u.next_2d();
            let y = x + (side - 0.5).signum() * -distance.ln();
            self.0.contains(&y).then(|| Step::with_pdf(y, 1.0, self.pdf(x, &y)))
        }
    }
    // absorption: the probability to leave, the mass of K outside [0, 1]
    impl Absorbing for Flight { fn absorption(&self, x: &f64) -> f64 { 0.5 * ((-x).exp() + (x - 1.0).exp()) } }
    impl Kernel for Flight { fn eval(&self, x: &f64, y: &f64) -> f64 { 0.5 * (-(x - y).abs()).exp() } }
    // multiple importance sampling
    impl TransitionPdf for Flight { fn pdf(&self, x: &f64, y: &f64) -> f64 { self.eval(x, y) } }
    // subcritical
    impl RowMass for Flight { fn mass(&self, x: &f64) -> f64 { 1.0 - self.absorption(x) } }
    // Kernel and HasDomain: next event, Nyström, proposals, the check that the series converges
    impl HasDomain for Flight { type Domain = Interval; fn domain(&self) -> &Interval { &self.0 } }
}

/// g = 1, with points as seen from x: q(y given x) ∝ e^{−|x−y|} on [0, 1].
struct Glow;

#[rustfmt::skip]
impl Source for Glow { type Point = f64; type Value = f64; fn eval(&self, _: &f64) -> f64 { 1.0 } }

impl SampleSource for Glow {
    fn sample_for<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Node<f64>> {
        // the masses 1 − e^{−x} on the left and 1 − e^{−(1−x)} on the right share the coordinate
        let (left, right) = (-(-x).exp_m1(), -(x - 1.0).exp_m1());
        let t = u.next_1d() * (left + right) - left;
        let y = (x - t.signum() * (-t.abs()).ln_1p()).clamp(0.0, 1.0);
        Some(Node { point: y, weight: 1.0 / self.pdf_for(x, &y) })
    }
    fn pdf_for(&self, x: &f64, y: &f64) -> f64 {
        (-(x - y).abs()).exp() / (2.0 - (-x).exp() - (x - 1.0).exp())
    }
}

fn main() -> Result<(), Error> {
    let n = std::env::args().skip_while(|a| a != "--samples").nth(1).map_or(1 << 16, |n| n.parse().expect("a whole number"));
    let eq = Equation::new(Glow, Flight(Interval::from(0.0..=1.0)));
    // does it keep its laws? a broken one would be named, with the place and the numbers
    println!("equation: {}", check::equation(&eq, check::Settings::default())?);
    println!("row mass: {}\n", check::row_mass(eq.kernel(), check::Settings::default())?);
    let methods: [(&str, &dyn Method<_, _, _, Solution = Estimate>); 5] = [
        ("collision", &Walk::collision().samples_per_cell(n)),
        ("absorption", &Walk::absorption().samples_per_cell(n)),
        ("subcritical (dies twice)", &Walk::subcritical().samples_per_cell(n)),
        ("next event", &Walk::next_event().samples_per_cell(n)),
        ("MIS", &Walk::mis().samples_per_cell(n)),
    ];
    println!("exact f(0.3) = 1.605\n{:26}{:16}{:>8}{:>14}", "method", "f(0.3)", "z", "efficiency");
    for (name, method) in methods {
        let f = eq.at(0.3).solve(method)?;
        println!("{name:26}{f:16}{:8.2}{:14.3}", f.z_score(1.605).unwrap_or(0.0), f.efficiency().unwrap_or(f64::INFINITY));
    }
    Ok(())
}
