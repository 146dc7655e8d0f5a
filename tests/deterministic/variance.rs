//! Predicted variances and costs against measured ones.

use crate::erased::Equation;
use crate::one;
use fredholm::deterministic::PredictedVariance;
use fredholm::domain::Cuboid;
use fredholm::special::e1;
use fredholm::walk::{OwnAbsorption, Roulette};
use fredholm::{Error, Walk};

/// Mean and standard error of 16 batches, each the (variance, steps a walk) of its sample: batches of variances give their own error.
fn measured(batch: impl Fn(u64) -> (f64, f64)) -> [(f64, f64); 2] {
    let runs: Vec<_> = (0..16).map(batch).collect();
    [|r: &(f64, f64)| r.0, |r: &(f64, f64)| r.1].map(|pick| {
        let mean = runs.iter().map(pick).sum::<f64>() / 16.0;
        (mean, (runs.iter().map(|r| (pick(r) - mean).powi(2)).sum::<f64>() / (15.0 * 16.0)).sqrt())
    })
}

/// Eight comparisons at 6 standard errors with 15 degrees of freedom: false alarms below 2·10⁻⁴; an error of 10 standard errors (at most 30 % of
/// the value) is found.
macro_rules! prediction_holds {
    ($eq:expr, $walk:expr, $x:expr) => {{
        let (eq, walk) = (&$eq, $walk.samples_per_cell(1 << 15));
        let p = eq.predict(&walk).unwrap();
        assert_eq!(p.verdict(), PredictedVariance::Finite);
        let predicted = [p.variance($x).unwrap().unwrap(), p.steps($x).unwrap()];
        assert!((p.efficiency($x).unwrap() * predicted[0] * predicted[1] - 1.0).abs() < 1e-12);
        let found = measured(|seed| {
            let f = eq.at($x).solve(&walk.seed(seed)).unwrap();
            (f.variance().unwrap(), f.steps as f64 / f.samples() as f64)
        });
        for ((mean, error), known) in found.into_iter().zip(predicted) {
            assert!(error < 0.03 * known, "{mean} ± {error} sees nothing");
            assert!((mean - known).abs() < 6.0 * error, "{mean} ± {error} is not {known}");
        }
    }};
}

#[test]
fn predicted_variance_and_steps_are_measured() {
    let smooth = Equation::on_interval(0.0..=1.0, |x: f64| 1.0 + x, |x: f64, y: f64| 0.5 * (x * y).exp());
    prediction_holds!(smooth, Walk::collision().roulette(Roulette::constant(0.8)), 0.3);
    let signed = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| -0.8 * (5.0 * (x - y)).cos());
    prediction_holds!(signed, Walk::collision().roulette(Roulette::constant(0.85)), 0.6);
    let slab = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 0.35 * e1((x - y).abs()));
    prediction_holds!(slab, Walk::collision().roulette(Roulette::constant(0.9)), 0.25);
    let square = Equation::on_domain(Cuboid::<2>::unit(), |_| 1.0, |x: &[f64; 2], y: &[f64; 2]| 0.5 * (x[0] * y[0] - x[1] * y[1]).exp());
    prediction_holds!(square, Walk::collision().roulette(Roulette::constant(0.8)), [0.3, 0.9]);
}

#[test]
fn infinite_variance_is_predicted() {
    // K₂ = λ²/P: infinite for λ² ≥ P although the series converges
    let constant = |l: f64| Equation::on_interval(0.0..=1.0, one, move |_, _| l);
    let verdict = |l: f64, p: f64| constant(l).predict(&Walk::collision().roulette(Roulette::constant(p))).unwrap().verdict();
    assert_eq!(verdict(0.9, 0.7), PredictedVariance::InfiniteBySeries);
    assert_eq!(verdict(0.9, 0.82), PredictedVariance::Finite);
    // K²/π = 0.04/|x − y| with the uniform proposal
    let abel = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 0.2 / (x - y).abs().sqrt());
    let prediction = abel.predict(&Walk::collision().roulette(Roulette::constant(0.5))).unwrap();
    assert!(matches!(prediction.verdict(), PredictedVariance::InfiniteAtDiagonal { ratio } if ratio > 0.98));
    assert_eq!((prediction.variance(0.5).unwrap(), prediction.efficiency(0.5).unwrap()), (None, 0.0));
    // throughput roulette remembers the walk: refused, not guessed
    assert!(matches!(constant(0.5).predict(&Walk::collision()), Err(Error::Invalid { parameter: "ending", .. })));
    // a walk that no ending and no absorption ends: Pπ has radius 1, the steps have no mean
    let half = constant(0.5);
    let endless = half.predict(&Walk::collision().ending(OwnAbsorption));
    assert!(matches!(endless, Err(Error::Singular { .. })), "{endless:?}");
}
