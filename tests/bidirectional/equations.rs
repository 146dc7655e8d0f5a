//! Twenty equations that no other test knows, in both directions, against Nyström or linear algebra: signs, half lines, squares, matrices, mirrors.

use crate::common::{Budget, all_pass};
use crate::problems::Line;
use crate::stated;
use fredholm::detector::{At, Functional};
use fredholm::deterministic::Nystrom;
use fredholm::deterministic::quadrature::composite_unit_rule;
use fredholm::domain::{Cuboid, Domain, HalfLine, Interval};
use fredholm::kernel::{HasAdjoint, HasDomain, Kernel, Operator, Step, Transition, TransitionPdf};
use fredholm::sampling::Sampler;
use fredholm::source::source_fn;
use fredholm::walk::{Collision, KernelTally, OwnAbsorption, Roulette};
use fredholm::{Bidirectional, Equation, Error, Forward, GroupMatrix, Spectrum, Value, Walk};
use nalgebra::{DMatrix, DVector};

fn end() -> Roulette {
    Roulette::constant(0.75)
}

/// f at x, ⟨h, f⟩ and the largest of |f| at the nodes, by Nyström.
macro_rules! truth {
    ($eq:expr, $rule:expr, $nodes:expr, $x:expr, $h:expr) => {{
        let (exact, nodes) = ($eq.solve(&$rule).unwrap(), $nodes);
        let hf: f64 = nodes.iter().map(|n| n.weight * $h(&n.point) * exact.eval(n.point)).sum();
        let size = nodes.iter().map(|n| (n.weight * $h(&n.point)).abs()).sum::<f64>().max(1.0);
        let largest = nodes.iter().map(|n| exact.eval(n.point).abs()).fold(0.0, f64::max);
        (exact.eval($x), hf, largest * size)
    }};
}

#[test]
fn on_lines() {
    let mut budget = Budget::of("bidirectional::lines");
    let interval = |a: f64, b: f64| Line::Finite(Interval::from(a..=b));
    let half = Line::Half(HalfLine::new(0.0));
    type Row = (Line, f64, fn(&f64) -> f64, fn(&f64, &f64) -> f64);
    let rows: [Row; 11] = [
        // signs of K, of g, of both
        (interval(0.0, 1.0), 0.3, |x| 1.0 + x, |x, y| 0.9 * (9.0 * x * y).cos()),
        (interval(-1.0, 1.0), -0.4, |x| x.sin(), |x, y| 0.4 * (x - 2.0 * y) / (1.0 + x * x)),
        (interval(0.0, 2.0), 1.7, |x| (3.0 * x).cos(), |x, y| 0.6 * (x - y).tanh()),
        (interval(0.0, 1.0), 0.9, |x| x - 0.4, |x, y| -0.8 * (x + y).exp() / 3.0),
        // g with gaps; far from the origin
        (interval(0.0, 1.0), 0.1, |x| if (0.6..0.7).contains(x) { 4.0 } else { 0.0 }, |x, y| 0.7 / (0.5 + x + y)),
        (interval(100.0, 101.0), 100.25, |x| (x - 100.5).abs(), |x, y| 0.6 * (-(x - y).powi(2)).exp()),
        // K with a jump, with a kink; not symmetric
        (interval(0.0, 1.0), 0.5, |x| 1.0 - x, |x, y| if y < x { 0.8 } else { 0.2 }),
        (interval(0.0, 1.0), 0.65, |x| x * x, |x, y| 0.9 * x.min(*y) * (2.0 - y)),
        // half lines
        (half, 0.7, |x| (-x).exp(), |x, y| 0.8 * (-x - 2.0 * y).exp() * (1.0 + x)),
        (half, 2.0, |x| x * (-2.0 * x).exp(), |x, y| 0.5 * (-(x - y).powi(2) - y).exp()),
        (half, 0.2, |x| (1.0 - x) * (-x).exp(), |x, y| 0.9 * (x - y).sin() * (-x - y).exp()),
    ];
    let mut results = Vec::new();
    for (i, (line, x, g, k)) in rows.into_iter().enumerate() {
        let eq = Equation::on_domain(line, g, k);
        let h = |x: &f64| (-(x % 100.0)).exp() * (1.0 + 0.5 * (4.0 * x).sin());
        // jumps of g and of K are at breaks of the rule
        let (f, hf, scale) = truth!(eq, Nystrom::composite(40, 6), eq.kernel().domain().rule(40, 6), x, h);
        let margin = 0.08 * scale;
        let seen = Functional::new(line, h);
        let (at, seen) = (eq.at(x), eq.seen_by(&seen));
        let pairs = Bidirectional::new().roulette(end()).samples_per_cell(1 << 16).seed(3);
        let walks = at.optimal(&Walk::mis().samples_per_cell(1 << 16).seed(5), 512).unwrap();
        let forward = Forward::new().walks(1 << 16).seed(7);
        let curve = eq.solve(&forward.profile(KernelTally::at(&[x]))).unwrap();
        let tally = (curve.values()[0], curve.std_errors().unwrap()[0], 127.0);
        let mut mean = |what: &str, seen, truth| budget.mean(&format!("line {i}, {what}"), seen, truth, margin);
        results.extend([
            mean("pairs at a point", stated(&at.solve(&pairs).unwrap()), f),
            mean("pairs, h", stated(&seen.solve(&pairs).unwrap()), hf),
            mean("pairs, optimal", stated(&at.solve(&pairs.optimal(512)).unwrap()), f),
            mean("pairs, h, optimal", stated(&seen.solve(&pairs.optimal(512)).unwrap()), hf),
            mean("walks, optimal", stated(&at.solve(&walks).unwrap()), f),
            mean("forward, h", stated(&seen.solve(&forward).unwrap()), hf),
            mean("forward, next event", stated(&seen.solve(&Forward::next_event().walks(1 << 16)).unwrap()), hf),
            mean("kernel tally", tally, f),
        ]);
    }
    all_pass(results);
}

