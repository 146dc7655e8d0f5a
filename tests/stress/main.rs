//! Stress: what must never be answered wrongly, and what must survive.

mod budgets;
mod contained;
#[path = "../common/erased.rs"]
mod erased;
mod faults;

/// Zero silent wrong answers in the table of [`cases`](cases/mod.rs), which the example `stress` prints.
#[test]
#[cfg_attr(debug_assertions, ignore = "runs in release")]
fn every_input_is_answered_within_its_error_or_refused() {
    let mut command = std::process::Command::new(env!("CARGO"));
    command.args(["run", "--quiet", "--release", "--example", "stress", "--", "--small"]);
    let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("the example `stress` starts");
    let text = String::from_utf8_lossy(&output.stdout);
    let wrong: Vec<_> = text.lines().filter(|l| l.contains("WRONG")).collect();
    assert!(output.status.success() && wrong.is_empty(), "{}\n{}", wrong.join("\n"), String::from_utf8_lossy(&output.stderr));
    assert!(text.lines().last().is_some_and(|l| l.starts_with("0 wrong")), "{text}");
}
