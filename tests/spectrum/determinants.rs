//! Fredholm determinants with closed forms, and the Tracy–Widom distribution.

use crate::erased::{AnyKernel, kernel_fn};
use fredholm::deterministic::quadrature::composite_unit_rule;
use fredholm::deterministic::{Determinant, Nystrom, determinant};
use fredholm::domain::Interval;
use fredholm::{Complex, Error};
use std::f64::consts::PI;

type Real = AnyKernel<'static, Interval>;

fn on(a: f64, b: f64, k: fn(&f64, &f64) -> f64) -> Real {
    kernel_fn(Interval::from(a..=b), k)
}

fn holds(d: Determinant, known: Complex<f64>, least: f64) {
    let error = (d.value - known).norm();
    assert!(error <= d.error && d.error <= least, "{d:?}, not {known}: {error:e}");
}

#[test]
fn degenerate_kernels_have_polynomials() {
    let product = on(0.0, 1.0, |x, y| x * y);
    for z in [-2.0, 0.7, 3.0, 30.0] {
        holds(determinant(&product, z, &Nystrom::adaptive().tolerance(1e-12)).unwrap(), (1.0 - z / 3.0).into(), 1e-11);
        holds(determinant(&product, z, &Nystrom::gauss_legendre(6)).unwrap(), (1.0 - z / 3.0).into(), 1e-12);
    }
    // eigenvalues ± iπ
    let turn = on(0.0, 2.0 * PI, |x, y| (x - y).sin());
    let z = Complex::new(0.1, 0.3);
    holds(determinant(&turn, z, &Nystrom::adaptive().tolerance(1e-12)).unwrap(), Complex::from(1.0) + z * z * PI * PI, 1e-11);
}

#[test]
fn kinks_converge_slowly_and_say_so() {
    // min(x, y): cos √z
    let kink = on(0.0, 1.0, |x, y| x.min(*y));
    let errors: Vec<f64> = [20, 40, 80]
        .iter()
        .map(|&n| {
            let d = determinant(&kink, 2.0, &Nystrom::gauss_legendre(n)).unwrap();
            holds(d, 2f64.sqrt().cos().into(), 1e-2);
            (d.value.re - 2f64.sqrt().cos()).abs()
        })
        .collect();
    assert!(errors.windows(2).all(|e| (e[0] / e[1]).log2() > 1.7), "{errors:?}");
    let strict = determinant(&kink, 2.0, &Nystrom::adaptive().max_unknowns(200));
    assert!(matches!(strict, Err(Error::NotConverged { error, .. }) if error < 1e-3), "{strict:?}");
}

/// x(1 + 100 e^{−((y − 0.377)/w)²}) for w = 10⁻³: a column between the nodes of small rules, which agree with each other on 1 − z/2.
#[test]
fn narrow_columns_are_not_missed() {
    let column = on(0.0, 1.0, |x, y| x * (1.0 + 100.0 * (-((y - 0.377) / 1e-3).powi(2)).exp()));
    let known = 0.5 - 37.7 * 1e-3 * PI.sqrt();
    for settings in [Nystrom::adaptive().tolerance(1e-9).max_unknowns(400), Nystrom::adaptive().tolerance(1e-9).max_unknowns(3000)] {
        match determinant(&column, 1.0, &settings) {
            Ok(d) => holds(d, known.into(), 2e-9),
            Err(refused) => assert!(matches!(refused, Error::NotConverged { .. }), "{refused:?}"),
        }
    }
}

#[test]
fn determinants_of_unbounded_kernels_are_refused() {
    for k in [|x: &f64, y: &f64| (x - y).abs().ln(), |x: &f64, y: &f64| (x - y).abs().powf(-0.5)] as [fn(&f64, &f64) -> f64; 2] {
        let refused = determinant(&on(0.0, 1.0, k), 1.0, &Nystrom::adaptive());
        assert!(matches!(refused, Err(Error::NonFiniteKernel { .. })), "{refused:?}");
    }
    let one = on(0.0, 1.0, |_, _| 1.0);
    assert!(matches!(determinant(&one, f64::NAN, &Nystrom::adaptive()), Err(Error::Invalid { parameter: "z", .. })));
    assert!(determinant(&one, 1.0, &Nystrom::graded(2, 4)).is_err());
}

/// Ai and Ai′ by steepest descent: ∫ e^{−s t²}… on the contour t = i√x + u for x > 0, by the Taylor series about 0 else.
fn airy(x: f64) -> (f64, f64) {
    if x > 4.0 {
        // Ai(x) = e^{−ζ}/π ∫₀^∞ e^{−√x u²} cos(u³/3) du, ζ = ⅔ x^{3/2}; Ai′ from the derivative in x
        let (root, zeta) = (x.sqrt(), 2.0 / 3.0 * x.powf(1.5));
        let (mut a, mut b) = (0.0, 0.0);
        for n in composite_unit_rule(8, 20) {
            let u = 6.5 / root.sqrt() * n.point;
            let w = 6.5 / root.sqrt() * n.weight * (-root * u * u).exp();
            a += w * (u * u * u / 3.0).cos();
            b += w * u * u * (u * u * u / 3.0).cos();
        }
        let scale = (-zeta).exp() / PI;
        return (scale * a, -scale * (root * a + b / (2.0 * root)));
    }
    let (c1, c2) = (0.355_028_053_887_817_2, 0.258_819_403_792_806_8);
    let (mut f, mut g, mut df, mut dg) = (1.0, x, 0.0, 1.0);
    let (mut tf, mut tg) = (1.0, x);
    for k in 1..80 {
        let k3 = 3.0 * f64::from(k);
        df += tf * x * x / (k3 - 1.0);
        tf *= x * x * x / ((k3 - 1.0) * k3);
        dg += tg * x * x / k3;
        tg *= x * x * x / (k3 * (k3 + 1.0));
        f += tf;
        g += tg;
    }
    (c1 * f - c2 * g, c1 * df - c2 * dg)
}

#[test]
fn tracy_widom() {
    let (ai, slope) = airy(1.0);
    assert!((ai - 0.135_292_416_312_881_4).abs() < 1e-15 && (slope + 0.159_147_441_296_793_2).abs() < 1e-15);
    let (ai, slope) = airy(5.0);
    assert!((ai / 1.083_444_281_360_744e-4 - 1.0).abs() < 1e-13 && (slope / -2.474_138_908_684_625e-4 - 1.0).abs() < 1e-13);
    // F₂(−2) = det(I − K_Airy) on [−2, ∞); beyond 14 the kernel is below 1e-30
    let airy = kernel_fn(Interval::from(-2.0..=14.0), |x: &f64, y: &f64| {
        let ((a, da), (b, db)) = (airy(*x), airy(*y));
        if x == y { da * da - x * a * a } else { (a * db - da * b) / (x - y) }
    });
    let d = determinant(&airy, 1.0, &Nystrom::gauss_legendre(60)).unwrap();
    assert!((d.value.re - 0.413_224_142_505_12).abs() < 1e-12, "{d:?}");
}
