//! Are the errors true? Coverage of intervals and of the stopping rule, p-values, moments to the fourth order, tails and verdicts.

mod common;
#[path = "common/erased.rs"]
mod erased;

use common::{Budget, all_pass, student};
use erased::Equation;
use fredholm::detector::{Functional, Points};
use fredholm::domain::Interval;
use fredholm::sampling::Sobol;
use fredholm::statistics::{Moments, Target, Verdict};
use fredholm::walk::Roulette;
use fredholm::{Estimate, Walk};

/// Independent repetitions of the estimate at x, all from one solve: cells have random numbers of their own.
const REPETITIONS: usize = 20_000;
const WALKS: u64 = 1024;

fn repetitions(x: f64) -> Points<f64> {
    Points(vec![x; REPETITIONS])
}

/// Hits of the 95 % interval, misses below and above, and z-scores.
struct Coverage {
    hits: u64,
    low: u64,
    high: u64,
    p: Vec<f64>,
}

fn coverage(estimates: &[Estimate], truth: f64) -> Coverage {
    let mut c = Coverage { hits: 0, low: 0, high: 0, p: Vec::new() };
    // one quantile for all: the degrees of freedom are the same
    let t = estimates[0].half_width(0.95).unwrap() / estimates[0].std_error.unwrap();
    for e in estimates {
        let (error, freedom) = (e.std_error.unwrap(), e.degrees_of_freedom as f64);
        let z = (e.value - truth) / error;
        c.hits += u64::from(z.abs() <= t);
        c.low += u64::from(z < -t);
        c.high += u64::from(z > t);
        if c.p.len() < 2000 {
            let two_sided = student(z, freedom);
            c.p.push(if z > 0.0 { 1.0 - 0.5 * two_sided } else { 0.5 * two_sided });
        }
    }
    c
}

/// Six problems, six estimators. 20 000 repetitions make ±1 % six standard deviations wide: a true coverage of 95 % fails with probability
/// 10⁻¹⁰, one of 93.5 % or 96.5 % passes with 10⁻³.
#[test]
fn intervals_cover_what_they_promise() {
    let mut budget = Budget::of("statistics::coverage");
    let mut uniform = Budget::of("statistics::p-values");
    let mut results = Vec::new();
    let rank_one = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let constant = Equation::on_interval(-1.0..=1.0, |z| 1.0 + 0.5 * z, |_, _| 0.25);
    let expxy = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (x * y).exp());
    let signed = Equation::on_interval(0.0..=1.0, f64::cos, |x: f64, y: f64| 1.2 * (5.0 * x - 3.0 * y).sin() * (-x * y).exp());
    let bridge = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 5.0 * (x.min(y) - x * y)).tabulated(16).unwrap();
    let value = |name: &str, x: f64| common::Reference::load(name).scalar().into_iter().find(|v| v.0 == x).unwrap().1;
    let rows = [
        ("rank one, collision", rank_one.seen_by(&repetitions(0.5)).solve(&Walk::collision().samples_per_cell(WALKS)).unwrap(), 1.15),
        (
            "sphere, absorption",
            constant
                .seen_by(&repetitions(0.5))
                .solve(&Walk::absorption().roulette(Roulette::constant(0.5)).samples_per_cell(WALKS))
                .unwrap(),
            value("integrating-sphere-rho0.5", 0.5),
        ),
        (
            "exp xy, next event",
            expxy.seen_by(&repetitions(0.25)).solve(&Walk::next_event().samples_per_cell(WALKS)).unwrap(),
            value("expxy-g1-lam0.5", 0.25),
        ),
        (
            "signed, balance",
            signed.seen_by(&repetitions(0.5)).solve(&Walk::mis().samples_per_cell(WALKS)).unwrap(),
            value("signchanging-nonsym", 0.5),
        ),
        (
            "bridge, subcritical",
            bridge.seen_by(&repetitions(0.75)).solve(&Walk::subcritical().samples_per_cell(WALKS)).unwrap(),
            value("green-bridge-lam5", 0.75),
        ),
        (
            "exp xy, constant roulette",
            expxy.seen_by(&repetitions(0.5)).solve(&Walk::collision().roulette(Roulette::constant(0.9)).samples_per_cell(WALKS)).unwrap(),
            value("expxy-g1-lam0.5", 0.5),
        ),
    ];
    for (name, estimates, truth) in &rows {
        let c = coverage(estimates, *truth);
        let share = c.hits as f64 / REPETITIONS as f64;
        assert!((0.94..=0.96).contains(&share), "{name}: covers {share} of {REPETITIONS}");
        let trials = REPETITIONS as u64;
        // skewed scores of 1024 walks move hits from one tail to the other: neither may be empty, or hold nearly all
        results.push(budget.frequency(&format!("{name}: below"), c.low, trials, 0.012, 0.045));
        results.push(budget.frequency(&format!("{name}: above"), c.high, trials, 0.012, 0.045));
        results.push(uniform.uniform(name, &c.p));
    }
    all_pass(results);
}

