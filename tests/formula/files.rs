//! Every file of the folder is stated, or refused with the reason listed here; kernels have the values of the same formulas in Rust.

use super::{FOLDER, interval, read};
use fredholm::Error;
use fredholm::domain::{Domain, HalfLine};
use fredholm::formula::{Problem, Stated, Statement, Visitor};
use fredholm::special::e1;
use std::f64::consts::PI;

/// Files that this crate cannot state, and a part of the reason.
const REFUSED: [(&str, &str); 11] = [
    ("cavity-eps0.5-L2", "kernel is given in words"),
    ("cavity-eps0.7-L4", "kernel is given in words"),
    ("critical-c1.1", "eigenproblem"),
    ("critical-c1.5", "eigenproblem"),
    ("critical-c2", "eigenproblem"),
    ("critical-slab-a0.5", "eigenproblem"),
    ("critical-slab-a1", "eigenproblem"),
    ("critical-slab-a10", "eigenproblem"),
    ("critical-slab-a2", "eigenproblem"),
    ("critical-slab-a5", "eigenproblem"),
    ("radiosity-coaxial-disks", "domain `two disks"),
];

struct Check;

impl Visitor for Check {
    type Output = Result<usize, String>;
    /// Source and kernel are finite between different points; the number of known values.
    fn visit<D: Domain>(&mut self, s: &Stated<D>) -> Result<usize, String> {
        s.domain().validate().map_err(|e| e.to_string())?;
        for k in &s.points {
            if !s.domain().contains(&k.point) {
                return Err(format!("{} lies outside", k.label));
            }
            // a singular kernel may be infinite between the groups at one place
            let apart =
                |l: &D::Point| (0..s.domain().dimension()).any(|a| s.domain().coordinate(l, a) != s.domain().coordinate(&k.point, a));
            for l in s.points.iter().filter(|l| apart(&l.point)) {
                if !s.kernel(&k.point, &l.point).is_finite() {
                    return Err(format!("K({}, {})", k.label, l.label));
                }
            }
        }
        Ok(s.points.iter().filter(|k| k.value.is_some()).count() + s.functionals.iter().filter(|f| f.value.is_some()).count())
    }
}

#[test]
fn every_file_is_stated_or_refused_with_its_reason() {
    let files = std::fs::read_dir(FOLDER).unwrap().map(|f| f.unwrap().path());
    let files: Vec<_> = files.filter(|p| p.extension().is_some_and(|e| e == "json")).collect();
    let (mut stated, mut refused, mut known) = (0, 0, 0);
    for path in &files {
        let name = path.file_stem().unwrap().to_str().unwrap();
        match (Problem::read(path), REFUSED.iter().find(|(n, _)| *n == name)) {
            (Ok(p), None) => {
                assert_eq!(p.name, name);
                let count = p.statement.visit(&mut Check).unwrap_or_else(|e| panic!("{name}: {e}"));
                assert!(count > 0 && p.digits.is_some() && p.class.is_some(), "{name}");
                known += count;
                stated += 1;
            }
            (Err(Error::Formula(e)), Some((_, reason))) => {
                assert!(e.contains(reason), "{name}: {e}");
                refused += 1;
            }
            (other, _) => panic!("{name}: {other:?}"),
        }
    }
    assert_eq!((files.len(), stated, refused), (158, 147, 11));
    assert!(known > 1200, "{known} known values");
}

#[test]
fn functionals_that_are_no_integrals_are_listed() {
    let p = read("halfspace-c1-mu1");
    let Statement::HalfLine(s) = &p.statement else { panic!() };
    assert_eq!((s.functionals.len(), p.skipped.len()), (5, 6));
    assert!(p.skipped.iter().all(|why| why.contains("not of the form")), "{:?}", p.skipped);
    // `py` times `scale`
    let love = read("love-plus-d1");
    let f = &interval(&love).functionals[1];
    assert_eq!((f.label.as_str(), f.weight(&0.3)), ("1/(2*pi)", 1.0 / (2.0 * PI)));
}

/// Pairs of places in (0, 1), spread like random ones.
fn places() -> impl Iterator<Item = (f64, f64)> {
    (1..40).map(|i| ((f64::from(i) * 0.618_033_988_749).fract(), (f64::from(i) * 0.414_213_562_373).fract()))
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 4e-15 * a.abs().max(b.abs())
}

#[test]
fn kernels_on_lines_are_those_of_their_formulas() {
    type K = fn(f64, f64) -> f64;
    let cases: [(&str, K); 7] = [
        ("abel-1over2-g1-lam0.2", |x, y| 0.2 / (x - y).abs().sqrt()),
        ("green-bridge-res0.99", |x, y| 0.99 * PI * PI * (x.min(y) - x * y)),
        ("cauchy-peaked-d1e-4-manufactured", |x, y| 0.9 * 1e-4 / (PI * (1e-8 + (x - y) * (x - y)))),
        ("tube-effective-emissivity-eps0.1-L2", |x, y| {
            let t = (x - y).abs();
            0.9 / 2.0 * (1.0 - (t * t * t + 6.0 * t) / (t * t + 4.0).powf(1.5))
        }),
        ("signchanging-nonsym", |x, y| 1.2 * (5.0 * x - 3.0 * y).sin() * (-x * y).exp()),
        ("volterra-exp", |x, y| if x > y { 3.0 * (-2.0 * (x - y)).exp() } else { 0.0 }),
        ("disk-gaussian-q1", |x, y| 2.0 * PI * 0.4 * y * (-(x * x + y * y)).exp() * puruspe::In(0, 2.0 * x * y)),
    ];
    for (name, k) in cases {
        let p = read(name);
        let s = interval(&p);
        for (x, y) in places() {
            assert!(close(s.kernel(&x, &y), k(x, y)), "{name}: K({x}, {y}) = {} ≠ {}", s.kernel(&x, &y), k(x, y));
        }
    }
    let p = read("gaussian-peaked-s0.01-manufactured");
    let (d, x) = (0.01 * 2f64.sqrt(), 0.995);
    let expected = 1.0 - 0.8 / 2.0 * (libm::erf((1.0 - x) / d) + libm::erf(x / d));
    assert!(close(interval(&p).source(&x), expected));
}

