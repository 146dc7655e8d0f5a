//! Orders of Galerkin and collocation solutions and of their iterates, as slopes of log error over log h.

use crate::erased::Equation;
use crate::one;
use fredholm::deterministic::{Collocation, ElementSolution, Galerkin, Nystrom};
use fredholm::domain::{Grouped, Interval};

use fredholm::kernel::{HasDomain, Kernel, Operator};
use fredholm::source::Source;
use fredholm::special::e1;
use fredholm::{Error, Everywhere, GroupMatrix, Method, Spectrum, Value};

/// Either method; the settings have the same names.
#[derive(Clone, Debug)]
enum Elements {
    Galerkin(Galerkin),
    Collocation(Collocation),
}

/// Both methods of degree p on n elements, on a mesh graded with exponent q.
fn both(n: usize, p: usize, q: f64) -> [Elements; 2] {
    [Elements::Galerkin(Galerkin::elements(n).degree(p).graded(q)), Elements::Collocation(Collocation::elements(n).degree(p).graded(q))]
}

impl<G, K> Method<G, K, Everywhere> for Elements
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: fredholm::Weight<Value = G::Value>,
{
    type Solution = ElementSolution<G, K>;

    fn solve(&self, equation: &fredholm::Equation<G, K>, _: &Everywhere) -> Result<Self::Solution, Error> {
        match self {
            Elements::Galerkin(g) => equation.solve(g),
            Elements::Collocation(c) => equation.solve(c),
        }
    }
}

/// Least-squares slope of ln error over ln n.
fn slope(meshes: &[usize], errors: &[f64]) -> f64 {
    let points = || meshes.iter().zip(errors).map(|(n, e)| ((*n as f64).ln(), e.ln()));
    let count = meshes.len() as f64;
    let (x, y) = points().fold((0.0, 0.0), |m, p| (m.0 + p.0 / count, m.1 + p.1 / count));
    let (top, bottom) = points().fold((0.0, 0.0), |s, p| (s.0 + (p.0 - x) * (p.1 - y), s.1 + (p.0 - x).powi(2)));
    top / bottom
}

/// Asserts the order over meshes.
fn converges(what: &str, meshes: &[usize], errors: &[f64], order: f64, within: f64) {
    let found = -slope(meshes, errors);
    assert!(meshes.len() >= 4 && (found - order).abs() < within, "{what}: order {found:.3} is not {order}: {errors:?}");
}

/// [0, 1] in 203 steps: no place of which is an end of an element, nor in the middle of one.
fn places() -> impl Iterator<Item = f64> {
    (0..=203).map(|i| f64::from(i) / 203.0)
}

fn largest(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(0.0, f64::max)
}

/// K = ½ e^{−3xy}, f = e^{−3x}: smooth.
macro_rules! smooth {
    () => {
        Equation::on_interval(
            0.0..=1.0,
            |x: f64| (-3.0 * x).exp() - 0.5 * (1.0 - (-3.0 * (x + 1.0)).exp()) / (3.0 * (x + 1.0)),
            |x: f64, y: f64| 0.5 * (-3.0 * x * y).exp(),
        )
    };
}

#[test]
fn orders_on_a_smooth_kernel() {
    let eq = smooth!();
    let f = |x: f64| (-3.0 * x).exp();
    let integral = (1.0 - (-5f64).exp()) / 5.0;
    let meshes = [16, 24, 32, 48];
    for (p, coarse) in [(0, meshes), (1, [8, 12, 16, 24]), (2, [5, 7, 9, 12]), (3, [3, 4, 6, 8])] {
        for method in 0..2 {
            let solve = |n: usize| eq.solve(&both(n, p, 1.0)[method]).unwrap();
            let errors = meshes.map(|n| {
                let s = solve(n);
                let error = largest(places().map(|x| (s.eval(x) - f(x)).abs()));
                let estimate = s.error_estimate().unwrap().solution / error;
                assert!((0.97..1.05).contains(&estimate), "degree {p}, {n} elements: estimate/error = {estimate}");
                error
            });
            let iterated = coarse.map(|n| {
                let s = solve(n);
                let error = largest(places().map(|x| (s.iterated(x).unwrap() - f(x)).abs()));
                let estimate = s.error_estimate().unwrap().iterated / error;
                assert!((0.5..1.2).contains(&estimate), "degree {p}, {n} elements: estimate/error = {estimate}");
                error
            });
            let functional = coarse.map(|n| (solve(n).functional(|x| (-2.0 * x).exp()) - integral).abs());
            let name = |what: &str| format!("{what}, degree {p}, {}", ["Galerkin", "collocation"][method]);
            converges(&name("f_h"), &meshes, &errors, p as f64 + 1.0, 0.15);
            converges(&name("iterated"), &coarse, &iterated, 2.0 * p as f64 + 2.0, 0.15);
            converges(&name("⟨h, f_h⟩"), &coarse, &functional, 2.0 * p as f64 + 2.0, 0.15);
        }
    }
}