/// Looking after every round and stopping at the first short interval: the sequence must cover at its stopping time.
#[test]
fn the_stopping_rule_keeps_its_coverage() {
    let mut budget = Budget::of("statistics::stopping");
    let mut results = Vec::new();
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (x * y).exp());
    let truth = common::Reference::load("expxy-g1-lam0.5").scalar()[3].1;
    for (name, target) in [
        ("absolute", Target::absolute(0.06).unwrap()),
        ("relative", Target::relative(0.02).unwrap()),
        ("80 %", Target::absolute(0.05).unwrap().confidence(0.8).unwrap()),
    ] {
        let nominal = if name == "80 %" { 0.8 } else { 0.95 };
        let trials = 1500;
        let (mut hits, mut met) = (0, 0);
        for seed in 0..trials {
            let walk = Walk::collision().samples_per_cell(1 << 17).seed(seed);
            let query = eq.at(0.5);
            let mut rounds = query.rounds(&walk).unwrap();
            let last = rounds.by_ref().map(Result::unwrap).find(|r| target.progress(&r.estimates).met);
            let Some(last) = last else { continue };
            met += 1;
            let p = target.progress(&last.estimates);
            assert!(p.half_width <= p.wanted && p.fraction == 1.0);
            hits += u64::from((last.estimates.value - truth).abs() <= p.half_width);
        }
        assert_eq!(met, trials, "{name}: the target is within the budget");
        results.push(budget.frequency(&format!("{name}: coverage at the stopping time"), hits, trials, nominal, 1.0));
    }
    all_pass(results);
}

// ---------------------------------------------------------------- moments

/// Σ (y − ȳ)^k by exact integer arithmetic: n^k Σ (y − ȳ)^k = Σ (n y − Σy)^k.
fn exact(values: &[i64], k: u32) -> f64 {
    let n = values.len() as i128;
    let sum: i128 = values.iter().map(|v| i128::from(*v)).sum();
    let total: i128 = values.iter().map(|v| (n * i128::from(*v) - sum).pow(k)).sum();
    total as f64 / (n as f64).powi(k as i32)
}

fn integers(count: usize, modulus: i64) -> Vec<i64> {
    let mut state = 12_345i64;
    (0..count)
        .map(|_| {
            state = (state * 1_103_515_245 + 12_345) % (1 << 31);
            // skewed: the square of a uniform
            let u = (state >> 8) % modulus;
            u * u / modulus
        })
        .collect()
}

fn close(a: f64, b: f64, scale: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * scale
}

#[test]
fn moments_are_exact_however_they_are_merged() {
    let values = integers(1000, 97);
    let scores: Vec<f64> = values.iter().map(|v| *v as f64).collect();
    let (m2, m3, m4) = (exact(&values, 2), exact(&values, 3), exact(&values, 4));
    for cut in [1, 2, 3, 7, 64, 333, 999, 1000] {
        let mut m = Moments::default();
        for part in scores.chunks(cut) {
            m.merge(&Moments::from_scores(part));
        }
        assert_eq!(m.count, 1000);
        assert!(close(m.mean, values.iter().sum::<i64>() as f64 / 1000.0, m.mean, 1e-14), "{cut}");
        assert!(close(m.m2, m2, m2, 1e-13) && close(m.m3, m3, m2.powf(1.5), 1e-13) && close(m.m4, m4, m4, 1e-13), "{cut}: {m:?}");
        let vov = m4 / (m2 * m2) - 1e-3;
        assert!(close(m.variance_of_variance(), vov, vov, 1e-12), "{cut}");
        assert!(close(m.variance().unwrap(), m2 / 999.0, m2, 1e-15));
        assert!(close(m.kurtosis(), 1000.0 * m4 / (m2 * m2), 10.0, 1e-12));
        assert!(close(m.skewness(), m3 / 1000.0 / (m2 / 1000.0).powf(1.5), 10.0, 1e-12));
    }
    // any shape of the tree of merges
    let (mut left, mut right) = (Moments::from_scores(&scores[..1]), Moments::from_scores(&scores[1..17]));
    right.merge(&Moments::from_scores(&scores[17..]));
    left.merge(&right);
    assert!(close(left.m4, m4, m4, 1e-13));
}

