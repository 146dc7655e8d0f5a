//! Tolerances that are met or refused.

use crate::erased::{Equation, kernel_fn, source_fn};
use crate::one;
use crate::reference::{interval, record, scalar_values};
use fredholm::Error;
use fredholm::deterministic::{Diagonal, Nystrom};
use fredholm::domain::{Cuboid, Domain, HalfLine, Interval};
use fredholm::kernel::{Singularity, difference_fn, split_fn};
use fredholm::special::{e1, e2};
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
        for (x, known) in scalar_values(&file) {
            let error = (f.eval(x) - known).abs();
            assert!(error <= estimate + 4.0 * f64::EPSILON * known.abs(), "{name} at {x}: error {error:.1e}, estimate {estimate:.1e}");
        }
    }
}

/// One type for all closures: the solver is compiled once for each domain.
pub(crate) type Source<'a> = &'a (dyn Fn(&f64) -> f64 + Send + Sync);
pub(crate) type Kernel<'a> = &'a (dyn Fn(&f64, &f64) -> f64 + Send + Sync);

/// f is within its own estimate of known values, and the estimate within the tolerance; g and K are asked nowhere outside the domain.
pub(crate) fn holds<D: Domain<Point = f64>>(name: &str, domain: D, g: Source<'_>, k: Kernel<'_>, tolerance: f64, known: &[(f64, f64)]) {
    let inside = |x: &f64| assert!(domain.contains(x), "asked at {x}");
    let g = source_fn(domain.clone(), |x: &f64| (inside(x), g(x)).1);
    let k = kernel_fn(domain.clone(), |x: &f64, y: &f64| (inside(x), inside(y), k(x, y)).2);
    let f = Equation::new(g, k).solve(&Nystrom::adaptive().tolerance(tolerance)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let estimate = f.error_estimate().unwrap();
    assert!(estimate <= tolerance * f.magnitude().max(1.0), "{name}: {f}");
    for &(x, value) in known {
        let error = (f.eval(x) - value).abs();
        // the tables end after 15 significant digits
        let printed = 10f64.powi(value.abs().log10().ceil() as i32 - 14);
        assert!(error <= estimate + printed, "{name} at {x}: error {error:.1e}; {f}");
    }
}

#[test]
fn published_tables_to_their_digits() {
    let unit = |a: f64, b: f64| Interval::from(a..=b);
    // Love; problems §2 B
    for (d, sign, values) in [
        (0.1, 1.0, [11.1695439542988, 9.90824446018426, 4.15775772288156]),
        (0.01, 1.0, [101.518237948679, 88.253669181878, 12.6179883138944]),
        (1.0, -1.0, [0.657411533787404, 0.683180339654284, 0.755718116646890]),
        (0.1, -1.0, [0.515317450890602, 0.520184112709075, 0.712456727780802]),
        (0.01, -1.0, [0.501579596430515, 0.502098287486685, 0.707664587844926]),
    ] {
        let love = move |x: &f64, y: &f64| sign * d / PI / (d * d + (x - y) * (x - y));
        holds("Love", unit(-1.0, 1.0), &|_| 1.0, &love, 1e-12, &[0.0, 0.5, 1.0].map(|x| (x, values[(2.0 * x) as usize])));
    }
    // Kirkwood–Riseman; §2 C1
    let kirkwood = |x: &f64, y: &f64| -(x - y).abs().powf(-0.5);
    holds(
        "Kirkwood–Riseman",
        unit(-1.0, 1.0),
        &|_| 1.0,
        &kirkwood,
        1e-11,
        &[(0.0, 0.190794157507565), (0.5, 0.200594600532248), (1.0, 0.357792765895745)],
    );
    // logarithms; §2 C2, the last beyond the radius of convergence
    let log = |lambda: f64| move |x: &f64, y: &f64| lambda * (x - y).abs().ln();
    holds("log", unit(-1.0, 1.0), &|_| 1.0, &log(1.0), 1e-12, &[(0.0, 0.320082831282398), (1.0, 0.688794480082155)]);
    holds("log", unit(0.0, 1.0), &|_| 1.0, &log(1.0), 1e-12, &[(0.5, 0.352631374211693), (1.0, 0.574076712157039)]);
    holds("log", unit(0.0, 1.0), &|_| 1.0, &log(-1.0), 1e-12, &[(0.5, -2.4666774644297), (1.0, -0.576403130782207)]);
    // slabs; §2 F1
    for (t, c, values) in [
        (1.0, 0.9, [1.83088362677178, 2.28566553054175, 2.39603055840591]),
        (1.0, 1.0, [2.06736687377002, 2.66054706185998, 2.80822218322495]),
        (5.0, 0.99, [5.04290804157520, 12.3426912516550, 14.4001974488709]),
        (10.0, 1.0, [9.8907816364916, 40.414412998152, 49.811793274540]),
    ] {
        let slab = move |x: &f64, y: &f64| 0.5 * c * e1((x - y).abs());
        holds("slab", unit(0.0, t), &|_| 1.0, &slab, 1e-12, &[0.0, 0.25, 0.5].map(|s| (s * t, values[(4.0 * s) as usize])));
    }
    // Heaslet–Warming; §2 F2
    holds(
        "Heaslet–Warming",
        unit(0.0, 2.0),
        &|x| 0.5 * e2(*x),
        &|x, y| 0.5 * e1((x - y).abs()),
        1e-12,
        &[(0.0, 0.830790523437719), (1.0, 0.5)],
    );
    // Chandrasekhar's H at μ = 1; §2 F3
    for (c, h) in [(0.5, 1.2512595633832226), (0.9, 1.85009851676981), (0.99, 2.47279282839702)] {
        let half_space = move |x: &f64, y: &f64| 0.5 * c * e1((x - y).abs());
        holds("H(1)", HalfLine::new(0.0), &|x| (-x).exp(), &half_space, 1e-11, &[(0.0, h)]);
    }
}

#[test]
fn closed_forms_of_kinks_layers_and_half_lines() {
    // D-exp: β = 0.99 and β = 3, whose Neumann series diverges
    for beta in [0.99f64, 3.0] {
        let (t, root) = (2.0, (1.0 - beta).abs().sqrt());
        let (cosh, sinh): (fn(f64) -> f64, fn(f64) -> f64) = if beta < 1.0 { (f64::cosh, f64::sinh) } else { (f64::cos, |x| -f64::sin(x)) };
        let whole = 1.0 / (1.0 - beta);
        let c = -(whole - 1.0) / (cosh(root * t / 2.0) + root * sinh(root * t / 2.0));
        let f = move |x: f64| whole + c * cosh(root * (x - t / 2.0));
        let k = move |x: &f64, y: &f64| 0.5 * beta * (-(x - y).abs()).exp();
        holds("D-exp", Interval::from(0.0..=t), &|_| 1.0, &k, 1e-12, &[0.0, 0.3, 1.0, 2.0].map(|x| (x, f(x))));
    }
    // a constant far out: f = 1/κ² − (1 − κ)/κ² e^{−κx}, κ² = 1 − 2λ
    let kappa = 0.4f64.sqrt();
    let f = |x: f64| (1.0 - (1.0 - kappa) * (-kappa * x).exp()) / (kappa * kappa);
    holds("half line", HalfLine::new(0.0), &|_| 1.0, &|x, y| 0.3 * (-(x - y).abs()).exp(), 1e-12, &[0.0, 1.0, 10.0].map(|x| (x, f(x))));
    // two layers: the interface is found
    let c = |x: f64| if x > 1.0 { 0.95 } else { 0.5 };
    let layers = move |x: &f64, y: &f64| 0.5 * c(*x) * e1((x - y).abs());
    holds(
        "layers",
        Interval::from(0.0..=3.0),
        &|_| 1.0,
        &layers,
        1e-11,
        &[(0.0, 1.5524802256437236), (0.9, 2.4005285441727677), (2.0, 4.96455689865067)],
    );
}

#[test]
fn peaks_that_no_node_sees_are_solved_or_refused() {
    // T → ½ at the middle as w → 0: f = 2 there, and √2 at the ends (Wiener–Hopf)
    for w in [1e-2, 1e-4, 1e-6, 1e-8] {
        let peak = move |x: f64, y: f64| 0.5 / (w * PI.sqrt()) * (-((x - y) / w).powi(2)).exp();
        match Equation::on_interval(0.0..=1.0, one, peak).solve(&Nystrom::adaptive().tolerance(1e-9)) {
            Ok(f) => {
                let known = [(0.5, 2.0), (0.0, 2f64.sqrt()), (1.0, 2f64.sqrt())];
                assert!(known.iter().all(|(x, v)| (f.eval(*x) - v).abs() < 1e-8), "{w}: {} {}; {f}", f.eval(0.5), f.eval(0.0));
            }
            Err(e) => assert!(matches!(e, Error::NotConverged { .. }) && w < 1e-4, "{w}: {e}"),
        }
    }
}

/// f = 1 with kernels of the distance d that are 0 on the diagonal; ∫₀^a K is known.
#[test]
fn kernels_that_are_zero_on_the_diagonal() {
    type Image = fn(f64) -> f64;
    let unit = Interval::from(0.0..=1.0);
    let log = |d: f64| if d > 0.0 { d.ln() } else { 0.0 };
    let rows: [(&str, Kernel<'_>, Image); 3] = [
        ("d", &|x, y| (x - y).abs(), |a| a * a / 2.0),
        ("d ln d", &|x, y| (x - y).abs() * log((x - y).abs()), |a| a * a / 2.0 * a.ln() - a * a / 4.0),
        ("d² ln d", &|x, y| (x - y).powi(2) * log((x - y).abs()), |a| a.powi(3) / 3.0 * a.ln() - a.powi(3) / 9.0),
    ];
    let known = [0.1, 0.377, 0.5, 0.99].map(|x| (x, 1.0));
    for (name, k, image) in rows {
        let image = |a: f64| if a > 0.0 { image(a) } else { 0.0 };
        for tolerance in [1e-6, 1e-9, 1e-12] {
            holds(name, unit, &|x| 1.0 - image(*x) - image(1.0 - x), k, tolerance, &known);
        }
    }
    // smooth ones take a rule for the whole
    for k in [(|x, y| 0.3 * (x - y)) as Pair, |x, y| (x - y).sin(), |x, y| (x - y).powi(2)] {
        let f = Equation::on_interval(0.0..=1.0, one, k).solve(&Nystrom::adaptive().tolerance(1e-10)).unwrap();
        assert!(f.unknowns() <= 24 && f.to_string().contains("smooth"), "{f}");
    }
}

#[test]
fn what_is_declared_wins_and_is_doubted() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 5.0 * (x.min(y) - x * y));
    let found = eq.solve(&Nystrom::adaptive()).unwrap();
    assert!(found.warning().is_none() && found.class().unwrap().diagonal == Diagonal::Kink, "{found}");
    let declared = eq.solve(&Nystrom::adaptive().diagonal(Diagonal::Smooth)).unwrap();
    assert!(declared.warning().unwrap().contains("a kink on the diagonal"), "{declared}");
    assert!((declared.eval(0.5) - found.eval(0.5)).abs() < 1e-10);
}

