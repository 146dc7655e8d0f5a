//! Tables on the terminal.

use crate::Row;
use crate::options::{Options, SourceChoice};
use crate::truth::Truth;
use fredholm::statistics::Verdict;
use fredholm::transport::{Flux, Outcome};
use fredholm::{Error, Estimate};

pub(crate) fn heading(options: &Options) {
    let source = match options.source {
        SourceChoice::Uniform => "S = 1".to_string(),
        SourceChoice::Ramp => "S = x/a".to_string(),
        SourceChoice::Beam(cosine) => format!("S = exp(−x/{cosine})"),
    };
    println!(
        "φ(x) = S(x) + (c/2) ∫₀ᵃ E₁(|x − y|) φ(y) dy      c = {}, a = {} mean free paths, {source}\n",
        options.ratio, options.thickness
    );
}

pub(crate) fn nystrom(truth: &Truth, xs: &[f64]) {
    println!("{:28}{}", "", columns(xs, |x| format!("x = {x}")));
    if truth.stored {
        println!("{:28}{}", "stored reference", columns(&truth.values, |v| format!("{v:.14}")));
    }
    println!("{:28}{}", format!("Nyström, {} unknowns", truth.unknowns), columns(&truth.nystrom, |v| format!("{v:.14}")));
    let from = if truth.stored { "the stored values" } else { "Nyström" };
    println!(
        "{:28}error ≤ {:.1e} by its residual, {:.0} ms; z-scores below refer to {from}\n",
        "",
        truth.error,
        truth.elapsed.as_secs_f64() * 1e3
    );
}

fn columns<T>(items: &[T], text: impl Fn(&T) -> String) -> String {
    items.iter().map(|i| format!("{:<20}", text(i))).collect()
}

pub(crate) fn table_head(xs: &[f64], samples: u64) {
    let points: String = xs.iter().map(|x| format!("{:<15}{:>5} ", format!("x = {x}"), "z")).collect();
    println!("{samples} walks a point{:1$}", "", 28usize.saturating_sub(format!("{samples} walks a point").len()));
    println!("{:28}{points}{:>9}{:>10}{:>10}", "method", "walks/s", "1/(V·W)", "1/(V·T)");
    println!("{}", "─".repeat(28 + 21 * xs.len() + 29));
}

/// Walks a second, and the efficiencies at the last point: for each kernel evaluation and for each second of all points' walks.
pub(crate) fn rates(estimates: &[Estimate]) -> Option<(f64, f64, f64)> {
    let last = estimates.last()?;
    let walks: u64 = estimates.iter().map(Estimate::samples).sum();
    let seconds = last.elapsed.as_secs_f64() / walks as f64;
    Some((1.0 / seconds, last.efficiency()?, 1.0 / (last.variance()? * seconds)))
}

pub(crate) fn row(row: &Row, truth: &[f64]) {
    let estimates = match &row.answer {
        Ok(estimates) => estimates,
        Err(error) => return println!("{:28}refused: {error}", row.name),
    };
    let cell = |(e, t): (&Estimate, &f64)| {
        let z = e.z_score(*t).map_or("–".to_string(), |z| format!("{z:+.1}"));
        format!("{:<15}{z:>5} ", e.to_string())
    };
    let cells: String = estimates.iter().zip(truth).map(cell).collect();
    let (speed, per_evaluation, per_second) = rates(estimates).unwrap_or((f64::NAN, f64::NAN, f64::NAN));
    println!("{:28}{cells}{speed:>9.2e}{per_evaluation:>10.2e}{per_second:>10.2e}", row.name);
}

pub(crate) fn legend(rows: &[Row]) {
    println!("value(standard error in the last digits); z = (value − reference)/error. At the last x: V variance of a walk,");
    println!(
        "W kernel evaluations a walk, T seconds a walk. * The slab's own subcritical sampling: survival M(x), next point ∝ K, weights 1."
    );
    for row in rows {
        let bounds = row.answer.iter().flatten().filter_map(|e| e.truncation?.bias_bound);
        if let Some(bound) = bounds.reduce(f64::max) {
            println!("{}: biased by at most {bound:.1e}, not part of the error.", row.name);
        }
    }
    let worst = |row: &Row| row.answer.iter().flatten().map(Estimate::verdict).max();
    for verdict in [Verdict::Doubtful, Verdict::NothingScored, Verdict::InfiniteVariance] {
        let names: Vec<_> = rows.iter().filter(|r| worst(r) == Some(verdict)).map(|r| r.name.as_str()).collect();
        if !names.is_empty() {
            println!("{verdict}: {}", names.join("; "));
        }
    }
}

pub(crate) fn forward(truth: &Truth, run: Result<Outcome<(Flux, Flux)>, Error>) {
    let run = match run {
        Ok(run) => run,
        Err(error) => return println!("\nforward histories refused: {error}"),
    };
    let n = run.histories as f64;
    println!(
        "\n{} forward analog histories, {:.1e} a second: {:.2} % captured, {:.2} % left, {:.2} % right; {:.2} collisions a history",
        run.histories,
        n / run.elapsed.as_secs_f64(),
        100.0 * run.captured.count as f64 / n,
        100.0 * run.left.count as f64 / n,
        100.0 * run.right.count as f64 / n,
        run.collisions as f64 / n
    );
    let (collision, track) = &run.flux;
    let bin = collision.grid().bins() / 2;
    let edges = [bin, bin + 1].map(|i| collision.grid().edge(i));
    let flux = truth.mean_flux(edges[0], edges[1]);
    let between = format!("Φ in [{}, {}]", edges[0], edges[1]);
    for (name, e, truth) in [
        ("leakage through x = 0".to_string(), &run.left.rate, truth.leakage[0]),
        ("leakage through x = a".to_string(), &run.right.rate, truth.leakage[1]),
        (format!("{between}, collisions"), &collision.bins()[bin], flux),
        (format!("{between}, track length"), &track.bins()[bin], flux),
    ] {
        let z = e.z_score(truth).map_or("–".to_string(), |z| format!("{z:+.1}"));
        println!("{name:32}{:<16}Nyström {truth:<12.8} z {z}", e.to_string());
    }
}