/// 10⁸ + {0, …, 96}: the naive ΣY² would lose every digit of the variance.
#[test]
fn huge_offsets_leave_the_variance_alone() {
    let values = integers(4096, 97);
    let (m2, m4) = (exact(&values, 2), exact(&values, 4));
    for offset in [1e8, -1e12, 1e15] {
        let scores: Vec<f64> = values.iter().map(|v| offset + *v as f64).collect();
        for cut in [64, 1024, 4096] {
            let mut m = Moments::default();
            scores.chunks(cut).for_each(|part| m.merge(&Moments::from_scores(part)));
            // merging needs differences of means, whose last digit is ε·offset
            let tolerance = 1e-12 + 8.0 * (f64::EPSILON * offset.abs() / (m2 / 4096.0).sqrt());
            assert!(close(m.m2, m2, m2, tolerance), "{offset} in parts of {cut}: {} against {m2}", m.m2);
            // Σ d⁴ is not corrected for the rounding of the mean, as Σ d² is: 4 · skewness · δ/σ
            if offset.abs() < 1e15 {
                assert!(close(m.m4, m4, m4, 1e-10 + 64.0 * tolerance), "{offset} in parts of {cut}: {} against {m4}", m.m4);
            }
        }
    }
}

#[test]
fn moments_of_few_scores_say_what_they_do_not_know() {
    let none = Moments::<f64>::from_scores(&[]);
    assert_eq!((none.count, none.variance(), none.std_error()), (0, None, None));
    let one = Moments::from_scores(&[3.0]);
    assert_eq!((one.mean, one.variance()), (3.0, None));
    let same = Moments::from_scores(&[0.1; 1000]);
    assert!(same.variance().unwrap() < 1e-30 && same.mean == 0.1, "{same:?}");
    let zeros = Moments::from_scores(&[0.0; 10]);
    assert_eq!((zeros.nonzero, zeros.variance()), (0, Some(0.0)));
}

// ---------------------------------------------------------------- tails and verdicts

/// Scores Y = g(U) with U uniform: the equation with K = 0 seen by the mean over [0, 1].
fn scores(g: impl Fn(f64) -> f64 + Send + Sync + Clone, walks: u64, seed: u64) -> Estimate {
    let eq = Equation::on_interval(0.0..=1.0, g, |_, _| 0.0);
    eq.seen_by(&Functional::new(Interval::from(0.0..=1.0), |_| 1.0))
        .solve(&Walk::fixed_depth(0).samples_per_cell(walks).seed(seed))
        .unwrap()
}

/// The largest scores are the largest in any unit.
#[test]
fn units_change_no_tail() {
    let scaled = |scale: f64| scores(move |u: f64| scale * u.powf(-0.4), 1 << 14, 3).tail.unwrap();
    let one = scaled(1.0);
    for power in [-30, -10, 10] {
        let scale = 2f64.powi(power);
        let largest: Vec<f64> = one.largest().iter().map(|y| scale * y).collect();
        assert!(scaled(scale).largest() == largest && largest.len() == 256, "2^{power}");
    }
}

#[test]
fn heavy_tails_are_told_from_light_ones() {
    let mut wrong = [0; 4];
    for seed in 0..200 {
        // Pareto: P(Y > y) = y^{−α}
        let heavy = scores(|u| u.powf(-1.0 / 1.5), 1 << 14, seed);
        let fine = scores(|u| u.powf(-1.0 / 3.0), 1 << 14, seed);
        let signed = scores(|u| (u - 0.5).signum() * (2.0 * (u - 0.5).abs()).powf(-1.0 / 1.5), 1 << 14, seed);
        let light = scores(|u| 1.0 - u.ln(), 1 << 14, seed);
        let (a, s) = heavy.tail.as_ref().unwrap().index().unwrap();
        assert!((a - 1.5).abs() < 6.0 * s, "seed {seed}: index {a} ± {s}");
        wrong[0] += u32::from(heavy.verdict() != Verdict::InfiniteVariance);
        wrong[1] += u32::from(fine.verdict() == Verdict::InfiniteVariance);
        wrong[2] += u32::from(signed.verdict() != Verdict::InfiniteVariance);
        wrong[3] += u32::from(light.verdict() != Verdict::Trustworthy);
    }
    // index 1.5 ± 0.09 against the threshold 1.78: 3 standard errors away
    assert!(wrong[0] <= 4 && wrong[2] <= 4, "{wrong:?}");
    assert_eq!((wrong[1], wrong[3]), (0, 0), "{wrong:?}");
}

