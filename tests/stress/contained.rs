//! A panic in a function of the user's is an error with its words, wherever the function is called.

use crate::erased::{Equation, source_fn};
use fredholm::check::{self, Settings};
use fredholm::detector::{At, Bins, Functional};
use fredholm::deterministic::{self, Galerkin, Nystrom};
use fredholm::domain::Interval;
use fredholm::estimator::{Combination, Debias, Metropolis, Survivors};
use fredholm::integral::{Gauss, Integral, Secondary, Strata, Stratified};
use fredholm::sampling::Sobol;
use fredholm::statistics::{Study, Sweep};
use fredholm::transport::{CollisionTally, Histories, Slab};
use fredholm::walk::{ArrayRqmc, Expansion, Histogram, KernelTally, Roulette, Smoothed};
use fredholm::{Bidirectional, Error, Forward, Walk};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

const WORDS: &str = "the function is broken";

/// What panics here does not fill the screen.
pub(crate) fn quietly() {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let loud = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if info.payload().downcast_ref::<&str>() != Some(&WORDS) {
                loud(info);
            }
        }));
    });
}

/// 1, or a panic.
pub(crate) fn one(broken: &AtomicBool) -> f64 {
    if broken.load(Ordering::Relaxed) { panic!("the function is broken") } else { 1.0 }
}

#[track_caller]
pub(crate) fn contained(results: impl IntoIterator<Item = Result<(), Error>>) {
    for (i, result) in results.into_iter().enumerate() {
        assert!(matches!(&result, Err(Error::Panicked { message }) if message == WORDS), "number {i} of these: {result:?}");
    }
}

pub(crate) fn unit() -> Interval {
    Interval::from(0.0..=1.0)
}

#[test]
fn in_walks_and_estimators() {
    quietly();
    let broken = AtomicBool::new(false);
    let eq = Equation::on_interval(0.0..=1.0, |x| one(&broken) + x, |x, y| 0.5 * x * y);
    let (query, bins) = (eq.at(0.5), Bins::new(0.0..=1.0, 4));
    let (seen, pairs) = (eq.seen_by(&bins), Bidirectional::new());
    let (walk, tally) = (query.estimator(&Walk::collision()).unwrap(), seen.tally(&Forward::new()).unwrap());
    let (depths, joined) = (query.depths().unwrap(), seen.bidirectional(&pairs).unwrap().shared());
    broken.store(true, Ordering::Relaxed);
    let xs = [0.2, 0.7];
    contained([
        query.solve(&ArrayRqmc::new(Walk::collision().sequence(Sobol::new(1)))).map(drop),
        query.solve(&Walk::mis().max_steps(u64::MAX)).map(drop),
        seen.solve(&Forward::new()).map(drop),
        query.solve(&pairs).map(drop),
        seen.solve(&pairs).map(drop),
        eq.solve(&Forward::new().profile(KernelTally::at(&xs))).map(drop),
        eq.solve(&Forward::new().profile(Histogram::new(0.0..=1.0, 4))).map(drop),
        eq.solve(&Forward::new().profile(Smoothed::at(0.0..=1.0, &xs))).map(drop),
        eq.solve(&Forward::new().profile(Expansion::legendre(0.0..=1.0, 3, &xs))).map(drop),
        Combination::new().with(&walk).with(&walk).solve().map(drop),
        Debias::new(depths).survivors(Survivors::Geometric(0.5)).solve().map(drop),
        Metropolis::new().solve(&tally).map(drop),
        Metropolis::new().solve(&joined).map(drop),
        Walk::collision().trace(&eq, &At(0.5), 0, 0).map(drop),
        Forward::new().trace(&eq, &bins, 0).map(drop),
        query.optimal(&Walk::mis(), 64).map(drop),
        eq.clone().tabulated_source(8).map(drop),
    ]);
    broken.store(false, Ordering::Relaxed);
    assert!(query.solve(&Walk::collision()).is_ok() && Metropolis::new().solve(&tally).is_ok());
}

/// h, and whatever repeats a solve.
#[test]
fn in_detectors_and_studies() {
    quietly();
    let broken = AtomicBool::new(true);
    let eq = Equation::on_interval(0.0..=1.0, |x| 1.0 + x, |x, y| 0.5 * x * y);
    let h = Functional::new(unit(), |x| x * one(&broken));
    let slab = Slab::new(1.0).scattering(0.5);
    contained([
        eq.seen_by(&h).solve(&Walk::collision()).map(drop),
        eq.seen_by(&h).solve(&Forward::new()).map(drop),
        eq.seen_by(&h).solve(&Bidirectional::new()).map(drop),
        Study::run(1.0, 4, |_| eq.at(one(&broken)).solve(&Walk::collision())).map(drop),
        Sweep::run(1.0, &[4, 8], 4, |_, _| eq.at(one(&broken)).solve(&Walk::collision())).map(drop),
        Histories::new(CollisionTally).run(&slab, &source_fn(Interval::from(0.0..=1.0), |x| x * one(&broken))).map(drop),
    ]);
}

#[test]
fn in_integrals() {
    quietly();
    let broken = AtomicBool::new(true);
    let integral = Integral::new(unit(), source_fn(unit(), |x: &f64| x * one(&broken)));
    contained([
        integral.solve(&Secondary::plain()).map(drop),
        integral.solve(&Stratified::new(Strata::uniform(4))).map(drop),
        integral.solve(&Gauss::legendre(2, 4)).map(drop),
        integral.predict(&Secondary::plain(), &Gauss::legendre(2, 4)).map(drop),
        integral.tabulated(8).map(drop),
        Strata::adapted(&integral, 8).map(drop),
    ]);
}

