//! What a run must survive: being killed, a full disk, a panic in a function of the user's, a long time.

use crate::erased::Equation;
use fredholm::detector::Bins;
use fredholm::deterministic::{Galerkin, Nystrom};
use fredholm::sampling::Sobol;
use fredholm::walk::{ArrayRqmc, InProgress, Roulette, Rounds};
use fredholm::{Bidirectional, Error, Estimate, Forward, Walk};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// A folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("fredholm-faults-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// This program again, with one of its ignored tests.
fn child(test: &str, folder: &Path, threads: &str) -> Child {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args([test, "--exact", "--ignored", "--nocapture"]).env("FREDHOLM_FOLDER", folder).env("RAYON_NUM_THREADS", threads);
    command.stdout(std::process::Stdio::null()).spawn().unwrap()
}

/// Where a child works; `None` if the test was not called by another.
fn told() -> Option<PathBuf> {
    std::env::var_os("FREDHOLM_FOLDER").map(PathBuf::from)
}

const WALKS: u64 = 1 << 20;
/// Runs that go in rounds.
#[cfg(feature = "serde")]
const KINDS: [&str; 3] = ["backward", "replicates", "forward"];

/// Bits of the result of an uninterrupted run, or of what is left of one.
#[cfg(feature = "serde")]
fn bits(kind: &str, state: Option<&Path>) -> String {
    let eq = Equation::on_interval(0.0..=1.0, |x: f64| x.cos(), |x: f64, y: f64| 0.7 * (-x * y * y).exp());
    let points = [0.1, 0.5, 0.9];
    let (query, bins) = (eq.on(&points), Bins::new(0.0..=1.0, 3));
    let replicates = Sobol::new(3).replicates(4);
    match kind {
        "backward" => finished(query.rounds(&Walk::next_event().samples_per_cell(WALKS).seed(3)), state),
        "replicates" => finished(query.rounds(&Walk::collision().sequence(replicates).samples_per_cell(WALKS)), state),
        _ => finished(eq.seen_by(&bins).rounds(&Forward::new().walks(WALKS).seed(3)), state),
    }
}

#[cfg(feature = "serde")]
fn finished<R: InProgress<Value = f64, Answer = Vec<Estimate>>>(rounds: Result<Rounds<R>, Error>, state: Option<&Path>) -> String {
    let mut rounds = rounds.unwrap();
    if let Some(saved) = state.and_then(|path| std::fs::read_to_string(path).ok()) {
        rounds = rounds.resume(serde_json::from_str(&saved).unwrap()).unwrap();
    }
    let mut last = None;
    while let Some(round) = rounds.next() {
        last = Some(round.unwrap().estimates);
        if let Some(path) = state {
            // beside, then renamed: a kill at any instant leaves a whole state
            let part = path.with_extension("part");
            std::fs::write(&part, serde_json::to_string(&rounds.checkpoint()).unwrap()).unwrap();
            std::fs::rename(&part, path).unwrap();
        }
    }
    let estimates = last.expect("a last round is always left to do: the result is written after it");
    let numbers = estimates.iter().flat_map(|e| [e.value, e.std_error.unwrap(), e.moments.m4, e.steps as f64]);
    numbers.map(|v| format!("{:016x}", v.to_bits())).collect()
}

#[cfg(feature = "serde")]
#[test]
#[ignore = "called by killed_and_resumed_at_random"]
fn resumed_by_another() {
    let Some(folder) = told() else { return };
    let kind = KINDS.into_iter().find(|kind| folder.ends_with(kind)).unwrap();
    let result = bits(kind, Some(&folder.join("state.json")));
    std::fs::write(folder.join("result.part"), result).unwrap();
    std::fs::rename(folder.join("result.part"), folder.join("result")).unwrap();
}

