//! From the source or from the detector? What a walk should start from depends on which of the two is small.
//!
//! Equation: f(x) = g(x) + ½ ∫₀¹ e^{−4|x − y|} f(y) dy; g = 1/w on a lamp of width w around ¼, h = 1/v on a window of width v around ¾.
//! Answer: ⟨h, f⟩ = ⟨φ, g⟩ by four walks, and their efficiency as the lamp shrinks and as the window does.
//!
//! `cargo run --release --example directions -- [--walks 50000]`
#![allow(clippy::print_stdout)]

use fredholm::detector::Functional;
use fredholm::domain::{Domain, Interval, Node};
use fredholm::kernel::{Proposed, Uniform, kernel_fn};
use fredholm::plot::Convergence;
use fredholm::sampling::Sampler;
use fredholm::source::{Birth, Emit, SampleSource, Source};
use fredholm::{Equation, Error, Estimate, Forward, Walk};

/// 1/w on an interval of width w, sampled there alone.
#[derive(Clone, Copy, Debug)]
struct Lamp(Interval);

impl Source for Lamp {
    type Point = f64;
    type Value = f64;
    fn eval(&self, x: &f64) -> f64 {
        self.0.density(x)
    }
}

impl SampleSource for Lamp {
    fn sample_for<S: Sampler>(&self, _: &f64, u: &mut S) -> Option<Node<f64>> {
        Some(self.0.sample(u))
    }
    fn pdf_for(&self, _: &f64, y: &f64) -> f64 {
        self.0.density(y)
    }
}

impl Emit for Lamp {
    type State = f64;
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<f64, f64> {
        Birth { point: self.0.sample(u).point, weight: 1.0 }
    }
}

fn around(middle: f64, width: f64) -> Interval {
    Interval::from(middle - 0.5 * width..=middle + 0.5 * width)
}

fn main() -> Result<(), Error> {
    let walks = std::env::args().skip_while(|a| a != "--walks").nth(1).map_or(50_000, |n| n.parse().expect("a whole number"));
    let unit = Interval::from(0.0..=1.0);
    let names = ["backward, collision", "backward, next event", "forward, collision", "forward, next event"];
    for (what, narrow) in [("lamp", [true, false]), ("window", [false, true]), ("lamp and window", [true, true])] {
        let mut series: [Vec<(f64, f64)>; 4] = Default::default();
        println!("\n{:>16} {}", format!("{what} w"), names.map(|n| format!("{n:>22}")).concat());
        for step in 0..=8 {
            let width = 0.5 * 0.4f64.powi(step);
            let [w, v] = narrow.map(|n| if n { width } else { 0.5 });
            let kernel = kernel_fn(unit, |x: &f64, y: &f64| 0.5 * (-4.0 * (x - y).abs()).exp());
            let eq = Equation::new(Lamp(around(0.25, w)), Proposed::new(kernel, Uniform::on(unit)));
            let window = Functional::new(around(0.75, v), move |_: &f64| 1.0 / v);
            let q = eq.seen_by(&window);
            let results: [Estimate; 4] = [
                q.solve(&Walk::collision().samples_per_cell(walks))?,
                q.solve(&Walk::next_event().samples_per_cell(walks))?,
                q.solve(&Forward::new().walks(walks))?,
                q.solve(&Forward::next_event().walks(walks))?,
            ];
            println!("{width:16.5} {}", results.each_ref().map(|e| format!("{:>22}", e.to_string())).concat());
            // both directions see one number: each agrees with the best of them
            let best = results[1].value;
            assert!(results.iter().all(|e| e.std_error.is_none() || e.agrees_with(best, 6.0)), "{results:#?}");
            let error = |e: &Estimate| e.efficiency().filter(|_| e.moments.nonzero > 20).map(|f| 1.0 / (f.sqrt() * best));
            results.iter().zip(&mut series).for_each(|(e, s)| s.extend(error(e).map(|error| (width, error))));
        }
        let mut plot = Convergence::against(&format!("⟨h, f⟩ as the {what} shrinks"), "width")
            .subtitle("K = ½ e^{−4|x − y|}: lower is better")
            .error_label("relative standard error · √evaluations")
            .slopes(&[]);
        for (name, points) in names.iter().zip(series) {
            plot = plot.series(name, points);
        }
        plot.save(format!("target/plots/directions-{}.png", what.replace(' ', "-")))?;
    }
    println!("\nwrote target/plots/directions-*.png");
    Ok(())
}