#[test]
fn in_deterministic_solutions() {
    quietly();
    let broken = AtomicBool::new(false);
    let eq = Equation::on_interval(0.0..=1.0, |x| 1.0 + x, |x, y| 0.5 * x * y * one(&broken));
    let (rule, kernel) = (Nystrom::gauss_legendre(8), eq.kernel().kernel());
    let (f, factorised, elements) = (eq.solve(&rule).unwrap(), eq.factorise(&rule).unwrap(), eq.solve(&Galerkin::elements(4)).unwrap());
    let prediction = eq.predict(&Walk::collision().roulette(Roulette::constant(0.5))).unwrap();
    broken.store(true, Ordering::Relaxed);
    contained([
        eq.solve(&Nystrom::adaptive()).map(drop),
        eq.solve(&Galerkin::elements(4)).map(drop),
        eq.factorise(&rule).map(drop),
        factorised.apply(eq.source(), &[0.5]).map(drop),
        f.try_eval(&0.5).map(drop),
        f.integral_term(0.5).map(drop),
        f.residual(0.5).map(drop),
        f.corrected_functional(|_| 1.0).map(drop),
        elements.iterated(0.5).map(drop),
        elements.error_estimate().map(drop),
        prediction.variance(0.5).map(drop),
        prediction.efficiency(0.5).map(drop),
        deterministic::classify(kernel).map(drop),
        deterministic::eigenvalues(kernel, &rule).map(drop),
        deterministic::spectral_radius(kernel, &Nystrom::adaptive()).map(drop),
        deterministic::determinant(kernel, 1.0, &rule).map(drop),
        check::equation(&eq, Settings::default()).map(drop),
        check::support(&eq, Settings::default()).map(drop),
        check::connections(&eq, Settings::default()).map(drop),
        check::density(eq.kernel(), Settings::default()).map(drop),
    ]);
    assert!(f.eval(0.5).is_nan());
    broken.store(false, Ordering::Relaxed);
    let by_hand = 1.5 + 0.5 * 0.5 * (0.5 + 1.0 / 3.0) / (1.0 - 1.0 / 6.0);
    assert!((f.eval(0.5) - by_hand).abs() < 1e-12 && f.residual(0.5).is_ok_and(|r| r.abs() < 1e-12), "{} {by_hand}", f.eval(0.5));
}

/// The panic of one walk in a million, the last: what the other rounds found is kept, and a mended function goes on to the bits of a run without it.
#[test]
fn in_the_last_walk_of_a_million() {
    quietly();
    const WALKS: u64 = 1_000_000;
    let (calls, broken) = (AtomicU64::new(0), AtomicBool::new(false));
    let last = AtomicU64::new(u64::MAX);
    let g = |x: f64| {
        let call = calls.fetch_add(1, Ordering::Relaxed);
        if call < last.load(Ordering::Relaxed) { 1.0 + x } else { 1.0 + x * one(&broken) }
    };
    let eq = Equation::on_interval(0.0..=1.0, g, |x, y| 0.5 * x * y);
    let walk = Walk::fixed_depth(0).samples_per_cell(WALKS);
    let query = eq.at(0.5);
    let whole = query.solve(&walk).unwrap();
    // as many calls again, but for the last of them
    last.store(calls.swap(0, Ordering::Relaxed) - 1, Ordering::Relaxed);
    broken.store(true, Ordering::Relaxed);
    let mut rounds = query.rounds(&walk).unwrap();
    let (mut kept, mut fault) = (None, None);
    for round in rounds.by_ref() {
        match round {
            Ok(round) => kept = Some(round),
            Err(e) => fault = Some(e),
        }
    }
    contained([Err(fault.expect("the last call panics"))]);
    assert!(kept.expect("rounds before").samples >= WALKS / 2);
    broken.store(false, Ordering::Relaxed);
    let again = query.rounds(&walk).unwrap().resume(rounds.checkpoint()).unwrap().last().unwrap().unwrap();
    assert_eq!((again.estimates.value.to_bits(), again.estimates.std_error), (whole.value.to_bits(), whole.std_error));
}

/// Of more cells than are walked at once, those that were done before a panic are not walked again after it.
#[test]
fn in_one_cell_of_many() {
    quietly();
    const CELLS: usize = 70_000;
    let broken = AtomicBool::new(false);
    let points: Vec<f64> = (0..CELLS).map(|i| (i as f64 + 0.5) / CELLS as f64).collect();
    let last = points[CELLS - 1];
    let eq = Equation::on_interval(0.0..=1.0, |x| if x == last { one(&broken) } else { 1.0 }, |x, y| 0.5 * x * y);
    let (query, walk) = (eq.on(&points), Walk::collision().samples_per_cell(64));
    let whole = query.solve(&walk).unwrap();
    let mut rounds = query.rounds(&walk).unwrap();
    rounds.next().unwrap().unwrap();
    broken.store(true, Ordering::Relaxed);
    contained([rounds.next().unwrap().map(drop)]);
    broken.store(false, Ordering::Relaxed);
    let rest = query.rounds(&walk).unwrap().resume(rounds.checkpoint()).unwrap().last().unwrap().unwrap();
    for (i, (a, b)) in whole.iter().zip(&rest.estimates).enumerate() {
        assert_eq!((a.moments, a.steps), (b.moments, b.steps), "cell {i}");
    }
}