#[test]
fn adaptive_is_not_silently_wrong() {
    // a jump along a curve, y = ½x² + 0.2: rules on panels cannot resolve it (trap 1.3)
    let step = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| if y < 0.5 * x * x + 0.2 { 0.7 } else { 0.0 });
    let Err(Error::NotConverged { error, tolerance, unknowns }) = step.solve(&Nystrom::adaptive().tolerance(1e-8).max_unknowns(600)) else {
        panic!("a step off the diagonal was accepted")
    };
    assert!(error > 1e-8 && tolerance == 1e-8 && (100..=600).contains(&unknowns), "{unknowns}");
    // a narrow bump in g between all coarse nodes
    let bump = |x: f64| (-((x - 0.503) / 1e-3).powi(2)).exp();
    let eq = Equation::on_interval(0.0..=1.0, bump, |x: f64, y: f64| 0.5 * (x * y).exp());
    let f = eq.solve(&Nystrom::adaptive().tolerance(1e-9)).unwrap();
    let exact = eq.solve(&Nystrom::composite(400, 10)).unwrap();
    for x in [0.2, 0.503] {
        assert!((f.eval(x) - exact.eval(x)).abs() < 1e-8, "{} is not {}", f.eval(x), exact.eval(x));
    }
    let few = Nystrom::adaptive().tolerance(1e-9).max_unknowns(60);
    assert!(matches!(eq.solve(&few), Err(Error::NotConverged { .. })), "the bump cannot be resolved by 60 unknowns");
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(eq.solve(&Nystrom::adaptive().tolerance(tolerance)), Err(Error::Invalid { parameter: "tolerance", .. })));
    }
}

