//! Profile, convergence, efficiencies.

use crate::methods::Entry;
use crate::options::Options;
use crate::report::rates;
use crate::truth::Truth;
use crate::{Row, methods};
use fredholm::plot::{Comparison, Convergence, Profile};
use fredholm::{Error, Estimate};
use std::path::PathBuf;

const SHOWN: [&str; 4] = ["collision, analog*", "MIS balance, analog", "absorption, analog", "implicit capture, P = 4|W|"];

fn shown<'a>(methods: &'a [Entry<'a>]) -> impl Iterator<Item = &'a methods::Entry<'a>> {
    methods.iter().filter(|m| SHOWN.contains(&m.name.as_str()))
}

fn save(options: &Options, name: &str, plot: impl Fn(PathBuf) -> Result<(), Error>) -> Result<(), Error> {
    ["svg", "png"].into_iter().try_for_each(|extension| plot(options.plots.join(format!("slab-{name}.{extension}"))))
}

fn profile(options: &Options, truth: &Truth, methods: &[Entry], samples: u64) -> Result<(), Error> {
    let a = options.thickness;
    let xs: Vec<f64> = (0..=10).map(|i| f64::from(i) * 0.1 * a).collect();
    let mut plot = Profile::new(&format!("Slab, c = {}, a = {a}", options.ratio), 0.0..=a)
        .subtitle(&format!("{} walks a point", samples / 8))
        .x_label("x / mean free paths")
        .y_label("φ")
        .curve("Nyström", &truth.profile);
    for method in shown(methods).take(2) {
        plot = plot.estimates(&method.name, &xs, &(method.solve)(&xs, samples / 8)?);
    }
    save(options, "profile", |path| plot.save(path))
}

/// Root mean square over the points of the relative error.
fn error(estimates: &[Estimate], truth: &[f64]) -> f64 {
    let sum: f64 = estimates.iter().zip(truth).map(|(e, t)| (e.value / t - 1.0).powi(2)).sum();
    (sum / truth.len() as f64).sqrt()
}

fn convergence(options: &Options, truth: &Truth, methods: &[Entry], samples: u64) -> Result<(), Error> {
    let title = format!("Slab, c = {}, a = {}", options.ratio, options.thickness);
    let axis = |plot: Convergence| plot.subtitle("root mean square over four points").error_label("relative error");
    let mut by_walks = axis(Convergence::against_samples(&title));
    let mut by_time = axis(Convergence::against_time(&title));
    for method in shown(methods) {
        let (mut walks, mut times) = (Vec::new(), Vec::new());
        let mut n = samples / 256;
        while n <= samples {
            let estimates = (method.solve)(&options.points(), n.max(2))?;
            let e = error(&estimates, &truth.values);
            walks.push((n as f64, e));
            times.push((estimates[0].elapsed.as_secs_f64(), e));
            n *= 2;
        }
        by_walks = by_walks.series(&method.name, walks);
        by_time = by_time.series(&method.name, times);
    }
    save(options, "convergence", |path| by_walks.save(path))?;
    save(options, "convergence-time", |path| by_time.save(path))
}

fn efficiency(options: &Options, rows: &[Row]) -> Result<(), Error> {
    let mut plot = Comparison::new(&format!("Slab, c = {}, a = {}", options.ratio, options.thickness), "efficiency 1/(V·T) / s⁻¹");
    for row in rows {
        plot = match row.answer.as_ref().map(|e| rates(e)) {
            Ok(Some((_, _, per_second))) if per_second.is_finite() => plot.bar(&row.name, per_second),
            Ok(_) => plot.missing(&row.name, "variance unknown or zero"),
            Err(_) => plot.missing(&row.name, "refused"),
        };
    }
    save(options, "efficiency", |path| plot.save(path))
}

pub(crate) fn draw(options: &Options, truth: &Truth, rows: &[Row], methods: &[Entry], samples: u64) -> Result<(), Error> {
    profile(options, truth, methods, samples)?;
    convergence(options, truth, methods, samples)?;
    efficiency(options, rows)?;
    println!("\nplots: {}/slab-{{profile,convergence,convergence-time,efficiency}}.{{svg,png}}", options.plots.display());
    Ok(())
}
