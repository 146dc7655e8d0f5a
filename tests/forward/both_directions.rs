//! ⟨h, f⟩ = ⟨φ, g⟩: forward against backward against Nyström; the order of matrices; the predicted variance; cut walks.

use crate::common::{Budget, Reference, all_pass};
use crate::erased::Equation;
use crate::problems::e1;
use crate::{PILOT, enough, judge};
use fredholm::detector::{At, Bins, Functional};
use fredholm::deterministic::Nystrom;
use fredholm::domain::{Cuboid, Interval, Node};
use fredholm::kernel::{Both, HasAdjoint, Kernel, Proposal, Transposed};
use fredholm::sampling::Sampler;
use fredholm::special::e2;
use fredholm::transport::{CollisionTally, Histories, Slab};
use fredholm::walk::{Collision, OwnAbsorption, Roulette};
use fredholm::{Complex, Estimate, Forward, GroupMatrix, Spectrum, Walk, Weight};
use nalgebra::{DMatrix, DVector};
use statrs::function::erf::{erf, erf_inv};
use std::f64::consts::PI;

fn unit() -> Interval {
    Interval::from(0.0..=1.0)
}

/// What leaks through the left face of a slab lit by a beam: analog walks, their own adjoint, and the deterministic value.
#[test]
fn leakage_of_a_slab() {
    let mut budget = Budget::of("forward::leakage");
    let reference = Reference::load("slab-c0.5-a1-beam0.3");
    let slab = Slab::new(1.0).scattering(0.5);
    let eq = Equation::new(slab.beam(0.3), &slab);
    let h = Functional::new(unit(), |x: &f64| 0.5 * 0.5 * e2(*x) / 0.3);
    // the file states c E₂/(2μ₀)
    let truth = reference.functional("c*E2(x)/(2*mu0)");
    let forward = Forward::scoring(Collision, OwnAbsorption).walks(1 << 20);
    let implicit = Equation::new(slab.beam(0.3), slab.implicit_capture());
    let mut judged = |what: &str, e: Estimate, margin: f64| judge(&mut budget, what, &e, truth, margin * truth);
    let q = eq.seen_by(&h);
    all_pass([
        judged("forward, analog", q.solve(&forward).unwrap(), 0.01),
        judged("forward, implicit", implicit.seen_by(&h).solve(&Forward::new().walks(1 << 20)).unwrap(), 0.01),
        judged("forward, next event", q.solve(&Forward::next_event().walks(1 << 18)).unwrap(), 0.03),
        judged("backward", q.solve(&Walk::mis().samples_per_cell(1 << 18)).unwrap(), 0.03),
    ]);
}

/// The tallies of histories and the bins of forward walks are one thing: (f − S)/c = Φ, bin by bin.
#[test]
fn bins_are_the_collision_tally() {
    let mut budget = Budget::of("forward::bins");
    let slab = Slab::new(2.0).scattering(0.8);
    let source = slab.uniform(1.0);
    let tally = Histories::new(CollisionTally).bins(5).histories(1 << 20).run(&slab, &source).unwrap();
    let eq = Equation::new(&source, &slab);
    let bins = eq.seen_by(&Bins::new(0.0..=2.0, 5)).solve(&Forward::scoring(Collision, OwnAbsorption).walks(1 << 20).seed(9)).unwrap();
    let compare = |(i, (f, flux)): (usize, (&Estimate, &Estimate))| {
        let error = (f.std_error.unwrap().powi(2) / 0.64 + flux.std_error.unwrap().powi(2)).sqrt();
        budget.mean(&format!("bin {i}"), ((f.value - 1.0) / 0.8, error, 99.0), flux.value, 0.05 * flux.value)
    };
    all_pass(bins.iter().zip(tally.flux.bins()).enumerate().map(compare).collect::<Vec<_>>());
}