type Plain = fn(f64) -> f64;
type Pair = fn(f64, f64) -> f64;

#[test]
fn what_integrates_to_nothing_is_seen_all_the_same() {
    // a dipole in g between the nodes of small rules: f = g + ½ x S, S = ∫ y f = (∫ y g)/(1 − 1/6)
    let dipole: Plain = |x| {
        let z = (x - 0.423_691_647_87) / 2.633e-3;
        1.0 - z * (-z * z).exp()
    };
    let moment = -0.5 * PI.sqrt() * 2.633e-3f64.powi(2);
    let eq = Equation::on_interval(0.0..=1.0, dipole, (|x, y| 0.5 * x * y) as Pair);
    match eq.solve(&Nystrom::adaptive().tolerance(1e-10)) {
        Ok(f) => {
            let exact = 1.0 + 0.5 * 0.9 * (0.5 + moment) * 1.2;
            assert!((f.eval(0.9) - exact).abs() < 1e-9, "{} is not {exact}: {f}", f.eval(0.9));
        }
        Err(e) => assert!(matches!(e, Error::NotConverged { .. }), "{e}"),
    }
    // a spot on the unit square between the nodes of 5, 8 and 11 points a side
    let spot = |x: &[f64; 2]| 1.0 + (-((x[0] - 0.303).powi(2) + (x[1] - 0.303).powi(2)) / 0.012f64.powi(2)).exp();
    let eq = Equation::on_domain(Cuboid::<2>::unit(), spot, |_: &[f64; 2], _: &[f64; 2]| 0.5);
    match eq.solve(&Nystrom::adaptive().tolerance(1e-8)) {
        Ok(f) => {
            let exact = 1.0 + (1.0 + PI * 0.012f64.powi(2));
            assert!((f.eval([0.9, 0.9]) - exact).abs() < 1e-7, "{f}");
        }
        Err(e) => assert!(matches!(e, Error::NotConverged { .. }), "{e}"),
    }
}

