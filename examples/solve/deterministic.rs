//! Deterministic methods on a stated equation.

use crate::options::{DeterministicMethod, Options};
use crate::report::{Comparison, Outcome};
use fredholm::Error;
use fredholm::deterministic::quadrature::unit_rule;
use fredholm::deterministic::{Galerkin, GalerkinSolution, Nystrom, NystromSolution};
use fredholm::domain::{Domain, Node};
use fredholm::formula::{Stated, Statement, TextEquation};
use fredholm::kernel::{HasDomain, Kernel, Operator};
use fredholm::sampling::{Pcg, Sequence};
use fredholm::source::Source;
use std::time::Instant;

/// Random places at which a solve without an estimate of its own is checked, beside those asked for.
const PROBES: u64 = 24;
/// The error at a few places is not the largest: what is reported is that many times more.
const SAFETY: f64 = 4.0;

/// Every deterministic method asked for.
pub(crate) fn all(statement: &Statement, options: &Options) -> Vec<Outcome> {
    match statement {
        Statement::Interval(s) => each(s, options),
        Statement::HalfLine(s) => each(s, options),
        Statement::System(s) => each(s, options),
        Statement::Box2(s) => each(s, options),
        Statement::Box3(s) => each(s, options),
        _ => refuse_all(options),
    }
}

fn refuse_all(options: &Options) -> Vec<Outcome> {
    let why = "a product rule of n nodes a coordinate has n^d of them: use walks beyond three dimensions";
    options.deterministic.iter().map(|(method, _)| Outcome { method, seconds: 0.0, result: Err(why.into()) }).collect()
}

fn each<D: Domain>(stated: &Stated<D>, options: &Options) -> Vec<Outcome> {
    let eq = stated.equation();
    let one = |&(method, which): &(&'static str, DeterministicMethod)| {
        let clock = Instant::now();
        let result = solve(&eq, stated, which, options.tolerance).map_err(|e| e.to_string());
        Outcome { method, seconds: clock.elapsed().as_secs_f64(), result }
    };
    options.deterministic.iter().map(one).collect()
}

fn solve<D: Domain>(
    eq: &TextEquation<'_, D>,
    stated: &Stated<D>,
    method: DeterministicMethod,
    tolerance: f64,
) -> Result<Vec<Comparison>, Error> {
    let (dimension, states) = (stated.domain().dimension(), stated.domain().states());
    let nodes = [64, 24, 8][dimension - 1];
    let settings = match method {
        DeterministicMethod::Nystrom => Nystrom::gauss_legendre(nodes),
        DeterministicMethod::Composite => Nystrom::composite([16, 4, 2][dimension - 1], [8, 6, 4][dimension - 1]),
        // a system has as many blocks as states
        DeterministicMethod::Graded => Nystrom::graded(8, if states > 2 { 8 } else { 12 }),
        DeterministicMethod::Adaptive => Nystrom::adaptive().tolerance(tolerance),
        DeterministicMethod::Galerkin => {
            let elements = if states > 2 { 32 } else { 128 };
            let f = eq.solve(&Galerkin::elements(elements))?;
            return Elements { f, rule: stated.domain().rule(elements, 6) }.compare(stated);
        }
    };
    let f = eq.solve(&settings)?;
    let reported = matches!(method, DeterministicMethod::Adaptive).then(|| tolerance * f.magnitude().max(1.0));
    Nodes { f, reported }.compare(stated)
}

/// A solution of either kind.
trait Found<D: Domain> {
    fn value(&self, x: &D::Point) -> Result<f64, Error>;
    /// Largest error at these places, as the method itself can tell.
    fn error(&self, places: &[D::Point]) -> Result<f64, Error>;
    /// ∫ h f, and how far another rule is from it.
    fn integral(&self, domain: &D, h: &dyn Fn(&D::Point) -> f64) -> Result<(f64, f64), Error>;
    fn evaluations(&self) -> u64;
    fn magnitude(&self) -> f64;