#[test]
fn on_squares() {
    let mut budget = Budget::of("bidirectional::squares");
    type P = [f64; 2];
    let rows: [(fn(&P) -> f64, fn(&P, &P) -> f64); 3] = [
        (|x| 1.0 + x[0], |x, y| 0.7 * (-(x[0] - y[1]).powi(2) - x[1] * y[0]).exp()),
        (|x| x[0] - x[1], |x, y| 0.8 * (3.0 * (x[0] * y[0] - x[1] * y[1])).sin()),
        (|x| (-4.0 * x[0] * x[1]).exp(), |x, y| -0.5 * (1.0 + x[0] * y[1] - y[0])),
    ];
    let mut results = Vec::new();
    for (i, (g, k)) in rows.into_iter().enumerate() {
        let eq = Equation::on_domain(Cuboid::<2>::unit(), g, k);
        let h = |x: &P| x[0] + x[1] * x[1];
        let x = [0.3, 0.8];
        let (f, hf, scale) = truth!(eq, Nystrom::gauss_legendre(14), eq.kernel().domain().rule(2, 6), x, h);
        let seen = Functional::new(Cuboid::<2>::unit(), h);
        let pairs = Bidirectional::new().roulette(end()).samples_per_cell(1 << 16).seed(3);
        let curve = eq.solve(&Forward::new().walks(1 << 16).profile(KernelTally::at(&[x]))).unwrap();
        let tally = (curve.values()[0], curve.std_errors().unwrap()[0], 127.0);
        let mut mean = |what: &str, seen, truth| budget.mean(&format!("square {i}, {what}"), seen, truth, 0.08 * scale);
        results.extend([
            mean("pairs, h", stated(&eq.seen_by(&seen).solve(&pairs).unwrap()), hf),
            mean("pairs, h, optimal", stated(&eq.seen_by(&seen).solve(&pairs.optimal(512)).unwrap()), hf),
            mean("kernel tally", tally, f),
        ]);
    }
    all_pass(results);
}

/// Matrices that do not commute: K(x, y) K(y, z) ≠ K(y, z) K(x, y).
#[test]
fn systems() {
    let mut budget = Budget::of("bidirectional::systems");
    type M = GroupMatrix<2>;
    let rows: [fn(&f64, &f64) -> M; 3] = [
        |x, y| GroupMatrix([[0.2, 0.6 * x], [0.3 * y * y, -0.3]]),
        |x, y| GroupMatrix([[0.0, 0.9 * (x - y).cos()], [0.2 * x, 0.4 * y]]),
        |x, y| GroupMatrix([[0.5 * (-x * y).exp(), -0.4], [0.4, 0.3 * x * y]]),
    ];
    let mut results = Vec::new();
    for (i, k) in rows.into_iter().enumerate() {
        let g: fn(&f64) -> Spectrum<2> = |x| Spectrum([1.0 + x, 2.0 - 3.0 * x]);
        let eq = Equation::on_domain(Interval::from(0.0..=1.0), g, k);
        let exact = eq.solve(&Nystrom::gauss_legendre(20)).unwrap();
        let (at, x) = (eq.at(0.6), At(0.6));
        let pairs = Bidirectional::new().roulette(end()).samples_per_cell(1 << 16).seed(1);
        let methods = [
            ("pairs", at.solve(&pairs).unwrap()),
            ("pairs, optimal", at.solve(&pairs.optimal(512)).unwrap()),
            ("forward", eq.seen_by(&x).solve(&Forward::next_event().walks(1 << 16)).unwrap()),
        ];
        for (what, e) in methods {
            for c in 0..2 {
                let what = format!("system {i}, {what}, component {c}");
                results.push(budget.mean(&what, stated(&e.component(c)), exact.eval(0.6).component(c), 0.2));
            }
        }
    }
    all_pass(results);
}

