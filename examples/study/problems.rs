//! The problems: equations as text with their known solutions, and the same formulas compiled, so that times are those of a program and not of an
//! interpreter.

use crate::any::AnyLine;
use crate::boxes;
use crate::scenes::SCENES;
use fredholm::deterministic::Nystrom;
use fredholm::domain::Domain;
use fredholm::formula::{KernelText, Problem, Stated, Statement, TextEquation};
use fredholm::special::e1;
use fredholm::{Equation, Error};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

type G = Box<dyn Fn(&f64) -> f64 + Send + Sync>;
type K = Box<dyn Fn(&f64, &f64) -> f64 + Send + Sync>;

/// One type for all problems, so that every method is compiled once: what text becomes.
pub(crate) type Plain<'a> = TextEquation<'a, AnyLine>;

/// A problem on a line.
pub(crate) struct Case {
    pub name: String,
    /// What makes it hard, in a word.
    pub class: String,
    /// How the other programs call it.
    pub peer: &'static str,
    /// c and a, if it is a slab, which has steps of its own.
    pub slab: Option<(f64, f64)>,
    domain: AnyLine,
    source: G,
    kernel: K,
    /// Points and values of f.
    pub known: Vec<(f64, f64)>,
}

impl Case {
    pub(crate) fn equation(&self) -> Plain<'_> {
        Equation::on_domain(self.domain, &*self.source, &*self.kernel)
    }

    /// Values of the kernel that `solve` asks for, all of them: of assembly, choosing panels, checks and interpolation.
    pub(crate) fn evaluations(&self, solve: impl FnOnce(Plain<'_>)) -> u64 {
        let count = AtomicU64::new(0);
        let kernel = |x: &f64, y: &f64| {
            count.fetch_add(1, Ordering::Relaxed);
            (self.kernel)(x, y)
        };
        let kernel: KernelText<'_, AnyLine> = &kernel;
        solve(Equation::on_domain(self.domain, &*self.source, kernel));
        count.into_inner()
    }

    /// Largest known |f|: errors are relative to it.
    pub(crate) fn scale(&self) -> f64 {
        self.known.iter().fold(0.0, |m: f64, k| m.max(k.1.abs()))
    }

    /// Values of f at `points`, or at five of the domain if there are none, by the tightest adaptive solve that succeeds; errors below its own mean nothing.
    fn solve(&mut self, points: &[f64]) -> Result<(), Error> {
        let five = || [0.1, 0.3, 0.5, 0.7, 0.9].map(|s| self.domain.place(0, || s).point).to_vec();
        let points = if points.is_empty() { five() } else { points.to_vec() };
        let (equation, solve) = (self.equation(), |t: f64| Nystrom::adaptive().tolerance(t));
        let f = equation.solve(&solve(1e-12)).or_else(|_| equation.solve(&solve(1e-9))).or_else(|_| equation.solve(&solve(1e-6)))?;
        let known = points.iter().map(|x| Ok((*x, f.try_eval(x)?))).collect::<Result<_, Error>>()?;
        let class = format!("{}; f by an adaptive solve ± {:.0e}", self.class, f.error_estimate().unwrap_or(f64::NAN));
        (self.known, self.class) = (known, class);
        Ok(())
    }

    /// The point where walks start.
    pub(crate) fn middle(&self) -> (f64, f64) {
        self.known[self.known.len() / 2]
    }
}

/// Reference file, name among the other programs, K, g.
type Row = (&'static str, &'static str, K, G);

#[rustfmt::skip]
fn compiled() -> Vec<Row> {
    fn row(name: &'static str, peer: &'static str, k: impl Fn(f64, f64) -> f64 + Send + Sync + 'static, g: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Row {
        (name, peer, Box::new(move |x, y| k(*x, *y)), Box::new(move |x| g(*x)))
    }
    let one = |_| 1.0;
    let peak = |d: f64| move |x: f64, y: f64| d / (PI * (d * d + (x - y) * (x - y)));
    let slab = |c: f64| move |x: f64, y: f64| 0.5 * c * e1((x - y).abs());
    vec![
        row("expxy-manufactured-lam0.5", "a exp(xy) lam=0.5", |x, y| 0.5 * (x * y).exp(), |x| x.exp() - 0.5 * (x + 1.0).exp_m1() / (x + 1.0)),
        row("gaussian-nearcritical-0.99", "", |x, y| 1.144718 * (-(x - y) * (x - y)).exp(), f64::exp),
        row("osc-cos-w10-lam1.2", "", |x, y| 1.2 * (10.0 * (x - y)).cos(), one),
        row("love-plus-d1", "b Love d=1.0", peak(1.0), one),
        row("love-plus-d0.1", "b Love d=0.1", peak(0.1), one),
        row("green-bridge-lam5", "c Green lam=5", |x, y| 5.0 * (x.min(y) - x * y), one),
        row("volterra-step-lam1", "", |x, y| f64::from(x > y), one),
        row("abel-1over2-g1-lam0.2", "d1 0.2|t|^-1/2", |x, y| 0.2 / (x - y).abs().sqrt(), one),
        row("log-g1-lam-0.5", "", |x, y| -0.5 * (x - y).abs().ln(), one),
        row("slab-c0.9-a1-uniform", "e Peierls a=1 c=0.9", slab(0.9), one),
        row("slab-c0.9-a10-uniform", "e Peierls a=10 c=0.9", slab(0.9), one),
        row("slab-c0.99-a10-uniform", "e Peierls a=10 c=0.99", slab(0.99), one),
        row("halfline-exp-lam0.3", "", |x, y| 0.3 * (-(x - y).abs()).exp(), one),
    ]
}

