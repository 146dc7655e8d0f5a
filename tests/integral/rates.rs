//! Slopes of error against n, coverage of intervals, and the same bits for any number of threads.

use crate::common::Budget;
use crate::study;
use fredholm::integral::{Allocation, Coefficient, Combined, Control, Integral, Plain, Roulette, Secondary, Strata, Stratified, inverse};
use fredholm::statistics::Sweep;
use fredholm::walk::Heuristic;
use fredholm::{Error, Estimate};
use std::f64::consts::E;

/// The slope and its standard error, from the known scatter of a root mean square of `repetitions` normal errors: 1/√(2R) in its logarithm.
pub(crate) fn slope(sweep: &Sweep, repetitions: u64) -> (f64, f64, f64) {
    let logs: Vec<f64> = sweep.errors().map(|p| p.0.ln()).collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    let spread: f64 = logs.iter().map(|x| (x - mean).powi(2)).sum();
    (sweep.rate().unwrap().slope, 1.0 / (2.0 * repetitions as f64 * spread).sqrt(), 1e6)
}

const REPETITIONS: u64 = 400;

fn sweep(samples: &[u64], solve: &(dyn Fn(u64, u64) -> Result<Estimate, Error> + Sync)) -> Sweep {
    Sweep::run(E - 1.0, samples, REPETITIONS, solve).unwrap()
}

#[test]
fn errors_fall_as_theory_says() {
    let mut budget = Budget::of("integral::slopes");
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let sizes: Vec<u64> = (4..=12).map(|k| 1 << k).collect();
    let plain = sweep(&sizes, &|n, seed| integral.solve(&Secondary::plain().samples(n).seed(seed)));
    budget.mean("plain", slope(&plain, REPETITIONS), -0.5, 0.1).unwrap();
    let jittered = sweep(&sizes, &|n, seed| integral.solve(&Stratified::jittered(Strata::uniform(n as usize), 1).seed(seed)));
    budget.mean("jittered, one dimension", slope(&jittered, REPETITIONS), -1.5, 0.1).unwrap();
    // d = 2: −(½ + 1/d) = −1
    let square = Integral::on(fredholm::domain::Cuboid::<2>::unit(), |x| (x[0] + x[1]).exp());
    let sides: Vec<u64> = vec![4, 8, 16, 32, 64];
    let grid = Sweep::run((E - 1.0).powi(2), &sides, REPETITIONS, |k, seed| {
        square.solve(&Stratified::jittered(Strata::grid(k as usize, 2), 1).seed(seed))
    });
    let (s, error, freedom) = slope(&grid.unwrap(), REPETITIONS);
    // against k = √n the slope is twice that against n
    budget.mean("jittered, two dimensions", (s / 2.0, error / 2.0, freedom), -1.0, 0.1).unwrap();
}

/// Coverage of the 95 % interval, whatever it comes from.
#[test]
fn intervals_cover_what_they_promise() {
    let mut budget = Budget::of("integral::coverage");
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let methods: [(&str, &(dyn Fn(u64) -> Estimate + Sync)); 5] = [
        ("independent points", &|s| integral.solve(&Secondary::plain().samples(200).seed(s)).unwrap()),
        ("within strata", &|s| integral.solve(&Stratified::new(Strata::uniform(4)).samples(40).seed(s)).unwrap()),
        ("two a stratum", &|s| integral.solve(&Stratified::new(Strata::uniform(16)).samples(32).seed(s)).unwrap()),
        ("replicates of one a stratum", &|s| integral.solve(&Stratified::jittered(Strata::uniform(8), 10).seed(s)).unwrap()),
        ("two replicates", &|s| integral.solve(&Stratified::jittered(Strata::uniform(32), 2).seed(s)).unwrap()),
    ];
    for (name, solve) in methods {
        let c = study(E - 1.0, 20_000, solve).coverage(0.95);
        assert_eq!(c.unknown, 0);
        budget.frequency(name, c.hits, c.trials, 0.94, 0.96).unwrap();
    }
    // one sample a stratum, no replicates: no error is invented, and no interval counted
    let c = study(E - 1.0, 10, &|s| integral.solve(&Stratified::jittered(Strata::uniform(8), 1).seed(s)).unwrap()).coverage(0.95);
    assert_eq!((c.trials, c.unknown), (0, 10));
    assert_eq!(integral.solve(&Secondary::plain().samples(1)).unwrap().std_error, None);
}

#[test]
fn clopper_and_pearson() {
    use fredholm::statistics::Coverage;
    let c = Coverage { hits: 8, trials: 10, unknown: 0 };
    // Clopper, Pearson (1934): 8 of 10 at 95 %
    let (low, high) = c.interval(0.95).unwrap();
    assert!((low - 0.443_904_537_692_349_8).abs() < 1e-6 && (high - 0.974_789_272_842_686_6).abs() < 1e-6, "{low} {high}");
    let none = Coverage { hits: 0, trials: 10, unknown: 0 };
    let (low, high) = none.interval(0.95).unwrap();
    assert!(low == 0.0 && (high - (1.0 - 0.025f64.powf(0.1))).abs() < 1e-9);
    assert!(none.interval(1.0).is_none() && Coverage { hits: 0, trials: 0, unknown: 3 }.interval(0.5).is_none());
}

/// Same bits for 1, 2, 3 and 8 threads; another seed, other bits.
#[test]
fn threads_change_nothing() {
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let everything = |seed: u64| -> Vec<u64> {
        let linear = || inverse(|u: f64| u.sqrt(), |x: &f64| 2.0 * x);
        let two = |c: Combined<f64>| c.technique(inverse(|u: f64| u, |_: &f64| 1.0), 1).technique(linear(), 1);
        let results = [
            integral.solve(&Secondary::plain().samples(50_000).seed(seed)),
            integral.solve(&Secondary::combined(two(Combined::new(Heuristic::Power(2.0)))).samples(5000).seed(seed)),
            integral.solve(&Secondary::combined(two(Combined::optimal(100))).samples(5000).seed(seed)),
            integral.solve(&Secondary::new(Roulette::new(Plain, 0.4)).samples(5000).seed(seed)),
            integral.solve(&Secondary::new(Control::new(Plain, |x: &f64| *x, 0.5, Coefficient::Pilot(50))).samples(5000).seed(seed)),
            integral.solve(&Stratified::jittered(Strata::uniform(3000), 3).seed(seed)),
            integral.solve(&Stratified::new(Strata::uniform(3)).allocation(Allocation::Neyman { pilot: 10 }).samples(9000).seed(seed)),
        ];
        results.into_iter().map(Result::unwrap).flat_map(|e| [e.value, e.std_error.unwrap()].map(f64::to_bits)).collect()
    };
    let run = |threads, seed| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| everything(seed));
    let one = run(1, 5);
    assert!([2, 3, 8].iter().all(|t| run(*t, 5) == one));
    assert!(run(2, 6).iter().zip(&one).all(|(a, b)| a != b));
}
