//! The worked problems of the lectures, with their exact variances, and the slips of lecture notes (theory §2.2) as tests.

use crate::common::{Budget, all_pass};
use crate::stated;
use fredholm::domain::{Cuboid, Disk, HalfLine, Line};
use fredholm::integral::{Coefficient, Combined, Control, Density, Gauss, Integral, Plain, Secondary, Strata, Stratified, inverse, warp};
use fredholm::sampling::distribution::Power;
use fredholm::sampling::{Pcg, Sampler, Sequence};
use fredholm::statistics::{Moments, Study, Verdict};
use fredholm::walk::Heuristic;
use fredholm::{Estimate, Spectrum};
use std::f64::consts::{E, PI};

const N: u64 = 1 << 16;

fn rule() -> Gauss {
    Gauss::legendre(8, 16)
}

/// The measured variance of one score against the formula: SE(s²) from the fourth moment.
fn variance(e: &Estimate) -> (f64, f64, f64) {
    let (n, v) = (e.samples() as f64, e.variance().unwrap());
    (v, ((e.moments.m4 / n - v * v) / n).sqrt(), 1e6)
}

/// theory (2.2.8): ∫x² with 4/45 and 1/72, ∫eˣ with 0.2420 and 0, ∫₀^π sin with p = sin/2 and 0.
#[test]
fn worked_problems_have_their_exact_variances() {
    let mut budget = Budget::of("integral::lectures");
    let square = Integral::on_interval(0.0..=1.0, |x| x * x);
    let exponential = Integral::on_interval(0.0..=1.0, f64::exp);
    let sine = Integral::on_interval(0.0..=PI, f64::sin);
    let linear = inverse(|u: f64| u.sqrt(), |x: &f64| 2.0 * x);
    let mut results = Vec::new();
    let e2 = (E * E - 1.0) / 2.0 - (E - 1.0).powi(2);
    assert!((e2 - 0.2420).abs() < 5e-5);
    let mut check = |name: &str, e: Estimate, predicted: f64, truth: f64, v: f64| {
        assert!((predicted - v).abs() < 1e-12, "{name}: predicted {predicted}, exact {v}");
        results.push(budget.mean(name, stated(&e), truth, 0.04 * truth));
        results.push(budget.mean(&format!("{name}, variance"), variance(&e), v, 0.1 * v));
        assert_eq!(e.verdict(), Verdict::Trustworthy, "{name}");
        let efficiency = 1.0 / (e.std_error.unwrap().powi(2) * e.evaluations as f64);
        assert!((e.efficiency().unwrap() / efficiency - 1.0).abs() < 1e-12 && e.evaluations == N);
    };
    let plain = Secondary::plain().samples(N).seed(3);
    let one = |p: f64| p * N as f64;
    let predicted = |p: Result<f64, fredholm::Error>| one(p.unwrap());
    check("∫x²", square.solve(&plain).unwrap(), predicted(square.predict(&plain, &rule())), 1.0 / 3.0, 4.0 / 45.0);
    check("∫eˣ", exponential.solve(&plain).unwrap(), predicted(exponential.predict(&plain, &rule())), E - 1.0, e2);
    let by_line = Secondary::importance(linear).samples(N).seed(3);
    check("∫x², p = 2x", square.solve(&by_line).unwrap(), predicted(square.predict(&by_line, &rule())), 1.0 / 3.0, 1.0 / 72.0);
    all_pass(results);

    // zero variance: exact to rounding, and sure of it
    let of_sine = Secondary::importance(inverse(|u: f64| (1.0 - 2.0 * u).acos(), |x: &f64| x.sin() / 2.0)).samples(N);
    let of_exp = Secondary::importance(inverse(|u: f64| (u * (E - 1.0)).ln_1p(), |x: &f64| x.exp() / (E - 1.0))).samples(N);
    for (e, truth) in [(sine.solve(&of_sine).unwrap(), 2.0), (exponential.solve(&of_exp).unwrap(), E - 1.0)] {
        assert!((e.value - truth).abs() < 1e-15 * truth && e.std_error.unwrap() < 1e-17 && e.variance().unwrap() < 1e-30, "{e:?}");
        assert!(e.agrees_with(truth, 1.0) && e.verdict() != Verdict::NothingScored);
    }
    assert!(sine.predict(&of_sine, &rule()).unwrap() < 1e-30 && exponential.predict(&of_exp, &rule()).unwrap() < 1e-30);
}

