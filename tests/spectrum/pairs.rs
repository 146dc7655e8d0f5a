//! Eigenpairs: claimed errors hold, functions solve their equations.

use crate::erased::{AnyKernel, kernel_fn};
use fredholm::deterministic::{Eigenpair, Nystrom, eigenpairs, eigenvalues, spectral_radius};
use fredholm::domain::{Cuboid, Grouped, Interval};
use fredholm::kernel::{HasDomain, Kernel};
use fredholm::{Complex, Error, GroupMatrix};
use std::f64::consts::PI;

type Real = AnyKernel<'static, Interval>;

fn on(a: f64, b: f64, k: fn(&f64, &f64) -> f64) -> Real {
    kernel_fn(Interval::from(a..=b), k)
}

fn tight(tolerance: f64) -> Nystrom {
    Nystrom::adaptive().tolerance(tolerance)
}

/// Each value is within its claimed error of the one known, and the claim is at most `least`.
fn holds<K: Kernel + HasDomain>(pairs: &[Eigenpair<K>], known: &[f64], least: f64) {
    assert!(pairs.len() >= known.len(), "{pairs:?}");
    for (pair, known) in pairs.iter().zip(known) {
        let error = (pair.value() - Complex::from(*known)).norm();
        // what is known has 15 digits
        assert!(error <= pair.error() + 1e-14 * known.abs() && pair.error() <= least, "{pair} is not {known}: {error:e}");
        assert!(pair.residual() <= 10.0 * least, "{pair}");
    }
}

#[test]
fn smooth_kernels() {
    let exp = on(0.0, 1.0, |x, y| (x * y).exp());
    let pairs = eigenpairs(&exp, &tight(1e-13), 2).unwrap();
    holds(&pairs, &[1.353_030_164_745_74, 0.105_983_224_090_897], 1e-12);
    assert!(pairs[0].unknowns() <= 32 && pairs[0].condition() < 2.0, "{}", pairs[0]);
    // the prolate kernel, problems §2 E12: λ₀(c)
    for (c, known) in [(0.5, 0.309_689_565_709_271), (1.0, 0.572_581_780_637_895), (4.0, 0.995_885_490_429_662), (8.0, 0.999_997_874_997_2)]
    {
        let prolate = kernel_fn(Interval::from(-1.0..=1.0), move |x: &f64, y: &f64| {
            let t = x - y;
            if t == 0.0 { c / PI } else { (c * t).sin() / (PI * t) }
        });
        let pairs = eigenpairs(&prolate, &tight(1e-13), 3).unwrap();
        let error = (pairs[0].value().re - known).abs();
        assert!(error <= pairs[0].error() + 1e-13 && pairs[0].error() < 1e-12, "c = {c}: {error:e}, {}", pairs[0]);
        // alternately even and odd
        let phi = |k: usize, x: f64| pairs[k].eval(x).re;
        assert!((0..3).all(|k| (phi(k, 0.4) - if k % 2 == 0 { 1.0 } else { -1.0 } * phi(k, -0.4)).abs() < 1e-10));
    }
}

#[test]
fn kinks_and_singularities() {
    let minimum = on(0.0, 1.0, |x, y| x.min(*y));
    let known: Vec<f64> = (0..4).map(|k| 1.0 / ((f64::from(k) + 0.5) * PI).powi(2)).collect();
    let pairs = eigenpairs(&minimum, &tight(1e-12), 4).unwrap();
    holds(&pairs, &known, 1e-12);
    for (k, pair) in pairs.iter().enumerate() {
        let exact = |x: f64| ((k as f64 + 0.5) * PI * x).sin();
        let scale = exact(0.5) / pair.eval(0.5).re;
        assert!([0.0, 0.13, 0.77, 1.0].iter().all(|x| (scale * pair.eval(*x).re - exact(*x)).abs() < 1e-10), "{pair}");
        assert!(pair.eval(1.5).re.is_nan());
    }
    let exponential = on(0.0, 1.0, |x, y| (-(x - y).abs()).exp());
    holds(&eigenpairs(&exponential, &tight(1e-12), 2).unwrap(), &[0.738_810_809_416_455, 0.138_003_775_354_263], 1e-12);
    // log|x − y| with the weight of Chebyshev, by x = cos θ: λ = −π ln 2 and −π/n
    let chebyshev = on(0.0, PI, |x, y| {
        let difference = 2.0 * (0.5 * (x + y)).sin() * (0.5 * (x - y)).sin();
        difference.abs().ln()
    });
    let pairs = eigenpairs(&chebyshev, &tight(1e-11), 3).unwrap();
    holds(&pairs, &[-PI, -PI * 2f64.ln(), -PI / 2.0], 1e-10);
    assert!((spectral_radius(&chebyshev, &tight(1e-9)).unwrap() - PI).abs() < 1e-8);
    // |x − y|^{−1/2} (1 − y²)^{−1/4}, by y = sin θ: Gegenbauer's π Γ(n + α)/(cos(πα/2) Γ(α) n!) = √2 π, √2 π/2, 3√2 π/8 for α = 1/2
    let gegenbauer = on(-0.5 * PI, 0.5 * PI, |x, y| {
        let difference = 2.0 * (0.5 * (x + y)).cos() * (0.5 * (x - y)).sin();
        (y.cos() / difference.abs()).sqrt()
    });
    let pairs = eigenpairs(&gegenbauer, &tight(1e-4), 3).unwrap();
    holds(&pairs, &[2f64.sqrt() * PI, 2f64.sqrt() * PI / 2.0, 2f64.sqrt() * PI * 0.375], 1e-3);
}