    fn compare(&self, stated: &Stated<D>) -> Result<Vec<Comparison>, Error> {
        let domain = stated.domain();
        let random = (0..PROBES).map(|i| domain.sample(&mut Pcg::default().point(0, 0, i)).point);
        let places: Vec<_> = stated.points.iter().map(|k| k.point).chain(random).collect();
        let error = self.error(&places)?;
        let unresolved = !(error <= 0.1 * self.magnitude().max(1e-3));
        let refusal = unresolved.then(|| format!("not resolved: the error may be {error:.0e}"));
        let comparison = |label: String, value: f64, error: f64, reference| Comparison {
            label,
            value,
            error,
            freedom: None,
            bias: 0.0,
            reference,
            evaluations: 0,
            refusal: refusal.clone(),
        };
        let mut found = Vec::new();
        for known in &stated.points {
            found.push(comparison(format!("x = {}", known.label), self.value(&known.point)?, error, known.value));
        }
        for f in &stated.functionals {
            let h = |x: &D::Point| f.weight(x);
            let (value, gap) = self.integral(domain, &h)?;
            let size: f64 = rule(domain).iter().map(|n| n.weight * h(&n.point).abs()).sum();
            found.push(comparison(format!("∫ f·({})", f.label), value, size * error + SAFETY * gap, f.value));
        }
        if let Some(first) = found.first_mut() {
            first.evaluations = self.evaluations();
        }
        Ok(found)
    }
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

struct Nodes<G: Source, K: Operator> {
    f: NystromSolution<G, K>,
    /// of an adaptive solve
    reported: Option<f64>,
}

impl<G, K, D> Found<D> for Nodes<G, K>
where
    D: Domain,
    G: Source<Point = D::Point, Value = f64>,
    K: Kernel + HasDomain<Domain = D> + Operator<Point = D::Point, Weight = f64>,
{
    fn value(&self, x: &D::Point) -> Result<f64, Error> {
        self.f.try_eval(x)
    }

    /// ‖(I − T)⁻¹‖ · |residual by a rule of other nodes|, and what rounding leaves.
    fn error(&self, places: &[D::Point]) -> Result<f64, Error> {
        if let Some(reported) = self.reported {
            return Ok(reported);
        }
        let residuals = places.iter().map(|x| self.f.residual(*x).map(f64::abs)).collect::<Result<Vec<_>, _>>()?;
        let largest = residuals.into_iter().fold(0.0, f64::max);
        Ok(SAFETY * self.f.inverse_norm() * largest + 16.0 * f64::EPSILON / self.f.rcond() * self.f.magnitude())
    }

    fn integral(&self, domain: &D, h: &dyn Fn(&D::Point) -> f64) -> Result<(f64, f64), Error> {
        let value = self.f.functional(h);
        let mut other = 0.0;
        for n in rule(domain) {
            other += n.weight * h(&n.point) * self.f.try_eval(&n.point)?;
        }
        Ok((value, (value - other).abs()))
    }

    fn evaluations(&self) -> u64 {
        self.f.evaluations()
    }

    fn magnitude(&self) -> f64 {
        self.f.magnitude()
    }
}

struct Elements<G: Source, K: Operator> {
    f: GalerkinSolution<G, K>,
    /// nodes that respect the elements
    rule: Vec<Node<K::Point>>,
}

impl<G, K, D> Found<D> for Elements<G, K>
where
    D: Domain,
    G: Source<Point = D::Point, Value = f64>,
    K: Kernel + HasDomain<Domain = D> + Operator<Point = D::Point, Weight = f64>,
{
    fn value(&self, x: &D::Point) -> Result<f64, Error> {
        Ok(self.f.eval(*x))
    }

    /// The distance to the iterated solution, which has twice the order.
    fn error(&self, places: &[D::Point]) -> Result<f64, Error> {
        let gaps = places.iter().map(|x| self.f.iterated(*x).map(|better| (better - self.f.eval(*x)).abs()));
        let largest = gaps.collect::<Result<Vec<_>, _>>()?.into_iter().fold(0.0, f64::max);
        Ok(SAFETY * largest + 16.0 * f64::EPSILON / self.f.rcond() * Found::<D>::magnitude(self))
    }

    fn integral(&self, domain: &D, h: &dyn Fn(&D::Point) -> f64) -> Result<(f64, f64), Error> {
        let by = |nodes: &[Node<D::Point>]| nodes.iter().map(|n| n.weight * h(&n.point) * self.f.eval(n.point)).sum::<f64>();
        let value = by(&self.rule);
        Ok((value, (value - by(&rule(domain))).abs()))
    }

    fn evaluations(&self) -> u64 {
        self.f.evaluations()
    }

    fn magnitude(&self) -> f64 {
        self.f.values().iter().fold(0.0, |m, v| m.max(v.abs()))
    }
}