/// Four matrices that do not commute, one for each pair of halves: f is a linear system of four unknowns.
#[test]
fn matrices_act_in_order() {
    let mut budget = Budget::of("forward::matrices");
    let m = |i: usize, j: usize| {
        let (a, b) = (i as f64, j as f64);
        [[0.2 + 0.3 * a, 0.5 - 0.4 * b], [0.1 + 0.5 * b * a, 0.3 - 0.5 * a]]
    };
    let g = |i: usize| [1.0 + i as f64, 0.3 - 0.2 * i as f64];
    let half = |x: f64| usize::from(x >= 0.5);
    let eq = Equation::on_interval(0.0..=1.0, move |x| Spectrum(g(half(x))), move |x, y| GroupMatrix(m(half(x), half(y))));
    let system = DMatrix::from_fn(4, 4, |r, c| f64::from(u8::from(r == c)) - 0.5 * m(r / 2, c / 2)[r % 2][c % 2]);
    let f = system.lu().solve(&DVector::from_fn(4, |r, _| g(r / 2)[r % 2])).unwrap();
    let first = Functional::new(unit(), |x: &f64| f64::from(u8::from(*x < 0.5)));
    let runs = [
        ("collision", eq.seen_by(&first).solve(&Forward::new().walks(1 << 18)).unwrap(), 0.5),
        ("next event", eq.seen_by(&first).solve(&Forward::next_event().walks(1 << 18)).unwrap(), 0.5),
        ("point", eq.at(0.25).solve(&Forward::next_event().walks(1 << 18)).unwrap(), 1.0),
        ("backward", eq.at(0.25).solve(&Walk::collision().samples_per_cell(1 << 18)).unwrap(), 1.0),
    ];
    let mut judge = |(what, e, share): &(&str, Estimate<Spectrum<2>>, f64), c: usize| {
        let seen = (e.value[c], e.std_error.unwrap()[c], e.degrees_of_freedom as f64);
        budget.mean(&format!("{what}, component {c}"), seen, share * f[c], 0.03 * share)
    };
    all_pass(runs.iter().flat_map(|r| [(r, 0), (r, 1)]).map(|(r, c)| judge(r, c)).collect::<Vec<_>>());
    // K†(y, x) = K(x, y)ᵀ, and twice transposed is the kernel itself
    let adjoint = eq.kernel().adjoint().unwrap();
    assert_eq!(adjoint.eval(&0.2, &0.9), eq.kernel().eval(&0.9, &0.2).transposed());
    assert_eq!(Transposed(&adjoint).eval(&0.9, &0.2), eq.kernel().eval(&0.9, &0.2));
}

/// f = 1/(1 − i/2): pairings without conjugation.
#[test]
fn complex_values() {
    let mut budget = Budget::of("forward::complex");
    let eq = Equation::on_interval(0.0..=1.0, |_| Complex::new(1.0, 0.0), |_, _| Complex::new(0.0, 0.5));
    let e = eq.seen_by(&Functional::new(unit(), |_: &f64| 1.0)).solve(&Forward::new().walks(1 << 16)).unwrap();
    let seen = |pick: fn(Complex<f64>) -> f64| (pick(e.value), pick(e.std_error.unwrap()), e.degrees_of_freedom as f64);
    let parts = [(seen(|z| z.re), 0.8), (seen(|z| z.im), 0.4)];
    all_pass(parts.into_iter().map(|(part, truth)| budget.mean("a part", part, truth, 0.03)).collect::<Vec<_>>());
}

/// Σ_{n ≤ D} ⟨1, Tⁿ 1⟩ with K = ½ xy: 1 + 1/8 + 1/48 + 1/288 + …; the bound of the bias holds.
#[test]
fn cut_walks() {
    let mut budget = Budget::of("forward::cut");
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let one = Functional::new(unit(), |_: &f64| 1.0);
    let truth = 1.0 + 0.125 + 0.125 / 6.0;
    let runs = [
        eq.seen_by(&one).solve(&Forward::new().depth(2).walks(1 << 16)).unwrap(),
        eq.seen_by(&one).solve(&Forward::next_event().depth(2).walks(1 << 16)).unwrap(),
    ];
    for e in &runs {
        let truncation = e.truncation.unwrap();
        let (bias, bound) = (1.15 - truth, truncation.bias_bound.unwrap());
        assert!(bias <= bound && bound < 20.0 * bias && truncation.walks > 0, "{bias} {bound}");
    }
    all_pass(runs.iter().map(|e| judge(&mut budget, "depth 2", e, truth, 0.01)).collect::<Vec<_>>());
}

