//! Bidirectional walks on equations with known answers.

use crate::common::{Budget, Reference, all_pass};
use crate::{erased, stated};
use fredholm::detector::{At, Bins, Functional};
use fredholm::deterministic::Nystrom;
use fredholm::deterministic::quadrature::composite_unit_rule;
use fredholm::domain::Interval;
use fredholm::estimator::{Combination, Metropolis, OneCell};
use fredholm::kernel::{HasAdjoint, Kernel, Operator, TransitionPdf};
use fredholm::sampling::Sobol;
use fredholm::source::{EmitPdf, Source};
use fredholm::walk::{Connect, Heuristic, Meet, Roulette, Strategies};
use fredholm::{Bidirectional, Equation, Error, Estimate, GroupMatrix, Spectrum, Value, Weight};

const HEURISTICS: [Heuristic; 4] = [Heuristic::Balance, Heuristic::Power(2.0), Heuristic::Maximum, Heuristic::Average];

/// Pairs for a standard error that sees a bias of `margin`, from a pilot of another seed.
fn sized<V: Value>(budget: &Budget, margin: f64, solve: impl Fn(u64, u64) -> Result<Estimate<V>, Error>) -> Estimate<V> {
    let sigma = solve(8192, 1).unwrap().variance().unwrap().magnitude().sqrt();
    let n = ((budget.detectable() * sigma / margin).powi(2) * 2.0).clamp(4096.0, 2e6) as u64;
    solve(n, 2).unwrap()
}

fn solve<G, K, D>(eq: &Equation<G, K>, detector: &D, walks: Bidirectional, (n, seed): (u64, u64)) -> Result<Estimate<G::Value>, Error>
where
    G: EmitPdf,
    K: HasAdjoint<Adjoint: TransitionPdf + Operator<Point = G::State>> + TransitionPdf + Connect<K::Adjoint> + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Meet<G::State, G::Value, Point = G::Point, Answer<Estimate<G::Value>> = Estimate<G::Value>>,
{
    eq.seen_by(detector).solve(&walks.samples_per_cell(n).seed(seed))
}

/// ⟨h, Tᵐ g⟩ on the unit interval for m = 0, …, `order`, by Gauss–Legendre.
fn elements<G: Source<Point = f64, Value = f64>, K: Kernel + Operator<Point = f64, Weight = f64>>(
    eq: &Equation<G, K>,
    h: impl Fn(f64) -> f64,
    order: usize,
) -> Vec<f64> {
    let nodes = composite_unit_rule(8, 8);
    let mut term: Vec<f64> = nodes.iter().map(|n| eq.source().eval(&n.point)).collect();
    let mut out = Vec::new();
    for _ in 0..=order {
        out.push(nodes.iter().zip(&term).map(|(n, v)| n.weight * h(n.point) * v).sum());
        let row = |x: f64| nodes.iter().zip(&term).map(|(y, v)| y.weight * eq.kernel().eval(&x, &y.point) * v).sum::<f64>();
        term = nodes.iter().map(|x| row(x.point)).collect();
    }
    out
}

/// For each order and each weight, the strategies agree with each other and with ⟨h, Tᵐ g⟩ (theory §5.3, T7).
#[test]
fn strategies_of_every_order_agree() {
    let mut budget = Budget::of("bidirectional::strategies");
    let mut results = Vec::new();
    let eq = erased!((0.0, 1.0), |x: f64| 1.0 + x * x, |x: f64, y: f64| 0.7 * (-x * y * y).exp() * (1.0 + x - y));
    let detector = Functional::new(Interval::from(0.0..=1.0), |x: &f64| 0.5 + x);
    let truth = elements(&eq, |x| 0.5 + x, 3);
    let walks = Bidirectional::new().roulette(Roulette::constant(0.8)).samples_per_cell(1 << 17);
    let query = eq.seen_by(&detector);
    let table = query.strategies(&walks, 0, 3).unwrap();
    for strategy in &table {
        let (what, truth) = (format!("s = {}, t = {}", strategy.s, strategy.t), truth[strategy.order() as usize]);
        let m = &strategy.alone;
        results.push(budget.mean(&what, (m.mean, m.std_error().unwrap(), m.count as f64), truth, 0.25 * truth));
        // weights lie in [0, 1], contributions of this equation are positive
        assert!(strategy.weighted.mean > 0.0 && strategy.weighted.mean < m.mean, "{what}");
    }
    for heuristic in HEURISTICS {
        for (m, truth) in truth.iter().enumerate() {
            let walks = walks.heuristic(heuristic).strategies(Strategies::Order(m as u64));
            let e = query.solve(&walks).unwrap();
            results.push(budget.mean(&format!("{heuristic:?}, order {m}"), stated(&e), *truth, 0.05 * truth));
        }
    }
    all_pass(results);
}

