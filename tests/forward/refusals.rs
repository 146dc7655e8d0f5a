//! Bad input, each with the error it must give.

use crate::erased::{Equation, source_fn};
use fredholm::detector::{Bins, Functional};
use fredholm::domain::Interval;
use fredholm::kernel::{HasAdjoint, Kernel, Operator, Step, Transition};
use fredholm::sampling::Sampler;
use fredholm::statistics::Verdict;
use fredholm::walk::{Collision, Expansion, Histogram, KernelTally, OwnAbsorption, Roulette, Smoothed};
use fredholm::{Error, Forward};

type Flat = fn(&f64) -> f64;
type Two = fn(&f64, &f64) -> f64;

fn unit() -> Interval {
    Interval::from(0.0..=1.0)
}

fn forward(g: Flat, k: Two, walks: &Forward) -> Result<(), Error> {
    Equation::on_domain(unit(), g, k).seen_by(&Bins::new(0.0..=1.0, 4)).solve(walks).map(drop)
}

fn refused(outcome: Result<(), Error>, words: &str) {
    match outcome {
        Err(e) => assert!(e.to_string().contains(words), "{e}"),
        Ok(()) => panic!("accepted, although {words}"),
    }
}

#[test]
fn functions_that_are_not_finite_are_named_with_the_place() {
    let k: Two = |x, y| 0.5 * x * y;
    refused(forward(|_| f64::NAN, k, &Forward::new()), "the source starts walk 0");
    refused(forward(|x| if *x > 0.9 { f64::INFINITY } else { 1.0 }, k, &Forward::new()), "with weight inf");
    refused(forward(|_| 1.0, |x, _| if *x > 0.9 { f64::NAN } else { 0.5 }, &Forward::new()), "kernel K is not finite: K(0.9");
    let eq = Equation::on_domain(unit(), (|_| 1.0) as Flat, k);
    let h = Functional::new(unit(), |x: &f64| if *x > 0.9 { f64::NAN } else { 1.0 });
    refused(eq.seen_by(&h).solve(&Forward::new()).map(drop), "detector cell 0 scores NaN");
    let eq = Equation::on_domain(unit(), (|_| 1.0) as Flat, (|x, y| if *x == 0.5 && *y > 0.3 { f64::NAN } else { 0.5 }) as Two);
    refused(eq.at(0.5).solve(&Forward::next_event()).map(drop), "kernel K is not finite: K(0.5, ");
    let eq = Equation::on_domain(unit(), (|x| if *x == 0.5 { f64::NAN } else { 1.0 }) as Flat, k);
    refused(eq.at(0.5).solve(&Forward::next_event()).map(drop), "source g is not finite: g(0.5)");
    refused(eq.solve(&Forward::new().profile(KernelTally::at(&[0.5]))).map(drop), "source g is not finite: g(0.5)");
}

