//! Randomised truncation.

use crate::common::{Budget, all_pass};
use crate::{erased, stated};
use fredholm::Error;
use fredholm::estimator::{Debias, Form, Levels, Survivors, levels_fn};
use fredholm::sampling::Sampler;

/// e^{E X} from the means of 2ⁿ uniform numbers and of both halves of them: Δ_n of order 2^{−n}, t_n = 2ⁿ.
fn exponential(n: u64, u: &mut dyn Sampler) -> f64 {
    if n == 0 {
        return u.next_1d().exp();
    }
    let (half, mut sums) = (1u64 << (n - 1), [0.0; 2]);
    (0..2 * half).for_each(|i| sums[(i % 2) as usize] += u.next_1d() / half as f64);
    ((sums[0] + sums[1]) / 2.0).exp() - (sums[0].exp() + sums[1].exp()) / 2.0
}

#[test]
fn debiased_sequences_are_unbiased() {
    let mut budget = Budget::of("bidirectional::debias");
    let mut results = Vec::new();
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let query = eq.at(0.5);
    let depths = query.depths().unwrap();
    for form in [Form::Sum, Form::SingleTerm] {
        for survivors in [Survivors::Geometric(0.5), Survivors::Power(2.5), Survivors::Fitted] {
            let d = Debias::new(&depths).form(form).survivors(survivors).samples(1 << 17).seed(3).solve().unwrap();
            results.push(budget.mean(&format!("depths {form:?} {survivors:?}"), stated(&d.estimate), 1.15, 0.03));
        }
        let d = Debias::new(levels_fn(2.0, exponential)).form(form).samples(1 << 18).seed(4).solve().unwrap();
        results.push(budget.mean(&format!("exponential {form:?}"), stated(&d.estimate), 0.5f64.exp(), 0.03));
        // Δ_n² ~ 4^{−n} against t_n = 2ⁿ: the fitted ratio is 2^{−3/2}
        let Survivors::Geometric(ratio) = d.survivors else { panic!("{:?}", d.survivors) };
        assert!((ratio.log2() + 1.5).abs() < 0.35, "{ratio}");
        assert!(d.variance_slope.unwrap() < 0.0 && d.cost_slope.unwrap() < 0.0);
    }
    all_pass(results);
}

/// The sum over depths with geometric survivors is the collision estimator with roulette: same mean, same variance.
#[test]
fn the_sum_over_depths_is_roulette() {
    let eq = erased!((0.0, 1.0), |x: f64| 1.0 + x, |x: f64, y: f64| 0.5 * x * y + 0.1);
    let query = eq.at(0.5);
    let d = Debias::new(query.depths().unwrap()).survivors(Survivors::Geometric(0.6)).samples(1 << 16).solve().unwrap();
    let walk = fredholm::Walk::collision().roulette(fredholm::walk::Roulette::constant(0.6)).samples_per_cell(1 << 16);
    let e = query.solve(&walk).unwrap();
    let ratio = d.estimate.variance().unwrap() / e.variance().unwrap();
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    assert!(d.estimate.agrees_with(e.value, 6.0));
}

/// Σ Δ_n²/Pr(N ≥ n) or Σ t_n Pr(N ≥ n) diverges: refused, with the slope.
#[test]
fn infinite_variance_and_infinite_cost_are_refused() {
    let slow = levels_fn(2.0, |n, u| (u.next_1d() - 0.4) * 0.7f64.powf(n as f64));
    let refused = |d: Debias<_>| match d.solve() {
        Err(Error::NotSummable { series, slope, .. }) => (series, slope),
        other => panic!("{other:?}"),
    };
    // Δ_n² falls by 0.49: not faster than survivors of 0.4; cost grows by 2: not slower than survivors of 0.6 fall
    let (series, slope) = refused(Debias::new(&slow).form(Form::SingleTerm).survivors(Survivors::Geometric(0.4)));
    assert!(series == "variance" && (slope - (0.49f64 / 0.4).ln()).abs() < 1e-9);
    let (series, slope) = refused(Debias::new(&slow).form(Form::SingleTerm).survivors(Survivors::Geometric(0.6)));
    assert!(series == "cost" && (slope - 1.2f64.ln()).abs() < 1e-9);
    // 0.49 · 1.9 < 1: between the two there is a ratio that serves
    let quick = levels_fn(1.9, |n, u| (u.next_1d() - 0.4) * 0.7f64.powf(n as f64));
    assert!(Debias::new(&quick).form(Form::SingleTerm).samples(1024).solve().is_ok());
    // 0.49 · 2.1 > 1: no geometric law serves
    let none = levels_fn(2.1, |n, u| (u.next_1d() - 0.4) * 0.7f64.powf(n as f64));
    assert!(matches!(Debias::new(&none).solve(), Err(Error::NotSummable { .. })));
    // differences like 1/(n+1): power survivors are judged along ln(n + 1)
    let power = levels_fn(1.0, |n, u| (u.next_1d() - 0.4) / (n as f64 + 1.0).powi(2));
    assert!(matches!(Debias::new(&power).survivors(Survivors::Geometric(0.5)).solve(), Err(Error::NotSummable { .. })));
    assert!(Debias::new(&power).form(Form::SingleTerm).survivors(Survivors::Power(1.3)).samples(1024).solve().is_ok());
}

#[test]
fn refusals() {
    let levels = levels_fn(1.0, |n, u| u.next_1d() * 0.5f64.powf(n as f64));
    for (bad, name) in [
        (Debias::new(&levels).survivors(Survivors::Geometric(1.0)), "ratio of survivors"),
        (Debias::new(&levels).survivors(Survivors::Power(0.0)), "exponent of survivors"),
        (Debias::new(&levels).samples(0), "samples"),
        (Debias::new(&levels).pilot(3, 100), "pilot"),
    ] {
        assert!(matches!(bad.solve(), Err(Error::Invalid { parameter, .. }) if parameter == name), "{name}");
    }
    let nan = levels_fn(1.0, |n, _| if n == 2 { f64::NAN } else { 0.5f64.powf(n as f64) });
    assert!(matches!(Debias::new(nan).solve(), Err(Error::NonFiniteScore { .. })));
    // a sequence that has arrived after two levels has nothing left to be summable
    let short = levels_fn(1.0, |n, u| if n < 2 { u.next_1d() } else { 0.0 });
    let d = Debias::new(&short).solve().unwrap();
    assert!(d.variance_slope.is_none() && d.estimate.agrees_with(1.0, 5.0));
    assert_eq!(Levels::cost(&short, 0..=3), 4.0);
}
