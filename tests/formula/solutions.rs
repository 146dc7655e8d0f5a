//! Solutions of files agree with the values the files know.

use super::{interval, read};
use fredholm::Walk;
use fredholm::detector::Detector;
use fredholm::deterministic::Nystrom;
use fredholm::domain::Domain;
use fredholm::formula::{Stated, Statement, Visitor};
use fredholm::kernel::Tabulated;

/// Standard errors that 10⁴ comparisons exceed together once in 10⁷ runs.
const SIGMAS: f64 = 6.8;

struct Walks(String);

impl Visitor for Walks {
    type Output = ();
    fn visit<D: Domain>(&mut self, s: &Stated<D>) {
        let walk = Walk::mis().samples_per_cell(4096).seed(3);
        let eq = s.equation();
        let points: Vec<_> = s.points.iter().map(|k| k.point).collect();
        let estimates = if s.domain().dimension() == 1 {
            let table = Tabulated::new(eq.kernel().kernel(), 64).unwrap().guided();
            eq.with_proposal(table).on(&points).solve(&walk)
        } else {
            eq.on(&points).solve(&walk)
        };
        for (e, k) in estimates.unwrap_or_else(|e| panic!("{}: {e}", self.0)).iter().zip(&s.points) {
            let truth = k.value.unwrap();
            assert!(e.agrees_with(truth, SIGMAS), "{} at {}: {e} ≠ {truth}", self.0, k.label);
            assert!((e.value - truth).abs() < 0.1 * truth.abs().max(1.0), "{} at {}: {e} says nothing of {truth}", self.0, k.label);
        }
    }
}

#[test]
fn walks_agree() {
    for name in [
        "expxy-g1-lam0.5",
        "abel-1over2-g1-lam0.2",
        "cauchy-peaked-d1e-4-manufactured",
        "green-bridge-lam5",
        "volterra-exp",
        "slab-c0.5-a1-beam0.3",
        "halfline-exp-lam0.3",
        "halfspace-c0.5-mu1",
        "twogroup-slab-downscatter",
        "coaxial-disks-lumped",
        "parallel-plates-infinite",
        "integrating-sphere-rho0.5",
        "square-nonseparable",
        "cube3-gaussian",
        "highd-5-gaussian-g1",
        "highd-10-gaussian-g1",
    ] {
        read(name).statement.visit(&mut Walks(name.into()));
    }
}

#[test]
fn functionals_agree() {
    for name in ["slab-c0.9-a1-uniform", "love-plus-d1", "disk-gaussian-q1"] {
        let p = read(name);
        let s = interval(&p);
        let eq = s.equation().tabulated(64).unwrap();
        for f in &s.functionals {
            let detector = f.detector().unwrap();
            assert_eq!(detector.cells(), 1);
            let e = eq.seen_by(&detector).solve(&Walk::collision().seed(5)).unwrap();
            assert!(e.agrees_with(f.value.unwrap(), SIGMAS), "{name}, {}: {e} ≠ {:?}", f.label, f.value);
        }
    }
    // starts in several states and in a box
    let p = read("twogroup-slab-downscatter");
    let Statement::System(s) = &p.statement else { panic!() };
    let eq = s.equation().tabulated(64).unwrap();
    for f in &s.functionals {
        let e = eq.seen_by(&f.detector().unwrap()).solve(&Walk::next_event().seed(5)).unwrap();
        assert!(e.agrees_with(f.value.unwrap(), SIGMAS), "{}: {e} ≠ {:?}", f.label, f.value);
    }
    let p = read("square-nonseparable");
    let Statement::Box2(s) = &p.statement else { panic!() };
    for f in &s.functionals {
        let e = s.equation().seen_by(&f.detector().unwrap()).solve(&Walk::collision().seed(5)).unwrap();
        assert!(e.agrees_with(f.value.unwrap(), SIGMAS), "{}: {e} ≠ {:?}", f.label, f.value);
    }
}

#[test]
fn nystrom_agrees() {
    for (name, rule, tolerance) in [
        ("expxy-manufactured-lam2", Nystrom::gauss_legendre(24), 1e-13),
        ("degenerate-rank5", Nystrom::gauss_legendre(16), 1e-13),
        ("disk-gaussian-q1", Nystrom::gauss_legendre(32), 1e-13),
        ("green-min-lam10", Nystrom::graded(8, 16), 1e-12),
        ("slab-c0.9-a1-uniform", Nystrom::adaptive().tolerance(1e-9), 1e-8),
        ("lieb-liniger-gamma1", Nystrom::composite(4, 16), 1e-12),
    ] {
        let p = read(name);
        let s = interval(&p);
        let f = s.equation().solve(&rule).unwrap_or_else(|e| panic!("{name}: {e}"));
        for k in &s.points {
            let error = (f.eval(k.point) - k.value.unwrap()).abs() / f.magnitude();
            assert!(error < tolerance, "{name} at {}: off by {error:.1e}", k.label);
        }
    }
}
