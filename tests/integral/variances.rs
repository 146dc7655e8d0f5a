//! Measured variances against their formulas, and the laws between them.

use crate::common::{Budget, all_pass};
use crate::{measured, study};
use fredholm::domain::{Cuboid, Disk};
use fredholm::integral::{
    Allocation, Coefficient, Combined, Control, Gauss, Importance, Integral, Integrator, Plain, Predictable, Roulette, Secondary, Strata,
    Stratified, inverse,
};
use fredholm::walk::Heuristic;
use fredholm::{Estimate, source::Source};

const REPETITIONS: u64 = 4000;

/// Two lobes on [0, 1], one narrow and high, one wide.
fn lobes(x: f64) -> f64 {
    (-((x - 0.3) / 0.05).powi(2)).exp() * 4.0 + (-((x - 0.6) / 0.2).powi(2)).exp() + 0.1
}

/// Normalised triangle-like densities that imitate one lobe each: Cauchy on [0, 1] by inversion.
fn cauchy(centre: f64, width: f64) -> impl fredholm::integral::Density<f64> + Clone + std::fmt::Debug + 'static {
    let (a, b) = ((-centre / width).atan(), ((1.0 - centre) / width).atan());
    inverse(
        move |u: f64| centre + width * (a + u * (b - a)).tan(),
        move |x: &f64| 1.0 / ((b - a) * width * (1.0 + ((x - centre) / width).powi(2))),
    )
}

fn techniques(start: Combined<f64>, samples: [u32; 3]) -> Combined<f64> {
    start
        .technique(cauchy(0.3, 0.05), samples[0])
        .technique(cauchy(0.6, 0.2), samples[1])
        .technique(inverse(|u: f64| u, |_: &f64| 1.0), samples[2])
}

fn rule() -> Gauss {
    Gauss::legendre(64, 8)
}

/// The measured variance and bias of many repetitions against formula and truth.
fn check<D, G, M>(budget: &mut Budget, name: &str, integral: &Integral<D, G>, method: impl Fn(u64) -> M + Sync) -> Vec<Result<(), String>>
where
    D: fredholm::domain::Domain,
    G: Source<Point = D::Point, Value = f64>,
    M: Integrator<D, G, Solution = Estimate> + Predictable<D, G>,
{
    let truth = integral.solve(&rule()).unwrap();
    let predicted = integral.predict(&method(0), &rule()).unwrap();
    let s = study(truth, REPETITIONS, &|seed| integral.solve(&method(seed)).unwrap());
    let scale = predicted.sqrt();
    vec![
        budget.mean(&format!("{name}: value"), measured(s.bias()), 0.0, 0.15 * scale),
        budget.mean(&format!("{name}: variance"), measured(s.variance()), predicted, 0.35 * predicted),
        budget.mean(&format!("{name}: stated"), measured(s.stated_variance()), predicted, 0.2 * predicted),
    ]
}

#[test]
fn measured_variances_are_those_of_the_formulas() {
    let mut budget = Budget::of("integral::variances");
    let integral = Integral::on_interval(0.0..=1.0, lobes);
    let n = 64;
    let mut results = check(&mut budget, "plain", &integral, |s| Secondary::plain().samples(n).seed(s));
    results.extend(check(&mut budget, "importance", &integral, |s| Secondary::importance(cauchy(0.3, 0.05)).samples(n).seed(s)));
    let halved = Roulette::new(Importance(cauchy(0.3, 0.05)), 0.5);
    results.extend(check(&mut budget, "roulette", &integral, |s| Secondary::new(halved.clone()).samples(n).seed(s)));
    let half = Control::new(Plain, |x: &f64| (-((x - 0.3) / 0.05).powi(2)).exp(), 0.088_622_692_545_275_7, Coefficient::Fixed(3.0));
    results.extend(check(&mut budget, "control", &integral, |s| Secondary::new(half).samples(n).seed(s)));
    for h in [Heuristic::Balance, Heuristic::Power(2.0), Heuristic::Maximum, Heuristic::Average] {
        let name = format!("{h:?}");
        let all = techniques(Combined::new(h), [2, 1, 1]);
        results.extend(check(&mut budget, &name, &integral, |s| Secondary::combined(all.clone()).samples(32).seed(s)));
    }
    let strata = || Strata::cut_at(&[0.1, 0.2, 0.4, 0.45]);
    for allocation in [Allocation::Proportional, Allocation::Equal] {
        let name = format!("{allocation:?}");
        results.extend(check(&mut budget, &name, &integral, |s| Stratified::new(strata()).allocation(allocation).samples(100).seed(s)));
    }
    // no repetitions in one solve, hence no interval from replicates: within the strata; with replicates: from them
    results.extend(check(&mut budget, "jittered", &integral, |s| Stratified::jittered(Strata::uniform(16), 8).seed(s)));
    let square = Integral::on(Cuboid::<2>::unit(), |x| (x[0] + 2.0 * x[1]).sin());
    results.extend(check(&mut budget, "grid", &square, |s| Stratified::new(Strata::grid(4, 2)).samples(64).seed(s)));
    all_pass(results);
}

