//! Lines, periods and disks: the laws of their maps, and equations on them with closed forms; complex equations.

use crate::erased::{Equation, kernel_fn};
use fredholm::deterministic::{Nystrom, eigenpairs};
use fredholm::domain::{Disk, Domain, Grouped, HalfLine, Line, Periodic};
use fredholm::{Complex, Error, Walk};
use std::f64::consts::PI;

/// The maps of a line: inverse, density, displacements without cancellation.
fn laws<D: Domain<Point = f64>>(domain: &D) {
    for t in [1e-9, 0.003, 0.2, 0.5, 0.77, 0.999] {
        let n = domain.place(0, || t);
        assert!((domain.coordinate(&n.point, 0) - t).abs() < 1e-14, "{domain:?} {t}: {n:?}");
        assert!((domain.density(&n.point) * n.weight - 1.0).abs() < 1e-12, "{domain:?} {t}");
        // Jacobian
        let h = 1e-5 * t * (1.0 - t);
        let slope = (domain.place(0, || t + h).point - domain.place(0, || t - h).point) / (2.0 * h);
        let noise = 4.0 * f64::EPSILON * n.point.abs() / (h * n.weight);
        assert!((slope / n.weight - 1.0).abs() < 1e-6 + noise, "{domain:?} {t}: {slope} {}", n.weight);
        for d in [1e-13, -1e-10, 1e-5, -0.1, 0.3] {
            let d: f64 = d * if d < 0.0 { t } else { 1.0 - t };
            let moved = domain.displaced(&n.point, 0, d);
            let apart = domain.separation(&n.point, &moved.point);
            // y is a floating-point number: what its spacing is in coordinates cannot be told
            let spacing = 4.0 * f64::EPSILON * n.point.abs().max(moved.point.abs()) / n.weight.min(moved.weight);
            assert!((apart - d).abs() <= 1e-12 * d.abs() + spacing, "{domain:?} {t} {d}: {apart}");
            assert!((domain.separation(&moved.point, &n.point) + apart).abs() <= 1e-12 * apart.abs());
        }
    }
}

#[test]
fn maps_of_lines() {
    laws(&Line::new());
    laws(&Line::new().centre(3.0).scale(0.2));
    laws(&Line::new().exponential());
    laws(&Line::new().centre(-1.0).scale(5.0).exponential());
    laws(&HalfLine::new(0.0));
    laws(&HalfLine::new(-2.0).scale(3.0).exponential());
    laws(&Periodic::from(1.0..=4.0));
    // both ends are at infinity, and coordinates counted from them
    let line = Line::new();
    for x in [-1e12, -3.0, 0.0, 1e9] {
        assert_eq!(line.separation(&f64::NEG_INFINITY, &x), line.coordinate(&x, 0));
        let back = line.displaced(&f64::NEG_INFINITY, 0, line.coordinate(&x, 0)).point;
        assert!((back - x).abs() <= 1e-15 * x.abs() * x.abs().max(1.0) + 1e-15, "{x} {back}");
    }
    for bad in [Line::new().scale(0.0), Line::new().scale(f64::NAN), Line::new().centre(f64::INFINITY)] {
        assert!(matches!(bad.validate(), Err(Error::Invalid { .. })));
    }
}

#[test]
fn decay_chooses_the_map() {
    for (phi, exponential) in [
        ((|x| (-x.abs()).exp()) as fn(f64) -> f64, true),
        (|x| (-x * x).exp(), true),
        (|x| 1e-3 / (1.0 + x * x), false),
        (|x| 1.0 / (1.0 + x.powi(4)), false),
        (|_| 1.0, false),
        (|_| 0.0, false),
        (|x| if x == 0.0 { f64::NAN } else { (-1e3 * x.abs()).exp() / x.abs().sqrt() }, true),
    ] {
        let (line, half) = (Line::fitted(0.0, phi), HalfLine::fitted(0.0, phi));
        assert_eq!((line == line.exponential(), half == half.exponential()), (exponential, exponential), "{line:?} {half:?}");
        assert!(line.validate().is_ok() && half.validate().is_ok());
    }
}