#[test]
fn verdicts_say_what_is_unknown() {
    let never = scores(|u| f64::from(u < 1e-9), 4096, 1);
    assert_eq!((never.verdict(), never.value), (Verdict::NothingScored, 0.0));
    assert!(format!("{never:#}").contains("unknown, not zero"), "{never:#}");
    let rare = scores(|u| f64::from(u < 1e-3), 4096, 1);
    assert_eq!(rare.verdict(), Verdict::Doubtful);
    let few = scores(|u| u, 50, 1);
    assert_eq!(few.verdict(), Verdict::Doubtful);
    let good = scores(|u| u, 4096, 1);
    assert_eq!(good.verdict(), Verdict::Trustworthy);
    let exact = scores(|_| 2.5, 4096, 1);
    assert_eq!(format!("{exact}"), "2.5(0)");
    let eq = Equation::on_interval(0.0..=1.0, |x| x, |_, _| 0.5);
    let randomised = |replicates: u32| {
        let walk = Walk::collision().samples_per_cell(1 << 14).sequence(Sobol::new(1).replicates(replicates));
        eq.at(0.5).solve(&walk).unwrap().verdict()
    };
    assert_eq!([2, 3, 4].map(randomised), [Verdict::Doubtful, Verdict::Doubtful, Verdict::Trustworthy]);
    let single = scores(|u| u, 1, 1);
    assert_eq!((single.std_error, single.half_width(0.95), single.verdict()), (None, None, Verdict::Unmeasured));
    assert!(format!("{single}").ends_with("(?)"));
    // fourth powers overflow: the value stands, the spread is unknown, and the verdict says so
    let huge = scores(|u| 1e300 * (1.0 + u), 4096, 1);
    assert!((huge.value / 1.5e300 - 1.0).abs() < 0.1, "{huge:?}");
    assert_eq!(huge.verdict(), Verdict::Doubtful);
    // squares underflow: an error of 0 is none
    for tiny in [1e-100, 1e-200, 1e-310] {
        let e = scores(move |u| tiny * (1.0 + u), 4096, 1);
        assert_eq!(e.verdict(), Verdict::Doubtful, "{e:?}");
    }
}

/// g(x) is added to every score of a walk from x: it must not hide a tail.
#[test]
fn a_constant_added_to_the_scores_hides_no_tail() {
    let mut trusted = [0; 4];
    for seed in 0..100 {
        for (count, index) in trusted.iter_mut().zip([1.5, 2.0, 2.1, 6.0]) {
            let e = scores(move |u: f64| 3.0 + u.powf(-1.0 / index), 1 << 16, seed);
            let (shape, error) = e.tail.as_ref().unwrap().shape().unwrap();
            assert!((shape - 1.0 / index).abs() < 6.0 * error, "seed {seed}, index {index}: {shape} ± {error}");
            *count += u32::from(e.verdict() == Verdict::Trustworthy);
        }
    }
    // of an index of 2.1 some 4 in 100 runs look like one above 3
    assert!(trusted[0] == 0 && trusted[1] < 6 && trusted[2] < 12 && trusted[3] > 97, "{trusted:?}");
}

#[test]
fn agreement_is_counted_in_standard_errors() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let e = eq.at(0.5).solve(&Walk::collision()).unwrap();
    let s = e.std_error.unwrap();
    for sign in [-1.0, 1.0] {
        assert!(e.agrees_with(e.value + sign * 2.9 * s, 3.0) && !e.agrees_with(e.value + sign * 3.1 * s, 3.0), "{e}");
        assert!((e.z_score(e.value - sign * 3.0 * s).unwrap() - sign * 3.0).abs() < 1e-9, "{e}");
    }
    assert_eq!(scores(|_| 2.5, 4096, 1).z_score(2.0), None, "no error, no z");
}

/// Weights 1.5ⁿ of walks of n steps: scores are tied, the tail index is 1.26, and no run may be trusted.
#[test]
fn tied_scores_hide_no_tail() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |_, _| 0.9);
    for seed in 0..100 {
        let e = eq.at(0.5).solve(&Walk::collision().roulette(Roulette::constant(0.6)).samples_per_cell(4096).seed(seed)).unwrap();
        assert_ne!(e.verdict(), Verdict::Trustworthy, "seed {seed}: {e:#}");
    }
}

#[test]
fn student_intervals_have_the_textbook_widths() {
    for (walks, t) in [(2u64, 12.706_204_736), (3, 4.302_652_730), (11, 2.228_138_852), (31, 2.042_272_456)] {
        let e = scores(|u| u, walks, 3);
        assert_eq!(e.degrees_of_freedom, walks - 1);
        let ratio = e.half_width(0.95).unwrap() / e.std_error.unwrap();
        assert!((ratio / t - 1.0).abs() < 1e-8, "{walks}: {ratio}");
    }
    let e = scores(|u| u, 100, 3);
    for bad in [0.0, 1.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(e.half_width(bad), None);
    }
}
