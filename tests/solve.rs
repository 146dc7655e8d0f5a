//! Every equation of `tests/data/reference` by every method of the example `solve`, judged as a user would judge it: a walk may be no further from a
//! stored value than chance allows once in a million *runs*, a deterministic method no further than the error it reports.
//!
//! Refusals are no failures (eigenproblems, diverging series, variances known or seen to be infinite), but their number is bounded, so that a method
//! which refuses everything cannot pass.

#![cfg(feature = "formula")]

use std::process::Command;

/// Runs the example on the whole folder; returns how many pairs of equation and method passed, and how many failed.
fn sweep(arguments: &[&str]) -> (usize, usize) {
    let mut command = Command::new(env!("CARGO"));
    command.args(["run", "--quiet", "--release", "--example", "solve", "--", "tests/data/reference"]).args(arguments);
    let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("the example `solve` starts");
    let text = String::from_utf8_lossy(&output.stdout);
    let wrong: Vec<_> = text.lines().filter(|l| l.contains("WRONG") || l.contains("FAILED")).collect();
    assert!(output.status.success(), "{}\n{}", wrong.join("\n"), String::from_utf8_lossy(&output.stderr));
    let last = text.lines().last().expect("a last line");
    let counts: Vec<usize> = last.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(counts.len() == 2, "the last line reads «{last}»");
    (counts[0], counts[1])
}

#[test]
#[cfg_attr(debug_assertions, ignore = "runs in release")]
fn every_walk_on_every_equation() {
    // 144 equations × 10 walks; a third is refused with its reason, most of them because 512 walks show a variance that they cannot measure
    let (passed, failed) = sweep(&["--walks", "all", "--samples", "512"]);
    assert_eq!(failed, 0);
    assert!(passed >= 1050, "{passed} passed");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "runs in release")]
fn adaptive_nystrom_on_every_equation() {
    let (passed, failed) = sweep(&["--deterministic", "adaptive", "--tolerance", "1e-9"]);
    assert_eq!(failed, 0);
    assert!(passed >= 135, "{passed} passed");
}
