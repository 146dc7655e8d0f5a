//! Same seed, same bits: for any number of threads, any schedule of rounds, and with `parallel` off (theory §5.3 T10).
//!
//! The golden numbers below must hold under `cargo test --test determinism` and under `--no-default-features`: nothing in them depends on
//! features, threads or time. They may depend on the platform's `exp` and `ln`, hence kernels of + − × ÷ only.

#[path = "common/erased.rs"]
mod erased;

use erased::Equation;
use fredholm::detector::{Bins, Points};
use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Estimate, GroupMatrix, Spectrum, Walk};

macro_rules! equation {
    () => {
        Equation::on_interval(0.0..=1.0, |x: f64| 1.0 + x * x, |x: f64, y: f64| 0.4 / (1.0 + x + y * y))
    };
}

/// Everything that must be equal, as bits.
fn bits(e: &Estimate) -> Vec<u64> {
    let m = &e.moments;
    let mut bits = vec![m.count, m.nonzero, e.steps, e.evaluations];
    bits.extend([m.mean, m.m2, m.m3, m.m4, e.value, e.std_error.unwrap_or(-1.0)].map(f64::to_bits));
    bits.extend(e.tail.iter().flat_map(|t| t.largest().iter().map(|y| y.to_bits())));
    bits
}

/// One run of everything: several detectors, endings and scorings, sizes that are no multiples of anything.
fn everything() -> Vec<Vec<u64>> {
    let eq = equation!();
    let table = equation!().tabulated(8).unwrap().tabulated_source(4).unwrap();
    let points = Points(vec![0.1, 0.5, 0.9]);
    let mut runs = eq.seen_by(&points).solve(&Walk::collision().samples_per_cell(5001).seed(1)).unwrap();
    runs.extend(eq.seen_by(&Bins::new(0.0..=1.0, 100)).solve(&Walk::next_event().samples_per_cell(37).seed(2)).unwrap());
    runs.push(eq.at(0.3).solve(&Walk::mis().heuristic(Heuristic::Power(2.0)).samples_per_cell(70_000).seed(3)).unwrap());
    runs.push(eq.at(0.3).solve(&Walk::absorption().roulette(Roulette::constant(0.6)).samples_per_cell(1).seed(4)).unwrap());
    runs.push(table.at(0.3).solve(&Walk::subcritical().samples_per_cell(12_345).seed(5)).unwrap());
    runs.push(table.at(0.3).solve(&Walk::fixed_depth(4).samples_per_cell(1024).seed(6)).unwrap());
    runs.iter().map(bits).collect()
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(everything);
    let one = run(1);
    for threads in [2, 3, 8] {
        assert_eq!(run(threads), one, "{threads} threads");
    }
    assert_eq!(everything(), one, "the global pool");
}

/// Sizes that are no multiples of anything, past those at which the work is divided.
#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit_of_a_deterministic_solve() {
    use fredholm::deterministic::Nystrom;
    let eq = equation!();
    let solve = |method: &Nystrom| {
        let f = eq.solve(method).unwrap();
        let mut bits: Vec<u64> = f.values().iter().map(|v| v.to_bits()).collect();
        bits.extend([f.rcond(), f.inverse_norm(), f.eval(0.3)].map(f64::to_bits));
        bits
    };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            [Nystrom::gauss_legendre(17), Nystrom::composite(611, 1), Nystrom::graded(9, 10), Nystrom::adaptive().tolerance(1e-10)]
                .map(|m| solve(&m))
        })
    };
    let one = run(1);
    for threads in [2, 3, 8] {
        assert_eq!(run(threads), one, "{threads} threads");
    }
}

#[test]
fn a_run_is_a_function_of_its_seed() {
    assert_eq!(everything(), everything());
    let eq = equation!();
    let at = |seed| eq.at(0.5).solve(&Walk::collision().seed(seed)).unwrap();
    assert_ne!(at(1).value, at(2).value);
    // cells are independent of their neighbours: a point's estimate is the same alone or first among others
    let alone = eq.at(0.1).solve(&Walk::collision().seed(9)).unwrap();
    let among = eq.on(&[0.1, 0.5]).solve(&Walk::collision().seed(9)).unwrap();
    assert_eq!(bits(&alone), bits(&among[0]));
}

#[test]
fn rounds_end_where_a_single_run_ends() {
    let eq = equation!();
    for n in [1, 1000, 1024, 1025, 8192, 10_000, 100_000] {
        let walk = Walk::mis().samples_per_cell(n).seed(4);
        let query = eq.on(&[0.2, 0.7]);
        let once = query.solve(&walk).unwrap();
        let rounds: Vec<_> = query.rounds(&walk).unwrap().map(Result::unwrap).collect();
        let last = rounds.last().unwrap();
        assert_eq!(last.samples, n);
        assert_eq!(last.fraction, 1.0);
        assert!(rounds.windows(2).all(|w| w[0].number + 1 == w[1].number && w[0].samples < w[1].samples));
        for (a, b) in once.iter().zip(&last.estimates) {
            assert_eq!(bits(a), bits(b), "{n} walks in rounds");
        }
    }
}

