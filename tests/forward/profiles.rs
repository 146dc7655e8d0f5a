//! Curves from forward walks: unbiased where they say so, biased as they say, and bands that hold for the whole curve.

use crate::common::{Budget, Reference, all_pass, slope};
use crate::erased::Equation;
use fredholm::deterministic::Nystrom;
use fredholm::statistics::{Bias, Moments, Profile, Verdict};
use fredholm::transport::Slab;
use fredholm::walk::{Expansion, Histogram, KernelTally, OwnAbsorption, Smoothed, Tally};
use fredholm::{Forward, Walk};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// f = 1 + 3x/10: straight, so that every tally says it without bias (its own bias is of f″, or of degrees above 1).
macro_rules! straight {
    () => {
        Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y)
    };
}

fn line(x: f64) -> f64 {
    1.0 + 0.3 * x
}

/// Points where something can score: K(0, ·) = 0.
fn points(n: u32) -> Vec<f64> {
    (1..=n).map(|i| f64::from(i) / f64::from(n)).collect()
}

/// 95 % bands of four tallies contain the whole curve in 95 of 100 runs; a band for 99 % is wider.
#[test]
fn bands_cover_the_whole_curve() {
    const RUNS: u64 = 1000;
    let mut budget = Budget::of("forward::bands");
    let (eq, xs) = (straight!(), points(10));
    let mut hits = [0u64; 4];
    let mut pointwise = 0;
    for seed in 0..RUNS {
        let walks = Forward::new().walks(1 << 11).seed(seed);
        let profiles: [Profile<f64>; 4] = [
            eq.solve(&walks.profile(KernelTally::at(&xs)).batches(16)).unwrap(),
            eq.solve(&walks.profile(Histogram::new(0.0..=1.0, 8)).batches(16)).unwrap(),
            eq.solve(&walks.profile(Smoothed::at(0.0..=1.0, &xs)).batches(16)).unwrap(),
            eq.solve(&walks.profile(Expansion::legendre(0.0..=1.0, 3, &xs)).batches(16)).unwrap(),
        ];
        for (hits, f) in hits.iter_mut().zip(&profiles) {
            let truth: Vec<f64> = f.points().iter().map(|x| line(*x)).collect();
            *hits += u64::from(f.band(0.95).unwrap().contains(&truth));
        }
        let (f, errors) = (&profiles[1], profiles[1].std_errors().unwrap());
        pointwise += u64::from((0..8).all(|i| (f.values()[i] - line(f.points()[i])).abs() < 2.13 * errors[i]));
    }
    let what = ["kernel tally", "histogram", "smoothed", "expansion"];
    all_pass(what.into_iter().zip(hits).map(|(what, hits)| budget.frequency(what, hits, RUNS, 0.94, 0.96)).collect::<Vec<_>>());
    assert!(pointwise < RUNS * 85 / 100, "intervals at single points would be no band: {pointwise} of {RUNS}");
}

/// The bumps of a smoothed profile are a detector like others: walks back from them find ∫ κ_x f, which is f(x) where f is straight, at the ends too.
#[test]
fn bumps_are_seen_from_both_sides() {
    let mut budget = Budget::of("forward::bumps");
    let (eq, xs) = (straight!(), [0.97, 0.02, 0.5]);
    let detector = Smoothed::at(0.0..=1.0, &xs).plan(&eq, 1 << 10).unwrap().detector;
    let found = eq.seen_by(&detector).solve(&Walk::collision().samples_per_cell(1 << 16)).unwrap();
    let one = |(x, e): (&f64, &fredholm::Estimate)| {
        let seen = (e.value, e.std_error.unwrap(), e.degrees_of_freedom as f64);
        budget.mean(&format!("x = {x}"), seen, line(*x), 0.05)
    };
    all_pass(xs.iter().zip(&found).map(one).collect::<Vec<_>>());
}

