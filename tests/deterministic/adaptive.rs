//! Tolerances that are met or refused.

use crate::one;
use crate::reference::{interval, record, scalar_values};
use fredholm::deterministic::Nystrom;
use fredholm::special::e1;
use fredholm::{Equation, Error};
use std::f64::consts::PI;

#[test]
fn adaptive_meets_its_tolerance_or_refuses() {
    for (name, tolerance, k) in [
        ("expxy-g1-lam0.5", 1e-12, (|x, y| 0.5 * (x * y).exp()) as fn(f64, f64) -> f64),
        ("green-bridge-lam5", 1e-11, |x, y| 5.0 * (x.min(y) - x * y)),
        ("volterra-step-lam5", 1e-10, |x, y| if x > y { 5.0 } else { 0.0 }),
        ("slab-c0.9-a1-uniform", 1e-9, |x, y| 0.45 * e1((x - y).abs())),
        ("log-g1-lam0.4", 1e-9, |x, y| 0.4 * (x - y).abs().ln()),
        ("love-plus-d0.1", 1e-10, |x, y| 0.1 / PI / (0.01 + (x - y) * (x - y))),
        ("gaussian-nearcritical-0.9999", 1e-9, |x, y| 1.156165 * (-(x - y) * (x - y)).exp()),
        ("osc-cos-w50-lam1.5", 1e-11, |x, y| 1.5 * (50.0 * (x - y)).cos()),
    ] {
        let file = record(name);
        let (a, b) = interval(&file);
        let f =
            Equation::on_interval(a..=b, one, k).solve(&Nystrom::adaptive().tolerance(tolerance)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let estimate = f.error_estimate().unwrap();
        assert!(estimate <= tolerance * f.magnitude().max(1.0));
        let rounding = 1e-15 * f.magnitude() / f.rcond();
        for (x, known) in scalar_values(&file) {
            let error = (f.eval(x) - known).abs();
            assert!(error <= 3.0 * estimate + rounding, "{name} at {x}: error {error:.1e}, estimate {estimate:.1e}");
        }
    }
}

#[test]
fn adaptive_is_not_silently_wrong() {
    // a jump off the diagonal, at |x − y| = 0.3: rules on panels cannot resolve it (trap 1.3)
    let step = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| if (x - y).abs() < 0.3 { 0.7 } else { 0.0 });
    let Err(Error::NotConverged { error, tolerance, unknowns }) = step.solve(&Nystrom::adaptive().tolerance(1e-8).max_unknowns(600)) else {
        panic!("a step off the diagonal was accepted")
    };
    assert!(error > 1e-8 && tolerance == 1e-8 && unknowns > 100);
    // a narrow bump in g between all coarse nodes
    let bump = |x: f64| (-((x - 0.503) / 1e-3).powi(2)).exp();
    let eq = Equation::on_interval(0.0..=1.0, bump, |x: f64, y: f64| 0.5 * (x * y).exp());
    match eq.solve(&Nystrom::adaptive().tolerance(1e-9).max_unknowns(700)) {
        Err(Error::NotConverged { .. }) => {}
        Ok(f) => {
            let exact = eq.solve(&Nystrom::composite(400, 10)).unwrap();
            assert!((f.eval(0.2) - exact.eval(0.2)).abs() < 1e-8, "{} is not {}", f.eval(0.2), exact.eval(0.2));
        }
        Err(e) => panic!("{e}"),
    }
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(eq.solve(&Nystrom::adaptive().tolerance(tolerance)), Err(Error::Invalid { parameter: "tolerance", .. })));
    }
}
