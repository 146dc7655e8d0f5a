//! Singular ends of K and f, narrow columns, the spectrum where f does not show it, and refusals in words.

use crate::adaptive::{Kernel, Source, holds};
use crate::erased::{Equation, kernel_fn, source_fn};
use fredholm::deterministic::Nystrom;
use fredholm::domain::{Domain, HalfLine, Interval, Line};
use fredholm::special::e1;
use fredholm::{Error, GroupMatrix, Spectrum, Value};
use std::f64::consts::PI;

const PLACES: [f64; 7] = [0.0, 1e-9, 1e-3, 0.21, 0.5, 0.93, 1.0];

fn at_places(f: impl Fn(f64) -> f64) -> [(f64, f64); 7] {
    PLACES.map(|x| (x, f(x)))
}

#[test]
fn kernels_singular_in_y() {
    let unit = Interval::from(0.0..=1.0);
    holds("ln y", unit, &|_| 1.0, &|_, y| -0.2 * y.ln(), 1e-12, &at_places(|_| 1.25));
    holds("1/√y", unit, &|_| 1.0, &|_, y| 0.2 / y.sqrt(), 1e-12, &at_places(|_| 1.0 / 0.6));
    holds("1/√(1 − y)", unit, &|_| 1.0, &|_, y| 0.2 / (1.0 - y).sqrt(), 1e-12, &at_places(|_| 1.0 / 0.6));
    // y^β(x), 0 ≤ β ≤ ½
    holds("y^β", unit, &|_| 0.7, &|x, y| 0.3 * (1.0 + 0.5 * x) * y.powf(0.5 * x), 1e-12, &at_places(|_| 1.0));
    // problems §2 C3, C4: singular on the diagonal as well, at ends whose distances floating-point numbers do not keep
    let both = Interval::from(-1.0..=1.0);
    let chebyshev = |x: &f64, y: &f64| 0.3 * (x - y).abs().ln() / (1.0 - y * y).sqrt();
    let t3 = |x: f64| 4.0 * x.powi(3) - 3.0 * x;
    let places = [-1.0, -0.99998, -0.3, 0.0, 0.5, 0.999, 1.0];
    holds("C3", both, &|x| t3(*x), &chebyshev, 1e-11, &places.map(|x| (x, t3(x) / (1.0 + 0.1 * PI))));
    let gegenbauer = |x: &f64, y: &f64| 0.1 * (1.0 - y * y).powf(-0.3) * (x - y).abs().powf(-0.4);
    let eigenvalue = 0.04 * PI / (0.2 * PI).cos();
    holds("C4", both, &|x| *x, &gegenbauer, 1e-11, &places.map(|x| (x, x / (1.0 - eigenvalue))));
}

#[test]
fn columns_singular_inside_are_found() {
    let unit = Interval::from(0.0..=1.0);
    let root = 1.0 / (1.0 - 0.2 * (0.35f64.sqrt() + 0.65f64.sqrt()));
    holds("|y − 0.35|^−½", unit, &|_| 1.0, &|_, y| 0.1 * (y - 0.35).abs().powf(-0.5), 1e-9, &at_places(|_| root));
    let log = 1.0 / (1.0 - 0.2 * (0.77 * 0.77f64.ln() + 0.23 * 0.23f64.ln() - 1.0));
    holds("ln|y − 0.77|", unit, &|_| 1.0, &|_, y| 0.2 * (y - 0.77).abs().ln(), 1e-12, &at_places(|_| log));
    // in one entry of a system, f = (1, 1)
    let matrix = |_: f64, y: f64| GroupMatrix([[0.3, 0.0], [0.1 * (y - 0.35).abs().powf(-0.5), 0.2]]);
    let g = move |_: f64| Spectrum([0.7, 0.8 - 0.2 * (0.35f64.sqrt() + 0.65f64.sqrt())]);
    let f = Equation::on_interval(0.0..=1.0, g, matrix).solve(&Nystrom::adaptive().tolerance(1e-9)).unwrap();
    for x in PLACES {
        assert!((f.eval(x) - Spectrum([1.0, 1.0])).magnitude() < 1e-9, "{x}: {:?}", f.eval(x));
    }
}

#[test]
fn slow_tails_err_by_no_more_than_is_said() {
    let half = HalfLine::new(0.0);
    for tolerance in [1e-4, 1e-6, 1e-8] {
        let known = [0.0, 0.3, 5.0, 100.0].map(|x: f64| (x, 1.0 + (1.0 + x).powf(-0.1) * 0.4 / 0.9 / 0.6));
        holds("y^−1.9", half, &|_| 1.0, &|x, y| 0.4 * (1.0 + x).powf(-0.1) * (1.0 + y).powf(-1.9), tolerance, &known);
    }
}

