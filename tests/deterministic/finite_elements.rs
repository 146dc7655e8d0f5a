//! Orders of the Galerkin solution and of its iterate.

use crate::one;
use fredholm::Equation;
use fredholm::deterministic::{Galerkin, Nystrom};
use fredholm::domain::{Grouped, Interval};
use fredholm::special::e1;

/// Slope of log₂ error under two halvings of h.
fn slope(errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).log2()
}

#[test]
fn finite_elements_converge_as_promised() {
    let eq = Equation::on_interval(
        0.0..=1.0,
        |x: f64| x.exp() - 0.5 * ((x + 1.0).exp() - 1.0) / (x + 1.0),
        |x: f64, y: f64| 0.5 * (x * y).exp(),
    );
    let errors = |n: usize| {
        let f = eq.solve(&Galerkin::elements(n)).unwrap();
        let places = (0..=200).map(|i| f64::from(i) / 200.0);
        let fem = places.clone().map(|x| (f.eval(x) - x.exp()).abs()).fold(0.0, f64::max);
        let iterated = places.map(|x| (f.iterated(x).unwrap() - x.exp()).abs()).fold(0.0, f64::max);
        (fem, iterated)
    };
    let (coarse, fine) = (errors(8), errors(16));
    assert!((slope([coarse.0, fine.0]) - 2.0).abs() < 0.1, "{coarse:?} {fine:?}");
    assert!((slope([coarse.1, fine.1]) - 4.0).abs() < 0.2, "{coarse:?} {fine:?}");
    // a kink on the diagonal: T φ_j is still integrated exactly, the order stays
    let bridge = Equation::on_interval(0.0..=1.0, one, |x: f64, y: f64| 5.0 * (x.min(y) - x * y));
    let exact = bridge.solve(&Nystrom::graded(2, 14)).unwrap();
    let error = |n: usize| {
        let f = bridge.solve(&Galerkin::elements(n)).unwrap();
        (0..=100).map(|i| f64::from(i) / 100.0).map(|x| (f.eval(x) - exact.eval(x)).abs()).fold(0.0, f64::max)
    };
    assert!((slope([error(10), error(20)]) - 2.0).abs() < 0.2);
}

#[test]
fn finite_elements_on_systems_and_slabs() {
    let slab = Interval::from(0.0..=1.0);
    let eq = Equation::on_domain(
        Grouped::new(slab, 2),
        |x: &(f64, usize)| 1.0 + x.1 as f64,
        |x, y| [[0.3, 0.0], [0.2, 0.5]][x.1][y.1] * e1((x.0 - y.0).abs()),
    );
    let (fem, nystrom) = (eq.solve(&Galerkin::elements(40)).unwrap(), eq.solve(&Nystrom::graded(2, 10)).unwrap());
    for x in [(0.0, 0), (0.31, 0), (0.5, 1), (1.0, 1)] {
        let error = (fem.eval(x) - nystrom.eval(x)).abs();
        assert!(error < 3e-2, "{x:?}: {error:.1e}");
        let error = (fem.iterated(x).unwrap() - nystrom.eval(x)).abs();
        assert!(error < 2e-3, "{x:?}: {error:.1e}");
    }
}