/// The variance of a walk from the solve of the adjoint equation (theory (4.5.4)): ∫ (g²/q₀)(σ_φ² + φ²) − J².
#[test]
fn the_variance_is_as_predicted() {
    let mut budget = Budget::of("forward::variance");
    let eq = Equation::on_interval(0.0..=1.0, |x: f64| 1.0 + x, |x: f64, y: f64| 0.7 * (-x * y * y).exp() * (1.0 + x - y));
    let h = |x: &f64| x * x;
    let p = 0.8;
    // ν = ∫ K*₂ φ² − (T†φ)², σ_φ² = ν + K*₂ σ_φ², K*₂ = K(x, z)²/p
    let nodes = fredholm::deterministic::quadrature::unit_rule(40);
    let n = nodes.len();
    let k = |i: usize, j: usize| eq.kernel().eval(&nodes[i].point, &nodes[j].point);
    let adjoint = DMatrix::from_fn(n, n, |j, i| nodes[i].weight * k(i, j));
    let second = DMatrix::from_fn(n, n, |j, i| nodes[i].weight * k(i, j) * k(i, j) / p);
    let one = DMatrix::identity(n, n);
    let source = DVector::from_fn(n, |i, _| h(&nodes[i].point));
    let phi = (&one - &adjoint).lu().solve(&source).unwrap();
    let image = &adjoint * &phi;
    let nu = &second * phi.map(|v| v * v) - image.map(|v| v * v);
    let sigma = (&one - &second).lu().solve(&nu).unwrap();
    let sum = |f: &dyn Fn(usize) -> f64| (0..n).map(|i| nodes[i].weight * f(i)).sum::<f64>();
    let g = |i: usize| 1.0 + nodes[i].point;
    let mean = sum(&|i| g(i) * phi[i]);
    let predicted = sum(&|i| g(i) * g(i) * (sigma[i] + phi[i] * phi[i])) - mean * mean;
    let e = eq.seen_by(&Functional::new(unit(), h)).solve(&Forward::new().roulette(Roulette::constant(p)).walks(1 << 21)).unwrap();
    let (variance, error) = (e.variance().unwrap(), e.moments.variance_of_variance().sqrt() * e.variance().unwrap());
    all_pass([
        judge(&mut budget, "mean", &e, mean, 0.02 * mean),
        budget.mean("variance", (variance, error, 1e6), predicted, 0.2 * predicted),
    ]);
}

/// ∝ e^{−(x−y)²} on [0, 1] in every coordinate.
#[derive(Clone, Copy)]
struct Gaussian;

impl Proposal<[f64; 5]> for Gaussian {
    fn sample<S: Sampler>(&self, x: &[f64; 5], u: &mut S) -> Node<[f64; 5]> {
        let one = |x: f64, u: f64| (x + erf_inv(erf(-x) + u * (erf(1.0 - x) - erf(-x)))).clamp(0.0, 1.0);
        let point = x.map(|x| one(x, u.next_1d()));
        Node { point, weight: 1.0 / Proposal::pdf(self, x, &point) }
    }
    fn pdf(&self, x: &[f64; 5], y: &[f64; 5]) -> f64 {
        let one = |x: f64, y: f64| (-(x - y).powi(2)).exp() / (0.5 * PI.sqrt() * (erf(1.0 - x) + erf(x)));
        x.iter().zip(y).map(|(x, y)| one(*x, *y)).product()
    }
}