/// f(x) = g(x) + ∫ K_c f + κ f(1 − x): half of the steps go along the mirror, and some are absorbed.
#[derive(Clone, Copy, Debug)]
struct Mirrored {
    smooth: fn(f64, f64) -> f64,
    kappa: f64,
    turned: fn(f64, f64) -> (f64, f64),
}

impl Mirrored {
    fn at(&self, x: f64, y: f64) -> f64 {
        let (x, y) = (self.turned)(x, y);
        (self.smooth)(x, y)
    }
}

impl Operator for Mirrored {
    type Point = f64;
    type Weight = f64;
}
impl Kernel for Mirrored {
    fn eval(&self, x: &f64, y: &f64) -> f64 {
        self.at(*x, *y)
    }
}
impl Transition for Mirrored {
    fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        let [v, y] = u.next_2d();
        match v {
            v if v < 0.4 => Some(Step::singular(1.0 - x, self.kappa / 0.4)),
            v if v < 0.9 => Some(Step::with_pdf(y, self.at(*x, y) / 0.5, 0.5)),
            _ => None,
        }
    }
}
impl TransitionPdf for Mirrored {
    fn pdf(&self, _: &f64, _: &f64) -> f64 {
        0.5
    }
}
impl HasAdjoint for Mirrored {
    type Adjoint = Mirrored;
    fn adjoint(&self) -> Result<Mirrored, Error> {
        Ok(Mirrored { turned: |x, y| (y, x), ..*self })
    }
}

#[test]
fn mirrors() {
    let mut budget = Budget::of("bidirectional::mirrors");
    let mut results = Vec::new();
    let rows: [(fn(f64) -> f64, fn(f64, f64) -> f64, f64); 3] = [
        (|x| 1.0 + x, |x, y| 0.4 * (x + y), 0.3),
        (|x| x - 0.3, |x, y| 0.5 * (x - y).sin(), -0.3),
        (|x| x * x, |x, y| 0.3 + x * y * y, 0.2),
    ];
    let nodes = composite_unit_rule(4, 8);
    let n = nodes.len();
    for (i, (g, smooth, kappa)) in rows.into_iter().enumerate() {
        let kernel = Mirrored { smooth, kappa, turned: |x, y| (x, y) };
        let eq = Equation::new(source_fn(Interval::from(0.0..=1.0), move |x: &f64| g(*x)), kernel);
        // the nodes are symmetric: 1 − x_i = x_{n−1−i}
        let matrix = DMatrix::from_fn(n, n, |r, c| {
            let delta = |a: usize, b: usize| f64::from(u8::from(a == b));
            delta(r, c) - nodes[c].weight * smooth(nodes[r].point, nodes[c].point) - kappa * delta(n - 1 - r, c)
        });
        let f = matrix.lu().solve(&DVector::from_fn(n, |r, _| g(nodes[r].point))).unwrap();
        let h = |x: &f64| 1.0 + x;
        let (hf, at) = ((0..n).map(|i| nodes[i].weight * h(&nodes[i].point) * f[i]).sum::<f64>(), (nodes[9].point, f[9]));
        let seen = Functional::new(Interval::from(0.0..=1.0), h);
        let (q, point) = (eq.seen_by(&seen), eq.at(at.0));
        let pairs = Bidirectional::new().endings(OwnAbsorption, OwnAbsorption).samples_per_cell(1 << 16).seed(2);
        let walk = point.optimal(&Walk::mis().ending(OwnAbsorption).samples_per_cell(1 << 16), 512).unwrap();
        let mut mean = |what: &str, seen, truth| budget.mean(&format!("mirror {i}, {what}"), seen, truth, 0.3);
        results.extend([
            mean("pairs at a point", stated(&point.solve(&pairs).unwrap()), at.1),
            mean("pairs, h", stated(&q.solve(&pairs).unwrap()), hf),
            mean("pairs, optimal", stated(&point.solve(&pairs.optimal(512)).unwrap()), at.1),
            mean("pairs, h, optimal", stated(&q.solve(&pairs.optimal(512)).unwrap()), hf),
            mean("walks, optimal", stated(&point.solve(&walk).unwrap()), at.1),
            mean("forward, h", stated(&q.solve(&Forward::scoring(Collision, OwnAbsorption).walks(1 << 16)).unwrap()), hf),
        ]);
        // what no next event can find is an error, not a bias
        let refused = eq.solve(&Forward::new().ending(OwnAbsorption).profile(KernelTally::at(&[0.5]))).map(drop);
        assert!(matches!(refused, Err(Error::SingularStep { .. })), "{refused:?}");
    }
    all_pass(results);
}