/// Zero variance that is exact in binary: no error at all. All scores zero: unknown, not certain.
#[test]
fn certain_and_unknown_are_not_the_same() {
    let half = Integral::on_interval(0.0..=2.0, |_| 0.25);
    for e in [
        half.solve(&Secondary::plain()).unwrap(),
        half.solve(&Stratified::new(Strata::uniform(8))).unwrap(),
        half.solve(&Stratified::jittered(Strata::uniform(64), 16)).unwrap(),
    ] {
        assert_eq!((e.value, e.std_error, e.verdict()), (0.5, Some(0.0), Verdict::Trustworthy));
    }
    // a spike that no sample finds
    let spike = Integral::on_interval(0.0..=1.0, |x: f64| if (0.123_456_7..0.123_456_8).contains(&x) { 1e7 } else { 0.0 });
    for e in
        [spike.solve(&Secondary::plain().samples(1000)).unwrap(), spike.solve(&Stratified::new(Strata::uniform(8)).samples(1000)).unwrap()]
    {
        assert_eq!((e.value, e.verdict()), (0.0, Verdict::NothingScored));
        // neither printed nor counted as certain
        assert_eq!((e.to_string().as_str(), e.half_width(0.95), e.interval(0.5)), ("0(?)", None, None));
    }
    let study = Study::run(1.0, 10, |seed| spike.solve(&Secondary::plain().samples(1000).seed(seed))).unwrap();
    assert_eq!((study.coverage(0.95).trials, study.coverage(0.95).unknown), (0, 10));
    // no error, no verdict about it
    let textbook = half.solve(&Secondary::plain().sequence(fredholm::sampling::Sobol::new(0).unscrambled())).unwrap();
    assert_eq!((textbook.verdict(), textbook.to_string().as_str()), (Verdict::Unmeasured, "0.5(?)"));
}

/// theory (2.2.1): n times the samples, a variance n times less, a standard error √n times less.
#[test]
fn the_variance_falls_by_n_and_the_error_by_its_root() {
    let integral = Integral::on_interval(0.0..=1.0, |x| x * x);
    let at = |n: u64| {
        let plain = Secondary::plain().samples(n).seed(1);
        (integral.solve(&plain).unwrap(), integral.predict(&plain, &rule()).unwrap())
    };
    let ((small, v), (large, w)) = (at(1 << 14), at(1 << 18));
    assert!((v / w - 16.0).abs() < 1e-9);
    let ratio = small.std_error.unwrap() / large.std_error.unwrap();
    assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
}

/// theory (2.2.2): f² stands in the variance of the combined estimate; with f it is another number, even of another unit.
#[test]
fn the_variance_of_the_combined_estimate_has_the_square() {
    let mut budget = Budget::of("integral::square");
    let (f, p2) = (|x: f64| x * x, |x: f64| 2.0 * x);
    let integral = Integral::on_interval(0.0..=1.0, f);
    let techniques = Combined::new(Heuristic::Balance)
        .technique(inverse(|u: f64| u, |_: &f64| 1.0), 1)
        .technique(inverse(|u: f64| u.sqrt(), |x: &f64| 2.0 * x), 1);
    let e = integral.solve(&Secondary::combined(techniques).samples(N)).unwrap();
    // by hand: w₁ = 1/(1 + 2x), w₂ = 2x/(1 + 2x)
    let unit = Integral::on_interval(0.0..=1.0, |x: f64| {
        Spectrum([1.0 / (1.0 + 2.0 * x), f(x) / (1.0 + 2.0 * x), p2(x) * f(x) / (1.0 + 2.0 * x)])
    });
    let Spectrum([_, i1, i2]) = unit.solve(&rule()).unwrap();
    let sum = |square: bool| {
        let h = move |x: f64| if square { f(x) * f(x) } else { f(x) } / (1.0 + 2.0 * x);
        Integral::on_interval(0.0..=1.0, h).solve(&rule()).unwrap() - i1 * i1 - i2 * i2
    };
    budget.mean("with f²", variance(&e), sum(true), 0.1 * sum(true)).unwrap();
    assert!(budget.mean("with f", variance(&e), sum(false), f64::INFINITY).is_err());
}

