//! Solves equations written as text: f(x) = g(x) + ∫ K(x, y) f(y) dy from JSON files, by random walks and by deterministic methods, and compares
//! them with the values the files know.
//!
//! ```text
//! cargo run --release --example solve -- FILE|FOLDER… [--walks METHOD…] [--deterministic METHOD…] [--tolerance ε]
//!                                        [--samples N] [--seed S] [--all-points] [--csv OUT] [--plot OUT.svg]
//! ```
//!
//! One line for each file and method, at the point where it is worst; the last line is `N passed, N failed`. A walk fails if it is further from a
//! known value than chance allows in the *whole* run (one false alarm in a million runs, Šidák's correction, Student's t); a deterministic method
//! fails if it is further than the error it reports.

#![allow(clippy::print_stdout, clippy::print_stderr)]

mod any;
mod deterministic;
mod options;
mod plot;
mod replace;
mod report;
mod rules;
mod spectrum;
mod walks;

use any::{AnyLine, AnyPlane};
use fredholm::Error;
use fredholm::formula::{Problem, Stated, Statement};
use options::Options;
use report::{Judge, Line, Outcome, Tally};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    sigpipe::reset();
    let options = match Options::parse(std::env::args().skip(1)) {
        Ok(options) => options,
        Err(message) => {
            eprintln!("{message}\n\n{}", options::USAGE);
            return ExitCode::from(2);
        }
    };
    match run(&options) {
        Ok(tally) => {
            println!("{} refused, {} not stated", tally.refused, tally.not_stated);
            println!("{} passed, {} failed", tally.passed, tally.failed);
            if tally.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

fn run(options: &Options) -> Result<Tally, String> {
    let problems: Vec<_> = files(&options.paths)?.into_iter().map(|path| (Problem::read(&path), path)).collect();
    let stated = problems.iter().filter_map(|(p, _)| p.as_ref().ok());
    let comparisons: usize = stated.map(|p| known_values(p) * options.walks.len()).sum();
    let judge = Judge::new(comparisons, options);
    let (mut tally, mut lines) = (Tally::default(), Vec::new());
    println!("{}", Line::HEADER);
    for (problem, path) in &problems {
        let name = path.file_stem().map_or_else(|| path.display().to_string(), |s| s.to_string_lossy().into_owned());
        match problem {
            Ok(problem) => {
                for line in solve(&name, problem, options) {
                    line.print(&judge);
                    tally.count(&line, &judge);
                    lines.push(line);
                }
            }
            Err(e @ Error::Formula(_)) => {
                if !options.deterministic.is_empty()
                    && let Some(found) = spectrum::lines(&name, path, options)
                {
                    for line in found {
                        line.print(&judge);
                        tally.count(&line, &judge);
                        lines.push(line);
                    }
                    continue;
                }
                println!("{name:<44} refused: {e}");
                tally.not_stated += 1;
            }
            Err(e) => {
                println!("{name:<44} FAILED: {e}");
                tally.failed += 1;
            }
        }
    }
    if let Some(path) = &options.csv {
        replace::replace(path, report::csv(&lines, &judge).map_err(|e| e.to_string())?)?;
        println!("all numbers: {}", path.display());
    }
    if let Some(path) = &options.plot {
        replace::replace(path, plot::errors(&lines).map_err(|e| format!("{}: {e}", path.display()))?)?;
        println!("errors of all methods: {}", path.display());
    }
    Ok(tally)
}

/// The files given, and the `*.json` of folders in alphabetical order.
fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = std::fs::read_dir(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let mut inside: Vec<_> = entries.filter_map(|e| Some(e.ok()?.path())).filter(|p| is_json(p)).collect();
        if inside.is_empty() {
            return Err(format!("{}: no *.json in this folder", path.display()));
        }
        inside.sort();
        files.append(&mut inside);
    }
    Ok(files)
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

/// How many numbers of a file a method can be compared with.
fn known_values(problem: &Problem) -> usize {
    struct Count;
    impl fredholm::formula::Visitor for Count {
        type Output = usize;
        fn visit<D: fredholm::domain::Domain>(&mut self, s: &fredholm::formula::Stated<D>) -> usize {
            s.points.iter().filter(|p| p.value.is_some()).count() + s.functionals.iter().filter(|f| f.value.is_some()).count()
        }
    }
    problem.statement.visit(&mut Count)
}

fn on_a_line(stated: &Stated<AnyLine>, options: &Options) -> Vec<Outcome> {
    both(walks::on_a_line(stated, options), deterministic::all(stated, options))
}

fn in_a_plane(stated: &Stated<AnyPlane>, options: &Options) -> Vec<Outcome> {
    both(walks::in_a_box(stated, options), deterministic::all(stated, options))
}

fn both(mut walks: Vec<Outcome>, deterministic: Vec<Outcome>) -> Vec<Outcome> {
    walks.extend(deterministic);
    walks
}

fn solve(name: &str, problem: &Problem, options: &Options) -> Vec<Line> {
    let outcomes: Vec<Outcome> = match &problem.statement {
        Statement::Interval(s) => on_a_line(&s.on((*s.domain()).into()), options),
        Statement::HalfLine(s) => on_a_line(&s.on((*s.domain()).into()), options),
        Statement::Line(s) => on_a_line(&s.on((*s.domain()).into()), options),
        Statement::System(s) => both(walks::on_a_line(s, options), deterministic::all(s, options)),
        Statement::Disk(s) => in_a_plane(&s.on((*s.domain()).into()), options),
        Statement::Box2(s) => in_a_plane(&s.on((*s.domain()).into()), options),
        Statement::Box3(s) => both(walks::in_a_box(s, options), deterministic::all(s, options)),
        Statement::Box8(s) => both(walks::in_a_box(s, options), deterministic::refused(options)),
        Statement::Box64(s) => both(walks::in_a_box(s, options), deterministic::refused(options)),
        _ => Vec::new(),
    };
    let line =
        |outcome| Line { file: name.into(), class: problem.class.clone().unwrap_or_else(|| "-".into()), digits: problem.digits, outcome };
    outcomes.into_iter().map(line).collect()
}