/// The orders the module states for K = 5 (min(x, y) − xy), f = cos(√5 (x − ½))/cos(√5/2): a kink on the diagonal.
#[test]
fn orders_with_a_kink_on_the_diagonal() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 5.0 * (x.min(y) - x * y));
    let f = |x: f64| (5f64.sqrt() * (x - 0.5)).cos() / (5f64.sqrt() / 2.0).cos();
    for (p, meshes) in [(0, [12, 16, 24, 32, 48]), (1, [8, 12, 16, 24, 32]), (2, [4, 6, 8, 12, 16]), (3, [3, 4, 5, 6, 8])] {
        for method in 0..2 {
            let mut errors = [[0.0; 5]; 3];
            for (i, n) in meshes.into_iter().enumerate() {
                let s = eq.solve(&both(n, p, 1.0)[method]).unwrap();
                let better = |x: f64| (s.iterated(x).unwrap() - f(x)).abs();
                errors[0][i] = largest(places().map(|x| (s.eval(x) - f(x)).abs()));
                errors[1][i] = largest(places().map(better));
                errors[2][i] = largest((1..n).map(|k| better(k as f64 / n as f64)));
            }
            let name = |what: &str| format!("{what}, degree {p}, {}", ["Galerkin", "collocation"][method]);
            converges(&name("f_h"), &meshes, &errors[0], p as f64 + 1.0, 0.15);
            converges(&name("iterated"), &meshes, &errors[1], (2 * p + 2).min(p + 3) as f64, 0.25);
            converges(&name("iterated at ends of elements"), &meshes, &errors[2], 2.0 * p as f64 + 2.0, 0.25);
        }
    }
}

/// Hats: h² and h⁴, also with a kink.
#[test]
fn orders_of_hats() {
    let eq = smooth!();
    let bridge = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 5.0 * (x.min(y) - x * y));
    let known = |x: f64| (5f64.sqrt() * (x - 0.5)).cos() / (5f64.sqrt() / 2.0).cos();
    let meshes = [8, 12, 16, 24, 32];
    let mut errors = [[0.0; 5]; 3];
    for (i, n) in meshes.into_iter().enumerate() {
        let f = eq.solve(&Galerkin::elements(n)).unwrap();
        assert_eq!((f.unknowns(), f.nodes().last()), (n + 1, Some(1.0)));
        errors[0][i] = largest(places().map(|x| (f.eval(x) - (-3.0 * x).exp()).abs()));
        errors[1][i] = largest(places().map(|x| (f.iterated(x).unwrap() - (-3.0 * x).exp()).abs()));
        let f = bridge.solve(&Galerkin::elements(n)).unwrap();
        errors[2][i] = largest(places().map(|x| (f.eval(x) - known(x)).abs()));
    }
    converges("hats", &meshes, &errors[0], 2.0, 0.1);
    converges("iterated hats", &meshes, &errors[1], 4.0, 0.2);
    converges("hats with a kink", &meshes, &errors[2], 2.0, 0.1);
}

