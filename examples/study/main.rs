//! Which method is fastest to an accuracy? Problems × methods: true error against wall time and against evaluations of the kernel.
//!
//! Equation: f(x) = g(x) + ∫ K(x, y) f(y) dμ(y) for a dozen kernels of known f (smooth, peaked, oscillating, singular, long walks), and four scenes.
//! Answer: `study.csv`, two plots a problem, and `study.md`: the fastest method to 1e-2, 1e-4, 1e-6, 1e-9.
//!
//! `cargo run --release --example study -- [--small] [--out DIR] [--peers FILE] [--problem NAME|FILE.json] [--no-scenes]`: half an hour, or with `--small`
//! and one problem some seconds.
//!
//! Walks find f at one point (root mean square of the true error over seeds), solves find f everywhere (largest true error over the points known);
//! both are relative to max |f|. Every method is called as a user would, its set-up is in its time. Times of rules that are not adaptive are those
//! of the cheapest rule that turned out to be accurate enough: nobody knows it beforehand.
#![allow(clippy::print_stdout, clippy::print_stderr)]

#[path = "../solve/any.rs"]
#[allow(dead_code, reason = "planes are not studied")]
mod any;
mod boxes;
mod curve;
mod options;
mod peers;
mod problem;
mod problems;
#[path = "../solve/replace.rs"]
mod replace;
mod report;
#[path = "../solve/rules.rs"]
mod rules;
mod scenes;
#[path = "../../tests/sampling/any.rs"]
#[allow(dead_code, reason = "not all sequences are studied")]
mod sequences;
mod solves;
mod walks;

use fredholm::{Equation, Walk};
use options::{Options, Scenes};
use peers::Peers;
use problem::Problem;
use std::process::ExitCode;
use std::time::Instant;

fn study(options: &Options) -> Result<Vec<Problem>, String> {
    let mut peers = Peers::default();
    for path in &options.peers {
        let skipped = peers.read(path)?;
        println!("{}: {skipped} lines that are no measurements", path.display());
    }
    // threads start with the first solve: in the set-up of no method
    Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y).at(0.5).solve(&Walk::collision()).map_err(|e| e.to_string())?;
    let (clock, mut problems, mut unwritten) = (Instant::now(), Vec::new(), None);
    // as they come: who breaks off has what was finished, and a full disk ends nothing
    let mut done = |problem: Problem| {
        println!("{:7.1} s  {}: {} methods", clock.elapsed().as_secs_f64(), problem.name, problem.curves.len());
        problems.push(problem);
        unwritten = write(options, &problems).err().or(unwritten.take());
    };
    for case in problems::cases(&options.problems)? {
        let mut curves = walks::all(&case, options.effort);
        curves.extend(solves::all(&case, options.effort));
        curves.extend(peers.curves(case.peer, case.scale()));
        done(Problem { name: case.name, class: case.class, curves });
    }
    let wanted = |name: &&str| options.problems.is_empty() || options.problems.iter().any(|p| p == name);
    for name in boxes::NAMES.into_iter().filter(wanted) {
        done(boxes::problem(name, options.effort)?);
    }
    for scene in scenes::SCENES.iter().filter(|s| options.scenes == Scenes::With && wanted(&s.name)) {
        done(scene.problem(options.effort, &peers)?);
    }
    println!("\n{}", report::table(&problems));
    if let Some(fault) = unwritten {
        return Err(fault);
    }
    println!("wrote study.csv, study.md and plots to {}", options.out.display());
    Ok(problems)
}

/// All tables anew, and the pictures of the last problem.
fn write(options: &Options, problems: &[Problem]) -> Result<(), String> {
    let folder = &options.out;
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    replace::replace(&folder.join("study.csv"), report::csv(problems))?;
    replace::replace(&folder.join("study.md"), report::table(problems))?;
    problems.last().map_or(Ok(()), |p| report::plots(p, folder)).map_err(|e| e.to_string())
}

fn main() -> ExitCode {
    sigpipe::reset();
    let run = || {
        let options = Options::parse(std::env::args().skip(1))?;
        let problems = study(&options)?;
        match report::too_sure(&problems) {
            wrong if wrong.is_empty() => Ok(()),
            wrong => Err(format!("errors larger than reported:\n{}", wrong.join("\n"))),
        }
    };
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