fn predict(
    method: &impl Predictable<fredholm::domain::Interval, fredholm::source::SourceFn<fredholm::domain::Interval, fn(&f64) -> f64, f64>>,
) -> f64 {
    Integral::on(fredholm::domain::Interval::from(0.0..=1.0), (|x| lobes(*x)) as fn(&f64) -> f64).predict(method, &rule()).unwrap()
}

/// theory (4.4.7), and the optimal weights below all of them; for several sample counts.
#[test]
fn balance_is_within_its_bound_of_any_weights() {
    let truth = Integral::on_interval(0.0..=1.0, lobes).solve(&rule()).unwrap();
    for samples in [[1, 1, 1], [1, 2, 5], [7, 1, 1], [1, 9, 1]] {
        let v = |start| predict(&Secondary::combined(techniques(start, samples)).samples(1));
        let balance = v(Combined::new(Heuristic::Balance));
        let slack = (1.0 / f64::from(*samples.iter().min().unwrap()) - 1.0 / f64::from(samples.iter().sum::<u32>())) * truth * truth;
        let others = [Heuristic::Power(2.0), Heuristic::Power(8.0), Heuristic::Maximum, Heuristic::Average].map(|h| v(Combined::new(h)));
        let optimal = v(Combined::optimal(2));
        for other in others.into_iter().chain([optimal]) {
            assert!(balance <= other + slack, "{samples:?}: {balance} > {other} + {slack}");
        }
        assert!(
            others.iter().all(|o| optimal <= *o) && optimal <= balance && optimal >= 0.0,
            "{samples:?}: {optimal}, {balance}, {others:?}"
        );
    }
}

/// A pilot finds weights that are nearly as good as the best, without bias; a mixture of the densities is integrated without error.
#[test]
fn optimal_weights_from_a_pilot() {
    let mut budget = Budget::of("integral::optimal");
    let integral = Integral::on_interval(0.0..=1.0, lobes);
    let truth = integral.solve(&rule()).unwrap();
    let method = |seed| Secondary::combined(techniques(Combined::optimal(1000), [1, 1, 1])).samples(64).seed(seed);
    let predicted = integral.predict(&method(0), &rule()).unwrap();
    let s = study(truth, REPETITIONS, &|seed| integral.solve(&method(seed)).unwrap());
    let ratio = s.variance().value / predicted;
    assert!((0.9..1.3).contains(&ratio), "{ratio}");
    budget.mean("value", measured(s.bias()), 0.0, 0.2 * predicted.sqrt()).unwrap();
    // both sides are measured
    let (v, stated) = (s.variance(), s.stated_variance());
    budget.mean("stated", (stated.value - v.value, stated.std_error.hypot(v.std_error), 1e6), 0.0, 0.4 * predicted).unwrap();
    let (p, q) = (cauchy(0.3, 0.05), cauchy(0.6, 0.2));
    use fredholm::integral::Density;
    let mixture = Integral::on_interval(0.0..=1.0, move |x| 3.0 * p.pdf(&x) - 0.5 * q.pdf(&x));
    let e = mixture.solve(&Secondary::combined(techniques(Combined::optimal(100), [1, 1, 1]))).unwrap();
    assert!((e.value - 2.5).abs() < 1e-12 && e.std_error.unwrap() < 1e-13, "{e:?}");
    // two densities that coincide: the matrix is singular, the answer is not
    let twins = techniques(Combined::optimal(100), [1, 1, 1]).technique(cauchy(0.3, 0.05), 1);
    let e = integral.solve(&Secondary::combined(twins)).unwrap();
    assert!(e.agrees_with(truth, 6.0) && e.std_error.unwrap() < 0.01, "{e:?}");
}

/// Proportional allocation is never worse than no strata, Neyman never worse than proportional; equal counts on unequal strata can be worse than both
/// (theory (4.14.5)). Adapted strata are better than uniform ones.
#[test]
fn strata_help_or_at_least_do_no_harm() {
    let n = 600;
    let plain = predict(&Secondary::plain().samples(n));
    let of = |strata: Strata, allocation| predict(&Stratified::new(strata).allocation(allocation).samples(n));
    let neyman = Allocation::Neyman { pilot: 2 };
    for strata in
        [Strata::uniform(2), Strata::uniform(10), Strata::uniform(100), Strata::cut_at(&[0.01, 0.5, 0.75]), Strata::cut_at(&[0.9])]
    {
        let (proportional, best) = (of(strata.clone(), Allocation::Proportional), of(strata.clone(), neyman));
        assert!(proportional <= plain, "{strata:?}: {proportional} > {plain}");
        // counts are rounded up to whole numbers, at least 2
        assert!(best <= 1.05 * proportional, "{strata:?}: {best} > {proportional}");
    }
    let thin = Strata::cut_at(&[0.88, 0.90, 0.92, 0.94, 0.96, 0.98]);
    assert!(of(thin.clone(), Allocation::Equal) > 2.0 * plain, "equal counts on unequal strata can be worse than none");
    assert!(of(thin, neyman) < plain);
    let integral = Integral::on_interval(0.0..=1.0, lobes);
    let adapted = Strata::adapted(&integral, 50).unwrap();
    let (shaped, uniform) = (of(adapted, Allocation::Equal), of(Strata::uniform(50), Allocation::Equal));
    assert!(shaped < 0.6 * uniform, "{shaped} against {uniform}");
}

