//! Bad input, each with the error it must give: the variant, and the words and numbers that tell a user what to change. Nothing panics.

#[path = "common/erased.rs"]
mod erased;

use erased::{AnyKernel, AnySource, Equation, kernel_fn, source_fn};
use fredholm::check::{self, Settings};
use fredholm::detector::{Bins, Functional, Points};
use fredholm::domain::{Cuboid, Domain, Grouped, HalfLine, Interval, Node};
use fredholm::kernel::{Density, HasDomain, Kernel, Operator, Proposed, RowMass, Step, Transition, TransitionPdf, Uniform};
use fredholm::sampling::Sampler;
use fredholm::source::{SampleSource, Source};
use fredholm::statistics::{Target, Verdict};
use fredholm::walk::{Collision, Ending, Heuristic, OwnAbsorption, Roulette, Scoring, Survival};
use fredholm::{Error, Walk};
use std::panic::{AssertUnwindSafe, catch_unwind};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

type Outcome = Result<(), Error>;
type Case = (&'static str, Box<dyn Fn() -> Outcome>, &'static str, &'static str);

fn case(name: &'static str, run: impl Fn() -> Outcome + 'static, variant: &'static str, words: &'static str) -> Case {
    (name, Box::new(run), variant, words)
}

/// Collision walks at ½ of a closure equation on an interval.
fn solve(
    interval: impl Into<Interval>,
    g: impl Fn(f64) -> f64 + Send + Sync + Clone,
    k: impl Fn(f64, f64) -> f64 + Send + Sync + Clone,
) -> Outcome {
    Equation::on_interval(interval.into(), g, k).at(0.5).solve(&Walk::collision()).map(drop)
}

fn with<C, E>(walk: &Walk<C, E>) -> Outcome
where
    C: for<'a> Scoring<SourceOf, KernelOf>,
    E: Ending<KernelOf>,
{
    let eq = Equation::new(source_fn(unit(), (|_: &f64| 1.0) as Flat), plain());
    eq.at(0.5).solve(walk).map(drop)
}

type Flat = fn(&f64) -> f64;
type Two = fn(&f64, &f64) -> f64;
type SourceOf = AnySource<'static, Interval>;
type KernelOf = Proposed<AnyKernel<'static, Interval>, Uniform<Interval>>;

fn unit() -> Interval {
    Interval::from(0.0..=1.0)
}

fn plain() -> KernelOf {
    Proposed::new(kernel_fn(unit(), (|x, y| 0.5 * x * y) as Two), Uniform::on(unit()))
}

// ---------------------------------------------------------------- kernels of a user's own

/// What is wrong with a hand-written transition.
#[derive(Clone, Copy, PartialEq)]
enum Own {
    /// K(x, ζ) is NaN for ζ > 0.9, where no step ever goes
    NanInConnections,
    NoDensity,
    NanWeight,
    InfiniteWeight,
    NegativeMass,
    NanMass,
    NeverDies,
}

struct Hand(Own);

impl Operator for Hand {
    type Point = f64;
    type Weight = f64;
}
impl Kernel for Hand {
    fn eval(&self, _: &f64, y: &f64) -> f64 {
        if self.0 == Own::NanInConnections && *y > 0.9 { NAN } else { 0.5 }
    }
}
impl Transition for Hand {
    fn step<S: Sampler>(&self, _: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        let y = u.next_1d();
        match self.0 {
            Own::NanInConnections => Some(Step::with_pdf(0.9 * y, 0.5, 1.0 / 0.9)),
            Own::NoDensity => Some(Step::new(y, 0.5)),
            Own::NanWeight if y > 0.95 => Some(Step::with_pdf(y, NAN, 1.0)),
            Own::InfiniteWeight if y > 0.95 => Some(Step::with_pdf(y, INF, 1.0)),
            Own::NeverDies => Some(Step::with_pdf(y, 1.0, 1.0)),
            _ => Some(Step::with_pdf(y, 0.5, 1.0)),
        }
    }
}
impl TransitionPdf for Hand {
    fn pdf(&self, _: &f64, _: &f64) -> f64 {
        1.0
    }
}
impl RowMass for Hand {
    fn mass(&self, _: &f64) -> f64 {
        match self.0 {
            Own::NegativeMass => -0.5,
            Own::NanMass => NAN,
            _ => 0.5,
        }
    }
}

fn own(fault: Own) -> fredholm::Equation<SourceOf, Hand> {
    Equation::new(source_fn(unit(), (|_: &f64| 1.0) as Flat), Hand(fault))
}

/// An ending with a probability that is none.
#[derive(Clone, Copy, Debug)]
struct Odds(f64);

impl<K: Operator> Ending<K> for Odds {
    fn survival(&self, _: &K, _: &K::Point, _: u64, _: f64) -> Survival {
        Survival::with_probability(self.0)
    }
}

/// A source that is fine where walks go, and NaN where next event looks.
struct Lamp;

impl Source for Lamp {
    type Point = f64;
    type Value = f64;
    fn eval(&self, x: &f64) -> f64 {
        if *x > 2.0 { NAN } else { 1.0 }
    }
}
impl SampleSource for Lamp {
    fn sample_for<S: Sampler>(&self, _: &f64, u: &mut S) -> Option<Node<f64>> {
        Some(Node { point: 2.0 + u.next_1d(), weight: 1.0 })
    }
    fn pdf_for(&self, _: &f64, _: &f64) -> f64 {
        1.0
    }
}

// ---------------------------------------------------------------- the table

#[rustfmt::skip]
fn cases() -> Vec<Case> {
    let one = |_: f64| 1.0;
    let k = |x: f64, y: f64| 0.5 * x * y;
    vec![
        // values that are not finite, with the place
        case("g NaN", move || solve(0.0..=1.0, |_| NAN, k), "NonFiniteSource", "g(0.5) = NaN"),
        case("g infinite", move || solve(0.0..=1.0, |_| INF, k), "NonFiniteSource", "g(0.5) = inf"),
        case("g NaN at rare points", move || solve(0.0..=1.0, |x| if x > 0.3 && x < 0.3004 { NAN } else { 1.0 }, |_, _| 0.6), "NonFiniteSource", "g(0.300"),
        case("g NaN at rare points, deep in a walk", move || Equation::on_interval(0.0..=1.0, |x: f64| if x > 0.3 && x < 0.30004 { NAN } else { 1.0 }, |_, _| 0.99)
            .at(0.5).solve(&Walk::collision()).map(drop), "NonFiniteSource", "g(0.3000"),
        case("g NaN in connections", || Equation::new(Lamp, plain()).at(0.5).solve(&Walk::next_event()).map(drop), "NonFiniteSource", "g(2."),
        case("g NaN in connections of MIS", || Equation::new(Lamp, plain()).at(0.5).solve(&Walk::mis()).map(drop), "NonFiniteSource", "g(2."),
        case("g NaN from tabulated_source", move || Equation::on_interval(0.0..=1.0, |x: f64| if x > 0.9 { NAN } else { 1.0 }, k)
            .tabulated_source(16).map(drop), "NonFiniteSource", "g(0.9"),
        case("K NaN", move || solve(0.0..=1.0, one, |_, _| NAN), "NonFiniteKernel", "= NaN"),
        case("K infinite in a region", move || solve(0.0..=1.0, one, |_, y| if y > 0.99 { INF } else { 0.1 }), "NonFiniteKernel", ", 0.99"),
        case("K NaN at rare points", move || solve(0.0..=1.0, one, |_, y: f64| if (y - 0.123_456).abs() < 2e-5 { NAN } else { 0.9 }), "NonFinite", "0.1234"),
        case("K NaN in connections", || own(Own::NanInConnections).at(0.5).solve(&Walk::next_event()).map(drop), "NonFiniteKernel", ", 0.9"),
        case("K NaN in connections of MIS", || own(Own::NanInConnections).at(0.5).solve(&Walk::mis()).map(drop), "NonFiniteKernel", ", 0.9"),
        case("K NaN from tabulated", move || Equation::on_interval(0.0..=1.0, one, |_, y| if y > 0.9 { NAN } else { 0.1 }).tabulated(16).map(drop), "NonFiniteKernel", ", 0.9"),
        case("K NaN on a half line", move || Equation::on_domain(HalfLine::new(0.0), |_| 1.0, |x: &f64, y: &f64| (x - y).sqrt()).at(0.5).solve(&Walk::collision()).map(drop), "NonFiniteKernel", "= NaN"),
        case("the point is NaN", move || Equation::on_interval(0.0..=1.0, |x| x, k).at(NAN).solve(&Walk::collision()).map(drop), "NonFiniteSource", "g(NaN) = NaN"),
        case("a step of weight NaN", || own(Own::NanWeight).at(0.5).solve(&Walk::collision()).map(drop), "NonFiniteWeight", "weight NaN"),
        case("a step of infinite weight", || own(Own::InfiniteWeight).at(0.5).solve(&Walk::collision()).map(drop), "NonFiniteWeight", "weight inf"),
        case("a step of weight NaN, roulette that never looks at it", || own(Own::NanWeight).at(0.5)
            .solve(&Walk::collision().roulette(Roulette::constant(0.5))).map(drop), "NonFiniteWeight", "weight NaN"),
        case("h NaN", move || Equation::on_interval(0.0..=1.0, one, k).seen_by(&Functional::new(unit(), |x| (x - 2.0).sqrt())).solve(&Walk::collision()).map(drop),
            "NonFiniteStart", "with weight NaN"),
        case("a row mass that is negative", || own(Own::NegativeMass).at(0.5).solve(&Walk::subcritical()).map(drop), "InvalidProbability", "-0.5"),
        case("a row mass that is NaN", || own(Own::NanMass).at(0.5).solve(&Walk::subcritical()).map(drop), "InvalidProbability", "NaN"),
        case("an ending of negative probability", || with(&Walk::new(Collision, Odds(-0.1))), "InvalidProbability", "-0.1"),
        // intervals and domains
        case("reversed interval", move || solve(1.0..=0.0, one, k), "Invalid", "interval end = 0: must be greater than the start"),
        case("empty interval", move || solve(1.0..=1.0, one, k), "Invalid", "interval end = 1"),
        case("interval from NaN", move || solve(NAN..=1.0, one, k), "Invalid", "interval start = NaN: must be finite"),
        case("interval to infinity", move || solve(0.0..=INF, one, k), "Invalid", "interval end = inf: must be finite"),
        case("interval from minus infinity", move || solve(-INF..=0.0, one, k), "Invalid", "interval start = -inf"),
        case("interval of infinite length", move || solve(-f64::MAX..=f64::MAX, one, k), "Invalid", "interval length = inf"),
        case("interval of nine numbers", move || solve(1e15..=1e15 + 1.0, one, k), "Invalid", "interval length = 1: holds less than"),
        case("half line from NaN", || half(HalfLine::new(NAN)), "Invalid", "half-line start = NaN"),
        case("half line of scale 0", || half(HalfLine::new(0.0).scale(0.0)), "Invalid", "half-line scale = 0: must be positive and finite"),
        case("half line of negative scale", || half(HalfLine::new(0.0).scale(-1.0)), "Invalid", "half-line scale = -1"),
        case("half line of infinite scale", || half(HalfLine::new(0.0).scale(INF)), "Invalid", "half-line scale = inf"),
        case("a reversed side", || cube(Cuboid::from([0.0..=1.0, 1.0..=0.0])), "Invalid", "interval end = 0"),
        case("no dimension", || cube(Cuboid::<0>::unit()), "Invalid", "dimension = 0"),
        case("no groups", || Equation::on_domain(Grouped::new(unit(), 0), |_| 1.0, |_, _| 0.1).at((0.5, 0)).solve(&Walk::collision()).map(drop), "Invalid", "groups = 0"),
        case("groups of a bad interval", || Equation::on_domain(Grouped::new(Interval::from(1.0..=0.0), 2), |_| 1.0, |_, _| 0.1).at((0.5, 0)).solve(&Walk::collision()).map(drop),
            "Invalid", "interval end"),
        // budgets and tables
        case("no samples", || with(&Walk::collision().samples_per_cell(0)), "Invalid", "samples_per_cell = 0: must be at least 1"),
        case("no steps", || with(&Walk::collision().max_steps(0)), "Invalid", "max_steps = 0"),
        case("no cells of a table", move || Equation::on_interval(0.0..=1.0, one, k).tabulated(0).map(drop), "Invalid", "cells = 0"),
        case("no cells of a source's table", move || Equation::on_interval(0.0..=1.0, one, k).tabulated_source(0).map(drop), "Invalid", "cells = 0"),
        case("a table on a reversed interval", move || Equation::on_interval(1.0..=0.0, one, k).tabulated(4).map(drop), "Invalid", "interval end"),
        case("a table in two dimensions", || Equation::on_domain(Cuboid::<2>::unit(), |_| 1.0, |_, _| 0.1).tabulated(4).map(drop), "Invalid", "dimension = 2"),
        case("a source's table in two dimensions", || Equation::on_domain(Cuboid::<2>::unit(), |_| 1.0, |_, _| 0.1).tabulated_source(4).map(drop), "Invalid", "dimension = 2"),
        // roulettes and heuristics
        case("P = 0", || with(&Walk::collision().roulette(Roulette::constant(0.0))), "Invalid", "roulette survival probability = 0: must lie in (0, 1]"),
        case("P < 0", || with(&Walk::collision().roulette(Roulette::constant(-0.1))), "Invalid", "roulette survival probability = -0.1"),
        case("P > 1", || with(&Walk::collision().roulette(Roulette::constant(1.1))), "Invalid", "roulette survival probability = 1.1"),
        case("P NaN", || with(&Walk::collision().roulette(Roulette::constant(NAN))), "Invalid", "roulette survival probability = NaN"),
        case("reference 0", || with(&Walk::collision().roulette(Roulette::throughput(0.0))), "Invalid", "roulette reference throughput = 0"),
        case("reference < 0", || with(&Walk::collision().roulette(Roulette::throughput(-1.0))), "Invalid", "roulette reference throughput = -1"),
        case("reference NaN", || with(&Walk::collision().roulette(Roulette::throughput(NAN).after(3))), "Invalid", "roulette reference throughput = NaN"),
        case("reference infinite", || with(&Walk::collision().roulette(Roulette::throughput(INF))), "Invalid", "roulette reference throughput = inf"),
        case("power 0", || with(&Walk::mis().heuristic(Heuristic::Power(0.0))), "Invalid", "power heuristic exponent = 0: must be positive and finite"),
        case("power < 0", || with(&Walk::mis().heuristic(Heuristic::Power(-2.0))), "Invalid", "power heuristic exponent = -2"),
        case("power NaN", || with(&Walk::mis().heuristic(Heuristic::Power(NAN))), "Invalid", "power heuristic exponent = NaN"),
        case("power infinite", || with(&Walk::mis().heuristic(Heuristic::Power(INF))), "Invalid", "power heuristic exponent = inf"),
        // walks that do not end, series that do not converge
        case("roulette of P = 1", || with(&Walk::collision().roulette(Roulette::constant(1.0))), "NeverEnds", "the kernel never absorbs and the method has no roulette"),
        case("no absorption, no roulette", || with(&Walk::new(Collision, OwnAbsorption)), "NeverEnds", "add `.roulette"),
        case("absorption without an ending", || with(&Walk::absorption()), "Invalid", "absorption probability = 0: the absorption estimator needs walks that may end"),
        case("absorption by throughput", || with(&Walk::absorption().roulette(Roulette::throughput(1.0))), "Invalid", "absorption probability = 0"),
        case("absorption after a start", || with(&Walk::absorption().roulette(Roulette::constant(0.5).after(2))), "Invalid", "absorption probability = 0"),
        case("absorption at a fixed depth", || with(&Walk::absorption().depth(3)), "Invalid", "depth = 3: the absorption estimator needs walks that end at random"),
        case("a walk of too many steps", || with(&Walk::collision().roulette(Roulette::constant(0.999)).max_steps(10)), "WalkTooLong", "still alive after 10 steps"),
        case("a transition that never ends", || own(Own::NeverDies).at(0.5).solve(&Walk::collision().max_steps(1000).samples_per_cell(8)).map(drop), "WalkTooLong", "1000 steps"),
        case("a series that diverges", move || solve(0.0..=1.0, one, |_, _| 1.5), "Divergent", "spectral radius of |T| is 1.5"),
        case("a signed series that diverges", move || solve(0.0..=1.0, one, |_, _| -1.5), "Divergent", "1.5"),
        case("a diverging half line", move || Equation::on_domain(HalfLine::new(0.0), |_| 1.0, |x: &f64, y: &f64| (-(x - y).abs()).exp()).at(0.5)
            .solve(&Walk::collision()).map(drop), "Divergent", "≥ 1"),
        case("a divergence that was accepted", move || Equation::on_interval(0.0..=1.0, one, |_, _| 2.0).at(0.5)
            .solve(&Walk::collision().accept_divergence().samples_per_cell(8)).map(drop), "Overflow", "the scores overflow"),
        case("weights that overflow", move || Equation::on_interval(0.0..=1.0, one, |_, _| 1e200).at(0.5).solve(&Walk::fixed_depth(4)).map(drop), "Overflow", "at vertex 2"),
        case("scores whose sum overflows", move || solve(0.0..=1.0, |_| 1e308, |_, _| 0.0), "Overflow", "the scores overflow"),
        // densities
        case("next event without density", || own(Own::NoDensity).at(0.5).solve(&Walk::next_event()).map(drop), "UnstatedDensity", "next-event estimation needs"),
        case("MIS without density", || own(Own::NoDensity).at(0.5).solve(&Walk::mis()).map(drop), "UnstatedDensity", "multiple importance sampling needs"),
        // detectors
        case("no points", move || Equation::on_interval(0.0..=1.0, one, k).on(&[]).solve(&Walk::collision()).map(drop), "Invalid", "cells = 0"),
        case("no points, given by hand", move || Equation::on_interval(0.0..=1.0, one, k).seen_by(&Points(vec![])).solve(&Walk::collision()).map(drop), "Invalid", "cells = 0"),
        case("no bins", move || Equation::on_interval(0.0..=1.0, one, k).seen_by(&Bins::new(0.0..=1.0, 0)).solve(&Walk::collision()).map(drop), "Invalid", "bins = 0"),
        case("reversed bins", move || Equation::on_interval(0.0..=1.0, one, k).seen_by(&Bins::new(1.0..=0.0, 4)).solve(&Walk::collision()).map(drop), "Invalid", "interval end"),
        case("functional on a reversed interval", move || Equation::on_interval(0.0..=1.0, one, k)
            .seen_by(&Functional::new(Interval::from(1.0..=0.0), |_| 1.0)).solve(&Walk::collision()).map(drop), "Invalid", "interval end"),
        // targets
        case("target 0", || Target::absolute(0.0).map(drop), "Invalid", "target absolute error = 0: must be positive and finite"),
        case("target < 0", || Target::absolute(-1.0).map(drop), "Invalid", "target absolute error = -1"),
        case("target NaN", || Target::relative(NAN).map(drop), "Invalid", "target relative error = NaN"),
        case("target infinite", || Target::relative(INF).map(drop), "Invalid", "target relative error = inf"),
        case("confidence 1", || Target::absolute(1.0)?.confidence(1.0).map(drop), "Invalid", "target confidence = 1: must lie strictly between 0 and 1"),
        case("confidence 0", || Target::absolute(1.0)?.confidence(0.0).map(drop), "Invalid", "target confidence = 0"),
        case("confidence NaN", || Target::absolute(1.0)?.confidence(NAN).map(drop), "Invalid", "target confidence = NaN"),
        // checkpoints
        case("checkpoint of another seed", || resume(Walk::collision().seed(1), Walk::collision().seed(2), 1, 1), "Checkpoint", "method was"),
        case("checkpoint of another roulette", || resume(Walk::collision(), Walk::collision().roulette(Roulette::constant(0.5)), 1, 1), "Checkpoint", "Constant"),
        case("checkpoint of other steps", || resume(Walk::collision(), Walk::collision().max_steps(99), 1, 1), "Checkpoint", "99"),
        case("checkpoint of other points", || resume(Walk::collision(), Walk::collision(), 1, 3), "Checkpoint", "number of cells was 1, now 3"),
        // checks
        case("check at no place", || check::transition(&plain(), Settings::default().places(0)).map(drop), "Invalid", "check places = 0"),
        case("check without samples", || check::transition(&plain(), Settings::default().samples(0)).map(drop), "Invalid", "check samples = 0"),
        case("check without a level", || check::density(&plain(), Settings::default().false_alarm(0.0)).map(drop), "Invalid", "check false alarm = 0"),
        case("check of a reversed interval", || check::transition(&reversed(), Settings::default()).map(drop), "Invalid", "interval end"),
    ]
}

fn half(domain: HalfLine) -> Outcome {
    Equation::on_domain(domain, |_| 1.0, |x: &f64, y: &f64| 0.1 * (-x - y).exp()).at(0.5).solve(&Walk::collision()).map(drop)
}

fn cube<const D: usize>(domain: Cuboid<D>) -> Outcome {
    Equation::on_domain(domain, |_| 1.0, |_, _| 0.1).at([0.5; D]).solve(&Walk::collision()).map(drop)
}

fn reversed() -> KernelOf {
    let domain = Interval::from(1.0..=0.0);
    Proposed::new(kernel_fn(domain, (|x, y| 0.5 * x * y) as Two), Uniform::on(domain))
}

/// Saves a run of `before` at `points.0` points, and resumes it with `after` at `points.1`.
fn resume<E: Ending<KernelOf>>(before: Walk, after: Walk<Collision, E>, points: usize, now: usize) -> Outcome {
    let eq = Equation::new(source_fn(unit(), (|_: &f64| 1.0) as Flat), plain());
    let (old, new) = (vec![0.5; points], vec![0.5; now]);
    let saved = eq.on(&old).rounds(&before)?.checkpoint();
    eq.on(&new).rounds(&after)?.resume(saved).map(drop)
}

#[test]
fn every_bad_input_is_refused_in_words() {
    let cases = cases();
    assert!(cases.len() >= 40, "{}", cases.len());
    let mut wrong = Vec::new();
    for (name, run, variant, words) in &cases {
        match catch_unwind(AssertUnwindSafe(run)) {
            Err(_) => wrong.push(format!("{name}: panicked")),
            Ok(Ok(())) => wrong.push(format!("{name}: accepted")),
            Ok(Err(e)) => {
                let (debug, text) = (format!("{e:?}"), e.to_string());
                if !debug.starts_with(variant) || !text.contains(words) {
                    wrong.push(format!("{name}: wanted {variant} «{words}», got {debug}: {text}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {} wrong:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

// ---------------------------------------------------------------- odd, but right

/// M(x) > 1 on half of the domain, ρ < 1: subcritical walks survive there and carry the weight on. Not an error, and not biased.
#[test]
fn masses_above_one_are_handled() {
    // K = 1.6·1{x < ½}·y: f = 1 + 1.6·1{x < ½}·c with c = ∫ y f = ½ + 1.6 c/8
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| if x < 0.5 { 3.0 * y } else { 0.0 }).tabulated(16).unwrap();
    let c = 0.5 / (1.0 - 3.0 / 8.0);
    assert!(eq.kernel().mass(&0.25) > 1.0);
    let f = eq.at(0.25).solve(&Walk::subcritical().samples_per_cell(1 << 18)).unwrap();
    assert!(f.agrees_with(1.0 + 3.0 * c, 5.0), "{f} against {}", 1.0 + 3.0 * c);
}

/// A peak that every sample of the table misses: the row's mass is unknown, and must not become a survival probability of 0.
#[test]
fn a_peak_between_the_samples_of_a_table_is_no_bias() {
    let k = |_: f64, y: f64| if y > 0.60 && y < 0.62 { 1.5 } else { 0.0 };
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, k).tabulated(1).unwrap();
    assert!(eq.kernel().mass(&0.3) > 0.0);
    // f = 1 + 1.5·0.02·f(peak) = 1/(1 − 0.03)
    let f = eq.at(0.3).solve(&Walk::subcritical().samples_per_cell(1 << 19)).unwrap();
    assert!(f.agrees_with(1.0 / 0.97, 5.0) && f.value != 1.0, "{f:#}");
}

/// A convergent series whose coarse discretisation is hopeless, by a peak away from the diagonal: not refused on false grounds.
#[test]
fn an_unresolved_peak_is_not_refused() {
    let k = |_: f64, y: f64| if (y - 0.5101).abs() < 0.002 { 100.0 } else { 0.0 };
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, k);
    assert!(eq.at(0.5).solve(&Walk::collision().samples_per_cell(64)).is_ok());
}

/// Scores of 10³⁰⁰: the value stands; that their powers overflow is a doubt, not an error and not a NaN in disguise.
#[test]
fn huge_scores_are_doubted_not_refused() {
    let eq = Equation::on_interval(0.0..=1.0, |x| 1e300 * (1.0 + x), |_, _| 0.5);
    let f = eq.at(0.5).solve(&Walk::collision()).unwrap();
    // f = g + ½ c, c = 1.5e300/(1 − ½)
    assert!((f.value / 3e300 - 1.0).abs() < 0.1, "{f:?}");
    assert_eq!(f.verdict(), Verdict::Doubtful);
    assert!(!f.agrees_with(0.0, 5.0) || f.std_error.unwrap() > 1e299, "{f:?}");
}

/// A state beyond the last group: closures may know it, so the table must not panic over it.
#[test]
fn states_beyond_the_last_do_not_panic() {
    let domain = Grouped::new(unit(), 2);
    assert!(!domain.contains(&(0.5, 7)));
    let eq = Equation::on_domain(domain, |_: &(f64, usize)| 1.0, |_: &(f64, usize), _: &(f64, usize)| 0.1).tabulated(4).unwrap();
    let f = eq.at((0.5, 7)).solve(&Walk::collision()).unwrap();
    assert!(f.agrees_with(1.25, 5.0));
}

/// Points outside the interval are answered by the equation itself: f(x) = g(x) + ∫ K(x, y) f(y) dy holds wherever K and g do.
#[test]
fn points_outside_the_domain_extend_the_solution() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let f = eq.at(2.0).solve(&Walk::collision()).unwrap();
    assert!(f.agrees_with(1.6, 5.0), "{f}");
}

/// The same with a table, whose shells around x then sit at the nearest end.
#[test]
fn tables_are_unbiased_for_points_outside_the_domain() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * x * y).tabulated(8).unwrap();
    for (x, f) in [(2.0, 1.6), (-1.0, 0.7)] {
        let e = eq.at(x).solve(&Walk::collision().samples_per_cell(1 << 16)).unwrap();
        assert!(e.agrees_with(f, 5.0), "{x}: {e} against {f}");
    }
    let half =
        Equation::on_domain(HalfLine::new(0.0), |_| 1.0, |x: &f64, y: &f64| 0.5 * (x + 3.0) * (-2.0 * y).exp()).tabulated(16).unwrap();
    // f = 1 + (x + 3) c/2, c = ∫ e^{−2y} f = ½ + c/2 (¼ + 3/2)
    let c = 0.5 / (1.0 - 0.875);
    let e = half.at(-1.0).solve(&Walk::collision().samples_per_cell(1 << 16)).unwrap();
    assert!(e.agrees_with(1.0 + c, 5.0), "{e} against {}", 1.0 + c);
}

/// After a failure a run of rounds is over; it does not go on as if nothing had happened.
#[test]
fn rounds_end_with_their_first_error() {
    let eq = Equation::on_interval(0.0..=1.0, |_| NAN, |_: f64, _: f64| 0.1);
    let query = eq.at(0.5);
    let mut rounds = query.rounds(&Walk::collision()).unwrap();
    assert!(rounds.next().unwrap().is_err());
    assert!(rounds.next().is_none());
}

/// The diagonal may be singular, and only it.
#[test]
fn a_singular_diagonal_is_no_error() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| -0.2 * (x - y).abs().ln());
    assert!(eq.at(0.5).solve(&Walk::collision()).is_ok());
    assert!(eq.tabulated(8).unwrap().at(0.5).solve(&Walk::subcritical()).is_ok());
}

#[test]
fn steps_say_what_they_are() {
    assert_eq!(Step::new(0.5, 1.0).density(), Density::Unstated);
    assert_eq!(Step::with_pdf(0.5, 1.0, NAN).density(), Density::Unstated);
    let domain = plain();
    assert_eq!(HasDomain::domain(&domain).volume(), 1.0);
}
