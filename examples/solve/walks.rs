//! Random walks on a stated equation.

use crate::options::{Options, WalkMethod};
use crate::report::{Comparison, Outcome};
use crate::rules::{AnyEnding, AnyScoring};
use fredholm::detector::{Detector, Points, Start};
use fredholm::domain::Domain;
use fredholm::formula::{KernelText, SourceText, Stated, TextFunctional};
use fredholm::kernel::{
    Absorbing, HasDomain, Kernel, KernelFn, Operator, Proposed, Radius, RowMass, Series, Tabulated, Transition, TransitionPdf, Uniform,
    kernel_fn,
};
use fredholm::sampling::Sampler;
use fredholm::source::{SampleSource, SourceFn, TabulatedSource};
use fredholm::statistics::Verdict;
use fredholm::walk::{Ending, FixedDepth, Heuristic, Mis, Roulette, Scoring};
use fredholm::{Equation, Error, Estimate, Walk};
use std::time::Instant;

/// Cells of the tables that proposals and sources are drawn from.
const CELLS: usize = 128;
/// Cells where those are not enough.
const FINE_CELLS: usize = 512;
/// Largest survival probability of a constant roulette: 200 steps a walk.
const MOST_SURVIVAL: f64 = 0.995;
/// Default numbers of walks for one value: at most, and at least however long they are.
const MOST: u64 = 4096;
const FEWEST: u64 = 512;
/// At most so many times more, where the errors themselves are still uncertain.
const MORE: u64 = 16;
/// Steps for one file and method where walks are long.
const STEPS: f64 = 4e6;
/// Deepest fixed depth.
const DEEPEST: u64 = 256;

/// Why a method was not used, in words.
struct Refusal(String);

impl From<Error> for Refusal {
    fn from(e: Error) -> Self {
        Refusal(e.to_string())
    }
}

type Found = Result<Vec<Comparison>, Refusal>;

/// Every walk asked for, with proposals tabulated from the kernel and the source.
///
/// A finer table is tried where the variance would be infinite with the first.
pub(crate) fn on_a_line<D: Domain>(stated: &Stated<D>, options: &Options) -> Vec<Outcome> {
    let states = stated.domain().states();
    let mut table = guided(stated, CELLS);
    if states * states <= 4 && table.as_ref().is_ok_and(|(_, spread)| !(spread.value < 1.0)) {
        table = guided(stated, FINE_CELLS);
    }
    let runner = Runner { stated, options };
    each(options, |method| {
        if method == WalkMethod::Subcritical {
            let eq = stated.equation().tabulated(CELLS)?;
            finite(squared(eq.kernel(), |x| eq.kernel().mass(x).min(1.0))?)?;
            return runner.run(&eq.tabulated_source(CELLS)?, &Walk::subcritical(), 0);
        }
        let (eq, spread) = table.as_ref().map_err(Clone::clone)?;
        runner.common(eq, *spread, method)
    })
}

/// An equation walked by a guided table.
type Guided<'a, D> =
    Equation<SourceFn<D, SourceText<'a, D>, f64, TabulatedSource<D>>, Proposed<KernelFn<D, KernelText<'a, D>, f64>, Tabulated<D>>>;

/// The equation with a guided table, and the spectral radius of K²/p.
fn guided<D: Domain>(stated: &Stated<D>, cells: usize) -> Result<(Guided<'_, D>, Radius), Error> {
    let eq = stated.equation();
    let table = Tabulated::new(eq.kernel().kernel(), cells)?.guided();
    let eq = eq.with_proposal(table).tabulated_source(cells)?;
    let spread = squared(eq.kernel(), |_| 1.0)?;
    Ok((eq, spread))
}

/// Every walk asked for, with uniform proposals.
pub(crate) fn in_a_box<D: Domain>(stated: &Stated<D>, options: &Options) -> Vec<Outcome> {
    let eq = stated.equation();
    let spread = squared(eq.kernel(), |_| 1.0);
    let runner = Runner { stated, options };
    each(options, |method| runner.common(&eq, spread.clone()?, method))
}

fn each(options: &Options, solve: impl Fn(WalkMethod) -> Found) -> Vec<Outcome> {
    let one = |&(name, method): &(&'static str, WalkMethod)| {
        let clock = Instant::now();
        let result = solve(method).map_err(|Refusal(why)| why);
        Outcome { method: name, seconds: clock.elapsed().as_secs_f64(), note: String::new(), result }
    };
    options.walks.iter().map(one).collect()
}

struct Runner<'a, D: Domain> {
    stated: &'a Stated<D>,
    options: &'a Options,
}

