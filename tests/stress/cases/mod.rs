//! Inputs at the edge of what numbers can do, and what must come of them: an answer with a true error, or a refusal by name.

#![allow(unreachable_pub, unused_imports, reason = "a module of the example `stress`")]

mod kernels;
mod numbers;
mod table;

pub use table::{Happened, Known, Row, Scale, Should, all_ways, known};

use crate::common::Reference;

/// All rows of the table.
pub fn rows() -> Vec<Row> {
    let mut rows = kernels::rows();
    rows.extend(numbers::rows());
    rows
}

/// The middle one of a reference problem's points, and f there.
fn middle(reference: &str) -> (f64, f64) {
    let known = Reference::load(reference).scalar();
    known[known.len() / 2]
}
