//! What happens at the edge? A table of hard inputs: near-critical, singular, huge, tiny, cancelling, oscillating, heavy-tailed, far away.
//!
//! Equation: f(x) = g(x) + ∫ K(x, y) f(y) dy for a hundred hard K and g. Answer: for each, the value with its error, or the refusal; none may be wrong
//! without saying so. `--small` is what the test `stress` runs.
//!
//! `cargo run --release --example stress -- [--small] [--out target/stress.md]`
#![allow(clippy::print_stdout)]

#[path = "../tests/stress/cases/mod.rs"]
mod cases;
#[path = "../tests/common/mod.rs"]
mod common;

use cases::{Scale, rows};
use std::fmt::Write;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    sigpipe::reset();
    let small = std::env::args().any(|a| a == "--small");
    let out = std::env::args().skip_while(|a| a != "--out").nth(1);
    let scale = if small { Scale::TEST } else { Scale::FULL };
    let mut table = String::from("| input | method | what happened | what should |\n|---|---|---|---|\n");
    let (mut wrong, mut blind) = (0, 0);
    for row in rows() {
        let clock = Instant::now();
        let happened = (row.run)(scale);
        let right = happened.is_right(row.should);
        wrong += usize::from(!right);
        blind += usize::from(happened.is_blind(row.should));
        let mark = match (right, happened.is_blind(row.should)) {
            (false, _) => " **WRONG**",
            (_, true) => " **blind, and says so**",
            _ => "",
        };
        let seconds = clock.elapsed().as_secs_f64();
        let cell = |text: &str| text.replace('|', "\\|");
        let (input, what) = (cell(&row.input), cell(&happened.describe()));
        let line = format!("| {input} | {} | {what}{mark} | {:?} |", row.method, row.should);
        println!("{line} {seconds:.2} s");
        let _ = writeln!(table, "{line}");
    }
    println!("{wrong} wrong; {blind} blind to what is narrower than they say");
    if let Some(path) = out
        && let Err(e) = std::fs::write(&path, table)
    {
        println!("{path}: {e}");
        return ExitCode::FAILURE;
    }
    if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
