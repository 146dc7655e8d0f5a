//! Eigenvalues of T.

use crate::erased::kernel_fn;
use fredholm::deterministic::{Nystrom, eigenvalues, spectral_radius};
use fredholm::domain::Interval;
use fredholm::special::e1;
use std::f64::consts::PI;

#[test]
fn spectra() {
    let unit = Interval::from(0.0..=1.0);
    let exp = kernel_fn(unit, |x: &f64, y: &f64| (x * y).exp());
    let values = eigenvalues(&exp, &Nystrom::gauss_legendre(20)).unwrap();
    assert!((values[0].re - 1.353_030_164_745_74).abs() < 1e-13 && (values[1].re - 0.105_983_224_090_897).abs() < 1e-13);
    let kink = kernel_fn(unit, |x: &f64, y: &f64| (-(x - y).abs()).exp());
    let values = eigenvalues(&kink, &Nystrom::graded(2, 12).levels(0)).unwrap();
    assert!((values[0].re - 0.738_810_809_416_455).abs() < 1e-13 && (values[1].re - 0.138_003_775_354_263).abs() < 1e-13);
    // a rotation: eigenvalues ± iπ of sin(x − y) on [0, 2π], so T is not what |T| is
    let turn = kernel_fn(Interval::from(0.0..=2.0 * PI), |x: &f64, y: &f64| (x - y).sin());
    let values = eigenvalues(&turn, &Nystrom::gauss_legendre(32)).unwrap();
    assert!(values[0].re.abs() < 1e-12 && (values[0].im.abs() - PI).abs() < 1e-12);
    assert!((spectral_radius(&turn, &Nystrom::gauss_legendre(32)).unwrap() - PI).abs() < 1e-12);
    // Volterra: 0 up to ε^{1/k}
    let volterra = kernel_fn(unit, |x: &f64, y: &f64| if x > y { 5.0 } else { 0.0 });
    assert!(spectral_radius(&volterra, &Nystrom::graded(4, 8).levels(0)).unwrap() < 0.2);
    for (a, known) in [(0.5, 0.447_425_316_581_694_9), (5.0, 0.928_011_538_919_879_4), (10.0, 0.975_724_583_882_712_3)] {
        let slab = kernel_fn(Interval::from(0.0..=a), |x: &f64, y: &f64| e1((x - y).abs()) / 2.0);
        let radius = spectral_radius(&slab, &Nystrom::graded(4, 10).levels(10)).unwrap();
        assert!((radius - known).abs() < 1e-10, "a = {a}: {radius} is not {known}");
    }
}