/// Five dimensions, and a proposal of one's own for each direction: a symmetric kernel, so one serves both.
#[test]
fn many_dimensions() {
    let mut budget = Budget::of("forward::cube");
    let reference = Reference::load("highd-5-gaussian-g1");
    let lambda = reference.parameter("lam");
    let eq = Equation::on_domain(
        Cuboid::<5>::unit(),
        |_: &[f64; 5]| 1.0,
        move |x: &[f64; 5], y: &[f64; 5]| lambda * x.iter().zip(y).map(|(x, y)| (-(x - y).powi(2)).exp()).product::<f64>(),
    )
    .with_proposal(Both::new(Gaussian, Gaussian));
    let (x, f) = &reference.spatial()[0];
    let at = At(std::array::from_fn(|i| x[i]));
    let solve = |n, seed| eq.seen_by(&at).solve(&Forward::next_event().walks(n).seed(seed)).unwrap();
    let n = enough(&budget, &solve(PILOT, 1), 0.03 * f);
    all_pass([judge(&mut budget, "point", &solve(n, 2), *f, 0.03 * f)]);
}

/// Two and four groups as matrix weights, tables in both directions: f at a point.
#[test]
fn systems() {
    let mut budget = Budget::of("forward::systems");
    let mut results = Vec::new();
    two_groups(&mut budget, &mut results);
    all_pass(results);
}

fn two_groups(budget: &mut Budget, results: &mut Vec<Result<(), String>>) {
    let r = Reference::load("twogroup-slab-downscatter");
    let sigma: [f64; 2] = std::array::from_fn(|j| r.parameter(&format!("S{}", j + 1)));
    let s: [[f64; 2]; 2] = std::array::from_fn(|i| std::array::from_fn(|j| r.parameter(&format!("s{}{}", j + 1, i + 1))));
    let k = move |i: usize, j: usize, t: f64| if s[i][j] == 0.0 { 0.0 } else { 0.5 * s[i][j] * e1(sigma[j] * t) };
    let eq = Equation::on_interval(
        0.0..=3.0,
        |_| Spectrum([1.0, 0.0]),
        move |x: f64, y: f64| GroupMatrix::<2>(std::array::from_fn(|i| std::array::from_fn(|j| k(i, j, (x - y).abs())))),
    )
    .tabulated(32)
    .unwrap();
    let (x, f) = &r.vector()[1];
    let margin = 0.04 * f.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let solve = |n, seed| eq.at(*x).solve(&Forward::next_event().walks(n).seed(seed)).unwrap();
    let n = enough(budget, &solve(PILOT, 1), margin);
    let e = solve(n, 2);
    for (c, f) in f.iter().enumerate() {
        let seen = (e.value[c], e.std_error.unwrap()[c], e.degrees_of_freedom as f64);
        results.push(budget.mean(&format!("two groups, x = {x}, group {c}"), seen, *f, margin));
    }
}

/// The corrected functional of a deterministic solve is the same number.
#[test]
fn the_deterministic_adjoint_agrees() {
    let mut budget = Budget::of("forward::adjoint");
    let eq = Equation::on_interval(0.0..=1.0, |x: f64| x.cos(), |x: f64, y: f64| 1.2 * (5.0 * x - 3.0 * y).sin() * (-x * y).exp());
    let h = |x: &f64| 1.0 + x;
    let exact = eq.solve(&Nystrom::gauss_legendre(24)).unwrap().corrected_functional(h).unwrap().value;
    let forward = eq.seen_by(&Functional::new(unit(), h)).solve(&Forward::new().walks(1 << 20)).unwrap();
    let backward = eq.seen_by(&Functional::new(unit(), h)).solve(&Walk::collision().samples_per_cell(1 << 20)).unwrap();
    all_pass([
        judge(&mut budget, "forward", &forward, exact, 0.02 * exact.abs()),
        judge(&mut budget, "backward", &backward, exact, 0.02 * exact.abs()),
    ]);
}
