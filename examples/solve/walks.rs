//! Random walks on a stated equation.

use crate::options::{Options, WalkMethod};
use crate::report::{Comparison, Outcome};
use fredholm::domain::{Cuboid, Domain};
use fredholm::formula::Stated;
use fredholm::kernel::{Absorbing, HasDomain, Kernel, Operator, Radius, Series, Transition, TransitionPdf};
use fredholm::source::SampleSource;
use fredholm::statistics::Verdict;
use fredholm::walk::{Ending, Heuristic, Roulette, Scoring};
use fredholm::{Equation, Error, Estimate, Walk};
use std::time::Instant;

/// Cells of the tables that proposals and sources are drawn from.
const CELLS: usize = 64;
/// Deepest fixed depth.
const DEEPEST: u64 = 64;

/// Every walk asked for, with proposals tabulated from the kernel and the source.
pub(crate) fn on_a_line<D: Domain>(stated: &Stated<D>, options: &Options) -> Vec<Outcome> {
    let table = stated.equation().tabulated(CELLS).and_then(|eq| eq.tabulated_source(CELLS));
    each(options, |method| {
        let (eq, runner) = (table.as_ref().map_err(Clone::clone)?, Runner { stated, options });
        match method {
            WalkMethod::Subcritical => runner.run(eq, &Walk::subcritical()),
            other => runner.common(eq, other),
        }
    })
}

/// Every walk asked for, with uniform proposals.
pub(crate) fn in_a_box<const D: usize>(stated: &Stated<Cuboid<D>>, options: &Options) -> Vec<Outcome> {
    let eq = stated.equation();
    each(options, |method| Runner { stated, options }.common(&eq, method))
}

fn each(options: &Options, solve: impl Fn(WalkMethod) -> Result<Vec<Comparison>, Error>) -> Vec<Outcome> {
    let one = |&(name, method): &(&'static str, WalkMethod)| {
        let clock = Instant::now();
        let result = solve(method).map_err(|e| e.to_string());
        Outcome { method: name, seconds: clock.elapsed().as_secs_f64(), result }
    };
    options.walks.iter().map(one).collect()
}

struct Runner<'a, D: Domain> {
    stated: &'a Stated<D>,
    options: &'a Options,
}

impl<D: Domain> Runner<'_, D> {
    fn common<G, K>(&self, eq: &Equation<G, K>, method: WalkMethod) -> Result<Vec<Comparison>, Error>
    where
        G: SampleSource<Point = D::Point, Value = f64>,
        K: Kernel + TransitionPdf + Absorbing + HasDomain + Operator<Point = D::Point, Weight = f64>,
    {
        let mis = |heuristic| Walk::mis().heuristic(heuristic);
        match method {
            WalkMethod::Collision => self.run(eq, &Walk::collision()),
            WalkMethod::Roulette => self.run(eq, &Walk::collision().roulette(constant(radius(eq)?))),
            WalkMethod::FixedDepth => self.run(eq, &Walk::fixed_depth(depth(radius(eq)?)?)),
            WalkMethod::Absorption => self.run(eq, &Walk::absorption().roulette(constant(radius(eq)?))),
            WalkMethod::NextEvent => self.run(eq, &Walk::next_event()),
            WalkMethod::Mis => self.run(eq, &Walk::mis()),
            WalkMethod::MisPower => self.run(eq, &mis(Heuristic::Power(2.0))),
            WalkMethod::MisMaximum => self.run(eq, &mis(Heuristic::Maximum)),
            WalkMethod::MisAverage => self.run(eq, &mis(Heuristic::Average)),
            WalkMethod::Subcritical => {
                Err(Error::Formula("subcritical walks need the row mass ∫|K|, which is measured on one-dimensional domains only".into()))
            }
        }
    }

    fn run<G, K, C, E>(&self, eq: &Equation<G, K>, walk: &Walk<C, E>) -> Result<Vec<Comparison>, Error>
    where
        G: SampleSource<Point = D::Point, Value = f64>,
        K: Transition + Operator<Point = D::Point, Weight = f64>,
        C: Scoring<G, K>,
        E: Ending<K>,
    {
        let walk = walk.samples_per_cell(self.options.samples).seed(self.options.seed);
        let points: Vec<_> = self.stated.points.iter().map(|p| p.point).collect();
        let estimates = eq.on(&points).solve(&walk)?;
        let known = self.stated.points.iter();
        let mut found: Vec<_> = estimates.iter().zip(known).map(|(e, k)| comparison(e, &format!("x = {}", k.label), k.value)).collect();
        for (i, functional) in self.stated.functionals.iter().enumerate() {
            // other walks than those of the points, and than those of other functionals
            let walk = walk.seed(self.options.seed.wrapping_add(1 + i as u64));
            let estimate = eq.seen_by(&functional.detector()?).solve(&walk)?;
            found.push(comparison(&estimate, &format!("∫ f·({})", functional.label), functional.value));
        }
        Ok(found)
    }
}

fn comparison(estimate: &Estimate<f64>, label: &str, reference: Option<f64>) -> Comparison {
    let refusal = match estimate.verdict() {
        // scores that are all exactly zero say nothing, unless nothing is the answer
        Verdict::NothingScored if reference == Some(0.0) => None,
        verdict @ (Verdict::InfiniteVariance | Verdict::NothingScored) => Some(verdict.to_string()),
        _ => None,
    };
    Comparison {
        label: label.into(),
        value: estimate.value,
        error: estimate.std_error.unwrap_or(f64::INFINITY),
        freedom: Some(estimate.degrees_of_freedom),
        bias: estimate.truncation.map_or(0.0, |t| t.bias_bound.unwrap_or(f64::INFINITY)),
        reference,
        evaluations: estimate.evaluations,
        refusal,
    }
}

fn radius<G: SampleSource<Value = f64>, K: Operator<Point = G::Point, Weight = f64>>(eq: &Equation<G, K>) -> Result<Radius, Error> {
    match eq.kernel().series()? {
        Series::Known(s) if s.radius().diverges() => {
            Err(Error::Divergent { radius: s.radius().value, uncertainty: s.radius().uncertainty })
        }
        Series::Known(s) => Ok(s.radius()),
        Series::Unknown => Ok(Radius { value: 1.0, uncertainty: 1.0 }),
    }
}

/// Survival between ρ and 1: the variance is finite if ρ(K²/(P·p)) < 1, and with p ∝ |K| that radius is near ρ²/P.
fn constant(radius: Radius) -> Roulette {
    Roulette::constant((0.5 * (1.0 + radius.value)).clamp(0.5, 0.9995))
}

/// The depth at which ρ^D falls below 10⁻⁴.
fn depth(radius: Radius) -> Result<u64, Error> {
    if radius.value >= 1.0 {
        return Err(Error::Divergent { radius: radius.value, uncertainty: radius.uncertainty });
    }
    Ok(((1e-4f64.ln() / radius.value.max(1e-3).ln()).ceil() as u64).clamp(4, DEEPEST))
}