#[test]
fn solutions_singular_at_ends_take_few_unknowns() {
    // Okayama, Matsuo, Sugihara's second example (problems §3.4: 81 unknowns for 1.4e-14), and S7
    let root = |x: &f64| x.sqrt() * (1.0 - PI * PI / 9.0 * (PI * x / 2.0).powf(0.25));
    let cases: [(&str, f64, Source<'_>, Kernel<'_>, fn(f64) -> f64); 3] = [
        ("√x", PI / 2.0, &root, &|x, y| (x * y).powf(0.75), f64::sqrt),
        ("S7", 1.0, &|x| x.powf(0.3) - x.powi(3) / 5.3, &|x, y| x.powi(3) * y.powi(4), |x| x.powf(0.3)),
        ("x ln x", 1.0, &|x| if *x > 0.0 { x * x.ln() + x / 9.0 } else { 0.0 }, &|x, y| x * y, |x| if x > 0.0 { x * x.ln() } else { 0.0 }),
    ];
    for (name, b, g, k, f) in cases {
        let domain = Interval::from(0.0..=b);
        let solved = Equation::new(source_fn(domain, g), kernel_fn(domain, k)).solve(&Nystrom::adaptive().tolerance(2e-12)).unwrap();
        assert!(solved.unknowns() <= 128, "{name}: {solved}");
        for x in PLACES {
            assert!((solved.eval(x) - f(x)).abs() <= solved.error_estimate().unwrap().max(1e-15), "{name} at {x}: {solved}");
        }
    }
}

#[test]
fn layers_of_g_are_seen() {
    let unit = Interval::from(0.0..=1.0);
    let layer = |r: f64, w: f64| (-r / w).exp();
    for w in [1e-4, 1e-5] {
        let f = move |x: f64, r: f64| layer(r, w) + 2.0 / 3.0 * w * x;
        let known = [0.0, w, 0.3, 1.0 - w, 1.0];
        holds("lower end", unit, &|x| layer(*x, w), &|x, _| 0.5 * x, 1e-6, &known.map(|x| (x, f(x, x))));
        holds("upper end", unit, &|x| layer(1.0 - x, w), &|x, _| 0.5 * x, 1e-6, &known.map(|x| (x, f(x, 1.0 - x))));
    }
}

#[test]
fn slow_tails_err_alike() {
    // f = 1 + c e^{−x}; ∫ (1 + y)^{−1.8} e^{−y} = 0.43291719155463179
    let c = 0.3 / 0.8 / (1.0 - 0.3 * 0.43291719155463179);
    let known = [0.0, 1e-4, 0.3, 2.0].map(|x: f64| (x, 1.0 + c * (-x).exp()));
    for tolerance in [1e-6, 1e-9] {
        holds("(1 + y)^−1.8", HalfLine::new(0.0), &|_| 1.0, &|x, y| 0.3 * (1.0 + y).powf(-1.8) * (-x).exp(), tolerance, &known);
    }
}

#[test]
fn columns_narrower_than_rows_tell() {
    let unit = Interval::from(0.0..=1.0);
    for (centre, width) in [(0.31, 1e-3), (0.7123, 2e-3), (0.0917, 4e-3)] {
        let bump = move |x: f64| (-((x - centre) / width).powi(2)).exp();
        let known = [0.05, centre - width, centre, centre + 0.4 * width, 0.99];
        // f = 1 in spite of K
        let hidden = move |x: &f64| 1.0 - bump(*x) * 0.5 * 2f64.sin();
        holds("hidden", unit, &hidden, &move |x, y| bump(*x) * (2.0 * y).cos(), 1e-10, &known.map(|x| (x, 1.0)));
        // f = 1 + c bump: narrow as well
        let c = 1.5 / (1.0 - PI.sqrt() * width * (1.0 + centre));
        let (g, k): (Source<'_>, Kernel<'_>) = (&|_| 1.0, &move |x, y| bump(*x) * (1.0 + y));
        match Equation::new(source_fn(unit, g), kernel_fn(unit, k)).solve(&Nystrom::adaptive().tolerance(1e-9)) {
            Ok(f) => assert!(known.iter().all(|x| (f.eval(*x) - 1.0 - c * bump(*x)).abs() <= f.error_estimate().unwrap()), "{width}: {f}"),
            Err(e) => assert!(matches!(e, Error::NotConverged { .. }), "{e}"),
        }
    }
}