/// f ~ d ln d at the ends of a slab: order 1 on uniform meshes, p + 1 on graded ones.
#[test]
fn graded_meshes_keep_the_order_with_singular_ends() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 0.45 * e1((x - y).abs()));
    let exact = eq.solve(&Nystrom::graded(3, 12).levels(24)).unwrap();
    let near_ends = || places().chain((3..40).map(|k| 0.7f64.powi(k)));
    let known: Vec<_> = near_ends().map(|x| exact.eval(x)).collect();
    let meshes = [8, 12, 16, 24];
    for (p, q, order, within) in [(2, 1.0, 1.0, 0.2), (1, 2.5, 2.0, 0.25), (2, 4.0, 3.0, 0.3)] {
        for method in 0..2 {
            let error = |n: usize| {
                let f = eq.solve(&both(n, p, q)[method]).unwrap();
                largest(near_ends().zip(&known).map(|(x, k)| (f.eval(x) - k).abs()))
            };
            converges(&format!("degree {p}, grading {q}"), &meshes, &meshes.map(error), order, within);
        }
    }
}

/// A logarithm on the diagonal: the iterate is worst at the ends of elements, and its estimate knows.
#[test]
fn estimates_hold_with_a_logarithm() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 0.45 * e1((x - y).abs()));
    let exact = eq.solve(&Nystrom::graded(3, 12).levels(24)).unwrap();
    for method in both(16, 3, 4.0).into_iter().chain(both(20, 1, 2.0)).chain([Elements::Galerkin(Galerkin::elements(20).graded(2.0))]) {
        let f = eq.solve(&method).unwrap();
        let estimate = f.error_estimate().unwrap();
        let all = || places().chain([0.5, 1e-4, 1e-3]);
        let fem = estimate.solution / largest(all().map(|x| (f.eval(x) - exact.eval(x)).abs()));
        let iterated = estimate.iterated / largest(all().map(|x| (f.iterated(x).unwrap() - exact.eval(x)).abs()));
        assert!((0.9..2.0).contains(&fem) && (0.7..4.0).contains(&iterated), "{method:?}: {fem:.2} {iterated:.2}");
    }
}

#[test]
fn systems_and_slabs_agree_with_nystrom() {
    let slab = Interval::from(0.0..=1.0);
    let grouped = Equation::on_domain(
        Grouped::new(slab, 2),
        |x: &(f64, usize)| 1.0 + x.1 as f64,
        |x, y| [[0.3, 0.0], [0.2, 0.5]][x.1][y.1] * e1((x.0 - y.0).abs()),
    );
    let nystrom = grouped.solve(&Nystrom::graded(2, 10)).unwrap();
    let fem = grouped.solve(&Galerkin::elements(40)).unwrap();
    for x in [(0.0, 0), (0.31, 0), (0.5, 1), (1.0, 1)] {
        let error = (fem.eval(x) - nystrom.eval(x)).abs();
        assert!(error < 3e-2, "{x:?}: {error:.1e}");
        let error = (fem.iterated(x).unwrap() - nystrom.eval(x)).abs();
        assert!(error < 2e-3, "{x:?}: {error:.1e}");
    }
    // the same system by components: a full matrix acts on them
    let matrix = |x: f64, y: f64| GroupMatrix([[0.3, 0.0], [0.2, 0.5]].map(|row| row.map(|s| s * e1((x - y).abs()))));
    let system = Equation::on_interval(0.0..=1.0, |_| Spectrum([1.0, 2.0]), matrix);
    for method in both(20, 3, 4.0) {
        let (g, s) = (grouped.solve(&method).unwrap(), system.solve(&method).unwrap());
        assert_eq!((g.unknowns(), s.unknowns()), (2 * 20 * 4, 2 * 20 * 4));
        for x in [0.0, 1e-4, 0.31, 0.5, 1.0] {
            let known = Spectrum([nystrom.eval((x, 0)), nystrom.eval((x, 1))]);
            let estimate = s.error_estimate().unwrap().solution;
            assert!((s.eval(x) - known).magnitude() < 1.5 * estimate && estimate < 3e-4, "{x}: {known:?}, {estimate}");
            let error = (s.iterated(x).unwrap() - known).magnitude();
            assert!(error < 1e-6, "{x}: {error:.1e}");
            assert!((g.eval((x, 1)) - s.eval(x)[1]).abs() < 1e-12 && (g.eval((x, 0)) - s.eval(x)[0]).abs() < 1e-12);
        }
        let total = nystrom.functional(|x| if x.1 == 1 { x.0 } else { 0.0 });
        assert!((s.functional(|x| *x)[1] - total).abs() < 1e-6);
    }
}

