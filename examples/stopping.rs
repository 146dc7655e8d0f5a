//! Stop at a target error, with a bar, and survive an interruption: the rounds of a run belong to you.
//!
//! Equation: f(x) = g(x) + ∫₀¹ ½(x+1)e^{−xy} f(y) dy, g(x) = e^{−x} − ½ + ½e^{−(x+1)}. Answer: f(x) = e^{−x}, at x = ½ therefore 0.606530….
//!
//! `cargo run --release --example stopping -- [--error 0.0005] [--samples 16777216]`
#![allow(clippy::print_stdout)]

use fredholm::{Equation, Walk, statistics::Target};
use indicatif::{ProgressBar, ProgressStyle};
use std::{error, fs, str::FromStr};

fn option<T: FromStr>(name: &str, default: T) -> T {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} needs a number, not {v}")))
}

fn main() -> Result<(), Box<dyn error::Error>> {
    let g = |x: f64| (-x).exp() - 0.5 + 0.5 * (-(x + 1.0)).exp();
    let eq = Equation::on_interval(0.0..=1.0, g, |x: f64, y: f64| 0.5 * (x + 1.0) * (-x * y).exp());
    let (query, walk) = (eq.at(0.5), Walk::next_event().samples_per_cell(option("--samples", 1 << 24)));
    let target = Target::absolute(option("--error", 5e-4))?.confidence(0.95)?;

    // a run that is interrupted after three rounds: leaving the loop is all it takes
    let mut rounds = query.rounds(&walk)?;
    for round in rounds.by_ref().take(3) {
        let round = round?;
        println!("round {}: f(½) = {}", round.number, round.estimates);
    }
    let file = "target/plots/stopping.json";
    let (state, at) = (serde_json::to_string_pretty(&rounds.checkpoint())?, |e| format!("{file}: {e}"));
    fs::create_dir_all("target/plots").map_err(at)?;
    // written beside and renamed: whenever the program is killed, a whole state is there
    fs::write("target/plots/stopping.part", state).and_then(|()| fs::rename("target/plots/stopping.part", file)).map_err(at)?;
    println!("interrupted; state saved in {file}");

    // perhaps on another day: read the state and go on until the interval is short enough
    let saved = serde_json::from_str(&fs::read_to_string(file).map_err(at)?)?;
    let bar = ProgressBar::new(1000).with_style(ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")?);
    let mut answer = None;
    for round in query.rounds(&walk)?.resume(saved)? {
        let round = round?;
        let progress = target.progress(&round.estimates);
        bar.set_position((1000.0 * progress.fraction) as u64);
        bar.set_message(format!("{} ± {:.1e}, wanted {:.1e}", round.estimates.value, progress.half_width, progress.wanted));
        let done = progress.met;
        answer = Some((round, progress));
        if done {
            break;
        }
    }
    bar.abandon();
    let (round, progress) = answer.ok_or("the budget was spent before the interruption")?;

    let (f, exact) = (&round.estimates, (-0.5f64).exp());
    println!("{} after {} walks", if progress.met { "target met" } else { "budget spent, target missed" }, round.samples);
    println!(
        "f(½) = {:.6} ± {:.6} (95 %, valid at any stopping time); exact {exact:.6}, error {:+.1e}",
        f.value,
        progress.half_width,
        f.value - exact
    );

    // the interruption left no trace: an uninterrupted run of as many walks gives the same bits
    let again = query.solve(&walk.samples_per_cell(round.samples))?;
    assert_eq!(again.value.to_bits(), f.value.to_bits());
    println!("an uninterrupted run of {} walks gives the same bits", round.samples);
    Ok(())
}
