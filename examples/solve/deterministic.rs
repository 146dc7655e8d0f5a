//! Deterministic methods on a stated equation.

use crate::options::{DeterministicMethod, Options};
use crate::report::{Comparison, Outcome};
use fredholm::Error;
use fredholm::deterministic::quadrature::unit_rule;
use fredholm::deterministic::{Collocation, ElementSolution, Galerkin, Nystrom, NystromSolution};
use fredholm::domain::{Domain, Node, Point};
use fredholm::formula::{Stated, TextEquation};
use fredholm::kernel::{HasDomain, Kernel, Operator};
use fredholm::sampling::{Pcg, Sequence};
use fredholm::source::Source;
use std::time::Instant;

/// Random places at which a solve without an estimate of its own is checked, beside those asked for.
const PROBES: u64 = 24;
/// The error at a few places is not the largest: what is reported is that many times more.
const SAFETY: f64 = 4.0;
/// Degree of finite elements, and the exponent of their meshes: for d ln d at the ends.
const DEGREE: usize = 3;
const GRADING: f64 = 4.0;

/// Why none of them is tried.
pub(crate) fn refused(options: &Options) -> Vec<Outcome> {
    let why = "a product rule of n nodes a coordinate has n^d of them: use walks beyond three dimensions";
    let refused = |method| Outcome { method, seconds: 0.0, note: String::new(), result: Err(why.into()) };
    options.deterministic.iter().map(|(method, _)| refused(*method)).collect()
}

/// Every deterministic method asked for.
pub(crate) fn all<D: Domain>(stated: &Stated<D>, options: &Options) -> Vec<Outcome> {
    let eq = stated.equation();
    let one = |&(method, which): &(&'static str, DeterministicMethod)| {
        let clock = Instant::now();
        match solve(&eq, stated, which, options.tolerance) {
            Ok(Solved { seconds, note, comparisons }) => Outcome { method, seconds, note, result: Ok(comparisons) },
            Err(e) => Outcome { method, seconds: clock.elapsed().as_secs_f64(), note: String::new(), result: Err(e.to_string()) },
        }
    };
    options.deterministic.iter().map(one).collect()
}

/// The seconds of the solve alone, what is worth a word, and the numbers.
struct Solved {
    seconds: f64,
    note: String,
    comparisons: Vec<Comparison>,
}

fn solve<D: Domain>(eq: &TextEquation<'_, D>, stated: &Stated<D>, method: DeterministicMethod, tolerance: f64) -> Result<Solved, Error> {
    let clock = Instant::now();
    let (dimension, states) = (stated.domain().dimension(), stated.domain().states());
    let nodes = [64, 24, 8][dimension - 1];
    // a system has as many blocks as states
    let elements = if states > 2 { 16 } else { 64 };
    let settings = match method {
        DeterministicMethod::Nystrom => Nystrom::gauss_legendre(nodes),
        DeterministicMethod::Composite => Nystrom::composite([16, 4, 2][dimension - 1], [8, 6, 4][dimension - 1]),
        DeterministicMethod::Graded => Nystrom::graded(8, if states > 2 { 8 } else { 12 }),
        DeterministicMethod::Adaptive => Nystrom::adaptive().tolerance(tolerance),
        DeterministicMethod::Galerkin => {
            let f = eq.solve(&Galerkin::elements(elements).degree(DEGREE).graded(GRADING))?;
            return Found::elements(&f)?.compared(stated, clock.elapsed().as_secs_f64());
        }
        DeterministicMethod::Collocation => {
            let f = eq.solve(&Collocation::elements(elements).degree(DEGREE).graded(GRADING))?;
            return Found::elements(&f)?.compared(stated, clock.elapsed().as_secs_f64());
        }
    };
    let f = eq.solve(&settings)?;
    let seconds = clock.elapsed().as_secs_f64();
    Found::nodes(&f, &places(stated))?.compared(stated, seconds)
}

/// Those asked for and some more.
fn places<D: Domain>(stated: &Stated<D>) -> Vec<D::Point> {
    let random = (0..PROBES).map(|i| stated.domain().sample(&mut Pcg::default().point(0, 0, i)).point);
    stated.points.iter().map(|k| k.point).chain(random).collect()
}

/// A solution, whoever found it.
struct Found<'a, X> {
    value: Box<dyn Fn(&X) -> Result<f64, Error> + 'a>,
    /// ∫ h f by the nodes of the solve
    functional: Box<dyn Fn(&dyn Fn(&X) -> f64) -> f64 + 'a>,
    /// largest error, as the method itself can tell
    error: f64,
    magnitude: f64,
    evaluations: u64,
    note: String,
}