#[test]
fn high_degrees_reach_rounding() {
    let eq = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 5.0 * (x.min(y) - x * y));
    let f = |x: f64| (5f64.sqrt() * (x - 0.5)).cos() / (5f64.sqrt() / 2.0).cos();
    for method in both(2, 12, 1.0).into_iter().chain(both(1, 16, 1.0)) {
        let s = eq.solve(&method).unwrap();
        let error = largest(places().map(|x| (s.eval(x) - f(x)).abs().max((s.iterated(x).unwrap() - f(x)).abs())));
        assert!(error < 1e-13 && s.rcond() > 1e-3, "{method:?}: {error:.1e}, {:.1e}", s.rcond());
        assert!((s.functional(|x| *x) - 0.5 * s.functional(|_| 1.0)).abs() < 1e-14);
    }
}

#[test]
fn elements_meet_breakpoints() {
    // K jumps in x at 0.3 and in y at 0.7: f is smooth between
    let eq = Equation::on_interval(0.0..=1.0, f64::cos, |x: f64, y: f64| {
        (if x < 0.3 { 0.2 } else { 0.6 }) * (if y < 0.7 { 1.0 } else { -1.0 }) * (-(x - y).abs()).exp()
    });
    let exact = eq.solve(&Nystrom::graded(3, 14).breakpoints(&[0.3, 0.7])).unwrap();
    let settings = [
        Elements::Galerkin(Galerkin::elements(10).degree(5).breakpoints(&[0.3, 0.7])),
        Elements::Collocation(Collocation::elements(10).degree(5).breakpoints(&[0.7, 0.3])),
    ];
    for method in settings {
        let f = eq.solve(&method).unwrap();
        let error = largest(places().map(|x| (f.eval(x) - exact.eval(x)).abs()));
        assert!(error < 1e-9, "{method:?}: {error:.1e}");
        // limits from either side, not an average
        assert!((f.eval(0.3) / f.eval(0.3 - 1e-12) - 1.0).abs() > 0.1);
        let estimate = f.error_estimate().unwrap().solution;
        assert!(error < 1.2 * estimate && estimate < 3.0 * error, "{error:.1e} {estimate:.1e}");
    }
    // between fixed breakpoints the mesh of hats is not uniform
    let hats = eq.solve(&Galerkin::elements(100).breakpoints(&[1.0 / 3.0])).unwrap();
    assert_eq!((hats.unknowns(), hats.nodes().filter(|x| *x == 1.0 / 3.0).count()), (101, 1));
}

#[test]
fn solutions_know_their_nodes() {
    let eq = smooth!();
    for method in both(5, 3, 2.0).into_iter().chain([Elements::Galerkin(Galerkin::elements(5).graded(2.0))]) {
        let f = eq.solve(&method).unwrap();
        assert_eq!(f.nodes().count(), f.values().len());
        assert!(f.nodes().zip(f.values()).all(|(x, v)| (f.eval(x) - v).abs() < 1e-14));
        assert_eq!(f.magnitude(), largest(f.values().iter().map(|v| v.abs())));
        // the iterate interpolates f_h where collocation holds, and only there
        let gap = largest(f.nodes().map(|x| (f.iterated(x).unwrap() - f.eval(x)).abs()));
        assert_eq!(gap < 1e-14, matches!(method, Elements::Collocation(_)), "{gap:.1e}");
        assert!([0.0, 5e-324, 1e-300, 0.5, 1.0].iter().all(|x| (f.eval(*x) - (-3.0 * x).exp()).abs() < 0.02));
        for x in [-1e-9, 1.1, f64::NAN] {
            assert!(f.eval(x).is_nan() && matches!(f.iterated(x), Err(Error::Outside { .. })));
        }
    }
}
