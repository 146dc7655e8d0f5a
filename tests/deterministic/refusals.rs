//! Singular systems, values that are not finite, settings that cannot be.

use crate::erased::Equation;
use crate::one;
use fredholm::Error;
use fredholm::deterministic::{Collocation, Galerkin, Nystrom};
use fredholm::domain::{Cuboid, HalfLine};
use std::f64::consts::PI;

#[test]
fn singular_equations_are_refused() {
    let all = |settings: Nystrom, eq: &dyn Fn(&Nystrom) -> Result<f64, Error>| match eq(&settings) {
        Err(Error::Singular { rcond, unknowns, .. }) => assert!(rcond < 1e-13 && unknowns > 0),
        other => panic!("{other:?}"),
    };
    all(Nystrom::gauss_legendre(16), &|n| Equation::on_interval(0.0..=1.0, one, |_, _| 1.0).solve(n).map(|f| f.eval(0.5)));
    let l = PI * PI / 4.0;
    all(Nystrom::graded(2, 14).levels(1), &|n| {
        Equation::on_interval(0.0..=1.0, one, move |x: f64, y| l * x.min(y)).solve(n).map(|f| f.eval(0.5))
    });
    for degree in [0, 2] {
        let constant = Equation::on_interval(0.0..=1.0, one, |_, _| 1.0);
        assert!(matches!(constant.solve(&Galerkin::elements(3).degree(degree)), Err(Error::Singular { .. })));
        assert!(matches!(constant.solve(&Collocation::elements(3).degree(degree)), Err(Error::Singular { .. })));
    }
    // nearly singular but solvable: the condition is reported
    let f = Equation::on_interval(0.0..=1.0, one, |_, _| 1.0 - 1e-9).solve(&Nystrom::gauss_legendre(16)).unwrap();
    assert!(f.rcond() < 1e-8 && f.rcond() > 1e-10 && (f.eval(0.5) * 1e-9 - 1.0).abs() < 1e-6);
    // prolate kernel, c = 8: 1 − λ₀ = 2.1e-6
    let prolate = |x: f64, y: f64| if x == y { 8.0 / PI } else { (8.0 * (x - y)).sin() / (PI * (x - y)) };
    let f = Equation::on_interval(-1.0..=1.0, one, prolate).solve(&Nystrom::gauss_legendre(40)).unwrap();
    assert!((f.inverse_norm() * 2.125_03e-6).ln().abs() < 1.5, "{}", f.inverse_norm());
}

#[test]
fn values_that_are_not_finite_are_named() {
    let g = Nystrom::gauss_legendre(9);
    let e = Equation::on_interval(0.0..=1.0, |x: f64| if x == 0.5 { f64::NAN } else { 1.0 }, |x, y| x * y).solve(&g).unwrap_err();
    assert_eq!(e, Error::NonFiniteSource { at: "0.5".into(), value: "NaN".into() });
    let e = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 1.0 / (x - y).abs().sqrt()).solve(&g).unwrap_err();
    assert!(matches!(&e, Error::NonFiniteKernel { x, y, value } if x == y && value == "inf"), "{e}");
    let cauchy = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 0.1 / (x - y).abs()).solve(&Nystrom::graded(2, 8));
    let no_number = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| if x > 0.9 && y < 0.1 { f64::NAN } else { 0.1 });
    assert!(matches!(no_number.solve(&Galerkin::elements(4).degree(2)), Err(Error::NonFiniteKernel { value, .. }) if value == "NaN"));
    assert!(matches!(no_number.solve(&Collocation::elements(4)), Err(Error::NonFiniteKernel { .. })));
    assert!(matches!(cauchy, Err(Error::NotIntegrable { ratio, .. }) if (ratio - 1.0).abs() < 1e-2), "{cauchy:?}");
}