impl<'a, X: Point> Found<'a, X> {
    /// Unless the solve estimates it, the error is ‖(I − T)⁻¹‖ · |residual by a rule of other nodes| and what rounding leaves.
    fn nodes<G, K>(f: &'a NystromSolution<G, K>, places: &[X]) -> Result<Self, Error>
    where
        G: Source<Point = X, Value = f64>,
        K: Kernel + HasDomain + Operator<Point = X, Weight = f64>,
    {
        let reported = f.error_estimate();
        let mut residual = 0.0f64;
        for x in places.iter().filter(|_| reported.is_none()) {
            residual = residual.max(f.residual(*x)?.abs());
        }
        let checked = SAFETY * f.inverse_norm() * residual + rounding(f.rcond(), f.magnitude());
        Ok(Found {
            value: Box::new(|x| f.try_eval(x)),
            functional: Box::new(|h| f.functional(h)),
            error: reported.unwrap_or(checked),
            magnitude: f.magnitude(),
            evaluations: f.evaluations(),
            note: note(f.unknowns(), f.condition(), f.class().map(|c| c.to_string())),
        })
    }

    /// The iterated solution.
    fn elements<G, K>(f: &'a ElementSolution<G, K>) -> Result<Self, Error>
    where
        G: Source<Point = X, Value = f64>,
        K: Kernel + HasDomain + Operator<Point = X, Weight = f64>,
    {
        Ok(Found {
            value: Box::new(|x| f.iterated(*x)),
            functional: Box::new(|h| f.functional(h)),
            error: SAFETY * f.error_estimate()?.iterated + rounding(f.rcond(), f.magnitude()),
            magnitude: f.magnitude(),
            evaluations: f.evaluations(),
            note: note(f.unknowns(), 1.0 / f.rcond(), None),
        })
    }

    fn compared<D: Domain<Point = X>>(&self, stated: &Stated<D>, seconds: f64) -> Result<Solved, Error> {
        Ok(Solved { seconds, note: self.note.clone(), comparisons: self.compare(stated)? })
    }

    fn compare<D: Domain<Point = X>>(&self, stated: &Stated<D>) -> Result<Vec<Comparison>, Error> {
        let unresolved = !(self.error <= 0.1 * self.magnitude.max(1e-3));
        let refusal = unresolved.then(|| format!("not resolved: the error may be {:.0e}", self.error));
        let comparison = |label: String, value: f64, error: f64, reference| Comparison {
            refusal: refusal.clone(),
            ..Comparison::deterministic(label, value, error, reference)
        };
        let mut found = Vec::new();
        for known in &stated.points {
            found.push(comparison(format!("x = {}", known.label), (self.value)(&known.point)?, self.error, known.value));
        }
        // another rule, and how far it is
        let nodes = if stated.functionals.is_empty() { Vec::new() } else { rule(stated.domain()) };
        let values = nodes.iter().map(|n| (self.value)(&n.point)).collect::<Result<Vec<_>, _>>()?;
        for f in &stated.functionals {
            let value = (self.functional)(&|x| f.weight(x));
            let weights = || nodes.iter().map(|n| n.weight * f.weight(&n.point));
            let other: f64 = weights().zip(&values).map(|(w, v)| w * v).sum();
            let size: f64 = weights().map(f64::abs).sum();
            found.push(comparison(format!("∫ f·({})", f.label), value, size * self.error + SAFETY * (value - other).abs(), f.value));
        }
        if let Some(first) = found.first_mut() {
            first.evaluations = self.evaluations;
        }
        Ok(found)
    }
}

fn note(unknowns: usize, condition: f64, class: Option<String>) -> String {
    let class = class.map_or_else(String::new, |c| format!("; {c}"));
    format!("{unknowns} unknowns, condition {condition:.0e}{class}")
}

/// What rounding leaves of the digits.
fn rounding(rcond: f64, magnitude: f64) -> f64 {
    16.0 * f64::EPSILON / rcond * magnitude
}

/// Nodes of a rule for ∫ h f that knows nothing of the solve: graded to both ends in one dimension.
fn rule<D: Domain>(domain: &D) -> Vec<Node<D::Point>> {
    if domain.dimension() > 1 {
        return domain.rule(1, [0, 0, 17, 7][domain.dimension().min(3)]);
    }
    let mut breaks: Vec<f64> = (0..20).rev().map(|k| 0.5f64.powi(k + 1)).collect();
    breaks.insert(0, 0.0);
    breaks.extend((1..20).map(|k| 1.0 - 0.5f64.powi(k + 1)));
    breaks.push(1.0);
    let panels =
        breaks.windows(2).flat_map(|e| unit_rule(10).into_iter().map(move |n| (e[0] + n.point * (e[1] - e[0]), n.weight * (e[1] - e[0]))));
    let panels: Vec<_> = panels.collect();
    let place = |state: usize| {
        panels.iter().map(move |&(t, w)| {
            let n = domain.place(state, || t);
            Node { point: n.point, weight: n.weight * w }
        })
    };
    (0..domain.states()).flat_map(place).collect()
}