/// Killed again and again, at instants that nobody chose, and gone on with by other numbers of threads, every run ends with the bits of an uninterrupted one.
#[cfg(feature = "serde")]
#[test]
fn killed_and_resumed_at_random() {
    let mut state = 7u64;
    for kind in KINDS {
        let (parent, whole) = (folder("kill"), bits(kind, None));
        let folder = parent.join(kind);
        std::fs::create_dir(&folder).unwrap();
        let mut kills = 0;
        while !folder.join("result").exists() {
            let threads = ["1", "2", "8"][kills as usize % 3];
            let mut process = child("faults::resumed_by_another", &folder, threads);
            // from 10 ms to 0.4 s by a linear congruential generator, longer each time: the run must end at last
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            std::thread::sleep(Duration::from_millis(10 + (state >> 33) % (40 + 40 * kills)));
            kills += u64::from(process.try_wait().unwrap().is_none());
            process.kill().ok();
            process.wait().unwrap();
            // a kill between the last state and the result leaves no round to do: the last state is taken back
            if !folder.join("result").exists() && last_round(&folder.join("state.json")) {
                std::fs::remove_file(folder.join("state.json")).unwrap();
            }
        }
        assert_eq!(std::fs::read_to_string(folder.join("result")).unwrap(), whole, "{kind}, after {kills} kills");
        std::fs::remove_dir_all(parent).ok();
    }
}

#[cfg(feature = "serde")]
fn last_round(state: &Path) -> bool {
    let Ok(text) = std::fs::read_to_string(state) else { return false };
    let saved: serde_json::Value = serde_json::from_str(&text).expect("states are whole whenever the program is killed");
    saved["done"].as_u64().is_some_and(|done| done * saved["cells"][0]["replicates"].as_array().map_or(1, Vec::len) as u64 >= WALKS)
}

/// A panic in g is an error with its words; the rounds before it are kept, and the next run starts unharmed.
#[test]
fn panics_of_the_user_are_contained() {
    let calls = AtomicU64::new(0);
    let eq = Equation::on_interval(
        0.0..=1.0,
        |x| {
            assert!(calls.fetch_add(1, Ordering::Relaxed) < 50_000, "the table of g ends at x = {x}");
            1.0
        },
        |x, y| 0.5 * x * y,
    );
    let query = eq.at(0.5);
    let mut rounds = query.rounds(&Walk::collision().samples_per_cell(1 << 20)).unwrap();
    let mut kept = None;
    let fault = loop {
        match rounds.next().expect("the panic comes first") {
            Ok(round) => kept = Some(round),
            Err(e) => break e,
        }
    };
    assert!(matches!(&fault, Error::Panicked { message } if message.contains("the table of g ends at x = 0.")), "{fault}");
    let kept = kept.expect("rounds before the panic");
    assert!(kept.samples >= 8192 && kept.estimates.agrees_with(1.15, 6.0), "{kept:?}");
    assert!(rounds.next().is_none());
    let again = query.solve(&Walk::collision().samples_per_cell(16));
    assert!(matches!(again, Err(Error::Panicked { .. })), "{again:?}");
    let solve = eq.solve(&fredholm::deterministic::Nystrom::gauss_legendre(8)).map(|f| f.eval(0.5));
    assert!(matches!(solve, Err(Error::Panicked { .. })), "{solve:?}");
    calls.store(0, Ordering::Relaxed);
    assert!(query.solve(&Walk::collision().samples_per_cell(4096)).unwrap().agrees_with(1.15, 6.0));
}

/// Wherever a function of the user's is first called: before the first round, in a table, in a search for eigenvalues.
#[test]
fn panics_before_the_first_walk_are_contained() {
    use fredholm::deterministic::{Nystrom, eigenpairs};
    use fredholm::kernel::Tabulated;
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| if x > 0.9 { panic!("no K at x = {x}") } else { x * y });
    let kernel = eq.kernel().kernel();
    let query = eq.at(0.5);
    let faults = [
        query.rounds(&Walk::collision()).map(drop).unwrap_err(),
        Tabulated::new(kernel, 16).map(drop).unwrap_err(),
        eigenpairs(kernel, &Nystrom::gauss_legendre(16), 1).map(drop).unwrap_err(),
        query.solve(&Walk::collision()).map(drop).unwrap_err(),
    ];
    for fault in faults {
        assert!(matches!(&fault, Error::Panicked { message } if message.contains("no K at x = 0.9")), "{fault}");
    }
}