/// Σ W_n K(x, Z_n) at 20 points against Nyström, one set of walks.
#[test]
fn the_kernel_tally_is_unbiased_at_every_point() {
    let mut budget = Budget::of("forward::points");
    let eq = Equation::on_interval(0.0..=1.0, |x: f64| 1.0 + x, |x: f64, y: f64| 0.7 * (-x * y * y).exp() * (1.0 + x - y));
    let exact = eq.solve(&Nystrom::gauss_legendre(32)).unwrap();
    let f = eq.solve(&Forward::new().walks(1 << 19).profile(KernelTally::at(&points(20)))).unwrap();
    assert!(f.bias() == Bias::None && f.verdict() == Verdict::Trustworthy, "{f}");
    let one = |(i, x): (usize, &f64)| {
        budget.mean(&format!("x = {x}"), (f.values()[i], f.std_errors().unwrap()[i], 127.0), exact.eval(*x), 0.02 * f.values()[i])
    };
    all_pass(f.points().iter().enumerate().map(one).collect::<Vec<_>>());
    // the walks are common: neighbours agree about their errors
    let variance = f.covariance(9, 9).unwrap();
    assert!((variance.sqrt() / f.std_errors().unwrap()[9] - 1.0).abs() < 1e-12);
    assert!(f.covariance(9, 10).unwrap() > 0.9 * variance);
}

/// A logarithm on the diagonal is square-integrable: the kernel tally of a slab is finite and right.
#[test]
fn the_kernel_tally_of_a_slab() {
    let mut budget = Budget::of("forward::slab");
    let reference = Reference::load("slab-c0.9-a1-uniform");
    let slab = Slab::new(1.0).scattering(0.9);
    let eq = Equation::new(slab.uniform(1.0), &slab);
    let values = reference.scalar();
    let xs: Vec<f64> = values.iter().map(|v| v.0).collect();
    let walks = Forward::new().ending(OwnAbsorption).walks(1 << 18);
    let f = eq.solve(&walks.profile(KernelTally::at(&xs))).unwrap();
    let one = |(i, (x, truth)): (usize, &(f64, f64))| {
        budget.mean(&format!("x = {x}"), (f.values()[i], f.std_errors().unwrap()[i], 127.0), *truth, 0.04 * truth)
    };
    all_pass(values.iter().take(3).enumerate().map(one).collect::<Vec<_>>());
}

/// K = ½ x²: T f = c x², whose smoothing over ± b errs by exactly c b²/5 in the middle, and by as many b² next to an end.
#[test]
fn smoothing_errs_by_its_square() {
    let mut budget = Budget::of("forward::smoothing");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, _: f64| 0.5 * x * x);
    // f = 1 + c x², c = ½ ∫ f = ½ (1 + c/3)
    let c = 0.6;
    let mut results = Vec::new();
    for b in [0.4, 0.2, 0.1] {
        let at = Smoothed::at(0.0..=1.0, &[0.5, 1.0]).bandwidth(b);
        let f = eq.solve(&Forward::new().walks(1 << 21).profile(at)).unwrap();
        assert_eq!(f.bias(), Bias::Smoothing { bandwidth: b });
        // ∫ u² κ_x du for the one-sided kernel: (a₂² − a₁ a₃)/(a₀ a₂ − a₁²) with a = (1/2, 3/16, 1/10, 1/16)
        let end = (0.01 - 3.0 / 256.0) / (0.05 - 9.0 / 256.0);
        for (i, (truth, shape, margin)) in [(1.0 + c * 0.25, 0.2, 0.003), (1.0 + c, end, 0.025)].into_iter().enumerate() {
            let seen = (f.values()[i], f.std_errors().unwrap()[i], 127.0);
            results.push(budget.mean(&format!("b = {b}, point {i}"), seen, truth + c * b * b * shape, margin));
        }
    }
    all_pass(results);
    // the default shrinks with the number of walks
    let width = |n| match eq.solve(&Forward::new().walks(n).profile(Smoothed::at(0.0..=1.0, &[0.5]))).unwrap().bias() {
        Bias::Smoothing { bandwidth } => bandwidth,
        other => panic!("{other:?}"),
    };
    assert!((width(1 << 7) / width(1 << 12) - 2.0).abs() < 1e-12);
}