impl<D: Domain> Runner<'_, D> {
    /// `spread` is the spectral radius of K²/p.
    fn common<G, K>(&self, eq: &Equation<G, K>, spread: Radius, method: WalkMethod) -> Found
    where
        G: SampleSource<Point = D::Point, Value = f64>,
        K: Kernel + TransitionPdf + Absorbing + HasDomain + Operator<Point = D::Point, Weight = f64>,
    {
        let depth = match method {
            WalkMethod::FixedDepth => Some(depth(radius(eq.kernel())?, spread)?),
            _ => {
                finite(spread)?;
                None
            }
        };
        let mis = |heuristic| AnyScoring::Mis(Mis(heuristic));
        let scoring = match method {
            WalkMethod::Collision | WalkMethod::Roulette | WalkMethod::FixedDepth => AnyScoring::Collision,
            WalkMethod::Absorption => AnyScoring::Absorption,
            WalkMethod::NextEvent => AnyScoring::NextEvent,
            WalkMethod::Mis => mis(Heuristic::Balance),
            WalkMethod::MisPower => mis(Heuristic::Power(2.0)),
            WalkMethod::MisMaximum => mis(Heuristic::Maximum),
            WalkMethod::MisAverage => mis(Heuristic::Average),
            WalkMethod::Subcritical => {
                return Err(Refusal("subcritical walks need the row mass ∫|K|, which is measured on one-dimensional domains only".into()));
            }
        };
        let ending = match (method, depth) {
            (_, Some(depth)) => AnyEnding::FixedDepth(FixedDepth(depth)),
            (WalkMethod::Roulette | WalkMethod::Absorption, _) => AnyEnding::Roulette(constant(spread)?),
            _ => AnyEnding::Roulette(Roulette::throughput(1.0)),
        };
        self.run(eq, &Walk::new(scoring, ending), scoring.evaluations())
    }

    /// As asked; else 4096, or fewer where walks are known to be long before the first is run.
    fn samples<K: Operator>(&self, kernel: &K) -> Result<u64, Refusal> {
        if let Some(samples) = self.options.samples {
            return Ok(samples);
        }
        let length = 1.0 / (1.0 - radius(kernel)?.value).max(1e-5);
        let cells = (self.stated.points.len() + self.stated.functionals.len()) as f64;
        Ok(((STEPS / (cells * length)) as u64).clamp(FEWEST, MOST))
    }

    /// The walk with the samples asked for; else with the default, and fourfold while the errors themselves are uncertain. Its scoring costs `evaluations` at
    /// every vertex.
    fn run<G, K, C, E>(&self, eq: &Equation<G, K>, walk: &Walk<C, E>, evaluations: u64) -> Found
    where
        G: SampleSource<Point = D::Point, Value = f64>,
        K: Transition + Operator<Point = D::Point, Weight = f64>,
        C: Scoring<G, K>,
        E: Ending<K>,
    {
        let fewest = self.samples(eq.kernel())?;
        let most = if self.options.samples.is_some() { fewest } else { MORE * fewest };
        let mut samples = fewest;
        loop {
            let mut found = self.once(eq, &walk.samples_per_cell(samples).seed(self.options.seed))?;
            // as many vertices as steps and starts
            found.iter_mut().for_each(|c| c.evaluations += evaluations * (c.evaluations + samples));
            if samples >= most || found.iter().all(|c| c.refusal.is_none()) {
                return Ok(found);
            }
            samples *= 4;
        }
    }

    fn once<G, K, C, E>(&self, eq: &Equation<G, K>, walk: &Walk<C, E>) -> Found
    where
        G: SampleSource<Point = D::Point, Value = f64>,
        K: Transition + Operator<Point = D::Point, Weight = f64>,
        C: Scoring<G, K>,
        E: Ending<K>,
    {
        let points = Asked::<D>::Points(Points(self.stated.points.iter().map(|p| p.point).collect()));
        let estimates = eq.seen_by(&points).solve(walk)?;
        let known = self.stated.points.iter();
        let mut found: Vec<_> = estimates.iter().zip(known).map(|(e, k)| comparison(e, &format!("x = {}", k.label), k.value)).collect();
        for (i, functional) in self.stated.functionals.iter().enumerate() {
            // other walks than those of the points, and than those of other functionals
            let walk = walk.seed(self.options.seed.wrapping_add(1 + i as u64));
            let estimates = eq.seen_by(&Asked::Functional(functional.detector()?)).solve(&walk)?;
            found.extend(estimates.iter().map(|e| comparison(e, &format!("∫ f·({})", functional.label), functional.value)));
        }
        Ok(found)
    }
}

/// What a file asks for, as one type: every walk is then compiled once a domain.
enum Asked<'a, D: Domain> {
    Points(Points<D::Point>),
    Functional(TextFunctional<'a, D>),
}

