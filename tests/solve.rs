//! Every equation of `tests/data/reference` by every method of the example `solve`, judged as a user would judge it: a walk may be no further from a
//! stored value than chance allows once in a million *runs*, a deterministic method no further than the error it reports.
//!
//! Refusals are no failures (eigenproblems, diverging series, variances known or seen to be infinite), but their number is bounded, so that a method
//! which refuses everything cannot pass.

#![cfg(feature = "formula")]

use std::path::Path;
use std::process::Command;

const FOLDER: &str = "tests/data/reference";
/// Walks of 3000 to 10 000 steps: nine tenths of the time, if there were as many of them.
const LONG: [&str; 3] = ["gaussian-nearcritical-0.9999", "green-bridge-res0.9999", "slab-c1-a100-uniform"];

fn files() -> Vec<String> {
    let entries = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER)).expect("the folder of references");
    let names = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
    let mut files: Vec<String> = names.filter(|name| name.ends_with(".json")).map(|name| format!("{FOLDER}/{name}")).collect();
    files.sort();
    files
}

/// Runs the example on files; returns how many pairs of equation and method passed, and how many failed.
fn sweep(files: &[String], arguments: &[&str]) -> (usize, usize) {
    let mut command = Command::new(env!("CARGO"));
    command.args(["run", "--quiet", "--release", "--example", "solve", "--"]).args(files).args(arguments);
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
    let (long, short): (Vec<_>, _) = files().into_iter().partition(|file| LONG.iter().any(|name| file.contains(name)));
    let (passed, failed) = sweep(&short, &["--walks", "all", "--samples", "512"]);
    let (also, wrong) = sweep(&long, &["--walks", "all", "--samples", "64"]);
    assert_eq!(failed + wrong, 0);
    assert!(passed + also >= 1050, "{passed} and {also} passed");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "runs in release")]
fn adaptive_nystrom_on_every_equation() {
    let (passed, failed) = sweep(&[FOLDER.into()], &["--deterministic", "adaptive", "--tolerance", "1e-9"]);
    assert_eq!(failed, 0);
    assert!(passed >= 135, "{passed} passed");
}
