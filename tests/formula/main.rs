//! Equations as text: formulas, files, refusals, and solutions that agree with what the files know.
#![cfg(feature = "formula")]

#[path = "../common/erased.rs"]
mod erased;

mod expressions;
mod files;
mod malformed;
mod solutions;
mod tabulated;

use fredholm::formula::{Problem, Statement};

/// The folder of equations with known solutions.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/reference");

fn read(name: &str) -> Problem {
    Problem::read(format!("{FOLDER}/{name}.json")).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The equation of a file on an interval.
fn interval(problem: &Problem) -> &fredholm::formula::Stated<fredholm::domain::Interval> {
    match &problem.statement {
        Statement::Interval(s) => s,
        other => panic!("{} is not on an interval: {other:?}", problem.name),
    }
}
