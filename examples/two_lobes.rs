//! Two lobes, after Veach's famous picture: a highlight times a lamp, each sampled well by its own technique, and neither alone for both.
//!
//! Integral: I(w) = ∫₋₁¹ a(x) b(x) dx, a = the highlight's lobe of width 0.03 + a constant, b = a lamp of width w with soft edges, w from 0.002 to 1.
//! Answer: by quadrature; the relative standard error of one sample of each technique, or of both combined, against w.
//!
//! `cargo run --release --example two_lobes -- [--samples 4096]`
#![allow(clippy::print_stdout)]

use fredholm::integral::{Combined, Density, Gauss, Integral, Secondary, inverse};
use fredholm::{Error, Estimate, plot::Convergence, walk::Heuristic};

fn option(name: &str, default: u64) -> u64 {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a whole number, not {v}")))
}

/// Cauchy's density of the given width on [−1, 1], by inversion.
fn lobe(width: f64) -> impl Density<f64> + Clone + std::fmt::Debug + 'static {
    let end = (1.0 / width).atan();
    let pdf = move |x: &f64| 0.5 * width / (end * (width * width + x * x));
    inverse(move |u: f64| width * (end * (2.0 * u - 1.0)).tan(), pdf)
}

fn main() -> Result<(), Error> {
    let samples = option("--samples", 4096);
    let highlight = lobe(0.03);
    let names = ["highlight alone", "lamp alone", "average", "maximum", "balance", "power, β = 2", "optimal"];
    let mut measured: Vec<Vec<(f64, f64)>> = vec![Vec::new(); names.len()];
    println!("{:>8}  {}", "w", names.map(|n| format!("{n:>17}")).join(""));
    for step in 0..=16 {
        let w = 0.002 * 500f64.powf(f64::from(step) / 16.0);
        let (a, lamp) = (highlight.clone(), lobe(w));
        let b = lamp.clone();
        // the lamp is flat inside its width and falls off fast: neither density is proportional to the product
        let integral = Integral::on_interval(-1.0..=1.0, move |x: f64| (a.pdf(&x) + 0.05) * b.pdf(&x) * (-(x / w).powi(4)).exp());
        let truth = integral.solve(&Gauss::legendre(4096, 8))?;
        // both techniques give one sample to a score: alone, they get two
        let both = |c: Combined<f64>| {
            integral.solve(&Secondary::combined(c.technique(highlight.clone(), 1).technique(lamp.clone(), 1)).samples(samples))
        };
        let results: [Estimate; 7] = [
            integral.solve(&Secondary::importance(highlight.clone()).samples(2 * samples))?,
            integral.solve(&Secondary::importance(lamp.clone()).samples(2 * samples))?,
            both(Combined::new(Heuristic::Average))?,
            both(Combined::new(Heuristic::Maximum))?,
            both(Combined::new(Heuristic::Balance))?,
            both(Combined::new(Heuristic::Power(2.0)))?,
            both(Combined::optimal(1000))?,
        ];
        let error = |e: &Estimate| e.std_error.unwrap_or(f64::NAN) * (2.0 * samples as f64).sqrt() / truth;
        println!("{w:8.4}  {}", results.each_ref().map(|e| format!("{:>17.4}", error(e))).join(""));
        results.iter().zip(&mut measured).for_each(|(e, m)| m.push((w, error(e))));
        assert!(results.iter().all(|e| e.agrees_with(truth, 6.0)), "{truth}: {results:?}");
    }
    let mut plot = Convergence::against("Two lobes: combined sampling", "width of the lamp w (highlight: 0.03)")
        .subtitle("relative standard error of one evaluation")
        .error_label("relative standard error · √evaluations")
        .slopes(&[]);
    for (name, points) in names.iter().zip(measured) {
        plot = plot.series(name, points);
    }
    plot.save("target/plots/two-lobes.png")?;
    println!("wrote target/plots/two-lobes.png");
    Ok(())
}
