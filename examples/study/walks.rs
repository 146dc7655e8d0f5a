//! Random walks: root mean square of the true error over seeds.

use crate::any::AnyLine;
use crate::curve::{Curve, Family, Point};
use crate::options::Effort;
use crate::problems::{Case, Plain};
use crate::rules::{AnyEnding, AnyScoring};
use crate::sequences::Any;
use fredholm::formula::{KernelText, SourceText};
use fredholm::kernel::{KernelFn, Operator, Proposed, Tabulated, Transition};
use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Layout, Sequence, Sobol};
use fredholm::source::{Source, SourceFn, TabulatedSource};
use fredholm::transport::Slab;
use fredholm::walk::{ArrayRqmc, FixedDepth, Heuristic, Mis, OwnAbsorption, Roulette};
use fredholm::{Bidirectional, Equation, Error, Estimate, Forward, Walk};
use std::time::Instant;

/// Cells of tables.
const CELLS: usize = 64;
/// Where fixed depths are cut.
const DEPTH: u64 = 8;
/// Randomisations of points that are not independent.
const REPLICATES: u32 = 16;

/// n walks with a seed.
type Solve<'a> = &'a dyn Fn(u64, u64) -> Result<Estimate, Error>;

/// Sizes ×4 from 256 on, until the effort is spent.
pub(crate) struct Sweep<'a> {
    pub effort: Effort,
    pub truth: f64,
    pub scale: f64,
    pub curves: &'a mut Vec<Curve>,
}

impl Sweep<'_> {
    pub(crate) fn run(&mut self, name: &str, family: Family, set_up: f64, solve: Solve<'_>) {
        let mut curve = Curve { set_up, ..Curve::new(name, family) };
        let mut n = 256;
        loop {
            let clock = Instant::now();
            match self.size(n, set_up, solve) {
                Ok(point) => curve.points.push(point),
                Err(e) => {
                    curve.refusal = Some(e.to_string());
                    break;
                }
            }
            n *= 4;
            if clock.elapsed().as_secs_f64() > self.effort.seconds || n > self.effort.walks {
                break;
            }
        }
        self.curves.push(curve);
    }

    fn size(&self, n: u64, set_up: f64, solve: Solve<'_>) -> Result<Point, Error> {
        let seeds = self.effort.seeds;
        let (mut squares, mut evaluations, mut stated, mut seconds) = (0.0, 0.0, 0.0, Vec::new());
        for seed in 0..seeds {
            let clock = Instant::now();
            // no seed twice in a sweep
            let f = solve(n, n * seeds + seed)?;
            seconds.push(clock.elapsed().as_secs_f64());
            squares += ((f.value - self.truth) / self.scale).powi(2) / seeds as f64;
            // walks that are cut know a bound on their bias, or nothing
            let bias = f.truncation.map_or(0.0, |t| t.bias_bound.unwrap_or(f64::NAN));
            stated += ((f.std_error.unwrap_or(f64::NAN) + bias) / self.scale).powi(2) / seeds as f64;
            evaluations += f.evaluations as f64 / seeds as f64;
        }
        seconds.sort_by(f64::total_cmp);
        let seconds = set_up + seconds[seconds.len() / 2];
        Ok(Point { setting: n.to_string(), seconds, evaluations, error: squares.sqrt(), reported: stated.sqrt() })
    }
}

/// Walked by a table, of the source too.
type Table<'a> = Equation<
    SourceFn<AnyLine, SourceText<'a, AnyLine>, f64, TabulatedSource<AnyLine>>,
    Proposed<KernelFn<AnyLine, KernelText<'a, AnyLine>, f64>, Tabulated<AnyLine>>,
>;

fn throughput() -> AnyEnding {
    AnyEnding::Roulette(Roulette::throughput(1.0))
}

/// What the scoring rule evaluates at every vertex, as many as steps and starts.
pub(crate) fn counted(mut f: Estimate, scoring: AnyScoring) -> Estimate {
    f.evaluations += scoring.evaluations() * (f.steps + f.samples());
    f
}

fn mis(heuristic: Heuristic) -> AnyScoring {
    AnyScoring::Mis(Mis(heuristic))
}

/// All walks on a problem.
pub(crate) fn all(case: &Case, effort: Effort) -> Vec<Curve> {
    let ((x, truth), scale) = (case.middle(), case.scale());
    let mut curves = Vec::new();
    let mut sweep = Sweep { effort, truth, scale, curves: &mut curves };
    uniform(case, x, &mut sweep);
    if let Some((ratio, thickness)) = case.slab {
        flights(&Slab::new(thickness).scattering(ratio), x, &mut sweep);
    }
    for (how, guided) in [("table", false), ("guided", true)] {
        let clock = Instant::now();
        match table(case.equation(), guided).and_then(|eq| first(&eq, x).map(|()| eq)) {
            Ok(eq) => tables(&eq, x, how, clock.elapsed().as_secs_f64(), &mut sweep),
            Err(e) => sweep.curves.push(Curve::refused(&format!("walks, {how}"), Family::MonteCarlo, &e)),
        }
    }
    curves
}

/// The spectral radius is known after the first walk: part of the set-up.
pub(crate) fn first<G, K>(eq: &Equation<G, K>, x: G::Point) -> Result<(), Error>
where
    G: Source<Value = f64>,
    K: Transition + Operator<Point = G::Point, Weight = f64>,
{
    eq.at(x).solve(&Walk::collision().samples_per_cell(1)).map(drop)
}