/// Interrupted after any round, and any number of times.
#[cfg(feature = "serde")]
#[test]
fn a_resumed_run_is_the_uninterrupted_one() {
    let eq = equation!();
    let walk = Walk::collision().samples_per_cell(20_000).seed(4);
    let query = eq.on(&[0.2, 0.7]);
    let whole = query.solve(&walk).unwrap();
    for interruptions in 1..5 {
        let mut saved: Option<String> = None;
        let mut last = None;
        loop {
            let rounds = query.rounds(&walk).unwrap();
            let mut rounds = match &saved {
                Some(text) => rounds.resume(serde_json::from_str(text).unwrap()).unwrap(),
                None => rounds,
            };
            let before = last.is_some();
            for _ in 0..interruptions {
                let Some(round) = rounds.next() else { break };
                last = Some(round.unwrap().estimates);
            }
            let text = serde_json::to_string(&rounds.checkpoint()).unwrap();
            if before && saved.as_ref() == Some(&text) {
                break;
            }
            saved = Some(text);
        }
        for (a, b) in whole.iter().zip(&last.unwrap()) {
            assert_eq!(bits(a), bits(b), "{interruptions} rounds at a time");
        }
    }
}

/// Scores whose fourth powers overflow, and values of several components, are read again as they were written.
#[cfg(feature = "serde")]
#[test]
fn states_of_any_value_can_be_stored() {
    let huge = Equation::on_interval(0.0..=1.0, |x: f64| 1e100 * (1.0 + x), |x: f64, y: f64| 0.5 * x * y);
    let colours = Equation::on_interval(0.0..=1.0, |x: f64| Spectrum([x, 1.0, 2.0]), |x: f64, y: f64| Spectrum([0.5 * x * y, 0.2, 1e-3]));
    let walk = Walk::collision().samples_per_cell(8192);
    macro_rules! resumed {
        ($eq:expr) => {{
            let (eq, query) = (&$eq, $eq.at(0.5));
            let mut rounds = query.rounds(&walk).unwrap();
            rounds.next().unwrap().unwrap();
            let text = serde_json::to_string(&rounds.checkpoint()).unwrap();
            let again = query.rounds(&walk).unwrap().resume(serde_json::from_str(&text).unwrap()).unwrap();
            (again.last().unwrap().unwrap().estimates, eq.at(0.5).solve(&walk).unwrap())
        }};
    }
    let (a, b) = resumed!(huge);
    assert!(!a.moments.m4.is_finite() && a.value.is_finite());
    assert_eq!((a.value, a.std_error, a.steps, a.moments.m2), (b.value, b.std_error, b.steps, b.moments.m2));
    let (a, b) = resumed!(colours);
    assert_eq!((a.value, a.std_error, a.moments), (b.value, b.std_error, b.moments));
}

/// run(2N) = run(N) + checkpoint + run(N), at sizes that rounds can reach.
#[test]
fn a_larger_budget_goes_on_where_the_smaller_ended() {
    let eq = equation!();
    let query = eq.at(0.4);
    for n in [1024, 4096, 65_536] {
        let mut first = query.rounds(&Walk::collision().samples_per_cell(n).seed(1)).unwrap();
        first.by_ref().for_each(|r| drop(r.unwrap()));
        let more = Walk::collision().samples_per_cell(2 * n).seed(1);
        let resumed = query.rounds(&more).unwrap().resume(first.checkpoint()).unwrap().last().unwrap().unwrap().estimates;
        assert_eq!(bits(&resumed), bits(&query.solve(&more).unwrap()), "{n}");
    }
}

#[test]
fn a_walk_can_be_replayed() {
    let eq = equation!();
    let walk = Walk::next_event().samples_per_cell(64).seed(8);
    let e = eq.at(0.5).solve(&walk).unwrap();
    let scores: Vec<f64> = (0..64).map(|i| walk.trace(&eq, &fredholm::detector::At(0.5), 0, i).unwrap().score).collect();
    let m = fredholm::statistics::Moments::from_scores(&scores);
    assert_eq!((m.mean, m.m2), (e.moments.mean, e.moments.m2));
}

#[test]
fn golden_numbers() {
    let eq = equation!();
    let collision = eq.at(0.5).solve(&Walk::collision().samples_per_cell(3000).seed(7)).unwrap();
    let mis = eq.at(0.5).solve(&Walk::mis().samples_per_cell(3000).seed(7)).unwrap();
    let table = equation!().tabulated(8).unwrap();
    let subcritical = table.at(0.5).solve(&Walk::subcritical().samples_per_cell(3000).seed(7)).unwrap();
    let system =
        Equation::on_interval(0.0..=1.0, |x| Spectrum([1.0, x]), |x: f64, y: f64| GroupMatrix([[0.3 * x, 0.1], [0.2 * y, 0.4 * x * y]]));
    let groups = system.at(0.5).solve(&Walk::collision().samples_per_cell(3000).seed(7)).unwrap();
    let golden = GOLDEN;
    let now = [
        (collision.value, collision.std_error.unwrap(), collision.steps),
        (mis.value, mis.std_error.unwrap(), mis.steps),
        (subcritical.value, subcritical.std_error.unwrap(), subcritical.steps),
        (groups.value[1], groups.std_error.unwrap()[1], groups.steps),
    ];
    assert_eq!(now, golden, "a change of these numbers is a change for every user: note it in CHANGELOG.md");
}

const GOLDEN: [(f64, f64, u64); 4] = [
    (1.6247224981342285, 0.0035355290522189127, 3864),
    (1.6258629864388394, 0.0013406059536171125, 3844),
    (1.6138822424636319, 0.01445935575104707, 821),
    (0.724034259522725, 0.0045417065282243995, 3618),
];