/// theory (2.2.5): two equal densities tie everywhere. The maximum gives each point to one of them; giving it to both doubles the integral.
#[test]
fn ties_of_the_maximum_count_once() {
    let mut budget = Budget::of("integral::ties");
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let uniform = || inverse(|u: f64| u, |_: &f64| 1.0);
    let three = Combined::new(Heuristic::Maximum).technique(uniform(), 1).technique(uniform(), 1).technique(uniform(), 1);
    let e = integral.solve(&Secondary::combined(three).samples(N)).unwrap();
    budget.mean("maximum of three equal techniques", stated(&e), E - 1.0, 0.02).unwrap();
    for h in [Heuristic::Maximum, Heuristic::Average, Heuristic::Balance, Heuristic::Power(2.0), Heuristic::Power(0.7)] {
        // ties, near ties, extreme ratios and zeros
        for p in [[1.0, 1.0, 1.0], [2.0, 2.0f64.next_down(), 0.0], [1e-300, 1e300, 5e-324], [0.0, 3.0, 3.0], [0.3, 0.1 + 0.2, 0.3]] {
            let weights: Vec<f64> = (0..3).map(|i| h.weight(i, p.iter().copied())).collect();
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{h:?} {p:?} {weights:?}");
            assert!(p.iter().zip(&weights).all(|(p, w)| *p > 0.0 || *w == 0.0));
        }
    }
}

/// The average of techniques is over those that can find the point (theory (4.4.5)).
#[test]
fn a_technique_that_cannot_find_a_point_has_no_share() {
    let mut budget = Budget::of("integral::blind");
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    // the second sees only the left half
    let half = inverse(|u: f64| u / 2.0, |x: &f64| if *x <= 0.5 { 2.0 } else { 0.0 });
    for h in [Heuristic::Average, Heuristic::Maximum, Heuristic::Balance, Heuristic::Power(2.0)] {
        let two = Combined::new(h).technique(inverse(|u: f64| u, |_: &f64| 1.0), 1).technique(half.clone(), 2);
        let e = integral.solve(&Secondary::combined(two).samples(N)).unwrap();
        budget.mean(&format!("{h:?}"), stated(&e), E - 1.0, 0.06).unwrap();
    }
    // alone it misses half of the integral: the prediction says so, the samples cannot
    let alone = Secondary::importance(half.clone());
    assert_eq!(integral.predict(&alone, &rule()).unwrap(), f64::INFINITY);
    assert_eq!(
        integral.predict(&Secondary::combined(Combined::new(Heuristic::Balance).technique(half, 1)), &rule()).unwrap(),
        f64::INFINITY
    );
}

/// Whatever can be drawn from is a technique: its density divides and weighs, and predicts the variance.
#[test]
fn distributions_are_densities() {
    let mut budget = Budget::of("integral::distributions");
    let integral = Integral::on_interval(0.0..=1.0, |x: f64| x * x);
    let square = || Power::new(1.0).unwrap();
    let two = Combined::new(Heuristic::Balance).technique(square(), 1).technique(inverse(|u: f64| u, |_: &f64| 1.0), 1);
    let e = integral.solve(&Secondary::combined(two).samples(N)).unwrap();
    budget.mean("2x and 1", stated(&e), 1.0 / 3.0, 0.01).unwrap();
    // p = 2x: ∫ x⁴/2x − 1/9
    let alone = Secondary::importance(square()).samples(N);
    let predicted = integral.predict(&alone, &rule()).unwrap() * N as f64;
    assert!((predicted - 1.0 / 72.0).abs() < 1e-12, "{predicted}");
    budget.mean("2x, variance", variance(&integral.solve(&alone).unwrap()), predicted, 0.1 * predicted).unwrap();
}