#[test]
fn jumps_along_lines_are_found() {
    let unit = Interval::from(0.0..=1.0);
    // problems §2 E16: f = cos 2x
    let sine = |low: f64, high: f64| 0.5 * ((2.0 * high).sin() - (2.0 * low).sin());
    let band = move |x: &f64| (2.0 * x).cos() - 0.7 * sine((x - 0.3).max(0.0), (x + 0.3).min(1.0));
    let known = at_places(|x| (2.0 * x).cos());
    holds("|x − y| < 0.3", unit, &band, &|x, y| if (x - y).abs() < 0.3 { 0.7 } else { 0.0 }, 1e-11, &known);
    let sum = move |x: &f64| (2.0 * x).cos() - 0.6 * sine(0.0, 1.0 - x) - 0.1 * sine(0.0, 1.0);
    holds("x + y < 1", unit, &sum, &|x, y| if x + y < 1.0 { 0.7 } else { 0.1 }, 1e-11, &known);
}

fn refused<D: Domain<Point = f64>>(domain: D, g: Source<'_>, k: Kernel<'_>, tolerance: f64) -> Error {
    let eq = Equation::new(source_fn(domain.clone(), g), kernel_fn(domain, k));
    match eq.solve(&Nystrom::adaptive().tolerance(tolerance)) {
        Ok(f) => panic!("{f}"),
        Err(e) => e,
    }
}

#[test]
fn sources_without_an_integral_are_named() {
    let poles: [(f64, Source<'_>); 5] = [
        (0.3, &|x| 1.0 / (x - 0.3)),
        (0.3, &|x| 1.0 + 1e-3 / (x - 0.3).abs().powf(1.5)),
        (0.3, &|x| 1.0 + 1e-6 / (x - 0.3).abs()),
        (0.0, &|x| 1.0 / x),
        (1.0, &|x| 1.0 / (1.0 - x)),
    ];
    for (place, g) in poles {
        let e = refused(Interval::from(0.0..=1.0), g, &|_, _| 0.5, 1e-8);
        let Error::SourceNotIntegrable { at, ratio } = &e else { panic!("{e}") };
        assert!((at.parse::<f64>().unwrap() - place).abs() < 1e-9 && *ratio > 0.99, "{e}");
    }
    let e = refused(HalfLine::new(0.0), &|x| (-x).exp() / x, &|x, y| 0.5 * (-x - y).exp(), 1e-8);
    assert!(matches!(e, Error::SourceNotIntegrable { .. }), "{e}");
    // a peak is none: f = g + ½ ∫ g/(1 − ½)
    let peak = |x: &f64| 1e-6 / (1e-6 * 1e-6 + (x - 0.3).powi(2));
    let known = at_places(|x| peak(&x) + (0.3e6f64.atan() + 0.7e6f64.atan()));
    holds("peak", Interval::from(0.0..=1.0), &peak, &|_, _| 0.5, 1e-9, &known);
}

#[test]
fn refusals_say_why() {
    let unit = Interval::from(0.0..=1.0);
    // 1 is in the spectrum, and f = g = 0 does not show it
    let sources: [Source<'_>; 2] = [&|_| 0.0, &|x| x.powi(2) - 0.75 * x];
    for g in sources {
        let e = refused(unit, g, &|x, y| 3.0 * x * y, 1e-8);
        assert!(matches!(e, Error::Singular { .. }), "{e}");
        let e = refused(unit, g, &|x, y| PI * PI / 4.0 * x.min(*y), 1e-8);
        assert!(matches!(e, Error::Singular { .. } | Error::NotConverged { .. }), "{e}");
    }
    let e = refused(unit, &|_| 1.0, &|_, _| 1.0 - 1e-9, 1e-12);
    assert!(matches!(e, Error::IllConditioned { condition, .. } if condition > 1e8), "{e}");
    let e = refused(unit, &|_| 1.0, &|x, y| 1e150 * x * y, 1e-8);
    assert!(matches!(e, Error::FirstKind { norm } if norm > 1e149), "{e}");
    // ‖T‖ is large because T is far from normal: its only eigenvalue but 0 is 1e-3
    let e = refused(unit, &|_| 1.0, &|x, y| 1e-3 * (30.0 * (x - y)).exp(), 1e-8);
    assert!(matches!(e, Error::FirstKind { norm } if norm > 1e6) && e.to_string().contains("unless T is far from normal"), "{e}");
    let e = refused(unit, &|_| 1.0, &|_, y| 0.1 / y, 1e-8);
    assert!(matches!(e, Error::NotIntegrableAtEnd { .. }), "{e}");
    let e = refused(HalfLine::new(0.0), &|x| (-x).exp(), &|x, y| 0.5 * e1((x - y).abs()), 1e-8);
    assert!(matches!(e, Error::ContinuousSpectrum { .. } | Error::IllConditioned { .. }), "{e}");
    let e = refused(Line::new(), &|x| 1.0 / (1.0 + x * x), &|x, y| 0.1 * (1.0 + (x - y).abs()).powf(-1.5), 1e-9);
    assert!(matches!(e, Error::SlowDecay { power, .. } if (power - 1.5).abs() < 0.1), "{e}");
}