/// A full disk, a name that cannot be: an error with the path; what was on the disk before stays, and so does the answer.
#[cfg(all(feature = "plot", target_os = "linux"))]
#[test]
fn what_cannot_be_written_is_not_lost() {
    use fredholm::plot::Convergence;
    let folder = folder("disk");
    let plot = Convergence::against_samples("errors").series("walk", [(1e2, 0.1), (1e4, 0.01)]);
    // the device that is always full, by a name that tells the format
    let full = folder.join("full.svg");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let e = plot.save(&full).unwrap_err();
    assert!(matches!(&e, Error::Io { path, message } if path.ends_with("full.svg") && message.contains("space")), "{e}");
    let e = plot.save("/dev/null/folder/plot.png").unwrap_err();
    assert!(matches!(&e, Error::Io { path, .. } if path.contains("plot.png")), "{e}");
    // a write that fails half way: the older picture is still there
    let good = folder.join("good.svg");
    plot.save(&good).unwrap();
    let before = std::fs::read(&good).unwrap();
    let blocked = folder.join(format!("good.svg.{}.part", std::process::id()));
    std::fs::create_dir(&blocked).unwrap();
    assert!(plot.save(&good).is_err());
    assert_eq!(std::fs::read(&good).unwrap(), before);
    std::fs::remove_dir(blocked).unwrap();
    plot.save(&good).unwrap();
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2, "nothing is left behind");
    std::fs::remove_dir_all(folder).ok();
}

/// What an example prints, what it says went wrong, and how it ends, where `target` is no folder.
#[cfg(target_os = "linux")]
fn example(name: &str, options: &[&str], folder: &Path) -> Child {
    let mut command = Command::new(env!("CARGO"));
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    command.args(["run", "--quiet", "--release", "--example", name, "--manifest-path"]).arg(manifest.join("Cargo.toml"));
    command.arg("--target-dir").arg(manifest.join("target")).arg("--").args(options).current_dir(folder);
    command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().unwrap()
}

/// Examples print what they found before they tell, with its name, what could not be written; a closed pipe ends those that are tools without a word.
#[cfg(all(feature = "plot", feature = "scene", feature = "serde", target_os = "linux"))]
#[test]
#[cfg_attr(debug_assertions, ignore = "runs examples in release")]
fn examples_tell_what_they_could_not_write() {
    let folder = folder("examples");
    std::fs::write(folder.join("target"), "a file").unwrap();
    for (name, options, found) in [
        ("first_steps", ["--samples", "2048"], "f(½) = "),
        ("stopping", ["--samples", "65536"], "round 3"),
        ("cornell", ["--size", "8"], "relative error of a pixel"),
    ] {
        let output = example(name, &options, &folder).wait_with_output().unwrap();
        let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(out.contains(found) && err.contains("target/plots/") && !err.contains("panicked"), "{name}: {out}\n{err}");
        assert!(!output.status.success(), "{name}");
    }
    let mut closed = example("cornell", &["--size", "8"], &folder);
    drop(closed.stdout.take());
    let output = closed.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && !err.contains("panicked"), "{err}");
    std::fs::remove_dir_all(folder).ok();
}