#[test]
fn equations_on_the_whole_line() {
    // ½b e^{−|x − y|}, g = e^{−2|x|}: f = A e^{−2|x|} + B e^{−κ|x|}, κ = √(1 − b), from (1 − b/(1 + ω²)) f̂ = 4/(4 + ω²)
    let b: f64 = 0.6;
    let kappa = (1.0 - b).sqrt();
    let (a, c) = (3.0 / (4.0 - kappa * kappa), 2.0 * b / (kappa * (4.0 - kappa * kappa)));
    let exact = |x: f64| a * (-2.0 * x.abs()).exp() + c * (-kappa * x.abs()).exp();
    for line in [Line::new(), Line::new().scale(2.0), Line::fitted(0.0, |x| (-x.abs()).exp())] {
        let eq = Equation::on_domain(line, |x: &f64| (-2.0 * x.abs()).exp(), move |x, y| 0.5 * b * (-(x - y).abs()).exp());
        let f = eq.solve(&Nystrom::adaptive().tolerance(1e-10).breakpoints(&[0.0])).unwrap();
        for x in [-5.0, -0.4, 0.0, 0.1, 1.0, 12.0] {
            let error = (f.eval(x) - exact(x)).abs();
            assert!(error <= f.error_estimate().unwrap() && error < 1e-10, "{line:?}, {x}: {error:e}");
        }
    }
    // a walk on it
    let eq = Equation::on_domain(Line::new(), |x: &f64| (-2.0 * x.abs()).exp(), move |x, y| 0.5 * b * (-(x - y).abs()).exp());
    assert!(eq.at(0.5).solve(&Walk::collision().samples_per_cell(20_000)).unwrap().agrees_with(exact(0.5), 6.0));
    // slow decay: Cauchy densities convolve to one, f̂ = e^{−|ω|}/(1 − b e^{−|ω|})
    let cauchy = |w: f64, x: f64| w / PI / (w * w + x * x);
    let eq = Equation::on_domain(Line::new(), move |x: &f64| cauchy(1.0, *x), move |x, y| 0.5 * cauchy(1.0, x - y));
    let f = eq.solve(&Nystrom::adaptive().tolerance(1e-10)).unwrap();
    for x in [0.0, 0.7, 30.0, -500.0] {
        let exact: f64 = (0..60).map(|n| 0.5f64.powi(n) * cauchy(f64::from(n) + 1.0, x)).sum();
        assert!((f.eval(x) - exact).abs() < 1e-10, "{x}");
    }
}

#[test]
fn periodic_functions() {
    let circle = Periodic::from(0.0..=1.0);
    // problems §2 S5: ∫ K cos 6πt = c³ cos 6πs
    for (c, n) in [(0.5, 96), (0.7, 192)] {
        let kernel = move |x: &f64, y: &f64| (1.0 - c * c) / (1.0 + c * c - 2.0 * c * (2.0 * PI * (x + y)).cos());
        let source = move |x: &f64| (6.0 * PI * x).cos() * (1.0 - 0.5 * c * c * c);
        let eq = Equation::on_domain(circle, source, move |x, y| 0.5 * kernel(x, y));
        let f = eq.solve(&Nystrom::adaptive().tolerance(1e-12)).unwrap();
        assert!([0.0, 0.2, 0.91].iter().all(|x| (f.eval(*x) - (6.0 * PI * x).cos()).abs() < 1e-12));
        assert!(f.unknowns() <= n, "{f}");
        let pairs = eigenpairs(&kernel_fn(circle, kernel), &Nystrom::adaptive().tolerance(1e-12), 3).unwrap();
        assert!((pairs[0].value().re - 1.0).abs() < 1e-12 && (pairs[1].value().norm() - c).abs() < 1e-12);
    }
    // the logarithm of a circle (Kress): e^{imx} → −1/(2|m|)·…: product integration knows nothing of periods and needs none
    let log = |x: &f64, y: &f64| (4.0 * (PI * (x - y)).sin().powi(2)).ln();
    let eq = Equation::on_domain(circle, |x: &f64| (4.0 * PI * x).cos(), move |x, y| 0.5 * log(x, y));
    // ∫₀¹ ln(4 sin² π(x − y)) cos 4πy dy = −½ cos 4πx
    let f = eq.solve(&Nystrom::graded(8, 12).levels(30)).unwrap();
    assert!((f.eval(0.3) - (1.2 * PI).cos() / 1.25).abs() < 1e-9, "{:e}", f.eval(0.3) - (1.2 * PI).cos() / 1.25);
    let system = Grouped::new(circle, 2);
    assert!(system.is_periodic(0) && system.rule(1, 4)[0].point.0 == 0.125);
}

