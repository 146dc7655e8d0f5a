//! Many dimensions: products of one-dimensional kernels on the unit cube, where only walks go.

use crate::curve::Family;
use crate::options::Effort;
use crate::problem::Problem;
use crate::rules::{AnyEnding, AnyScoring};
use crate::sequences::Any;
use crate::walks::{Sweep, counted, first};
use fredholm::domain::Cuboid;
use fredholm::formula::{self, Known, Stated, Statement};
use fredholm::sampling::{Pcg, Sobol};
use fredholm::walk::{Heuristic, Mis, Roulette};
use fredholm::{Equation, Walk};
use std::path::Path;
use std::time::Instant;

/// K and g.
type K = dyn Fn(&[f64], &[f64]) -> f64 + Send + Sync;
type G = dyn Fn(&[f64]) -> f64 + Send + Sync;

/// The names of these problems.
pub(crate) const NAMES: [&str; 4] =
    ["highd-5-gaussian-g1", "highd-5-separable-manufactured", "highd-20-gaussian-g1", "highd-20-separable-manufactured"];

/// One of them.
pub(crate) fn problem(name: &str, effort: Effort) -> Result<Problem, String> {
    let product = |l: f64, k: fn(f64, f64) -> f64| move |x: &[f64], y: &[f64]| l * x.iter().zip(y).map(|(x, y)| k(*x, *y)).product::<f64>();
    let manufactured = |l: f64| {
        move |x: &[f64]| {
            let f: f64 = x.iter().map(|x| x.exp()).product();
            f - l * x.iter().map(|x| (x + 1.0).exp_m1() / (x + 1.0)).product::<f64>()
        }
    };
    let gauss = |x: f64, y: f64| (-(x - y) * (x - y)).exp();
    let exp = |x: f64, y: f64| (x * y).exp();
    match name {
        "highd-5-gaussian-g1" => on::<5>(name, &product(1.5, gauss), &|_| 1.0, effort),
        "highd-5-separable-manufactured" => on::<5>(name, &product(0.1, exp), &manufactured(0.1), effort),
        "highd-20-gaussian-g1" => on::<20>(name, &product(12.0, gauss), &|_| 1.0, effort),
        _ => on::<20>(name, &product(0.0015, exp), &manufactured(0.0015), effort),
    }
}

fn on<const D: usize>(name: &str, kernel: &K, source: &G, effort: Effort) -> Result<Problem, String> {
    let (x, truth) = known::<D>(name, kernel, source)?;
    let clock = Instant::now();
    let eq = Equation::on_domain(Cuboid::<D>::unit(), |x: &[f64; D]| source(x), |x: &[f64; D], y: &[f64; D]| kernel(x, y));
    first(&eq, x).map_err(|e| e.to_string())?;
    let (set_up, query) = (clock.elapsed().as_secs_f64(), eq.at(x));
    let mut curves = Vec::new();
    let mut sweep = Sweep { effort, truth, scale: truth.abs(), curves: &mut curves };
    let rules =
        [("collision", AnyScoring::Collision), ("next event", AnyScoring::NextEvent), ("MIS", AnyScoring::Mis(Mis(Heuristic::Balance)))];
    for (rule, scoring) in rules {
        let walk = Walk::new(scoring, AnyEnding::Roulette(Roulette::throughput(1.0)));
        let sequences: [(&str, Family, fn(u64) -> Any); 2] = [
            ("uniform", Family::MonteCarlo, |seed| Any::Pcg(Pcg::new(seed))),
            ("uniform, Sobol'", Family::Quasi, |seed| Any::Sobol(Sobol::new(seed))),
        ];
        for (how, family, sequence) in sequences {
            sweep.run(&format!("{rule}, {how}"), family, set_up, &|n, seed| {
                query.solve(&walk.sequence(sequence(seed)).samples_per_cell(n)).map(|f| counted(f, scoring))
            });
        }
    }
    Ok(Problem { name: name.into(), class: format!("{D} dimensions"), curves })
}

/// The first point of the file and f there, if its formulas are these.
fn known<const D: usize>(name: &str, kernel: &K, source: &G) -> Result<([f64; D], f64), String> {
    let path = Path::new("tests/data/reference").join(format!("{name}.json"));
    let problem = formula::Problem::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    // f, K and g of the file; coordinates beyond D are its own
    let (points, values): (Vec<Vec<f64>>, Vec<[f64; 3]>) = match &problem.statement {
        Statement::Box8(s) => facts(s),
        Statement::Box64(s) => facts(s),
        _ => return Err(format!("{name}: not a problem of many dimensions")),
    };
    let ours = |x: &[f64]| [kernel(&x[..D], &points[0][..D]), source(&x[..D])];
    let differ = |a: f64, b: f64| !((a - b).abs() <= 1e-12 * a.abs());
    if points.iter().zip(&values).any(|(x, v)| ours(x).iter().zip(&v[1..]).any(|(a, b)| differ(*a, *b))) {
        return Err(format!("{name}: the compiled formulas are not those of the file"));
    }
    match values[0][0] {
        f if f.is_finite() => Ok((std::array::from_fn(|i| points[0][i]), f)),
        _ => Err(format!("{name}: no value of f is known")),
    }
}

/// Points of a file with f, K towards the first, and g.
fn facts<const D: usize>(stated: &Stated<Cuboid<D>>) -> (Vec<Vec<f64>>, Vec<[f64; 3]>) {
    let first = &stated.points[0].point;
    let of = |k: &Known<[f64; D]>| [k.value.unwrap_or(f64::NAN), stated.kernel(&k.point, first), stated.source(&k.point)];
    stated.points.iter().map(|k| (k.point.to_vec(), of(k))).unzip()
}