#[test]
fn settings_that_cannot_be_are_refused() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x, y| 0.5 * x * y);
    let square = Equation::on_domain(Cuboid::<2>::unit(), |_| 1.0, |x, y| 0.1 * x[0] * y[1]);
    let invalid = |r: Result<f64, Error>, name: &str| match r {
        Err(Error::Invalid { parameter, .. }) => assert_eq!(parameter, name),
        other => panic!("{name}: {other:?}"),
    };
    let on = |n: Nystrom| eq.solve(&n).map(|f| f.eval(0.5));
    invalid(on(Nystrom::gauss_legendre(0)), "order");
    invalid(on(Nystrom::composite(0, 4)), "panels");
    invalid(on(Nystrom::graded(0, 4)), "panels");
    invalid(on(Nystrom::graded(4, 0)), "order");
    invalid(on(Nystrom::graded(4, 4).levels(200)), "levels");
    invalid(on(Nystrom::gauss_legendre(100_000)), "unknowns");
    invalid(on(Nystrom::graded(4, 4).breakpoints(&[2.0])), "breakpoint");
    invalid(on(Nystrom::graded(4, 4).breakpoints(&[f64::NAN])), "breakpoint");
    invalid(on(Nystrom::graded(4, 4).breakpoints(&[0.5; 40])), "breakpoints");
    invalid(on(Nystrom::gauss_legendre(4).breakpoints(&[0.5])), "breakpoints");
    invalid(square.solve(&Nystrom::graded(2, 4)).map(|f| f.eval([0.5; 2])), "dimension");
    invalid(square.solve(&Galerkin::elements(4)).map(|f| f.eval([0.5; 2])), "dimension");
    invalid(eq.solve(&Galerkin::elements(0)).map(|f| f.eval(0.5)), "elements");
    let fem = |g: Galerkin| eq.solve(&g).map(|f| f.eval(0.5));
    let collocation = |c: Collocation| eq.solve(&c).map(|f| f.eval(0.5));
    invalid(fem(Galerkin::elements(0).degree(3)), "elements");
    invalid(fem(Galerkin::elements(4).degree(17)), "degree");
    invalid(fem(Galerkin::elements(usize::MAX)), "unknowns");
    invalid(fem(Galerkin::elements(4).breakpoints(&[0.0])), "breakpoint");
    invalid(fem(Galerkin::elements(4).breakpoints(&[f64::NAN])), "breakpoint");
    invalid(fem(Galerkin::elements(4).breakpoints(&[0.5, 0.5 + 1e-14])), "shortest element");
    invalid(fem(Galerkin::elements(4).graded(0.5)), "grading");
    invalid(fem(Galerkin::elements(4).graded(f64::INFINITY)), "grading");
    invalid(fem(Galerkin::elements(100).graded(9.0)), "shortest element");
    invalid(collocation(Collocation::elements(0)), "elements");
    invalid(collocation(Collocation::elements(4).degree(usize::MAX)), "degree");
    invalid(collocation(Collocation::elements(16_384)), "unknowns");
    invalid(square.solve(&Collocation::elements(4)).map(|f| f.eval([0.5; 2])), "dimension");
    invalid(eq.factorise(&Nystrom::adaptive().tolerance(1e-6)).map(|f| f.rcond()), "Nystrom::adaptive");
    invalid(Equation::on_interval(1.0..=0.0, one, |_, _| 0.1).solve(&Nystrom::gauss_legendre(4)).map(|f| f.eval(0.5)), "interval end");
    invalid(
        Equation::on_domain(Cuboid::<20>::unit(), |_| 1.0, |_, _| 0.1).solve(&Nystrom::gauss_legendre(64)).map(|f| f.eval([0.5; 20])),
        "unknowns",
    );
    let line = Equation::on_domain(HalfLine::new(0.0), |_| 1.0, |x: &f64, y: &f64| 0.1 * (-(x - y).abs()).exp());
    assert!(matches!(line.solve(&Galerkin::elements(4)), Err(Error::InfiniteDomain { .. })));
    assert!(matches!(line.solve(&Collocation::elements(4).degree(2)), Err(Error::InfiniteDomain { .. })));
}
