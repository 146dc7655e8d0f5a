//! Closed forms, and evaluation at every kind of place.

use crate::erased::{Equation, source_fn};
use crate::one;
use fredholm::Error;
use fredholm::deterministic::Nystrom;
use fredholm::domain::Interval;
use fredholm::special::e1;
use std::f64::consts::{FRAC_PI_2, PI};

/// Closed forms by their numbers in problems §2.
#[test]
fn closed_forms() {
    // D-exp: K = (βa/2) e^{−a|x−y|} on [0, T], also where the Neumann series diverges (κ imaginary)
    for (beta, a, t) in [(0.5f64, 1.0f64, 2.0f64), (0.99, 1.0, 2.0), (0.5, 20.0, 1.0)] {
        let kappa = a * (1.0 - beta).sqrt();
        let c = -(1.0 / (1.0 - beta) - 1.0) / ((kappa * t / 2.0).cosh() + kappa / a * (kappa * t / 2.0).sinh());
        let f = Equation::on_interval(0.0..=t, one, move |x: f64, y: f64| beta * a / 2.0 * (-a * (x - y).abs()).exp());
        let f = f.solve(&Nystrom::graded(6, 14).levels(2)).unwrap();
        for x in [0.0, 0.1, 0.77 * t, t] {
            let known = 1.0 / (1.0 - beta) + c * (kappa * (x - t / 2.0)).cosh();
            assert!((f.eval(x) - known).abs() < 1e-12 * known, "β = {beta}: {} is not {known}", f.eval(x));
        }
    }
    let f = Equation::on_interval(0.0..=2.0, one, |x: f64, y: f64| 1.5 * (-(x - y).abs()).exp()).solve(&Nystrom::graded(2, 14)).unwrap();
    let (kappa, t) = (2f64.sqrt(), 2.0);
    let c = 1.5 / ((kappa * t / 2.0).cos() - kappa * (kappa * t / 2.0).sin());
    assert!((f.eval(0.3) - (-0.5 + c * (kappa * (0.3f64 - 1.0)).cos())).abs() < 1e-12);
    // E2: spectral radius 1.35
    let e2 = Equation::on_interval(0.0..=1.0, |x: f64| x.exp() - ((x + 1.0).exp() - 1.0) / (x + 1.0), |x: f64, y: f64| (x * y).exp());
    let f = e2.solve(&Nystrom::gauss_legendre(16)).unwrap();
    assert!([0.0, 0.33, 1.0].iter().all(|x| (f.eval(*x) - x.exp()).abs() < 1e-13));
    // E6: nilpotent
    let e6 = Equation::on_interval(0.0..=2.0 * PI, |x| x, |x: f64, y: f64| (x + 2.0 * y).sin());
    let f = e6.solve(&Nystrom::gauss_legendre(32)).unwrap();
    assert!([0.0, 1.0, 6.0].iter().all(|x| (f.eval(*x) - (x - PI * x.cos())).abs() < 1e-12));
    // E4: rank 2
    let e4 = Equation::on_interval(0.0..=FRAC_PI_2, |x: f64| -2.0 / PI * x.cos(), |x: f64, y: f64| 4.0 / PI * (x - y).cos());
    assert!((e4.solve(&Nystrom::gauss_legendre(16)).unwrap().eval(1.0) - 1f64.sin()).abs() < 1e-13);
}

/// F1 of problems §2: φ(0), φ(T/4), φ(T/2), ∫φ of slabs that have no stored file, or for which another rule is tried.
#[test]
fn table_of_slabs() {
    for (t, c, known) in [
        (1.0, 0.99, [2.040_377_050_050_25, 2.617_666_275_967_45, 2.761_015_082_182_55, 2.554_235_416_940_56]),
        (5.0, 0.5, [1.412_371_636_005_18, 1.882_568_323_249_74, 1.942_407_366_821_78, 9.151_828_531_333_41]),
        (5.0, 1.0, [5.560_418_790_956_95, 13.922_227_356_018_3, 16.330_926_244_985_4, 65.106_492_824_643_4]),
        (10.0, 1.0, [9.890_781_636_491_6, 40.414_412_998_152, 49.811_793_274_540, 371.349_934_355_43]),
    ] {
        let f =
            Equation::on_interval(0.0..=t, one, move |x: f64, y: f64| c / 2.0 * e1((x - y).abs())).solve(&Nystrom::graded(3, 12)).unwrap();
        let found = [f.eval(0.0), f.eval(t / 4.0), f.eval(t / 2.0), f.functional(|_| 1.0)];
        for (v, k) in found.iter().zip(known).take(3) {
            assert!((v - k).abs() < 1e-11 * k, "T = {t}, c = {c}: {v} is not {k}");
        }
    }
}

#[test]
fn every_place_can_be_evaluated() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| {
        assert!(x != y && (0.0..=1.0).contains(&y), "K({x}, {y}) was asked for");
        0.45 * e1((x - y).abs())
    });
    let f = eq.solve(&Nystrom::graded(4, 8)).unwrap();
    let node = f.nodes().nth(100).unwrap();
    assert!((f.eval(node) - f.values()[100]).abs() < 1e-13);
    // ends, the ends of panels, and places a few ulps from them
    for x in [0.0, 1.0, 0.25, 0.5, 0.25 + f64::EPSILON, 0.25 - f64::EPSILON / 4.0, f64::MIN_POSITIVE, 1e-17, 1.0 - f64::EPSILON, 1e-300] {
        let mirrored = f.eval(1.0 - x);
        assert!((f.eval(x) - mirrored).abs() < 1e-12, "f({x}) = {} but f(1 − x) = {mirrored}", f.eval(x));
    }
    for x in [-1e-9, 1.1, f64::NAN, f64::INFINITY] {
        assert!(f.eval(x).is_nan());
        assert!(matches!(f.try_eval(&x), Err(Error::Outside { .. })));
    }
}

#[test]
fn residuals_tell_what_the_solve_does_not() {
    let kink = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 5.0 * (x.min(y) - x * y));
    let plain = kink.solve(&Nystrom::gauss_legendre(32)).unwrap();
    let error = (plain.eval(0.37) - kink.solve(&Nystrom::graded(2, 14)).unwrap().eval(0.37)).abs();
    let residual = plain.residual(0.37).unwrap().abs();
    assert!(error > 1e-5 && residual > 0.1 * error && error < 5.0 * plain.inverse_norm() * residual, "error {error}, residual {residual}");
    let smooth = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 0.5 * (x * y).exp()).solve(&Nystrom::gauss_legendre(16)).unwrap();
    assert!(smooth.residual(0.37).unwrap().abs() < 1e-14);
}

#[test]
fn one_factorisation_serves_many_sources() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 0.9 * (-(x - y) * (x - y)).exp());
    let solver = eq.factorise(&Nystrom::gauss_legendre(20)).unwrap();
    assert_eq!(solver.solve(eq.source()).unwrap().values(), eq.solve(&Nystrom::gauss_legendre(20)).unwrap().values());
    let moving = solver.solve(&source_fn(Interval::from(0.0..=1.0), |x: &f64| x.sin())).unwrap();
    let again = Equation::on_interval(0.0..=1.0, f64::sin, |x: f64, y: f64| 0.9 * (-(x - y) * (x - y)).exp());
    assert!((moving.eval(0.3) - again.solve(&Nystrom::gauss_legendre(20)).unwrap().eval(0.3)).abs() < 1e-14);
}