#[test]
fn no_value_at_the_diagonal_or_at_an_end_is_no_obstacle() {
    let solve = |g: Plain, k: Pair| Equation::on_interval(0.0..=1.0, g, k).solve(&Nystrom::adaptive().tolerance(1e-10));
    // sin(4(x − y))/(x − y) without a case for x = y
    let sinc = solve(|_| 1.0, |x, y| 0.2 * (4.0 * (x - y)).sin() / (x - y)).unwrap();
    let cased = solve(|_| 1.0, |x, y| if x == y { 0.8 } else { 0.2 * (4.0 * (x - y)).sin() / (x - y) }).unwrap();
    assert!((sinc.eval(0.3) - cased.eval(0.3)).abs() < 1e-10);
    // f = 1/(1 − 0.2); K has no value at y = 0
    let eq = Equation::on_interval(0.0..=1.0, (|_| 1.0) as Plain, (|_, y| -0.2 * y.ln()) as Pair);
    let end = eq.solve(&Nystrom::adaptive().tolerance(1e-8)).unwrap();
    assert!((end.eval(0.5) - 1.25).abs() < 1e-8, "{} {end}", end.eval(0.5));
    assert!(matches!(solve(|_| 1e308, |_, _| 0.95), Err(Error::NonFiniteSolution { .. } | Error::NotConverged { .. })));
    // a jump declared a little beside its place: the place found counts
    let eq = Equation::on_interval(0.0..=1.0, (|_| 1.0) as Plain, (|_, y| if y < 1.0 / 3.0 { 0.3 } else { 0.6 }) as Pair);
    let f = eq.solve(&Nystrom::adaptive().tolerance(1e-12).breakpoints(&[0.333_333_333_5])).unwrap();
    assert!((f.eval(0.5) - 2.0).abs() < 1e-12, "{}", f.eval(0.5));
}

#[test]
fn exact_differences_and_declared_splits() {
    // Kirkwood–Riseman, λ = 1, and the logarithm: problems §2 C1, C2
    let domain = Interval::from(-1.0..=1.0);
    let g = source_fn(domain, (|_| 1.0) as fn(&f64) -> f64);
    let kirkwood = [(0.0, 0.190794157507565), (0.5, 0.200594600532248), (1.0, 0.357792765895745)];
    let logarithm = [(0.0, 0.320082831282398), (1.0, 0.688794480082155)];
    type Difference = fn(&f64, &f64, f64) -> f64;
    type Factor = fn(&f64, &f64) -> f64;
    let power = Singularity::Power { exponent: 0.5 };
    for (by_difference, singularity, factor, known) in [
        ((|_, _, d| -d.abs().powf(-0.5)) as Difference, power, (|_, _| -1.0) as Factor, &kirkwood[..]),
        (|_, _, d| d.abs().ln(), Singularity::Logarithm, |_, _| 1.0, &logarithm[..]),
    ] {
        let method = Nystrom::adaptive().tolerance(1e-12);
        let by_difference = Equation::new(g, difference_fn(domain, by_difference)).solve(&method).unwrap();
        let rest: Factor = |_, _| 0.0;
        let declared = Equation::new(g, split_fn(domain, singularity, factor, rest)).solve(&method).unwrap();
        for &(x, value) in known {
            assert!((by_difference.eval(x) - value).abs() < 2e-14, "{singularity:?} at {x}: {}", by_difference.eval(x));
            assert!((declared.eval(x) - value).abs() < 2e-14, "{singularity:?} at {x}: {}", declared.eval(x));
        }
        assert!(declared.evaluations() < by_difference.evaluations());
    }
    for exponent in [1.0, 1.5, f64::NAN, f64::INFINITY] {
        let kernel = split_fn(domain, Singularity::Power { exponent }, (|_, _| 1.0) as Factor, (|_, _| 0.0) as Factor);
        let refused = Equation::new(g, kernel).solve(&Nystrom::adaptive()).unwrap_err();
        assert!(matches!(refused, Error::Invalid { parameter: "exponent", .. }), "{refused}");
    }
}