#[test]
fn kernels_elsewhere_are_those_of_their_formulas() {
    let p = read("fourgroup-slab");
    let Statement::System(s) = &p.statement else { panic!() };
    // row = group of x, and parameter sJI scatters from J to I
    assert!(close(s.kernel(&(0.3, 2), &(1.1, 1)), 0.5 / 2.0 * e1(1.5 * 0.8)));
    assert_eq!(s.source(&(0.7, 1)), 0.2);
    let p = read("coaxial-disks-lumped");
    let Statement::System(s) = &p.statement else { panic!() };
    let (x, r) = (1.0 + 1.25, 0.5f64);
    assert!(close(s.kernel(&(0.5, 0), &(0.2, 1)), 0.6 * (x - (x * x - 4.0 * r * r).sqrt()) / 2.0));
    let p = read("halfline-exp-lam0.4-src");
    let Statement::HalfLine(s) = &p.statement else { panic!() };
    assert_eq!(s.domain(), &HalfLine::new(0.0));
    assert!(close(s.kernel(&3.0, &4.5), 0.4 * (-1.5f64).exp()) && close(s.source(&1.5), (-3f64).exp()));
    let p = read("square-nonseparable");
    let Statement::Box2(s) = &p.statement else { panic!() };
    assert!(close(s.kernel(&[0.1, 0.9], &[0.4, 0.3]), 0.8 / (1.0 + 0.09 + 0.36)));
    let p = read("highd-10-separable-manufactured");
    let Statement::Box64(s) = &p.statement else { panic!() };
    let (x, y) = (std::array::from_fn(|i| 0.05 * i as f64), std::array::from_fn(|i| 1.0 - 0.06 * i as f64));
    let dot: f64 = (0..10).map(|i| x[i] * y[i]).sum();
    assert!(close(s.kernel(&x, &y), 0.03 * dot.exp()), "coordinates beyond the tenth must not matter");
    let phi: f64 = x[..10].iter().sum::<f64>().exp();
    let image: f64 = x[..10].iter().map(|x| ((x + 1.0).exp() - 1.0) / (x + 1.0)).product();
    assert!(close(s.source(&x), phi - 0.03 * image));
}

#[test]
fn domains() {
    let domain = |text: &str| -> Statement {
        let equation = format!(r#"{{"domain": "{text}", "parameters": {{"a": "2*b", "b": 1.5, "d": 5}}, "kernel": "0.1", "source": "1"}}"#);
        Problem::parse(&equation).unwrap_or_else(|e| panic!("{text}: {e}")).statement
    };
    let ends = |text: &str| match domain(text) {
        Statement::Interval(s) => (s.domain().lower(), s.domain().upper()),
        other => panic!("{text}: {other:?}"),
    };
    assert_eq!(ends("[0, a]"), (0.0, 3.0));
    assert_eq!(ends("[-pi, sqrt(pi**2)]"), (-PI, PI));
    assert_eq!(ends("(0,mx(1, 2))"), (0.0, 2.0));
    assert_eq!(ends("unit sphere (z in [-1, 1], azimuthally symmetric)"), (-1.0, 1.0));
    assert!(matches!(domain("[1, infinity)"), Statement::HalfLine(s) if s.domain() == &HalfLine::new(1.0)));
    assert!(matches!(domain("[0,1]^2"), Statement::Box2(_)));
    assert!(matches!(domain("[0, 1] x [0, 2] × [1, a]"), Statement::Box3(s) if (s.domain().volume() - 4.0).abs() < 1e-15));
    assert!(matches!(domain("[0,1]^d"), Statement::Box8(s) if s.domain().volume() == 1.0));
    assert!(matches!(domain("[0,1]^64"), Statement::Box64(_)));
}

#[test]
fn a_distance_in_a_box_is_euclidean() {
    let p = Problem::parse(r#"{"domain": "[0,1]^2", "kernel": "0.1*t + x2*y1", "source": "x1", "points": [[0.5, 1]], "values": ["1/3"]}"#)
        .unwrap();
    let Statement::Box2(s) = &p.statement else { panic!() };
    assert!(close(s.kernel(&[0.0, 0.5], &[0.6, 0.3]), 0.1 * (0.36f64 + 0.04).sqrt() + 0.3));
    assert_eq!((s.points[0].point, s.points[0].value), ([0.5, 1.0], Some(1.0 / 3.0)));
}
