//! Every sequence in every estimator; variance laws, slopes and coverage of replicates of low-discrepancy points.

use crate::any::{Any, randomised};
use crate::common::{Budget, all_pass};
use crate::rates::slope;
use crate::stated;
use fredholm::domain::Cuboid;
use fredholm::integral::{
    Allocation, Coefficient, Combined, Control, Gauss, Integral, Integrator, Plain, Primary, Roulette, Secondary, Strata, inverse,
};
use fredholm::sampling::distribution::{Exponential, Power};
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, Sequence, Sobol, Stratified};
use fredholm::source::Source;
use fredholm::statistics::{Study, Sweep};
use fredholm::walk::Heuristic;
use fredholm::{Error, Estimate};
use std::f64::consts::E;

const N: u64 = 1 << 12;

fn rule() -> Gauss {
    Gauss::legendre(4, 16)
}

/// All estimators with one sequence; each must be right, and none may find less than it says.
fn every_estimator(name: &str, sequence: Any, budget: &mut Budget) -> Vec<Result<(), String>> {
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let line = || inverse(|u: f64| u.sqrt(), |x: &f64| 2.0 * x);
    let uniform = || inverse(|u: f64| u, |_: &f64| 1.0);
    let two = |c: Combined<f64>| c.technique(uniform(), 1).technique(line(), 1);
    let mut check = |what: &str, e: Result<Estimate, Error>| {
        let e = e.unwrap();
        assert!(e.std_error.unwrap() > 0.0 && e.samples() >= N);
        budget.mean(&format!("{name}, {what}"), stated(&e), E - 1.0, 0.4)
    };
    let mean = |primary| Secondary::new(primary).samples(N).sequence(sequence);
    vec![
        check("plain", integral.solve(&mean(Plain))),
        check("combined", integral.solve(&Secondary::new(two(Combined::new(Heuristic::Power(2.0)))).samples(N).sequence(sequence))),
        check("optimal", integral.solve(&Secondary::new(two(Combined::optimal(64))).samples(N).sequence(sequence))),
        check(
            "control",
            integral.solve(&Secondary::new(Control::new(Plain, |x: &f64| *x, 0.5, Coefficient::Pilot(64))).samples(N).sequence(sequence)),
        ),
        check("roulette", integral.solve(&Secondary::new(Roulette::new(Plain, 0.5)).samples(N).sequence(sequence))),
        check("strata", {
            let strata = fredholm::integral::Stratified::new(Strata::uniform(4)).allocation(Allocation::Neyman { pilot: 8 });
            integral.solve(&strata.samples(N).sequence(sequence))
        }),
    ]
}

#[test]
fn every_sequence_serves_every_estimator() {
    let mut budget = Budget::of("integral::sequences");
    let mut results = every_estimator("PCG", Any::Pcg(Pcg::new(5)), &mut budget);
    for (name, sequence) in randomised(16) {
        results.extend(every_estimator(name, sequence.with_seed(5), &mut budget));
    }
    all_pass(results);
}

/// Distributions of the crate are densities, without a wrapper.
#[test]
fn distributions_are_densities() {
    let integral = Integral::on_interval(0.0..=1.0, |x: f64| 3.0 * x * x);
    let e = integral.solve(&Secondary::importance(Power::new(2.0).unwrap())).unwrap();
    assert!((e.value - 1.0).abs() < 1e-14 && e.std_error.unwrap() < 1e-16, "{e:?}");
    let half_line = Integral::on(fredholm::domain::HalfLine::new(0.0), |x: &f64| x * (-x).exp());
    assert!(half_line.solve(&Secondary::importance(Exponential::new(0.5).unwrap())).unwrap().agrees_with(1.0, 6.0));
}

/// N rooks: Var ≤ σ²/(N−1) whatever f, even one that they cannot help; far less for a sum of functions of one coordinate (theory (4.14.5)).
#[test]
fn latin_hypercubes_are_within_their_bound() {
    let mut budget = Budget::of("integral::rooks");
    const POINTS: u64 = 16;
    let n = POINTS;
    let functions: [(&str, fn(&[f64; 2]) -> f64, f64); 4] = [
        ("sum", |x| x[0].exp() + x[1] * x[1], 0.2),
        ("product", |x| (2.0 * x[0] - 1.0) * (2.0 * x[1] - 1.0), 1.0),
        ("diagonal", |x| f64::from(u8::from(x[0] + x[1] > 1.0)), 1.0),
        ("step across the strata", |x| if (POINTS as f64 * x[0]).fract() + (POINTS as f64 * x[1]).fract() > 1.0 { 1.0 } else { -1.0 }, 1.0),
    ];
    for (name, f, share) in functions {
        let integral = Integral::on(Cuboid::<2>::unit(), f);
        let fine = Gauss::legendre(128, 4);
        let truth = integral.solve(&fine).unwrap();
        let bound = integral.predict(&Secondary::plain().samples(n - 1), &fine).unwrap();
        let rooks = LatinHypercube::new(n).unwrap().replicates(1);
        let s = Study::run(truth, 20_000, |seed| integral.solve(&Secondary::plain().samples(n).sequence(rooks).seed(seed))).unwrap();
        // a one-sided bound: what is below it is no deviation
        let excess = (s.variance().value - share * bound).max(0.0);
        budget.mean(name, (excess, s.variance().std_error, 1e6), 0.0, 0.2 * bound).unwrap();
    }
}