/// With b ∝ n^(−1/5) the bias is c b²/5 ∝ n^(−2/5) and the mean square error falls as n^(−4/5) (theory (4.6.4)).
#[test]
fn smoothing_converges_at_its_rate() {
    let mut budget = Budget::of("forward::smoothing rate");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, _: f64| 0.5 * x * x);
    let c = 0.6;
    let (mut results, mut sizes) = (Vec::new(), Vec::new());
    for (log, repetitions) in [(8, 800), (11, 800), (14, 400), (17, 200)] {
        let n = 1u64 << log;
        let error = |seed| {
            let at = Smoothed::at(0.0..=1.0, &[0.5]).shrinking(1.5);
            eq.solve(&Forward::new().walks(n).seed(seed).profile(at).batches(2)).unwrap().values()[0] - (1.0 + 0.25 * c)
        };
        let errors: Vec<f64> = (0..repetitions).map(error).collect();
        let (b, m) = (1.5 * (n as f64).powf(-0.2), Moments::from_scores(&errors));
        let bias = c * b * b / 5.0;
        results.push(budget.mean(&format!("bias, n = {n}"), (m.mean, m.std_error().unwrap(), m.count as f64 - 1.0), bias, bias));
        sizes.push((n as f64, errors));
    }
    results.push(budget.mean("slope of the rms error", slope(&sizes), -0.4, 0.09));
    all_pass(results);
}

/// Coefficients against quadrature of the deterministic solution; what is cut off is measured.
#[test]
fn expansions() {
    let mut budget = Budget::of("forward::expansion");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (x * y).exp());
    let exact = eq.solve(&Nystrom::gauss_legendre(24)).unwrap();
    let xs = [0.0, 0.3, 1.0];
    let walks = Forward::new().walks(1 << 18);
    let mut results = Vec::new();
    for (tally, margin) in [(Expansion::legendre(0.0..=1.0, 5, &xs), 0.15), (Expansion::chebyshev_second(0.0..=1.0, 9, &xs), 0.3)] {
        let (missed, all) = tally.missed(|x| exact.integral_term(x).unwrap());
        assert!(missed < 0.04 * all && missed > 0.0, "{missed} {all}");
        let f = eq.solve(&walks.profile(tally)).unwrap();
        for (i, x) in xs.iter().enumerate().filter(|(_, x)| f.bias() == Bias::Projection { terms: 5 } || **x == 0.3) {
            results.push(budget.mean(&format!("{x}"), (f.values()[i], f.std_errors().unwrap()[i], 127.0), exact.eval(*x), margin));
        }
    }
    // fewer terms miss more, and Legendre's are the best in the mean square
    let missed = |terms| Expansion::legendre(0.0..=1.0, terms, &[]).missed(|x| exact.integral_term(x).unwrap()).0;
    assert!(missed(2) > 10.0 * missed(3) && missed(3) > 10.0 * missed(4));
    all_pass(results);
}

/// |x − y|^−α in the kernel tally: for α ≥ ½ no variance exists, and the verdict says so; the histogram of the same walks has one.
#[test]
fn singular_kernels_are_found_out() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.06 * (x - y).abs().powf(-0.7)).tabulated(32).unwrap();
    let walks = Forward::new().walks(1 << 16).seed(1);
    let f = eq.solve(&walks.profile(KernelTally::at(&[0.3, 0.6]))).unwrap();
    assert_eq!(f.verdicts(), [Verdict::InfiniteVariance; 2], "{f}");
    assert!(f.to_string().contains("infinite variance"));
    let means = eq.solve(&walks.profile(Histogram::new(0.0..=1.0, 4))).unwrap();
    assert_eq!(means.verdict(), Verdict::Trustworthy, "{means}");
}

/// More cells than tails are kept for: an infinite variance would not be seen, and no verdict is better than doubtful.
#[test]
fn what_has_no_tail_is_doubtful() {
    let verdict = |count| straight!().solve(&Forward::new().walks(1 << 12).profile(KernelTally::at(&points(count)))).unwrap().verdict();
    assert_eq!((verdict(1024), verdict(1025)), (Verdict::Trustworthy, Verdict::Doubtful));
}