/// Variances of strategies alone by quadrature (theory (4.7.4)) against those of pairs: of a functional, and of f at a point.
#[test]
fn variances_of_strategies_are_predicted_by_quadrature() {
    let mut budget = Budget::of("bidirectional::variances");
    let mut results = Vec::new();
    let (g, h, k) = (|x: f64| 1.0 + x * x, |x: f64| 0.5 + x, |x: f64, y: f64| 0.7 * (-x * y * y).exp() * (1.0 + x - y));
    let eq = erased!((0.0, 1.0), g, k);
    let detector = Functional::new(Interval::from(0.0..=1.0), move |x: &f64| h(*x));
    let walks = Bidirectional::new().roulette(Roulette::constant(0.8)).samples_per_cell(1 << 17).seed(4);
    let (rule, exact) = (Nystrom::composite(4, 8), elements(&eq, h, 2));
    let (inside, at) = (eq.seen_by(&detector), eq.at(0.3));
    let inside = (inside.predict_strategies(&walks, 0, 2, &rule).unwrap(), inside.strategies(&walks, 0, 2).unwrap());
    let at = (at.predict_strategies(&walks, 0, 2, &rule).unwrap(), at.strategies(&walks, 0, 2).unwrap());
    for (p, m) in inside.0.iter().zip(&inside.1).chain(at.0.iter().zip(&at.1)) {
        assert_eq!((p.s, p.t), (m.s, m.t));
        let (m, what) = (&m.alone, format!("s = {}, t = {}", p.s, p.t));
        if m.nonzero == 0 {
            assert!(p.t == 0 && p.variance.is_infinite(), "{what}");
            continue;
        }
        let (n, variance) = (m.count as f64, m.variance().unwrap());
        if variance == 0.0 {
            assert!(p.variance == 0.0 && (m.mean - p.mean).abs() < 1e-12, "{what}");
            continue;
        }
        let error = ((m.m4 / n - (m.m2 / n).powi(2)) / n).sqrt();
        results.push(budget.mean(&what, (variance, error, n), p.variance, 0.3 * p.variance));
    }
    assert!(inside.0.iter().all(|p| (p.mean - exact[(p.s + p.t) as usize - 1]).abs() < 1e-9));
    // roulette by throughput is not a function of the place
    let refused = eq.at(0.3).predict_strategies(&Bidirectional::new(), 0, 2, &rule);
    assert!(matches!(refused, Err(Error::Invalid { parameter: "ending", .. })), "{refused:?}");
    let refused = eq.at(0.3).predict_strategies(&walks, 0, u64::MAX, &rule);
    assert!(matches!(refused, Err(Error::Invalid { parameter: "order", .. })), "{refused:?}");
    all_pass(results);
}

#[test]
fn problems_of_the_zoo() {
    let mut budget = Budget::of("bidirectional::zoo");
    let mut results = Vec::new();
    let green = |x: f64, y: f64| 5.0 * (x.min(y) - x * y);
    let rows = [
        ("expxy-g1-lam0.5", erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * (x * y).exp())),
        ("green-bridge-lam5", erased!((0.0, 1.0), |_| 1.0, green)),
        ("signchanging-nonsym", erased!((0.0, 1.0), f64::cos, |x: f64, y: f64| 1.2 * (5.0 * x - 3.0 * y).sin() * (-x * y).exp())),
        ("volterra-step-lam1", erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| f64::from(u8::from(x > y)))),
        ("lieb-liniger-gamma1", {
            let d = Reference::load("lieb-liniger-gamma1").parameter("d");
            let pi = std::f64::consts::PI;
            erased!((-1.0, 1.0), move |_| 0.5 / pi, move |x: f64, y: f64| d / (pi * (d * d + (x - y).powi(2))))
        }),
    ];
    for (name, eq) in rows {
        let values = Reference::load(name).scalar();
        let margin = 0.04 * values.iter().fold(0.0, |m: f64, v| m.max(v.1.abs()));
        let table = eq.clone().tabulated(16).unwrap().tabulated_source(16).unwrap();
        for (i, heuristic) in HEURISTICS.into_iter().enumerate() {
            let (x, f) = values[(2 * i + 1) % values.len()];
            let walks = Bidirectional::new().heuristic(heuristic);
            let e = sized(&budget, margin, |n, seed| solve(&eq, &At(x), walks, (n, seed)));
            results.push(budget.mean(&format!("{name} uniform {heuristic:?} x = {x}"), stated(&e), f, margin));
            let e = sized(&budget, margin, |n, seed| solve(&table, &At(x), walks.roulette(Roulette::constant(0.9)), (n, seed)));
            results.push(budget.mean(&format!("{name} tabulated {heuristic:?} x = {x}"), stated(&e), f, margin));
        }
    }
    all_pass(results);
}

