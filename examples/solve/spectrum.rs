//! Files that state λf = Tf: the largest eigenvalue, and its function up to a factor.

use crate::options::Options;
use crate::report::{Comparison, Line, Outcome};
use fredholm::Error;
use fredholm::deterministic::{Eigenpair, Nystrom, eigenpairs};
use fredholm::formula::Eigenproblem;
use fredholm::kernel::{HasDomain, Kernel};
use std::path::Path;
use std::time::Instant;

/// The lines of a file, or `None` if it states no eigenproblem.
pub(crate) fn lines(name: &str, path: &Path, options: &Options) -> Option<Vec<Line>> {
    let problem = Eigenproblem::read(path).ok()?;
    let clock = Instant::now();
    let found = solve(&problem, options.tolerance);
    let (note, result) = match found {
        Ok((note, comparisons)) => (note, Ok(comparisons)),
        Err(e) => (String::new(), Err(e.to_string())),
    };
    let outcome = Outcome { method: "spectrum", seconds: clock.elapsed().as_secs_f64(), note, result };
    let class = problem.class.clone().unwrap_or_else(|| "-".into());
    Some(vec![Line { file: name.into(), class, digits: problem.digits, outcome }])
}

fn solve(problem: &Eigenproblem, tolerance: f64) -> Result<(String, Vec<Comparison>), Error> {
    let pairs = eigenpairs(&problem.kernel(), &Nystrom::adaptive().tolerance(tolerance), 1)?;
    let Some(pair) = pairs.first() else { return Ok(("all eigenvalues are 0".into(), Vec::new())) };
    let mut all = vec![Comparison::deterministic("largest eigenvalue".into(), pair.value().re, pair.error(), problem.largest)];
    all[0].evaluations = pair.evaluations();
    all.extend(
        function(problem, pair).into_iter().map(|(label, value, error, known)| Comparison::deterministic(label, value, error, Some(known))),
    );
    Ok((pair.to_string(), all))
}

/// Label, value, error and reference of the eigenfunction, in the scale of its largest known value.
fn function<K: Kernel<Point = f64> + HasDomain>(problem: &Eigenproblem, pair: &Eigenpair<K>) -> Vec<(String, f64, f64, f64)> {
    let known: Vec<_> = problem.stated.points.iter().filter_map(|k| Some((k, k.value?))).collect();
    let Some((place, largest)) = known.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else { return Vec::new() };
    let scale = largest / pair.eval(place.point).re;
    // φ errs by its residual over the distance to the next eigenvalue, which is of the order of the largest one here
    let error = 16.0 * pair.residual() / pair.value().norm() * scale.abs();
    known.iter().map(|(k, value)| (format!("f({})", k.label), scale * pair.eval(k.point).re, error + 1e-15, *value)).collect()
}
