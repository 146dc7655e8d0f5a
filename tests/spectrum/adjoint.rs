//! ⟨h, f⟩ corrected by the adjoint solution.

use crate::erased::Equation;
use fredholm::deterministic::Nystrom;
use fredholm::{Complex, Error, GroupMatrix, Spectrum};

#[test]
fn accuracy_is_doubled() {
    // f = 1 + ½∫ e^{−|x−y|} f on [0, 1]: f = 13/8 − (x − ½)²/2, ∫ x f = ½ ∫ f by symmetry
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y: f64| 0.5 * f64::exp(-(x - y).abs()));
    let exact = 0.5 * (1.625 - 1.0 / 24.0);
    let errors: Vec<(f64, f64)> = [6, 12, 24, 48]
        .iter()
        .map(|&n| {
            let found = eq.solve(&Nystrom::gauss_legendre(n)).unwrap().corrected_functional(|x| *x).unwrap();
            let error = (found.value - exact).abs();
            assert!(error <= found.error, "{n}: {error:e}, claimed {:e}", found.error);
            (error, (found.uncorrected - exact).abs())
        })
        .collect();
    for e in errors.windows(2) {
        let slopes = ((e[0].0 / e[1].0).log2(), (e[0].1 / e[1].1).log2());
        assert!(slopes.0 > 3.4 && (1.6..2.4).contains(&slopes.1), "{errors:?}");
    }
    assert!(errors[3].0 < 1e-8 && errors[3].1 > 1e-5);
}

#[test]
fn smooth_and_singular_kernels() {
    // f = 1 + ½xy ∫: 1 + 3x/10
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let found = eq.solve(&Nystrom::gauss_legendre(6)).unwrap().corrected_functional(|x| *x).unwrap();
    assert!((found.value - 0.6).abs() <= found.error && found.error < 1e-13, "{found:?}");
    // f = 1 + ∫₀¹ ln|x − y| f, problems §2 C2: ∫ f
    let log = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y: f64| (x - y).abs().ln());
    for (rule, least) in [(Nystrom::graded(2, 6).levels(8), 1e-6), (Nystrom::graded(4, 12), 1e-9), (Nystrom::composite(1, 1), 1.0)] {
        let Ok(f) = log.solve(&rule) else { continue };
        let found = f.corrected_functional(|_| 1.0).unwrap();
        let error = (found.value - 0.404_081_843_036_346).abs();
        assert!(error <= found.error + 1e-15 && error < least, "{found:?}: {error:e}");
    }
}

/// f is known to rounding here, ∫ h f is not: few nodes see little of thirteen periods.
#[test]
fn the_weight_is_integrated_as_well_as_is_said() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let found = eq.solve(&Nystrom::gauss_legendre(4)).unwrap().corrected_functional(|x| (80.0 * x).cos()).unwrap();
    let exact = 80f64.sin() / 80.0 + 0.3 * (80f64.sin() / 80.0 + (80f64.cos() - 1.0) / 6400.0);
    assert!((found.value - exact).abs() <= found.error && (found.value - exact).abs() > 1e-5, "{found:?}: {exact}");
}

#[test]
fn systems_and_complex_equations() {
    let m = |x: f64, y: f64| GroupMatrix([[0.3 * x, 0.2 * y], [0.1, 0.4 * x * y]]);
    let eq = Equation::on_interval(0.0..=1.0, |x: f64| Spectrum([1.0, x]), m);
    let fine = eq.solve(&Nystrom::gauss_legendre(24)).unwrap().functional(|x| x.exp());
    let found = eq.solve(&Nystrom::gauss_legendre(8)).unwrap().corrected_functional(|x| x.exp()).unwrap();
    assert!((0..2).all(|a| (found.value[a] - fine[a]).abs() <= found.error) && found.error < 1e-12, "{found:?}");
    // f = 1 + iκ ∫ f
    let eq = Equation::on_interval(0.0..=1.0, |_| Complex::new(1.0, 0.0), |_, _| Complex::new(0.0, 0.5));
    let found = eq.solve(&Nystrom::gauss_legendre(4)).unwrap().corrected_functional(|_| 1.0).unwrap();
    assert!((found.value - Complex::new(0.8, 0.4)).norm() < 1e-14);
    let infinite = eq.solve(&Nystrom::gauss_legendre(4)).unwrap().corrected_functional(|_| f64::NAN);
    assert!(matches!(infinite, Err(Error::NonFiniteSolution { .. })));
}