fn table(eq: Plain<'_>, guided: bool) -> Result<Table<'_>, Error> {
    let table = Tabulated::new(eq.kernel().kernel(), CELLS)?;
    eq.with_proposal(if guided { table.guided() } else { table }).tabulated_source(CELLS)
}

fn uniform(case: &Case, x: f64, sweep: &mut Sweep<'_>) {
    let clock = Instant::now();
    let eq = case.equation();
    if let Err(e) = first(&eq, x) {
        return sweep.curves.push(Curve::refused("walks, uniform", Family::MonteCarlo, &e));
    }
    let set_up = clock.elapsed().as_secs_f64();
    for (name, scoring) in [("collision", AnyScoring::Collision), ("next event", AnyScoring::NextEvent), ("MIS", mis(Heuristic::Balance))] {
        let walk = Walk::new(scoring, throughput());
        sweep.run(&format!("{name}, uniform"), Family::MonteCarlo, set_up, &|n, seed| {
            eq.at(x).solve(&walk.samples_per_cell(n).seed(seed)).map(|f| counted(f, scoring))
        });
    }
}

/// Steps and absorption of the slab's own: free flights, no table.
fn flights(slab: &Slab, x: f64, sweep: &mut Sweep<'_>) {
    let clock = Instant::now();
    let eq = Equation::new(slab.uniform(1.0), slab.clone());
    if let Err(e) = first(&eq, x) {
        return sweep.curves.push(Curve::refused("walks, own flights", Family::MonteCarlo, &e));
    }
    let (set_up, balance) = (clock.elapsed().as_secs_f64(), mis(Heuristic::Balance));
    let rules = [
        ("collision", AnyScoring::Collision),
        ("absorption", AnyScoring::Absorption),
        ("next event", AnyScoring::NextEvent),
        ("MIS", balance),
    ];
    for (name, scoring) in rules {
        let walk = Walk::new(scoring, OwnAbsorption);
        sweep.run(&format!("{name}, own flights"), Family::MonteCarlo, set_up, &|n, seed| {
            eq.at(x).solve(&walk.samples_per_cell(n).seed(seed)).map(|f| counted(f, scoring))
        });
    }
}

fn tables(eq: &Table<'_>, x: f64, how: &str, set_up: f64, sweep: &mut Sweep<'_>) {
    let query = eq.at(x);
    let constant = AnyEnding::Roulette(Roulette::constant(0.9));
    let rules = [
        ("collision", AnyScoring::Collision, throughput()),
        ("collision, constant roulette", AnyScoring::Collision, constant),
        ("absorption, constant roulette", AnyScoring::Absorption, constant),
        ("next event", AnyScoring::NextEvent, throughput()),
        ("MIS balance", mis(Heuristic::Balance), throughput()),
        ("MIS power", mis(Heuristic::Power(2.0)), throughput()),
        ("MIS maximum", mis(Heuristic::Maximum), throughput()),
        ("MIS average", mis(Heuristic::Average), throughput()),
        ("fixed depth 8", AnyScoring::Collision, AnyEnding::FixedDepth(FixedDepth(DEPTH))),
    ];
    for (name, scoring, ending) in rules {
        let family = if matches!(ending, AnyEnding::FixedDepth(_)) { Family::Biased } else { Family::MonteCarlo };
        let walk = Walk::new(scoring, ending);
        sweep.run(&format!("{name}, {how}"), family, set_up, &|n, seed| {
            query.solve(&walk.samples_per_cell(n).seed(seed)).map(|f| counted(f, scoring))
        });
    }
    if how == "table" {
        // survival by the row mass, which a guided table does not have
        sweep.run("subcritical, table", Family::MonteCarlo, set_up, &|n, seed| {
            query.solve(&Walk::subcritical().samples_per_cell(n).seed(seed))
        });
        return;
    }
    sequences(eq, x, set_up, sweep);
    sweep.run("forward next event, guided", Family::MonteCarlo, set_up, &|n, seed| query.solve(&Forward::next_event().walks(n).seed(seed)));
    sweep.run("bidirectional, guided", Family::MonteCarlo, set_up, &|n, seed| {
        query.solve(&Bidirectional::new().samples_per_cell(n).seed(seed))
    });
}

/// The guided walk along points that are not independent.
fn sequences(eq: &Table<'_>, x: f64, set_up: f64, sweep: &mut Sweep<'_>) {
    let (query, walk) = (eq.at(x), Walk::new(AnyScoring::Collision, throughput()));
    let mut quasi = |name: &str, solve: Solve<'_>| sweep.run(name, Family::Quasi, set_up, solve);
    let drawn = |sequence: Any, n: u64| walk.sequence(sequence).samples_per_cell(n);
    quasi("collision, guided, Sobol'", &|n, seed| query.solve(&drawn(Any::Sobol(Sobol::new(seed)), n)));
    quasi("collision, guided, Halton", &|n, seed| query.solve(&drawn(Any::Halton(Halton::new(seed)), n)));
    // `Stratified` with the one axis that a step has
    quasi("collision, guided, Latin hypercube", &|n, seed| {
        let rooks = LatinHypercube::new(n / u64::from(REPLICATES))?.replicates(REPLICATES).with_seed(seed);
        query.solve(&drawn(Any::LatinHypercube(rooks), n))
    });
    quasi("collision, guided, Hammersley", &|n, seed| {
        let points = Hammersley::new(n / u64::from(REPLICATES))?.replicates(REPLICATES).with_seed(seed);
        query.solve(&drawn(Any::Hammersley(points), n))
    });
    // a walk needs one number for roulette and one for its step
    let layout = Layout::of_dimension(1).start(0).event(0);
    quasi("Array-RQMC, guided", &|n, seed| query.solve(&ArrayRqmc::new(drawn(Any::Sobol(Sobol::new(seed).layout(layout)), n))));
}
