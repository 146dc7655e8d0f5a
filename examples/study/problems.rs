//! The problems: equations as text with their known solutions, and the same formulas compiled, so that times are those of a program and not of an
//! interpreter.

use crate::any::AnyLine;
use crate::boxes::NAMES;
use fredholm::Equation;
use fredholm::formula::{Problem, Stated, Statement, TextEquation};
use fredholm::special::e1;
use std::f64::consts::PI;
use std::path::Path;

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

    /// Largest known |f|: errors are relative to it.
    pub(crate) fn scale(&self) -> f64 {
        self.known.iter().fold(0.0, |m: f64, k| m.max(k.1.abs()))
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
        row("slab-c0.9-a1-uniform", "e Peierls a=1 c=0.9", slab(0.9), one),
        row("slab-c0.9-a10-uniform", "e Peierls a=10 c=0.9", slab(0.9), one),
        row("slab-c0.99-a10-uniform", "e Peierls a=10 c=0.99", slab(0.99), one),
        row("halfline-exp-lam0.3", "", |x, y| 0.3 * (-(x - y).abs()).exp(), one),
    ]
}

/// Those asked for by name or by file; all that are compiled, if none is.
pub(crate) fn cases(names: &[String]) -> Result<Vec<Case>, String> {
    let rows = compiled();
    let wanted = |row: &Row| names.is_empty() || names.iter().any(|n| n == row.0);
    if let Some(unknown) = names.iter().find(|n| !n.ends_with(".json") && !NAMES.contains(&n.as_str()) && !rows.iter().any(|r| r.0 == **n))
    {
        let all: Vec<_> = rows.iter().map(|r| r.0).chain(NAMES).collect();
        return Err(format!("unknown problem {unknown}: a file.json, or one of {}", all.join(" ")));
    }
    let mut cases = Vec::new();
    for (name, peer, kernel, source) in rows.into_iter().filter(wanted) {
        let stated = read(&Path::new("tests/data/reference").join(format!("{name}.json")))?;
        same(&stated.0, name, &kernel, &source)?;
        cases.push(case(stated, peer, source, kernel)?);
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
    let known: Vec<_> = stated.points.iter().filter_map(|k| Some((k.point, k.value?))).collect();
    if known.is_empty() {
        return Err(format!("{}: no value of f is known: nothing to compare with", problem.name));
    }
    let class = problem.class.unwrap_or_else(|| "-".into());
    Ok(Case { name: problem.name, class, peer, domain: *stated.domain(), source, kernel, known })
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
