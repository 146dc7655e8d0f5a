//! Stress: what must never be answered wrongly, and what must survive.

mod cases;
#[path = "../common/mod.rs"]
mod common;
mod faults;

use cases::{Scale, rows};

/// Zero silent wrong answers.
#[test]
fn every_input_is_answered_within_its_error_or_refused() {
    let wrong: Vec<String> = rows()
        .iter()
        .map(|row| (row, (row.run)(Scale::TEST)))
        .filter(|(row, happened)| !happened.is_right(row.should))
        .map(|(row, happened)| format!("{}, {}: {} (should: {:?})", row.input, row.method, happened.describe(), row.should))
        .collect();
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}