#[test]
fn multiple_and_complex_eigenvalues() {
    // Poisson's kernel: 1, then c^m twice
    let poisson = on(0.0, 1.0, |x, y| 0.36 / (1.64 - 1.6 * (2.0 * PI * (x - y)).cos()));
    let pairs = eigenpairs(&poisson, &tight(1e-12), 5).unwrap();
    holds(&pairs, &[1.0, 0.8, 0.8, 0.64, 0.64], 1e-11);
    let product: f64 = pairs[1].values().iter().zip(pairs[2].values()).map(|(a, b)| (a * b.conj()).re).sum();
    assert!(product.abs() < 1e-8 * pairs[1].unknowns() as f64, "independent functions: {product}");
    // sin(x − y): ± iπ with e^{± ix}
    let turn = on(0.0, 2.0 * PI, |x, y| (x - y).sin());
    let pairs = eigenpairs(&turn, &tight(1e-12), 2).unwrap();
    assert!((pairs[0].value() - Complex::new(0.0, PI)).norm() < 1e-12 && (pairs[1].value() + Complex::new(0.0, PI)).norm() < 1e-12);
    let quotient = pairs[0].eval(0.7) / pairs[0].eval(0.2);
    assert!((quotient - Complex::new(0.0, -0.5).exp()).norm() < 1e-12 || (quotient - Complex::new(0.0, 0.5).exp()).norm() < 1e-12);
    // many unknowns: the leading ones only
    let pairs = eigenpairs(&turn, &Nystrom::composite(40, 8), 2).unwrap();
    assert!((pairs[0].value() - Complex::new(0.0, PI)).norm() <= pairs[0].error() && pairs[0].error() < 1e-12);
    assert_eq!(eigenpairs(&turn, &Nystrom::gauss_legendre(20), 9).unwrap().len(), 2, "rank 2");
}

#[test]
fn unresolved_and_nilpotent_kernels_do_not_pretend() {
    // errors of coarse rules are covered by what they claim
    let peaked = on(-1.0, 1.0, |x, y| 0.05 / PI / (0.0025 + (x - y) * (x - y)));
    let exact = eigenpairs(&peaked, &tight(1e-11), 1).unwrap()[0].value();
    for n in [10, 16, 24, 40, 80] {
        let pair = &eigenpairs(&peaked, &Nystrom::gauss_legendre(n), 1).unwrap()[0];
        let error = (pair.value() - exact).norm();
        assert!(error <= pair.error(), "{n}: {pair}, error {error:e}");
    }
    // rank 2 and nilpotent: rounding makes eigenvalues √ε of it
    let nilpotent = on(0.0, 2.0 * PI, |x, y| (x + 2.0 * y).sin());
    let pairs = eigenpairs(&nilpotent, &Nystrom::gauss_legendre(40), 1).unwrap();
    assert!(pairs.iter().all(|p| p.error() >= p.value().norm()), "{pairs:?}");
    assert!(matches!(eigenpairs(&nilpotent, &tight(1e-10), 1), Ok(p) if p.is_empty()) || eigenpairs(&nilpotent, &tight(1e-10), 1).is_err());
}