/// c and a of the slabs.
const SLABS: [(&str, (f64, f64)); 3] =
    [("slab-c0.9-a1-uniform", (0.9, 1.0)), ("slab-c0.9-a10-uniform", (0.9, 10.0)), ("slab-c0.99-a10-uniform", (0.99, 10.0))];

/// Those asked for by name or by file; all that are compiled, if none is.
pub(crate) fn cases(names: &[String]) -> Result<Vec<Case>, String> {
    let rows = compiled();
    let wanted = |row: &Row| names.is_empty() || names.iter().any(|n| n == row.0);
    let all: Vec<_> = rows.iter().map(|r| r.0).chain(boxes::NAMES).chain(SCENES.iter().map(|s| s.name)).collect();
    if let Some(unknown) = names.iter().find(|n| !n.ends_with(".json") && !all.contains(&n.as_str())) {
        return Err(format!("unknown problem {unknown}: a file.json, or one of {}", all.join(" ")));
    }
    let mut cases = Vec::new();
    for (name, peer, kernel, source) in rows.into_iter().filter(wanted) {
        let stated = read(&Path::new("tests/data/reference").join(format!("{name}.json")))?;
        same(&stated.0, name, &kernel, &source)?;
        let slab = SLABS.iter().find(|s| s.0 == name).map(|s| s.1);
        cases.push(Case { slab, ..case(stated, peer, source, kernel)? });
    }
    for file in names.iter().filter(|n| n.ends_with(".json")) {
        let stated = read(Path::new(file))?;
        let (s, k) = (stated.0.clone(), stated.0.clone());
        cases.push(case(stated, "", Box::new(move |x| s.source(x)), Box::new(move |x, y| k.kernel(x, y)))?);
    }
    Ok(cases)
}

fn read(path: &Path) -> Result<(Stated<AnyLine>, Problem), String> {
    let problem = Problem::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let stated = match &problem.statement {
        Statement::Interval(s) => s.on((*s.domain()).into()),
        Statement::HalfLine(s) => s.on((*s.domain()).into()),
        Statement::Line(s) => s.on((*s.domain()).into()),
        _ => return Err(format!("{}: only scalar equations on a line are studied", path.display())),
    };
    Ok((stated, problem))
}

fn case((stated, problem): (Stated<AnyLine>, Problem), peer: &'static str, source: G, kernel: K) -> Result<Case, String> {
    let known = stated.points.iter().filter_map(|k| Some((k.point, k.value?))).collect();
    let class = problem.class.unwrap_or_else(|| "-".into());
    let mut case = Case { name: problem.name, class, peer, slab: None, domain: *stated.domain(), source, kernel, known };
    if case.known.is_empty() {
        let points: Vec<_> = stated.points.iter().map(|k| k.point).collect();
        case.solve(&points).map_err(|e| format!("{}: no value of f is known, and the adaptive solve finds none: {e}", case.name))?;
    }
    if !(case.scale() > 0.0) {
        return Err(format!("{}: f is 0 wherever it is known: there are no relative errors", case.name));
    }
    Ok(case)
}

/// Formulas typed twice must be the same.
fn same(stated: &Stated<AnyLine>, name: &str, kernel: &K, source: &G) -> Result<(), String> {
    let points = [0.1, 0.3, 0.45, 0.8];
    let differ = |a: f64, b: f64| !((a - b).abs() <= 1e-12 * a.abs().max(1e-3));
    for x in points {
        for y in points.map(|y| y + 0.07) {
            if differ(stated.kernel(&x, &y), kernel(&x, &y)) || differ(stated.source(&x), source(&x)) {
                return Err(format!("{name}: the compiled formulas are not those of the file at x = {x}, y = {y}"));
            }
        }
    }
    Ok(())
}