/// Highest resident memory so far, KiB.
#[cfg(target_os = "linux")]
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|l| l.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "called by memory_stays_flat: other tests in the same process need memory too"]
fn long_run() {
    let Some(folder) = told() else { return };
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let query = eq.at(0.5);
    let peaks = query.rounds(&Walk::collision().samples_per_cell(1 << 24)).unwrap().map(|round| (round.unwrap().samples, peak()));
    let lines: Vec<String> = peaks.map(|(samples, peak)| format!("{samples} {peak}")).collect();
    std::fs::write(folder.join("peaks"), lines.join("\n")).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "called by memory_stays_flat"]
fn many_solves() {
    let Some(folder) = told() else { return };
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let (query, bins, sobol) = (eq.at(0.5), Bins::new(0.0..=1.0, 8), Sobol::new(1).replicates(4));
    let mut lines = Vec::new();
    for i in 0..400 {
        query.solve(&Walk::next_event().samples_per_cell(2048).seed(i)).unwrap();
        eq.seen_by(&bins).solve(&Forward::new().sequence(sobol).walks(2048)).unwrap();
        eq.seen_by(&bins).solve(&Bidirectional::new().samples_per_cell(64)).unwrap();
        query.solve(&ArrayRqmc::new(Walk::collision().sequence(sobol).samples_per_cell(256))).unwrap();
        eq.solve(&Nystrom::adaptive()).unwrap().residual(0.5).unwrap();
        eq.solve(&Galerkin::elements(8)).unwrap();
        eq.clone().tabulated(8).unwrap();
        lines.push(format!("{i} {}", peak()));
    }
    std::fs::write(folder.join("peaks"), lines.join("\n")).unwrap();
}

/// 2²⁴ walks need no more memory than 2²² (the first rounds find how many chunks are in flight), and 400 times all kinds of solves no more than 100 times.
#[cfg(target_os = "linux")]
#[test]
fn memory_stays_flat() {
    for (test, early, late) in [("faults::long_run", 1 << 22, 1 << 24), ("faults::many_solves", 99, 399)] {
        let folder = folder("memory");
        assert!(child(test, &folder, "2").wait().unwrap().success());
        let text = std::fs::read_to_string(folder.join("peaks")).unwrap();
        let peaks: Vec<Vec<u64>> = text.lines().map(|l| l.split(' ').map(|n| n.parse().unwrap()).collect()).collect();
        let at = |number: u64| peaks.iter().find(|p| p[0] >= number).unwrap()[1];
        assert!(at(late) <= at(early) + 2048, "KiB by {test}: {text}");
        std::fs::remove_dir_all(folder).ok();
    }
}

/// What runs before a solve meets the same functions: pilots, predictions, tables of strategies.
#[test]
fn panics_in_pilots_and_predictions_are_errors() {
    let k = |x: f64, _: f64| if x > 0.25 { panic!("no K here") } else { 0.5 };
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, k);
    let (query, half) = (eq.at(0.5), Roulette::constant(0.5));
    let pairs = Bidirectional::new().roulette(half);
    for result in [
        query.optimal(&Walk::mis(), 64).map(drop),
        query.strategies(&pairs, 0, 2).map(drop),
        query.bidirectional(&pairs.optimal(64)).map(drop),
        query.predict_strategies(&pairs, 0, 2, &Nystrom::gauss_legendre(4)).map(drop),
        eq.predict(&Walk::collision().roulette(half)).map(drop),
    ] {
        assert!(matches!(&result, Err(Error::Panicked { message }) if message == "no K here"), "{result:?}");
    }
}

/// A table of strategies has the weights of the heuristic: no pilot is run for it, nor refused.
#[test]
fn tables_of_strategies_need_no_pilot() {
    let eq = Equation::on_interval(0.0..=1.0, |x| 1.0 + x, |x: f64, y: f64| 0.5 * x * y);
    let pairs = Bidirectional::new().samples_per_cell(256);
    let table = |pairs: &Bidirectional| eq.at(0.5).strategies(pairs, 0, 2).unwrap().iter().map(|s| s.weighted.mean).collect::<Vec<_>>();
    assert_eq!(table(&pairs), table(&pairs.optimal(2)));
}