#[test]
fn complex_kernels_have_their_own_eigenvalues() {
    // Fox and Li's resonator √(iF/π) e^{−iF(x − y)²}: complex symmetric, not Hermitian
    let fresnel = |f: f64| {
        let factor = (Complex::new(0.0, 1.0) * f / PI).sqrt();
        kernel_fn(Interval::from(-1.0..=1.0), move |x: &f64, y: &f64| factor * Complex::new(0.0, -f * (x - y) * (x - y)).exp())
    };
    let pairs = eigenpairs(&fresnel(16.0 * PI), &tight(1e-11), 6).unwrap();
    let spectrum = eigenvalues(&fresnel(16.0 * PI), &Nystrom::gauss_legendre(220)).unwrap();
    for (pair, value) in pairs.iter().zip(&spectrum) {
        assert!((pair.value() - value).norm() < 1e-11 && pair.error() < 1e-10, "{pair} {value}");
        assert!(pair.value().norm() < 1.0 && pair.condition() > 1.0);
    }
    // no conjugates among them, as the real embedding would have
    let far = |z: Complex<f64>| spectrum.iter().take(10).all(|w| (w - z.conj()).norm() > 1e-3);
    assert!(far(spectrum[0]) && far(spectrum[1]));
    // rank 1: i ∫ y² dy
    let product = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| Complex::new(0.0, x * y));
    let pair = &eigenpairs(&product, &tight(1e-12), 1).unwrap()[0];
    assert!((pair.value() - Complex::new(0.0, 1.0 / 3.0)).norm() < 1e-14);
}

#[test]
fn systems_and_boxes() {
    let unit = Interval::from(0.0..=1.0);
    let coupling = [[0.5, 0.2], [0.3, 0.4]];
    let matrix = kernel_fn(unit, move |x: &f64, y: &f64| GroupMatrix(coupling.map(|row| row.map(|k| k * (x * y).exp()))));
    let groups = kernel_fn(Grouped::new(unit, 2), move |x: &(f64, usize), y: &(f64, usize)| coupling[x.1][y.1] * (x.0 * y.0).exp());
    // eigenvalues of the product: those of the coupling, 0.7 and 0.2, times those of e^{xy}
    let known = [0.7 * 1.353_030_164_745_74, 0.2 * 1.353_030_164_745_74, 0.7 * 0.105_983_224_090_897];
    let pairs = eigenpairs(&matrix, &tight(1e-12), 3).unwrap();
    holds(&pairs, &known, 1e-11);
    // the vector of 0.7 is (1, 1)
    assert!((pairs[0].component(0.3, 0) - pairs[0].component(0.3, 1)).norm() < 1e-13);
    holds(&eigenpairs(&groups, &tight(1e-12), 3).unwrap(), &known, 1e-11);
    let square = kernel_fn(Cuboid::<2>::unit(), |x: &[f64; 2], y: &[f64; 2]| (x[0] * y[0] + x[1] * y[1]).exp());
    let pairs = eigenpairs(&square, &tight(1e-11), 3).unwrap();
    let (a, b) = (1.353_030_164_745_74, 0.105_983_224_090_897);
    holds(&pairs, &[a * a, a * b, a * b], 1e-10);
}

#[test]
fn bad_input() {
    let one = on(0.0, 1.0, |_, _| 1.0);
    assert!(matches!(eigenpairs(&one, &tight(1e-10), 0), Err(Error::Invalid { parameter: "count", .. })));
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(eigenpairs(&one, &tight(tolerance), 1), Err(Error::Invalid { parameter: "tolerance", .. })));
    }
    assert!(eigenpairs(&on(1.0, 0.0, |_, _| 1.0), &tight(1e-10), 1).is_err());
    assert!(matches!(eigenpairs(&one, &tight(1e-10).breakpoints(&[2.0]), 1), Err(Error::Invalid { parameter: "breakpoint", .. })));
    let strong = on(0.0, 1.0, |x, y| 1.0 / (x - y).abs());
    let refused = eigenpairs(&strong, &tight(1e-6), 1);
    assert!(matches!(refused, Err(Error::NotIntegrable { .. })), "{refused:?}");
    let broken = on(0.0, 1.0, |x, y| if (x - y).abs() > 0.8 { f64::NAN } else { 1.0 });
    assert!(matches!(eigenpairs(&broken, &tight(1e-6), 1), Err(Error::NonFiniteKernel { .. })));
    assert!(matches!(eigenpairs(&on(0.0, 1.0, |_, _| 0.0), &tight(1e-6), 1), Ok(none) if none.is_empty()));
    for (a, b) in [(0.0, 1e300), (0.0, 1e-300), (1e300, 1.1e300)] {
        let length = b - a;
        let mean = kernel_fn(Interval::from(a..=b), move |_: &f64, _: &f64| 1.0 / length);
        let pairs = eigenpairs(&mean, &tight(1e-12), 1).unwrap();
        assert!((pairs[0].value().re - 1.0).abs() <= 1e-12, "[{a}, {b}]: {pairs:?}");
    }
}