/// theory (2.2.6): J estimated from the same sample cancels; the exact J helps.
#[test]
fn the_control_function_needs_its_integral() {
    let mut budget = Budget::of("integral::control");
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let (g, j) = (|x: &f64| 1.0 + x, 1.5);
    let plain = integral.solve(&Secondary::plain().samples(N)).unwrap();
    let xs: Vec<f64> = (0..N).map(|i| Pcg::new(0).point(0, 0, i).next_1d()).collect();
    let mean = |h: &dyn Fn(&f64) -> f64| xs.iter().map(h).sum::<f64>() / N as f64;
    let same_sample = mean(&|x| x.exp() - g(x)) + mean(&|x| g(x));
    assert!((same_sample - plain.value).abs() < 1e-12, "it cancels: {same_sample} against {}", plain.value);
    let control = Secondary::new(Control::new(Plain, g, j, Coefficient::Fixed(1.0))).samples(N);
    let e = integral.solve(&control).unwrap();
    budget.mean("α = 1", stated(&e), E - 1.0, 0.01).unwrap();
    let predicted = integral.predict(&control, &rule()).unwrap() * N as f64;
    budget.mean("α = 1, variance", variance(&e), predicted, 0.1 * predicted).unwrap();
    // the pilot's α is near the best, Cov/Var = 12 (∫x eˣ − ½∫eˣ) = 12 (1 − (e − 1)/2), and pays
    let tuned = Secondary::new(Control::new(Plain, g, j, Coefficient::Pilot(4096))).samples(N);
    let t = integral.solve(&tuned).unwrap();
    budget.mean("pilot", stated(&t), E - 1.0, 0.01).unwrap();
    let best = integral.predict(&tuned, &rule()).unwrap() * N as f64;
    let alpha = 12.0 * (1.0 - (E - 1.0) / 2.0);
    let by_hand = (E * E - 1.0) / 2.0 - (E - 1.0).powi(2) - alpha * alpha / 12.0;
    assert!((best - by_hand).abs() < 1e-12 && best < predicted);
    assert!((t.variance().unwrap() / best - 1.0).abs() < 0.1, "{:?} against {best}", t.variance());
    assert_eq!(t.evaluations, N + 4096);
    // a control function equal to f leaves nothing
    let all = integral.solve(&Secondary::new(Control::new(Plain, |x: &f64| x.exp(), E - 1.0, Coefficient::Fixed(1.0)))).unwrap();
    assert_eq!((all.value, all.std_error), (E - 1.0, Some(0.0)));
    // one that does not vary is of no use, and does no harm
    let flat = integral.solve(&Secondary::new(Control::new(Plain, |_: &f64| 1.0, 1.0, Coefficient::Pilot(100))).samples(N)).unwrap();
    assert_eq!(flat.value, plain.value);
}

/// theory (2.2.9): «from three dimensions on Monte Carlo is better» is false for smooth integrands: 512 nodes of Gauss against 2²⁰ random points.
#[test]
fn quadrature_beats_monte_carlo_in_three_dimensions_where_f_is_smooth() {
    let integral = Integral::on(Cuboid::<3>::unit(), |x| (x[0] + x[1] * x[2]).cos());
    let truth = integral.solve(&Gauss::legendre(2, 16)).unwrap();
    let gauss = integral.solve(&Gauss::legendre(1, 8)).unwrap();
    let random = integral.solve(&Secondary::plain().samples(1 << 20)).unwrap();
    assert!((gauss - truth).abs() < 1e-12 && (random.value - truth).abs() > 1e-6 && random.agrees_with(truth, 6.0));
}