/// RMS error over seeds against n: −1 for Halton and Hammersley in the plane, ≤ −1.4 for scrambled Sobol', −½ for Latin hypercubes that cannot help,
/// −3/2 on a line.
#[test]
fn low_discrepancy_has_its_slopes() {
    let mut budget = Budget::of("integral::net slopes");
    const R: u64 = 300;
    let sizes: Vec<u64> = (2..=6).map(|k| 1 << (2 * k)).collect();
    let line = Integral::on_interval(0.0..=1.0, f64::exp);
    let square = Integral::on(Cuboid::<2>::unit(), |x| (x[0] + x[1]).exp() * (x[0] - x[1]).cos());
    let truth = square.solve(&rule()).unwrap();
    let plain = Secondary::plain;
    type Solve<'a> = &'a (dyn Fn(u64, u64) -> Result<Estimate, Error> + Sync);
    let rows: [(&str, f64, Option<f64>, Solve<'_>); 6] = [
        ("Sobol', line", E - 1.0, Some(-1.5), &|n, s| line.solve(&plain().samples(n).sequence(Sobol::new(s).replicates(1)))),
        ("jittered, line", E - 1.0, Some(-1.5), &|n, s| {
            line.solve(&plain().samples(n).sequence(Stratified::new(n, 1)?.replicates(1)).seed(s))
        }),
        ("Halton", truth, None, &|n, s| square.solve(&plain().samples(n).sequence(Halton::new(s).replicates(1)))),
        ("Hammersley", truth, None, &|n, s| square.solve(&plain().samples(n).sequence(Hammersley::new(n)?.replicates(1)).seed(s))),
        ("jittered, plane", truth, Some(-1.0), &|n, s| {
            square.solve(&plain().samples(n).sequence(Stratified::new(n.isqrt(), 2)?.replicates(1)).seed(s))
        }),
        ("PCG", truth, Some(-0.5), &|n, s| square.solve(&plain().samples(n).sequence(Pcg::new(s)))),
    ];
    for (name, truth, expected, solve) in rows {
        let (s, error, freedom) = slope(&Sweep::run(truth, &sizes, R, solve).unwrap(), R);
        match expected {
            // logarithms, of which theory says no more than that they slow down
            None => budget.at_most(name, (s, error, freedom), -0.94, 0.2).unwrap(),
            Some(expected) => budget.mean(name, (s, error, freedom), expected, 0.2).unwrap(),
        }
    }
    // logarithms again: the slope nears −3/2 from above
    let sizes: Vec<u64> = (5..=13).map(|k| 1 << k).collect();
    let sobol = Sweep::run(truth, &sizes, R, |n, s| square.solve(&plain().samples(n).sequence(Sobol::new(s).replicates(1)))).unwrap();
    budget.at_most("Sobol', plane", slope(&sobol, R), -1.4, 0.1).unwrap();
}

/// 95 % intervals from replicates, for a smooth and for a jumping integrand.
#[test]
fn replicates_cover_what_they_promise() {
    let mut budget = Budget::of("integral::replicates");
    let smooth: fn(&[f64; 2]) -> f64 = |x| (x[0] + x[1]).exp();
    let jump: fn(&[f64; 2]) -> f64 = |x| f64::from(u8::from(x[0] * x[0] + x[1] * x[1] < 1.0));
    for (name, f, truth) in [("smooth", smooth, (E - 1.0).powi(2)), ("jump", jump, std::f64::consts::FRAC_PI_4)] {
        let integral = Integral::on(Cuboid::<2>::unit(), f);
        let mut row = |what: &str, solve: &(dyn Fn(u64) -> Result<Estimate, Error> + Sync)| {
            let c = Study::run(truth, 10_000, solve).unwrap().coverage(0.95);
            budget.frequency(&format!("{name}, {what}"), c.hits, c.trials, 0.935, 0.965).unwrap();
        };
        row("Sobol'", &|s| integral.solve(&Secondary::plain().samples(16 * 64).sequence(Sobol::new(s).replicates(16))));
        row("Latin hypercube", &|s| {
            integral.solve(&Secondary::plain().samples(10 * 64).sequence(LatinHypercube::new(64)?.replicates(10)).seed(s))
        });
        row("Halton", &|s| integral.solve(&Secondary::plain().samples(16 * 64).sequence(Halton::new(s).replicates(16))));
    }
}

/// What the traits of a method of one's own need: nothing but a score.
#[test]
fn a_primary_estimator_of_ones_own() {
    /// Antithetic pairs: (f(u) + f(1 − u))/2.
    #[derive(Clone, Debug)]
    struct Antithetic;
    impl Primary<fredholm::domain::Interval, f64> for Antithetic {
        fn score<S: fredholm::sampling::Sampler>(&self, domain: &fredholm::domain::Interval, f: &impl Fn(&f64) -> f64, u: &mut S) -> f64 {
            let u = u.next_1d();
            let at = |t: f64| f(&(domain.lower() + t * domain.length())) * domain.length();
            0.5 * (at(u) + at(1.0 - u))
        }
    }
    fn solve<G: Source<Point = f64, Value = f64>>(
        i: &Integral<fredholm::domain::Interval, G>,
        m: &dyn Integrator<fredholm::domain::Interval, G, Solution = Estimate>,
    ) -> Estimate {
        i.solve(m).unwrap()
    }
    let integral = Integral::on_interval(0.0..=1.0, f64::exp);
    let e = solve(&integral, &Secondary::new(Antithetic).samples(N));
    let plain = solve(&integral, &Secondary::plain().samples(2 * N));
    assert!(e.agrees_with(E - 1.0, 6.0) && e.evaluations == 2 * N);
    // (10e − 3e² − 5)/4 = 0.0039 a pair against 0.2420 a sample
    assert!(e.efficiency().unwrap() > 25.0 * plain.efficiency().unwrap());
}
