//! Bad input is refused with its name and number.

use fredholm::domain::{Cuboid, HalfLine, Interval};
use fredholm::integral::{
    Allocation, Coefficient, Combined, Control, Gauss, Importance, Integral, Plain, Roulette, Secondary, Strata, Stratified, inverse, warp,
};
use fredholm::statistics::{Study, Sweep};
use fredholm::walk::Heuristic;
use fredholm::{Error, Estimate};

fn invalid<T: std::fmt::Debug>(result: Result<T, Error>, name: &str) {
    match result {
        Err(Error::Invalid { parameter, .. }) if parameter == name => {}
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn parameters_out_of_range() {
    let i = Integral::on_interval(0.0..=1.0, f64::exp);
    let uniform = || inverse(|u: f64| u, |_: &f64| 1.0);
    let none: Combined<f64> = Combined::new(Heuristic::Balance);
    invalid(i.solve(&Secondary::plain().samples(0)), "samples");
    invalid(i.solve(&Secondary::combined(none.clone())), "techniques");
    invalid(i.solve(&Secondary::combined(none.clone().technique(uniform(), 0))), "samples of a technique");
    for beta in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let power = Combined::new(Heuristic::Power(beta)).technique(uniform(), 1);
        invalid(i.solve(&Secondary::combined(power)), "power heuristic exponent");
    }
    invalid(i.solve(&Secondary::combined(Combined::optimal(1).technique(uniform(), 1))), "pilot samples");
    for p in [0.0, -0.5, 1.5, f64::NAN] {
        invalid(i.solve(&Secondary::new(Roulette::new(Plain, p))), "roulette survival probability");
    }
    let control = |j, c| Secondary::new(Control::new(Plain, |x: &f64| *x, j, c));
    invalid(i.solve(&control(f64::NAN, Coefficient::Fixed(1.0))), "integral of the control function");
    invalid(i.solve(&control(0.5, Coefficient::Fixed(f64::INFINITY))), "control coefficient");
    invalid(i.solve(&control(0.5, Coefficient::Pilot(1))), "pilot samples");
    invalid(i.solve(&Stratified::new(Strata::uniform(0))), "strata");
    for cuts in [vec![0.0], vec![1.0], vec![0.5, 0.5], vec![0.7, 0.2], vec![f64::NAN]] {
        invalid(i.solve(&Stratified::new(Strata::cut_at(&cuts))), "cut");
    }
    invalid(i.solve(&Stratified::new(Strata::grid(2, 0))), "strata");
    invalid(i.solve(&Stratified::new(Strata::uniform(100_000).times(Strata::uniform(100_000)))), "strata");
    for absurd in [Strata::uniform(usize::MAX), Strata::grid(usize::MAX, 3), Strata::grid(2, usize::MAX), Strata::grid(1 << 40, 40)] {
        assert_eq!(absurd.count(), usize::MAX);
        invalid(i.solve(&Stratified::jittered(absurd, u32::MAX)), "strata");
    }
    assert!(i.solve(&Stratified::new(Strata::grid(1, usize::MAX))).unwrap().agrees_with(1f64.exp() - 1.0, 6.0));
    invalid(Strata::adapted(&i, usize::MAX), "strata");
    invalid(i.solve(&Stratified::new(Strata::uniform(4)).samples(0)), "samples");
    invalid(i.solve(&Stratified::new(Strata::uniform(4)).replicates(0)), "replicates");
    invalid(i.solve(&Stratified::new(Strata::uniform(4)).allocation(Allocation::Neyman { pilot: 1 })), "pilot samples a stratum");
    invalid(i.solve(&Gauss::legendre(0, 4)), "panels");
    invalid(i.solve(&Gauss::legendre(4, 0)), "order");
    invalid(Integral::on(Cuboid::<10>::unit(), |_| 1.0).solve(&Gauss::legendre(2, 8)), "nodes of the tensor rule");
    invalid(Integral::on_interval(1.0..=0.0, f64::exp).solve(&Secondary::plain()), "interval end");
    invalid(Integral::on(HalfLine::new(f64::NAN), |x: &f64| *x).solve(&Secondary::plain()), "half-line start");
    invalid(Strata::adapted(&i, 0), "strata");
    invalid(Strata::adapted(&Integral::on(Cuboid::<2>::unit(), |x| x[0]), 4), "dimension");
    invalid(i.tabulated(0), "cells");
    invalid(i.predict(&Stratified::new(Strata::grid(2, 2)), &Gauss::legendre(1, 4)), "axes of strata");
    // mass outside the domain, where the mixture of optimal weights is not 0
    let wide = Combined::optimal(16).technique(uniform(), 1).technique(inverse(|u: f64| 2.0 * u, |_: &f64| 0.5), 1);
    invalid(i.predict(&Secondary::combined(wide), &Gauss::legendre(4, 8)), "mass of a technique outside the domain");
    let run = |_| i.solve(&Secondary::plain());
    invalid(Study::run(1.0, 1, run), "repetitions");
    invalid(Study::run(f64::NAN, 5, run), "truth");
    invalid(Sweep::run(1.0, &[8, 16], 5, |_, s| run(s)).unwrap().rate(), "number of points");
}

/// Values that are no numbers are named with their place, by every method.
#[test]
fn values_that_are_no_numbers() {
    let i = Integral::on_interval(0.0..=1.0, |x| if x > 0.9 { f64::NAN } else { 1.0 });
    let uniform = || inverse(|u: f64| u, |_: &f64| 1.0);
    let results: Vec<Result<Estimate, Error>> = vec![
        i.solve(&Secondary::plain()),
        i.solve(&Secondary::importance(uniform())),
        i.solve(&Secondary::combined(Combined::new(Heuristic::Average).technique(uniform(), 3))),
        i.solve(&Secondary::combined(Combined::optimal(64).technique(uniform(), 3))),
        i.solve(&Secondary::new(Roulette::new(Plain, 0.5))),
        i.solve(&Secondary::new(Control::new(Plain, |x: &f64| *x, 0.5, Coefficient::Pilot(100)))),
        i.solve(&Stratified::new(Strata::uniform(10))),
        i.solve(&Stratified::new(Strata::uniform(10)).allocation(Allocation::Neyman { pilot: 4 })),
    ];
    for (k, r) in results.into_iter().enumerate() {
        let Err(Error::NonFiniteIntegrand { at, value }) = r else { panic!("{k}: {r:?}") };
        assert!(at.starts_with("0.9") && value == "NaN", "{k}: f({at}) = {value}");
    }
    assert!(matches!(i.solve(&Gauss::legendre(4, 8)), Err(Error::NonFiniteIntegrand { .. })));
    assert!(matches!(i.predict(&Secondary::plain(), &Gauss::legendre(4, 8)), Err(Error::NonFiniteIntegrand { .. })));
    assert!(matches!(i.predict(&Stratified::new(Strata::uniform(4)), &Gauss::legendre(4, 8)), Err(Error::NonFiniteIntegrand { .. })));
    assert!(matches!(i.tabulated(16), Err(Error::NonFiniteIntegrand { .. })));
    assert!(matches!(Strata::adapted(&i, 16), Err(Error::NonFiniteIntegrand { .. })));
    // the first bad score in order, whatever the threads
    let i = Integral::on(Interval::from(0.0..=1.0), |x: &f64| 1.0 / *x);
    let blind = warp(|[u]: [f64; 1]| u, |x: &f64| if *x < 0.5 { 0.0 } else { 1.0 });
    let Err(Error::NonFiniteScore { sample, replicate, .. }) = i.solve(&Secondary::importance(blind)) else { panic!() };
    let first = (0..100).find(|k| {
        use fredholm::sampling::{Pcg, Sampler, Sequence};
        Pcg::new(0).point(0, 0, *k).next_1d() < 0.5
    });
    assert_eq!((Some(sample), replicate), (first, 0));
    // a technique that denies its own points, and sums that overflow
    let two = Combined::new(Heuristic::Balance).technique(blind, 1).technique(inverse(|u: f64| u, |_: &f64| 1.0), 1);
    assert!(matches!(i.solve(&Secondary::combined(two)), Err(Error::NonFiniteScore { .. })));
    let huge = Integral::on_interval(0.0..=1.0, |_| 1e308);
    assert!(matches!(
        huge.solve(&Stratified::of(Importance(blind), Strata::cut_at(&[0.6])).samples(50)),
        Err(Error::NonFiniteScore { .. })
    ));
    assert!(matches!(huge.solve(&Secondary::plain()), Err(Error::NonFiniteScore { .. })));
}
