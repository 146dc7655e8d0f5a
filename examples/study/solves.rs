//! Deterministic solves: the largest true error over the known points.

use crate::curve::{Curve, Family, Point};
use crate::options::Effort;
use crate::problems::{Case, Plain};
use fredholm::Error;
use fredholm::deterministic::{Collocation, Galerkin, Nystrom};
use std::time::Instant;

/// Runs beyond so many seconds are timed once.
const LONG: f64 = 0.2;

/// What a solve found: f at the known points, its own word on the error.
struct Found {
    values: Vec<f64>,
    reported: Option<f64>,
}

type Solve<'a> = Box<dyn Fn(Plain<'_>) -> Result<Found, Error> + 'a>;

fn nystrom<'a>(case: &'a Case, settings: Nystrom) -> Solve<'a> {
    Box::new(move |equation| {
        let f = equation.solve(&settings)?;
        let values = case.known.iter().map(|(x, _)| f.try_eval(x)).collect::<Result<_, _>>()?;
        Ok(Found { values, reported: f.error_estimate() })
    })
}

fn galerkin<'a>(case: &'a Case, settings: Galerkin) -> Solve<'a> {
    Box::new(move |equation| {
        let f = equation.solve(&settings)?;
        let values = case.known.iter().map(|(x, _)| f.iterated(*x)).collect::<Result<_, _>>()?;
        Ok(Found { values, reported: None })
    })
}

fn collocation<'a>(case: &'a Case, settings: Collocation) -> Solve<'a> {
    Box::new(move |equation| {
        let f = equation.solve(&settings)?;
        let values = case.known.iter().map(|(x, _)| f.iterated(*x)).collect::<Result<_, _>>()?;
        Ok(Found { values, reported: None })
    })
}

/// All solves of a problem.
pub(crate) fn all<'a>(case: &'a Case, effort: Effort) -> Vec<Curve> {
    let adaptive = |t: f64| (format!("{t:e}"), nystrom(case, Nystrom::adaptive().tolerance(t)));
    // panels or elements ×2, as long as there are not too many unknowns
    let sizes = |each: usize| {
        let first = if each == 1 { 4 } else { 1 };
        std::iter::successors(Some(first), |n| Some(2 * n)).take_while(move |n| n * each <= effort.unknowns)
    };
    let fixed = |name: &str, each: usize, solve: &dyn Fn(usize) -> Solve<'a>| {
        curve(name, case, sizes(each).map(|n| ((n * each).to_string(), solve(n))))
    };
    vec![
        curve("Nyström adaptive", case, [1e-2, 1e-4, 1e-6, 1e-9, 1e-12].into_iter().map(adaptive)),
        fixed("Nyström Gauss", 1, &|n| nystrom(case, Nystrom::gauss_legendre(n))),
        fixed("Nyström composite, 8 a panel", 8, &|n| nystrom(case, Nystrom::composite(n, 8))),
        fixed("Nyström graded, 12 a panel", 12, &|n| nystrom(case, Nystrom::graded(n, 12))),
        fixed("Galerkin, degree 1", 2, &|n| galerkin(case, Galerkin::elements(n).degree(1))),
        fixed("Galerkin, degree 3", 4, &|n| galerkin(case, Galerkin::elements(n).degree(3))),
        fixed("collocation, degree 3", 4, &|n| collocation(case, Collocation::elements(n).degree(3))),
    ]
}

/// Every setting; the refusal of the last that was refused.
fn curve<'a>(name: &str, case: &Case, settings: impl Iterator<Item = (String, Solve<'a>)>) -> Curve {
    let mut curve = Curve::new(name, Family::Deterministic);
    for (setting, solve) in settings {
        match timed(case, &solve) {
            Ok((seconds, found)) => {
                let evaluations = case.evaluations(|equation| drop(solve(equation))) as f64;
                let scale = case.scale();
                let error = case.known.iter().zip(&found.values).fold(0.0, |m: f64, (k, v)| m.max((v - k.1).abs())) / scale;
                let reported = found.reported.map_or(f64::NAN, |e| e / scale);
                curve.points.push(Point { setting, seconds, evaluations, error, reported });
            }
            Err(e) => curve.refusal = Some(format!("{setting}: {e}")),
        }
    }
    curve
}

/// Median seconds of up to five runs.
fn timed(case: &Case, solve: &Solve<'_>) -> Result<(f64, Found), Error> {
    let mut seconds = Vec::new();
    loop {
        let clock = Instant::now();
        let found = solve(case.equation())?;
        seconds.push(clock.elapsed().as_secs_f64());
        if seconds.len() == 5 || seconds.iter().sum::<f64>() > LONG {
            seconds.sort_by(f64::total_cmp);
            return Ok((seconds[seconds.len() / 2], found));
        }
    }
}
