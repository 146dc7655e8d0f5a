//! Estimators combined: unbiased, and never worse than the best of them beyond the pilot's noise.

use crate::common::{Budget, all_pass};
use crate::{erased, stated};
use fredholm::estimator::{Combination, Coupling, estimator_fn};
use fredholm::sampling::Sobol;
use fredholm::walk::{Mis, NextEvent, Roulette};
use fredholm::{Error, Spectrum, Walk};

#[test]
fn combinations_are_unbiased_and_no_worse_than_their_best_member() {
    let mut budget = Budget::of("bidirectional::combination");
    let mut results = Vec::new();
    // f = 1 + 3x/10, and f = e^{2x}: solutions known
    let line = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let curve = erased!((0.0, 1.0), |x: f64| (2.0 * x).exp() - 0.075 * 4f64.exp_m1() * x, |x: f64, y: f64| 0.3 * x * (2.0 * y).exp());
    for (name, eq, x, truth) in [("line", &line, 0.5, 1.15), ("curve", &curve, 0.7, 1.4f64.exp())] {
        let query = eq.at(x);
        for coupling in [Coupling::Common, Coupling::Separate] {
            let combination = Combination::new()
                .with(query.estimator(&Walk::collision()).unwrap())
                .with(query.estimator(&Walk::new(NextEvent, Roulette::constant(0.7))).unwrap())
                .with(query.estimator(&Walk::new(Mis(fredholm::walk::Heuristic::Balance), Roulette::constant(0.7))).unwrap())
                .with(query.estimator(&Walk::absorption().roulette(Roulette::constant(0.6))).unwrap())
                .coupling(coupling)
                .pilot(4096)
                .samples_per_cell(1 << 17)
                .seed(5);
            let c = &combination.solve().unwrap()[0];
            let best = c.variances.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(c.estimate.variance().unwrap() < 1.1 * best, "{name}: {} against {best}", c.estimate.variance().unwrap());
            assert!((c.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            results.push(budget.mean(&format!("{name} {coupling:?}"), stated(&c.estimate), truth, 0.04 * truth));
        }
    }
    all_pass(results);
}

/// Members that coincide have a singular covariance: halves, not a division by zero.
#[test]
fn identical_members_share() {
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let query = eq.at(0.5);
    let walk = Walk::collision();
    let of = || query.estimator(&walk).unwrap();
    let c = Combination::new().with(of()).with(of()).samples_per_cell(4096).solve().unwrap();
    assert!(c[0].weights.iter().all(|a| (a - 0.5).abs() < 1e-9), "{:?}", c[0].weights);
    let alone = Combination::new().with(of()).samples_per_cell(4096).solve().unwrap();
    assert!((c[0].estimate.value - alone[0].estimate.value).abs() < 1e-14);
    // the same walks as the method itself makes
    let direct = query.solve(&walk.samples_per_cell(4096)).unwrap();
    assert_eq!((direct.value, direct.steps), (alone[0].estimate.value, alone[0].estimate.steps));
}

/// A member that scored nothing in the pilot has an unknown variance, not none.
#[test]
fn a_member_that_never_scored_gets_no_weight() {
    let rare = estimator_fn(1, |_, u| if u.next_1d() < 1e-7 { 1e7 } else { 0.0 });
    let plain = estimator_fn(1, |_, u| 2.0 * u.next_1d());
    let c = &Combination::new().with(rare).with(plain).solve().unwrap()[0];
    assert_eq!(c.weights, [0.0, 1.0]);
    assert!(c.estimate.agrees_with(1.0, 5.0));
}

/// Components have weights of their own; randomised sequences have errors from replicates; cells are combined one by one.
#[test]
fn components_cells_and_sequences() {
    let a = estimator_fn(2, |cell, u| Spectrum([u.next_1d() + cell as f64, 0.5 + 10.0 * (u.next_1d() - 0.5)]));
    let b = estimator_fn(2, |cell, u| Spectrum([0.5 + cell as f64 + 10.0 * (u.next_1d() - 0.5), u.next_1d()]));
    let c = Combination::new().sequence(Sobol::new(3)).with(a).with(b).coupling(Coupling::Separate).samples_per_cell(4096).solve().unwrap();
    for (cell, c) in c.iter().enumerate() {
        assert_eq!(c.estimate.degrees_of_freedom, 15);
        assert!(c.weights[0][0] > 0.9 && c.weights[1][1] > 0.9, "{:?}", c.weights);
        assert!(c.estimate.agrees_with(Spectrum([0.5 + cell as f64, 0.5]), 8.0), "{}", c.estimate);
    }
}

#[test]
fn refusals() {
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let query = eq.at(0.5);
    let invalid = |r: Result<_, Error>, name: &str| match r {
        Err(Error::Invalid { parameter, .. }) => assert_eq!(parameter, name),
        Err(e) => panic!("{name}: {e}"),
        Ok(()) => panic!("{name} was accepted"),
    };
    invalid(Combination::<f64>::new().solve().map(drop), "members");
    invalid(query.estimator(&Walk::fixed_depth(3)).map(drop), "depth");
    let (one, two) = (estimator_fn(1, |_, u| u.next_1d()), estimator_fn(2, |_, u| u.next_1d()));
    invalid(Combination::new().with(&one).with(&two).solve().map(drop), "cells of a member");
    invalid(Combination::new().with(&one).pilot(1).solve().map(drop), "pilot");
    invalid(Combination::new().with(&one).samples_per_cell(0).solve().map(drop), "samples_per_cell");
    let nan = estimator_fn(1, |_, u| if u.next_1d() < 0.01 { f64::NAN } else { 1.0 });
    assert!(matches!(Combination::new().with(nan).solve(), Err(Error::NonFiniteScore { .. })));
    // walks name the place
    let bad = erased!((0.0, 1.0), |x: f64| if x > 0.9 { f64::INFINITY } else { 1.0 }, |x: f64, y: f64| 0.5 * x * y);
    let query = bad.at(0.5);
    let broken = Combination::new().with(query.estimator(&Walk::collision()).unwrap()).solve();
    assert!(matches!(broken, Err(Error::NonFiniteSource { .. })), "{broken:?}");
}