/// Means of a g with a singular end or a jump are right to what the profile says; one without a mean has no band. K = 0: no walk adds to them.
#[test]
fn sources_that_are_hard_to_integrate() {
    type Hard = fn(f64) -> f64;
    let rows: [(Hard, f64); 4] = [
        (|x| x.powf(-0.6), 2.5),
        (|x| (1.0 - x).powf(-0.8), 5.0),
        (|x| f64::from(u8::from(x > 0.377)), 0.623),
        (f64::recip, f64::INFINITY),
    ];
    for (g, integral) in rows {
        let eq = Equation::on_interval(0.0..=1.0, g, |_, _| 0.0);
        let f = eq.solve(&Forward::new().walks(256).profile(Histogram::new(0.0..=1.0, 4))).unwrap();
        let error = (f.values().iter().sum::<f64>() / 4.0 - integral).abs();
        assert!(error <= f.source_error() && (f.source_error() < 0.2 * integral || integral.is_infinite()), "{error} {}", f.source_error());
    }
    // noise is given up, not pursued to the last bit
    let asked = AtomicU64::new(0);
    let noise = |x: f64| {
        assert!(asked.fetch_add(1, Relaxed) < 1 << 20, "asked without end");
        (x.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / 2f64.powi(53)
    };
    let eq = Equation::on_interval(0.0..=1.0, noise, |_, _| 0.0);
    let f = eq.solve(&Forward::new().walks(256).profile(Histogram::new(0.0..=1.0, 4))).unwrap();
    let error = (f.values().iter().sum::<f64>() / 4.0 - 0.5).abs();
    assert!(error <= f.source_error() && f.source_error() > 1e-6, "{error} {}", f.source_error());
}

/// Unbiased but for the cut.
#[test]
fn cut_walks_say_so() {
    let f = straight!().solve(&Forward::new().depth(1).profile(KernelTally::at(&[1.0]))).unwrap();
    let (bias, bound) = (line(1.0) - 1.25, f.truncation().unwrap().bias_bound.unwrap());
    // the bound is the largest at places down to 1e-9 from the ends
    assert!(bias <= bound * (1.0 + 1e-8) && f.to_string().contains("cut at depth 1 (|bias| ≤"), "{f}");
    assert!(straight!().solve(&Forward::new().profile(KernelTally::at(&[1.0]))).unwrap().truncation().is_none());
}

/// What nothing reaches is unknown: no interval, and a band without ends.
#[test]
fn the_unreached_is_unknown() {
    // walks never leave the left half
    let eq =
        Equation::on_interval(0.0..=1.0, |x: f64| f64::from(u8::from(x < 0.5)), |x: f64, y: f64| f64::from(u8::from(x < 0.5 && y < 0.5)));
    let f = eq.solve(&Forward::new().profile(Histogram::new(0.0..=1.0, 4))).unwrap();
    assert_eq!(f.verdicts()[3], Verdict::NothingScored);
    assert_eq!(f.verdict(), Verdict::NothingScored);
    let band = f.band(0.95).unwrap();
    assert_eq!((band.lower[3], band.upper[3]), (f64::NEG_INFINITY, f64::INFINITY));
    assert!(band.upper[0].is_finite() && band.critical > 1.9);
}

/// One batch knows nothing of its error.
#[test]
fn one_batch_has_no_band() {
    let eq = straight!();
    let f = eq.solve(&Forward::new().profile(KernelTally::at(&[0.5])).batches(1)).unwrap();
    assert!(f.band(0.95).is_none() && f.std_errors().is_none() && f.covariance(0, 0).is_none() && f.to_string().contains("errors unknown"));
    let f = eq.solve(&Forward::new().profile(KernelTally::at(&[0.5]))).unwrap();
    assert!(f.band(0.0).is_none() && f.band(1.0).is_none() && f.batches() == 128);
}