/// Every domain, and values of several components.
#[test]
fn every_domain_can_be_integrated_over() {
    let mut budget = Budget::of("integral::domains");
    let mut results = Vec::new();
    let half_line = Integral::on(HalfLine::new(0.0), |x: &f64| Spectrum([(-x).exp(), x * (-x).exp()]));
    let e = half_line.solve(&Secondary::plain().samples(N)).unwrap();
    (0..2).for_each(|i| results.push(budget.mean("half line", stated(&e.component(i)), 1.0, 0.05)));
    let exact = half_line.solve(&Secondary::importance(inverse(|u: f64| -(-u).ln_1p(), |x: &f64| (-x).exp()))).unwrap();
    assert!((exact.value[0] - 1.0).abs() < 1e-15 && exact.std_error.unwrap()[0] < 1e-17);
    let disk = Integral::on(Disk::new([1.0, 0.0], 2.0), |x: &[f64; 2]| x[0] * x[0]);
    // ∫r² dA/2 + the centre's square: π R⁴/4 + π R²
    results.push(budget.mean("disk by its map", stated(&disk.solve(&Secondary::plain().samples(N)).unwrap()), 8.0 * PI, 1.2));
    let line = Integral::on(Line::new(), |x: &f64| (-x * x).exp());
    results.push(budget.mean("line", stated(&line.solve(&Secondary::plain().samples(N)).unwrap()), PI.sqrt(), 0.1));
    // the disk, as an importance density in the square: points outside the domain would score 0
    let disk = warp(
        |[u, v]: [f64; 2]| [u.sqrt() * (2.0 * PI * v).cos(), u.sqrt() * (2.0 * PI * v).sin()],
        |x: &[f64; 2]| if x[0].hypot(x[1]) <= 1.0 { 1.0 / PI } else { 0.0 },
    );
    let on_disk = |x: &[f64; 2]| if x[0].hypot(x[1]) <= 1.0 { x[0] * x[0] } else { 0.0 };
    let square = Integral::on(Cuboid::from([-1.0..=1.0, -1.0..=1.0]), on_disk);
    results.push(budget.mean("disk", stated(&square.solve(&Secondary::importance(disk).samples(N)).unwrap()), PI / 4.0, 0.05));
    let quarter = Integral::on(Cuboid::from([0.0..=1.0, 0.0..=1.0]), on_disk);
    results.push(budget.mean("quarter", stated(&quarter.solve(&Secondary::importance(disk).samples(N)).unwrap()), PI / 16.0, 0.05));
    assert!((disk.pdf(&[0.1, 0.2]) * PI - 1.0).abs() < 1e-15);
    // tables ∝ |f|
    let peak = Integral::on_interval(0.0..=1.0, |x: f64| 1.0 / (1e-4 + (x - 0.3).powi(2)));
    let truth = 100.0 * ((70.0f64).atan() + (30.0f64).atan());
    let table = peak.solve(&Secondary::importance(peak.tabulated(256).unwrap()).samples(N)).unwrap();
    results.push(budget.mean("table", stated(&table), truth, 0.02 * truth));
    let plain = peak.solve(&Secondary::plain().samples(N)).unwrap();
    assert!(table.variance().unwrap() < plain.variance().unwrap() / 100.0, "{table:?}");
    all_pass(results);
}

/// Bias, variance and MSE = V + β² of an estimator that is biased on purpose: α from the very scores it is used for.
#[test]
fn a_study_sees_the_bias() {
    let mut budget = Budget::of("integral::study");
    // two samples: the regression through them makes the variance vanish and the estimate wrong
    let biased = |seed: u64| {
        let xs: [f64; 2] = std::array::from_fn(|i| Pcg::new(seed).point(0, 0, i as u64).next_1d());
        let alpha = (xs[0].exp() - xs[1].exp()) / (xs[0] - xs[1]);
        let scores = xs.map(|x| x.exp() - alpha * (x - 0.5));
        let mut e = Integral::on_interval(0.0..=1.0, |_| 1.0).solve(&Secondary::plain().samples(2))?;
        (e.value, e.moments) = ((scores[0] + scores[1]) / 2.0, Moments::from_scores(&scores));
        Ok(e)
    };
    let study = Study::run(E - 1.0, 40_000, biased).unwrap();
    let bias = study.bias();
    assert!(budget.mean("bias", (bias.value, bias.std_error, 1e6), 0.0, f64::INFINITY).is_err(), "{bias:?}");
    let r = study.runs().len() as f64;
    let sum = study.variance().value * (r - 1.0) / r + bias.value * bias.value;
    assert!((study.mse().value / sum - 1.0).abs() < 1e-12);
    assert!(study.coverage(0.95).fraction() < 0.5);
    // the same number of samples, honest: no bias
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let honest = Study::run(E - 1.0, 40_000, |seed| integral.solve(&Secondary::plain().samples(2).seed(seed))).unwrap();
    budget.mean("no bias", (honest.bias().value, honest.bias().std_error, 1e6), 0.0, 0.05).unwrap();
}
