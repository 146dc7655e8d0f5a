//! Every problem on a line × every way to walk forward, against stored references.

use crate::common::{Budget, Reference, all_pass};
use crate::problems::{By, Line, Problem, equation, problems};
use crate::{PILOT, enough, judge};
use fredholm::detector::{At, Functional};
use fredholm::kernel::{HasAdjoint, Kernel, Operator, RowMass, Transition};
use fredholm::sampling::Sobol;
use fredholm::source::Emit;
use fredholm::walk::Roulette;
use fredholm::{Error, Estimate, Forward};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    Collision,
    ConstantRoulette,
    NextEvent,
    /// Next event with a point for a detector: the kernel tally.
    Point,
    Subcritical,
    Sobol,
}

const PLAIN: [Method; 4] = [Method::Collision, Method::ConstantRoulette, Method::NextEvent, Method::Point];

type Functionals = Functional<Line, fn(&f64) -> f64>;

/// One estimate; `run` is (survival of constant roulettes, walks, seed).
fn walk<G, K>(
    eq: &fredholm::Equation<G, K>,
    h: &Functionals,
    x: f64,
    method: Method,
    (p, n, seed): (f64, u64, u64),
) -> Result<Estimate, Error>
where
    G: Emit<Point = f64, Value = f64, State = f64>,
    K: Kernel + HasAdjoint<Adjoint: Transition + Operator<Point = f64>> + Operator<Point = f64, Weight = f64>,
{
    let q = eq.seen_by(h);
    match method {
        Method::Collision => q.solve(&Forward::new().walks(n).seed(seed)),
        Method::ConstantRoulette => q.solve(&Forward::new().roulette(Roulette::constant(p)).walks(n).seed(seed)),
        Method::NextEvent => q.solve(&Forward::next_event().walks(n).seed(seed)),
        Method::Point => eq.seen_by(&At(x)).solve(&Forward::next_event().walks(n).seed(seed)),
        Method::Subcritical | Method::Sobol => unreachable!("see `table_only`"),
    }
}

/// What needs a table, or is tested with one alone.
fn table_only<G, K>(eq: &fredholm::Equation<G, K>, h: &Functionals, method: Method, (n, seed): (u64, u64)) -> Result<Estimate, Error>
where
    G: Emit<Point = f64, Value = f64, State = f64>,
    K: HasAdjoint<Adjoint: Transition + RowMass + Operator<Point = f64>> + Operator<Point = f64, Weight = f64>,
{
    let q = eq.seen_by(h);
    match method {
        Method::Subcritical => q.solve(&Forward::subcritical().walks(n).seed(seed)),
        _ => q.solve(&Forward::new().sequence(Sobol::new(seed)).walks(n)),
    }
}

/// A functional of a reference file: its name, h, the value.
fn functional(p: &Problem) -> (Functionals, f64) {
    let names: [(&str, fn(&f64) -> f64); 4] =
        [("1", |_| 1.0), ("1/2", |_| 0.5), ("exp(-1*x)", |x| (-x).exp()), ("exp(-x/0.5)", |x| (-x / 0.5).exp())];
    let reference = Reference::load(p.reference);
    let (h, weight) = names.into_iter().find(|n| reference.has_functional(n.0)).expect("a functional of a known name");
    (Functional::new(p.line, weight), reference.functional(h))
}

type Solve<'a> = &'a dyn Fn(Method, u64, u64) -> Result<Estimate, Error>;

fn all(budget: &mut Budget, results: &mut Vec<Result<(), String>>, p: &Problem, how: &str, methods: &[Method], solve: Solve) {
    let (values, (_, integral)) = (Reference::load(p.reference).scalar(), functional(p));
    let (x, f) = values[1];
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.1.abs()));
    for method in methods {
        let (truth, margin) =
            if *method == Method::Point { (f, 2.0 * p.margin * largest) } else { (integral, 1.6 * p.margin * largest.max(integral.abs())) };
        let what = format!("{} {how} {method:?} x = {x}", p.reference);
        let pilot = if *method == Method::Sobol { Method::Collision } else { *method };
        let run = solve(pilot, PILOT, 1).map(|e| enough(budget, &e, margin));
        match run.and_then(|n| solve(*method, n, 2)) {
            Ok(e) => results.push(judge(budget, &what, &e, truth, margin)),
            Err(e) => results.push(Err(format!("{what}: {e}"))),
        }
    }
}

#[test]
fn problems_on_a_line() {
    let mut budget = Budget::of("forward::line");
    let mut results = Vec::new();
    for p in problems() {
        let (eq, (h, _)) = (equation(&p), functional(&p));
        let x = Reference::load(p.reference).scalar()[1].0;
        let (By::Both(cells) | By::Table(cells)) = p.by;
        if p.by == By::Both(cells) {
            all(&mut budget, &mut results, &p, "uniform", &PLAIN, &|m, n, seed| walk(&eq, &h, x, m, (p.constant, n, seed)));
        }
        let table = eq.tabulated(cells).unwrap().tabulated_source(cells).unwrap();
        let by_table = |method, n, seed| match method {
            Method::Subcritical | Method::Sobol => table_only(&table, &h, method, (n, seed)),
            _ => walk(&table, &h, x, method, (p.constant, n, seed)),
        };
        let methods = [&PLAIN[..], &[Method::Subcritical, Method::Sobol]].concat();
        all(&mut budget, &mut results, &p, "tabulated", &methods, &by_table);
    }
    all_pass(results);
}