#[test]
fn settings_out_of_range() {
    let (g, k): (Flat, Two) = (|_| 1.0, |x, y| 0.5 * x * y);
    refused(forward(g, k, &Forward::new().walks(0)), "samples_per_cell = 0");
    refused(forward(g, k, &Forward::new().max_steps(0)), "max_steps = 0");
    refused(forward(g, k, &Forward::new().roulette(Roulette::constant(1.5))), "roulette survival probability = 1.5");
    refused(forward(g, |_, _| 0.5, &Forward::new().roulette(Roulette::constant(1.0))), "walks cannot end");
    refused(forward(g, |_, _| 1.5, &Forward::new().max_steps(100)), "the Neumann series diverges");
    refused(forward(g, |_, _| 1.5, &Forward::new().accept_divergence().max_steps(100)), "still alive after 100 steps");
    let eq = Equation::on_domain(unit(), g, k);
    let refuse = |xs: &[f64], words| refused(eq.solve(&Forward::new().profile(Smoothed::at(0.0..=1.0, xs))).map(drop), words);
    refuse(&[], "points = 0");
    refuse(&[0.5, 1.5], "1.5 is outside");
    refuse(&[f64::NAN], "NaN is outside");
    let walks = Forward::new();
    refused(eq.solve(&walks.profile(Smoothed::at(0.0..=1.0, &[0.5]).bandwidth(0.0))).map(drop), "bandwidth = 0");
    refused(eq.solve(&walks.profile(Smoothed::at(0.0..=1.0, &[0.5]).shrinking(-1.0))).map(drop), "bandwidth factor = -");
    refused(eq.solve(&walks.profile(Smoothed::at(1.0..=0.0, &[0.5]))).map(drop), "interval end = 0");
    refused(eq.solve(&walks.profile(Expansion::legendre(0.0..=1.0, 0, &[0.5]))).map(drop), "terms = 0");
    let many = Expansion::legendre(0.0..=1.0, usize::MAX, &[0.5]);
    assert!(many.missed(|x| x).0.is_nan());
    refused(eq.solve(&walks.profile(many)).map(drop), "must be at most 4096");
    refused(eq.solve(&walks.profile(Histogram::new(0.0..=1.0, 0))).map(drop), "bins = 0");
    refused(eq.solve(&walks.profile(KernelTally::at(&[]))).map(drop), "cells = 0");
    refused(eq.solve(&walks.profile(KernelTally::at(&[0.5])).batches(0)).map(drop), "batches = 0");
}

/// A detector beyond the reach of all walks: unknown, never 0 ± 0.
#[test]
fn an_unreached_detector_is_unknown() {
    let eq =
        Equation::on_domain(unit(), (|x| f64::from(u8::from(*x < 0.5))) as Flat, (|x, y| f64::from(u8::from(*x < 0.5 && *y < 0.5))) as Two);
    let far = Functional::new(unit(), |x: &f64| f64::from(u8::from(*x > 0.9)));
    let e = eq.seen_by(&far).solve(&Forward::new()).unwrap();
    assert!(e.verdict() == Verdict::NothingScored && e.std_error.is_none() && e.half_width(0.95).is_none(), "{e:#}");
    assert!(!e.agrees_with(0.0, 4.0) && e.to_string() == "0(?)");
}

/// Half of the light goes on to 1 − x by a mirror, half is spread evenly: K = ¼ + ¼ δ(y − (1 − x)).
#[derive(Clone)]
struct Mirror;

impl Operator for Mirror {
    type Point = f64;
    type Weight = f64;
}

impl Kernel for Mirror {
    fn eval(&self, _: &f64, _: &f64) -> f64 {
        0.25
    }
}

impl Transition for Mirror {
    fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        match u.next_1d() {
            v if v < 0.25 => Some(Step::singular(1.0 - x, 1.0)),
            v if v < 0.5 => Some(Step::with_pdf(u.next_1d(), 1.0, 0.25)),
            _ => None,
        }
    }
}

impl HasAdjoint for Mirror {
    type Adjoint = Mirror;
    fn adjoint(&self) -> Result<Mirror, Error> {
        Ok(Mirror)
    }
}

#[test]
fn mirrors_are_scored_by_collisions_alone() {
    let eq = Equation::new(source_fn(unit(), |_: &f64| 1.0), Mirror);
    let bins = Bins::new(0.0..=1.0, 2);
    let means = eq.seen_by(&bins).solve(&Forward::scoring(Collision, OwnAbsorption).walks(1 << 16)).unwrap();
    assert!(means[0].agrees_with(2.0, 5.0) && means[1].agrees_with(2.0, 5.0), "{means:?}");
    let refused_with = |outcome: Result<(), Error>| assert!(matches!(outcome, Err(Error::SingularStep { .. })), "{outcome:?}");
    refused_with(eq.seen_by(&bins).solve(&Forward::next_event().ending(OwnAbsorption)).map(drop));
    refused_with(eq.solve(&Forward::new().ending(OwnAbsorption).profile(KernelTally::at(&[0.5]))).map(drop));
}