#[test]
fn disks() {
    let disk = Disk::unit();
    let distance = |x: &[f64; 2], y: &[f64; 2]| (x[0] - y[0]).hypot(x[1] - y[1]);
    // areas and moments, around any point and around the centre
    for x in [[0.0, 0.0], [0.3, -0.4], [0.0, 0.99], [-1.0, 0.0]] {
        let rule = disk.around(&x, 10).unwrap();
        let sum = |phi: &dyn Fn(&[f64; 2]) -> f64| rule.iter().map(|n| n.weight * phi(&n.point)).sum::<f64>();
        assert!((sum(&|_| 1.0) - PI).abs() < 1e-11, "{x:?}: {:e}", sum(&|_| 1.0) - PI);
        assert!((sum(&|y| y[0] * y[0]) - PI / 4.0).abs() < 1e-11);
        // ∫ ln|x − y| dy = π(|x|² − 1)/2
        let exact = 0.5 * PI * (x[0] * x[0] + x[1] * x[1] - 1.0);
        let error = (sum(&|y| distance(&x, y).ln()) - exact).abs();
        assert!(error < 1e-10, "{x:?}: {error:e}");
    }
    // smooth: rank 3, f = 1 + c·x by hand
    let eq = Equation::on_domain(disk, |x: &[f64; 2]| 1.0 + x[0], |x, y| 0.2 + 0.4 * (x[0] * y[0] + x[1] * y[1]));
    let f = eq.solve(&Nystrom::adaptive().tolerance(1e-12)).unwrap();
    let exact = |x: [f64; 2]| 1.0 / (1.0 - 0.2 * PI) + x[0] / (1.0 - 0.1 * PI);
    assert!([[0.0, 0.0], [0.5, -0.5], [0.0, 1.0]].iter().all(|x| (f.eval(*x) - exact(*x)).abs() < 1e-12), "{f}");
    // problems §2 N1, −λ/(2π) ln|x − y|: the stored solution J₀(kr)/J₀(k)
    let log = Equation::on_domain(disk, |_| 1.0, move |x, y| -0.3 * distance(x, y).ln());
    let f = log.solve(&Nystrom::adaptive().tolerance(1e-8)).unwrap();
    for (x, known) in [([0.0, 0.0], 1.719_824_111_383_791), ([0.2, -0.6], 1.410_605_278_034_257), ([0.0, 0.95], 1.062_583_868_797_686)] {
        let error = (f.eval(x) - known).abs();
        assert!(error <= f.error_estimate().unwrap() && error < 1e-8, "{x:?}: {error:e}");
    }
    // walks draw uniformly
    let walk = eq.at([0.5, -0.5]).solve(&Walk::collision().samples_per_cell(20_000)).unwrap();
    assert!(walk.agrees_with(exact([0.5, -0.5]), 6.0));
    for bad in [Disk::new([0.0, 0.0], 0.0), Disk::new([f64::NAN, 0.0], 1.0), Disk::new([0.0, 0.0], 1e200), Disk::new([0.0, 0.0], 1e-200)] {
        assert!(matches!(bad.validate(), Err(Error::Invalid { .. })));
    }
    let line = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| x * y);
    assert!(matches!(line.solve(&Nystrom::centred(5)), Err(Error::Invalid { parameter: "Nystrom::centred", .. })));
}

#[test]
fn complex_equations() {
    // problems §2 D-exp with a = −ik: (βa/2) e^{−a|x − y|} on [0, T], g = 1
    for (k, t) in [(5.0, 1.0), (50.0, 1.0)] {
        let (a, beta) = (Complex::new(0.0, -k), 0.5);
        let kappa = a * (1.0f64 - beta).sqrt();
        let c = -(Complex::from(1.0 / (1.0 - beta)) - 1.0) / ((kappa * (t / 2.0)).cosh() + kappa / a * (kappa * (t / 2.0)).sinh());
        let exact = |x: f64| 1.0 / (1.0 - beta) + c * (kappa * (x - t / 2.0)).cosh();
        let kernel = move |x: f64, y: f64| a * (0.5 * beta) * (-a * (x - y).abs()).exp();
        let eq = Equation::on_interval(0.0..=t, |_| Complex::new(1.0, 0.0), kernel);
        let f = eq.solve(&Nystrom::adaptive().tolerance(1e-11)).unwrap();
        for x in [0.0, 0.21, 0.5, 0.88, 1.0] {
            let error = (f.eval(x) - exact(x)).norm();
            assert!(error <= 1.5 * f.error_estimate().unwrap() && error < 2e-11, "{k}, {x}: {error:e}");
        }
    }
    // a walk: f = 1 + ½i x ∫ y f dy = 1 + ¼i x/(1 − i/6)
    let eq = Equation::on_interval(0.0..=1.0, |_| Complex::new(1.0, 0.0), |x, y| Complex::new(0.0, 0.5 * x * y));
    let exact = Complex::from(1.0) + Complex::new(0.0, 0.2) / Complex::new(1.0, -1.0 / 6.0);
    let found = eq.at(0.8).solve(&Walk::collision().samples_per_cell(20_000)).unwrap();
    assert!(found.agrees_with(exact, 6.0), "{found}");
}