/// Neyman's allocation by a pilot: unbiased, near the best, errors as stated.
#[test]
fn neyman_from_a_pilot() {
    let mut budget = Budget::of("integral::neyman");
    let integral = Integral::on_interval(0.0..=1.0, lobes);
    let truth = integral.solve(&rule()).unwrap();
    let method = |seed| Stratified::new(Strata::uniform(10)).allocation(Allocation::Neyman { pilot: 50 }).samples(400).seed(seed);
    let predicted = integral.predict(&method(0), &rule()).unwrap();
    let s = study(truth, REPETITIONS, &|seed| integral.solve(&method(seed)).unwrap());
    budget.mean("value", measured(s.bias()), 0.0, 0.2 * predicted.sqrt()).unwrap();
    let ratio = s.variance().value / predicted;
    assert!((0.85..1.25).contains(&ratio), "{ratio}");
    let c = s.coverage(0.95);
    budget.frequency("coverage", c.hits, c.trials, 0.92, 0.97).unwrap();
    assert!(s.runs()[0].evaluations >= 900);
}

/// A pilot that sees no spread says nothing about where to spend the budget: it is spent in proportion, not dropped.
#[test]
fn a_pilot_without_spread_drops_no_budget() {
    // a spike that a pilot of two scores in each of ten strata misses
    let spike = Integral::on_interval(0.0..=1.0, |x: f64| if (0.35..0.351).contains(&x) { 1000.0 } else { 0.0 });
    let method = Stratified::new(Strata::uniform(10)).allocation(Allocation::Neyman { pilot: 2 }).samples(100_000);
    let e = spike.solve(&method).unwrap();
    assert!(e.samples() == 100_000 && e.agrees_with(1.0, 6.0) && e.std_error.unwrap() > 0.0, "{e:?}");
    let constant = Integral::on_interval(0.0..=2.0, |_| 0.25).solve(&method).unwrap();
    assert!(constant.samples() == 100_000 && constant.value == 0.5 && constant.std_error.unwrap() < 1e-20, "{constant:?}");
}

/// Strata live in the cube that the points are made of, which on a disk is not that of its quadrature.
#[test]
fn variances_on_a_disk() {
    let mut budget = Budget::of("integral::disk");
    let disk = Integral::on(Disk::unit(), |x: &[f64; 2]| (x[0] + 2.0 * x[1]).exp());
    let rule = Gauss::legendre(8, 8);
    let truth = disk.solve(&rule).unwrap();
    let mut results = Vec::new();
    let mut check = |what: &str, predicted: f64, solve: &(dyn Fn(u64) -> Estimate + Sync)| {
        let s = study(truth, REPETITIONS, solve);
        results.push(budget.mean(&format!("{what}: value"), measured(s.bias()), 0.0, 0.15 * predicted.sqrt()));
        results.push(budget.mean(&format!("{what}: variance"), measured(s.variance()), predicted, 0.35 * predicted));
    };
    let strata = |seed| Stratified::new(Strata::grid(4, 2)).samples(64).seed(seed);
    check("strata", disk.predict(&strata(0), &rule).unwrap(), &|seed| disk.solve(&strata(seed)).unwrap());
    let plain = |seed| Secondary::plain().samples(64).seed(seed);
    check("plain", disk.predict(&plain(0), &rule).unwrap(), &|seed| disk.solve(&plain(seed)).unwrap());
    all_pass(results);
}

/// Strata in the cube of an importance density are strata of equal probability: both gains multiply.
#[test]
fn strata_of_an_importance_density() {
    let integral = Integral::on_interval(0.0..=20.0, |x: f64| (-x).exp() * (1.0 + 0.1 * x));
    let truth = integral.solve(&Gauss::legendre(16, 16)).unwrap();
    let solve = |m: &dyn Integrator<_, _, Solution = Estimate>| -> Estimate { integral.solve(m).unwrap() };
    let density = inverse(|u: f64| -(-u).ln_1p(), |x: &f64| (-x).exp());
    let importance = solve(&Secondary::importance(density.clone()).samples(4096));
    let uniform = solve(&Stratified::new(Strata::uniform(256)).samples(4096));
    let both = solve(&Stratified::of(Importance(density), Strata::uniform(256)).samples(4096));
    assert!([&importance, &uniform, &both].iter().all(|e| e.agrees_with(truth, 6.0)));
    assert!(both.std_error.unwrap() < uniform.std_error.unwrap() / 3.0 && both.std_error.unwrap() < importance.std_error.unwrap() / 10.0);
}