/// The order of matrix factors: W^E K w^L.
#[test]
fn systems_with_matrix_weights() {
    let mut budget = Budget::of("bidirectional::matrix");
    let mut results = Vec::new();
    // f = (1, x) + ∫ K f with K = [[0.3, 0.5 x], [0.1 y, 0.2]]: by Nyström
    let k = |x: f64, y: f64| GroupMatrix([[0.3, 0.5 * x], [0.1 * y, 0.2]]);
    let eq = Equation::on_interval(0.0..=1.0, |x| Spectrum([1.0, x]), k);
    let exact = eq.solve(&Nystrom::gauss_legendre(16)).unwrap();
    for heuristic in [Heuristic::Balance, Heuristic::Maximum] {
        let walks = Bidirectional::new().heuristic(heuristic);
        let e = sized(&budget, 0.02, |n, seed| solve(&eq, &At(0.7), walks, (n, seed)));
        for c in 0..2 {
            let seen = (e.value[c], e.std_error.unwrap()[c], e.degrees_of_freedom as f64);
            results.push(budget.mean(&format!("{heuristic:?}, component {c}"), seen, exact.eval(0.7)[c], 0.03));
        }
    }
    all_pass(results);
}

/// Small source, small detector, peaked kernel: neither direction alone is as good.
#[test]
fn strategies_combine_with_minimum_variance_too() {
    let eq = erased!((0.0, 1.0), |x: f64| f64::from(u8::from(x > 0.9)), |x: f64, y: f64| 0.8 * (-(x - y).powi(2)).exp());
    let h = Functional::new(Interval::from(0.0..=1.0), |x: &f64| f64::from(u8::from(*x < 0.1)));
    let query = eq.seen_by(&h);
    let alone = |s, t| Bidirectional::new().strategies(Strategies::One { s, t });
    let combination = Combination::new()
        .with(query.bidirectional(&alone(0, 3)).unwrap())
        .with(query.bidirectional(&alone(1, 2)).unwrap())
        .with(query.bidirectional(&alone(2, 1)).unwrap())
        .with(query.bidirectional(&alone(3, 0)).unwrap())
        .pilot(1 << 14)
        .samples_per_cell(1 << 16)
        .solve()
        .unwrap();
    let balance = query.solve(&Bidirectional::new().strategies(Strategies::Order(2)).samples_per_cell(1 << 16).seed(9)).unwrap();
    let best = combination[0].variances.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(combination[0].estimate.variance().unwrap() < 1.05 * best);
    let difference = combination[0].estimate.value - balance.value;
    let error = combination[0].estimate.std_error.unwrap().hypot(balance.std_error.unwrap());
    assert!(difference.abs() < 6.0 * error, "{} against {balance}", combination[0].estimate);
}

/// Sequences with replicates, cells, the same bits for any number of threads, and Metropolis over pairs of walks.
#[test]
fn pairs_are_estimators_like_others() {
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let bins = Bins::new(0.0..=1.0, 4);
    let solve = || eq.seen_by(&bins).solve(&Bidirectional::new().sequence(Sobol::new(2)).samples_per_cell(1 << 12)).unwrap();
    let run = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(solve);
    let (one, three) = (run(1), run(3));
    for (cell, (a, b)) in one.iter().zip(&three).enumerate() {
        assert_eq!((a.value, a.std_error, a.evaluations), (b.value, b.std_error, b.evaluations));
        assert_eq!(a.degrees_of_freedom, 15);
        assert!(a.agrees_with(1.0 + 0.3 * bins.centre(cell), 8.0), "{a}");
    }
    // the coordinate that chooses a cell is none of the walk's
    let query = eq.seen_by(&bins);
    let shared = query.bidirectional(&Bidirectional::new()).unwrap().shared();
    let by_points = Combination::new().sequence(Sobol::new(3)).with(OneCell(shared)).solve().unwrap();
    for (cell, c) in by_points.iter().enumerate() {
        assert!(c.estimate.agrees_with(1.0 + 0.3 * bins.centre(cell), 8.0), "{}", c.estimate);
    }
    let pairs = query.bidirectional(&Bidirectional::new()).unwrap();
    let chains = Metropolis::new().mutations(512).solve(&pairs).unwrap();
    assert!(chains.cells[2].agrees_with(1.0 + 0.3 * bins.centre(2), 8.0), "{}", chains.cells[2]);
}

