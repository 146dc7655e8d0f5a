//! Same seed, same bits, for any number of threads.

use crate::erased::Equation;
use fredholm::detector::{Bins, Functional};
use fredholm::domain::Interval;
use fredholm::sampling::Sobol;
use fredholm::walk::{Expansion, Histogram, KernelTally, Smoothed};
use fredholm::{Error, Estimate, Forward};

fn bits(e: &Estimate) -> Vec<u64> {
    let m = &e.moments;
    let mut bits = vec![m.count, m.nonzero, e.steps, e.evaluations];
    bits.extend([m.mean, m.m2, m.m3, m.m4, e.value, e.std_error.unwrap_or(-1.0)].map(f64::to_bits));
    bits.extend(e.tail.iter().flat_map(|t| t.largest().iter().map(|y| y.to_bits())));
    bits
}

/// Lists and tables of scores, chunks and batches that are no multiples of anything.
fn everything() -> Vec<Vec<u64>> {
    let eq = Equation::on_interval(0.0..=1.0, |x: f64| 1.0 + x * x, |x: f64, y: f64| 0.4 / (1.0 + x + y * y));
    let mut runs = eq.seen_by(&Bins::new(0.0..=1.0, 40)).solve(&Forward::new().walks(70_001).seed(1)).unwrap();
    runs.extend(eq.seen_by(&Bins::new(0.0..=1.0, 3)).solve(&Forward::next_event().walks(5001).seed(2)).unwrap());
    runs.extend(eq.on(&[0.1, 0.9]).solve(&Forward::next_event().walks(3001).seed(3)).unwrap());
    let one = Functional::new(Interval::from(0.0..=1.0), |_: &f64| 1.0);
    runs.push(eq.seen_by(&one).solve(&Forward::new().sequence(Sobol::new(4)).walks(5000)).unwrap());
    let mut all: Vec<_> = runs.iter().map(bits).collect();
    let xs = [0.2, 0.5, 1.0];
    let walks = Forward::new().walks(30_001).seed(5);
    for f in [
        eq.solve(&walks.profile(KernelTally::at(&xs))).unwrap(),
        eq.solve(&walks.profile(Smoothed::at(0.0..=1.0, &xs)).batches(7)).unwrap(),
        eq.solve(&walks.profile(Histogram::new(0.0..=1.0, 30)).batches(2)).unwrap(),
        eq.solve(&walks.profile(Expansion::legendre(0.0..=1.0, 3, &xs))).unwrap(),
    ] {
        let band = f.band(0.9).unwrap();
        let numbers = f.values().iter().chain(f.std_errors().unwrap()).chain(&band.lower).chain(&band.upper);
        all.push(numbers.map(|v| v.to_bits()).chain([band.critical.to_bits()]).collect());
    }
    all
}

#[test]
fn a_run_is_a_function_of_its_seed() {
    assert_eq!(everything(), everything());
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(everything);
    let one = run(1);
    for threads in [2, 3, 8] {
        assert_eq!(run(threads), one, "{threads} threads");
    }
}

/// A replay is the walk itself.
#[test]
fn a_trace_is_the_walk() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let bins = Bins::new(0.0..=1.0, 2);
    let total: f64 =
        (0..64).map(|i| Forward::new().trace(&eq, &bins, i).unwrap().scores.iter().filter(|s| s.0 == 1).map(|s| s.1).sum::<f64>()).sum();
    let e = &eq.seen_by(&bins).solve(&Forward::new().walks(64)).unwrap()[1];
    assert!((total / 64.0 - e.value).abs() < 1e-12);
}

/// Rounds end where a single run ends; an interrupted run goes on where it was left, and only as the same method.
#[test]
fn rounds_are_one_run() {
    let eq = Equation::on_interval(0.0..=1.0, |x: f64| 1.0 + x * x, |x: f64, y: f64| 0.4 / (1.0 + x + y * y));
    let bins = Bins::new(0.0..=1.0, 20);
    let query = eq.seen_by(&bins);
    for n in [1, 1025, 10_000] {
        let forward = Forward::new().walks(n).seed(4);
        let once: Vec<_> = query.solve(&forward).unwrap().iter().map(bits).collect();
        let mut rounds = query.rounds(&forward).unwrap();
        let first = rounds.next().unwrap().unwrap();
        let saved = rounds.checkpoint();
        assert_eq!((first.number, first.samples, saved.round()), (1, n.min(1024), 1));
        let last = rounds.last().map_or(first.estimates, |round| round.unwrap().estimates);
        assert_eq!(last.iter().map(bits).collect::<Vec<_>>(), once, "{n} walks in rounds");
        let resumed = query.rounds(&forward).unwrap().resume(saved.clone()).unwrap();
        if let Some(round) = resumed.last() {
            assert_eq!(round.unwrap().estimates.iter().map(bits).collect::<Vec<_>>(), once, "{n} walks, resumed");
        }
        let other = query.rounds(&forward.seed(5)).unwrap().resume(saved).map(drop);
        assert!(matches!(other, Err(Error::Checkpoint { field: "method", .. })), "{other:?}");
    }
}