impl<D: Domain> Detector for Asked<'_, D> {
    type Point = D::Point;
    type Answer<T> = Vec<T>;
    fn cells(&self) -> usize {
        match self {
            Asked::Points(points) => points.cells(),
            Asked::Functional(functional) => functional.cells(),
        }
    }
    fn start<S: Sampler>(&self, cell: usize, u: &mut S) -> Start<D::Point> {
        match self {
            Asked::Points(points) => points.start(cell, u),
            Asked::Functional(functional) => functional.start(cell, u),
        }
    }
    fn norm(&self) -> Option<f64> {
        match self {
            Asked::Points(points) => points.norm(),
            Asked::Functional(functional) => functional.norm(),
        }
    }
    fn answer<T>(&self, cells: Vec<T>) -> Vec<T> {
        cells
    }
}

fn comparison(estimate: &Estimate<f64>, label: &str, reference: Option<f64>) -> Comparison {
    let bias = estimate.truncation.map_or(Some(0.0), |t| t.bias_bound);
    let refusal = match estimate.verdict() {
        // scores that are all exactly zero say nothing, unless nothing is the answer
        Verdict::NothingScored if reference == Some(0.0) => None,
        verdict @ (Verdict::InfiniteVariance | Verdict::NothingScored | Verdict::Doubtful) => Some(verdict.to_string()),
        _ if estimate.std_error.is_none() => Some("no standard error: a single walk".into()),
        _ if bias.is_none() => Some("no bound of the truncation bias is known".into()),
        _ => None,
    };
    Comparison {
        label: label.into(),
        value: estimate.value,
        error: estimate.std_error.unwrap_or(f64::INFINITY),
        freedom: Some(estimate.degrees_of_freedom),
        bias: bias.unwrap_or(f64::INFINITY),
        reference,
        evaluations: estimate.evaluations,
        refusal,
    }
}

/// Spectral radius of |T|; refused where the series diverges.
fn radius<K: Operator>(kernel: &K) -> Result<Radius, Error> {
    match kernel.series()? {
        Series::Known(s) if s.radius().diverges() => {
            Err(Error::Divergent { radius: s.radius().value, uncertainty: s.radius().uncertainty })
        }
        Series::Known(s) => Ok(s.radius()),
        Series::Unknown => Ok(Radius { value: 1.0, uncertainty: 1.0 }),
    }
}

/// Spectral radius of K²/(P·p), which must be below 1 for a finite variance (theory (4.3.1)), where walks survive with probability P(x).
fn squared<K>(kernel: &K, survival: impl Fn(&K::Point) -> f64 + Send + Sync) -> Result<Radius, Error>
where
    K: Kernel + TransitionPdf + HasDomain + Operator<Weight = f64>,
{
    radius(kernel)?;
    let square = kernel_fn(kernel.domain().clone(), |x: &K::Point, y: &K::Point| {
        let k = kernel.eval(x, y);
        if k == 0.0 { 0.0 } else { k * k / (kernel.pdf(x, y) * survival(x)) }
    });
    match Proposed::new(square, Uniform::on(kernel.domain().clone())).series()? {
        Series::Known(s) => Ok(s.radius()),
        Series::Unknown => Ok(Radius { value: 1.0, uncertainty: 1.0 }),
    }
}

/// Refuses walks whose variance is known to be infinite.
fn finite(radius: Radius) -> Result<Radius, Refusal> {
    if radius.diverges() {
        return Err(Refusal(format!(
            "infinite variance: the spectral radius of K²/π is {:.4} ± {:.0e} ≥ 1",
            radius.value, radius.uncertainty
        )));
    }
    Ok(radius)
}

/// Survival half-way between the least that keeps the variance finite, ρ(K²/p), and 1; at most `MOST_SURVIVAL`.
fn constant(squared: Radius) -> Result<Roulette, Refusal> {
    let survival = (0.5 * (1.0 + squared.value)).clamp(0.5, MOST_SURVIVAL);
    finite(Radius { value: squared.value / survival, ..squared })?;
    Ok(Roulette::constant(survival))
}

/// The depth at which ρ^D falls below 10⁻⁴, unless the variance, which grows like ρ(K²/p)^D, is a hundredfold before.
fn depth(radius: Radius, squared: Radius) -> Result<u64, Error> {
    if radius.value >= 1.0 {
        return Err(Error::Divergent { radius: radius.value, uncertainty: radius.uncertainty });
    }
    let small_bias = (1e-4f64.ln() / radius.value.max(1e-3).ln()).ceil();
    let small_variance = if squared.value > 1.0 { 100f64.ln() / squared.value.ln() } else { f64::INFINITY };
    Ok((small_bias.min(small_variance) as u64).clamp(4, DEEPEST))
}