/// Forward walks that end at any cell count there: every cell's mean is right, by every heuristic, from runs and from single points.
#[test]
fn pairs_for_all_cells_at_once() {
    let mut budget = Budget::of("bidirectional::shared");
    let mut results = Vec::new();
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let bins = Bins::new(0.0..=1.0, 4);
    let query = eq.seen_by(&bins);
    for heuristic in HEURISTICS {
        let walks = Bidirectional::new().heuristic(heuristic).roulette(Roulette::constant(0.7)).samples_per_cell(1 << 15);
        let run = query.solve(&walks).unwrap();
        let shared = query.bidirectional(&walks).unwrap().shared();
        let points = Combination::new().with(OneCell(shared)).samples_per_cell(1 << 16).solve().unwrap();
        for (cell, (run, points)) in run.iter().zip(&points).enumerate() {
            let truth = 1.0 + 0.3 * bins.centre(cell);
            results.push(budget.mean(&format!("{heuristic:?}, run, cell {cell}"), stated(run), truth, 0.1));
            results.push(budget.mean(&format!("{heuristic:?}, points, cell {cell}"), stated(&points.estimate), truth, 0.1));
        }
    }
    all_pass(results);
}

/// Starts that rounding puts into the neighbour cell: bins whose points are 10⁻⁷ apart.
#[test]
fn bins_far_from_zero() {
    let a = 1e9;
    let eq = erased!((a, a + 1.0), |_| 1.0, move |x: f64, y: f64| 0.5 * (x - a) * (y - a));
    let cells = eq.seen_by(&Bins::new(a..=a + 1.0, 100)).solve(&Bidirectional::new().samples_per_cell(1 << 12)).unwrap();
    assert!(cells[50].agrees_with(1.1515, 8.0), "{}", cells[50]);
}

#[test]
fn refusals() {
    let eq = erased!((0.0, 1.0), |_| 1.0, |x: f64, y: f64| 0.5 * x * y);
    let invalid = |r: Result<Estimate, Error>, name: &str| match r {
        Err(Error::Invalid { parameter, .. }) => assert_eq!(parameter, name),
        other => panic!("{name}: {other:?}"),
    };
    let q = eq.at(0.5);
    invalid(q.solve(&Bidirectional::new().samples_per_cell(0)), "samples_per_cell");
    invalid(q.solve(&Bidirectional::new().max_steps(0)), "max_steps");
    invalid(q.solve(&Bidirectional::new().heuristic(Heuristic::Power(-1.0))), "power heuristic exponent");
    invalid(q.solve(&Bidirectional::new().roulette(Roulette::constant(0.0))), "roulette survival probability");
    invalid(q.solve(&Bidirectional::new().endings(fredholm::walk::FixedDepth(3), Roulette::constant(0.5))), "depth");
    assert!(matches!(q.solve(&Bidirectional::new().roulette(Roulette::constant(1.0))), Err(Error::NeverEnds)));
    let points = Bidirectional::new().sequence(Sobol::new(1).replicates(8));
    assert!(matches!(q.strategies(&points, 0, 2), Err(Error::Invalid { parameter: "replicates", .. })));
    assert!(matches!(q.strategies(&Bidirectional::new(), 1, 2), Err(Error::Invalid { parameter: "cell", .. })));
    let divergent = erased!((0.0, 1.0), |_| 1.0, |_: f64, _: f64| 1.5);
    assert!(matches!(divergent.at(0.5).solve(&Bidirectional::new()), Err(Error::Divergent { .. })));
    let long = q.solve(&Bidirectional::new().max_steps(1).samples_per_cell(1 << 16));
    assert!(matches!(long, Err(Error::WalkTooLong { steps: 1, .. })), "{long:?}");
    let bad = erased!((0.0, 1.0), |x: f64| if x > 0.5 { f64::NAN } else { 1.0 }, |x: f64, y: f64| 0.5 * x * y);
    assert!(matches!(bad.at(0.2).solve(&Bidirectional::new()), Err(Error::NonFiniteSource { .. })));
    // no source: nothing scores, and the estimate says that it knows nothing
    let dark = erased!((0.0, 1.0), |_| 0.0, |x: f64, y: f64| 0.5 * x * y);
    let e = dark.at(0.5).solve(&Bidirectional::new()).unwrap();
    assert_eq!(e.verdict(), fredholm::statistics::Verdict::NothingScored);
    assert!(e.std_error.is_none() && !e.agrees_with(0.0, 5.0), "{e:#}");
    let cells = dark.seen_by(&Bins::new(0.0..=1.0, 3)).solve(&Bidirectional::new().samples_per_cell(64)).unwrap();
    assert!(cells.iter().all(|e| e.std_error.is_none()));
    // strategies that are none, and tables without end
    invalid(q.solve(&Bidirectional::new().strategies(Strategies::One { s: 0, t: 0 })), "vertices of a strategy");
    assert!(q.solve(&Bidirectional::new().strategies(Strategies::Order(u64::MAX))).unwrap().std_error.is_none());
    assert!(matches!(q.strategies(&Bidirectional::new(), 0, u64::MAX), Err(Error::Invalid { parameter: "order", .. })));
}
