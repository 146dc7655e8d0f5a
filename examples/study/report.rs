//! CSV, plots and the Markdown tables.

use crate::curve::{Curve, Point, Reach};
use crate::problem::{Problem, TARGETS, is_walk};
use crate::scenes::CLASS;
use fredholm::Error;
use fredholm::plot::Convergence;
use std::fmt::Write;
use std::path::Path;

/// Every number.
pub(crate) fn csv(problems: &[Problem]) -> String {
    let mut out = String::from("problem,class,method,family,setting,set_up_s,seconds,evaluations,error,reported,refusal\n");
    let quote = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    for (p, c) in problems.iter().flat_map(|p| p.curves.iter().map(move |c| (p, c))) {
        let head = format!("{},{},{},{:?}", quote(&p.name), quote(&p.class), quote(&c.method), c.family);
        for q in &c.points {
            let _ =
                writeln!(out, "{head},{},{:e},{:e},{:e},{:e},{:e},", q.setting, c.set_up, q.seconds, q.evaluations, q.error, q.reported);
        }
        if let Some(why) = &c.refusal {
            let _ = writeln!(out, "{head},,,,,,,{}", quote(why));
        }
    }
    out
}

/// A name as that of a file: letters, digits and what is harmless of the rest.
fn file(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
}

/// Text in a cell of a Markdown table.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

const SUBTITLE: &str = "set-up included; walks: root mean square over seeds, solves: largest error";
/// Curves that a legend has room for.
const MOST: usize = 17;

/// Error against time for the best of every family, error against evaluations for the most efficient walks.
pub(crate) fn plots(problem: &Problem, folder: &Path) -> Result<(), Error> {
    let overview = problem.overview();
    let finite = |v: f64| v.is_finite() && v > 0.0;
    let draw = |plot: Convergence, curves: &[&Curve], cost: fn(&Point) -> f64, which: &str| {
        let points = |c: &Curve| c.points.iter().map(|p| (cost(p), p.error)).filter(|p| finite(p.0) && p.1.is_finite()).collect::<Vec<_>>();
        let drawn: Vec<_> = curves.iter().map(|c| (&c.method, points(c))).filter(|(_, points)| !points.is_empty()).collect();
        // nothing to draw: every method refused, or none has an error
        if !drawn.iter().any(|(_, points)| points.iter().any(|p| p.1 > 0.0)) {
            return Ok(());
        }
        let plot = drawn.into_iter().fold(plot, |plot, (method, points)| plot.series(method, points));
        plot.save(folder.join(format!("{}-{which}.png", file(&problem.name))))
    };
    let title = format!("{} ({})", problem.name, problem.class);
    let how = if problem.class == CLASS { "one run a point: root mean square over pixels" } else { SUBTITLE };
    let time = Convergence::against_time(&title).subtitle(how);
    draw(time.error_label("relative error").slopes(&[-0.5]), &overview, |p| p.seconds, "time")?;
    // error · √evaluations at the largest size
    let constant = |c: &Curve| c.points.last().map_or(f64::INFINITY, |p| p.error * p.evaluations.sqrt());
    let mut walks: Vec<_> = problem.curves.iter().filter(|c| is_walk(c) && !c.points.is_empty()).collect();
    walks.sort_by(|a, b| constant(a).total_cmp(&constant(b)));
    walks.truncate(MOST);
    let subtitle = format!("the {} most efficient walks, best first; without what the set-up evaluates", walks.len());
    let work = Convergence::against(&title, "evaluations of the kernel").subtitle(&subtitle);
    draw(work.error_label("relative error").slopes(&[-0.5]), &walks, |p| p.evaluations, "walks")
}

fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-3 => format!("{:.3} ms", 1e3 * s),
        s if s < 1.0 => format!("{:.2} ms", 1e3 * s),
        s if s < 1e3 => format!("{s:.2} s"),
        s if s < 1e5 => format!("{:.0} h", (s / 3600.0).max(1.0)),
        s => format!("{s:.0e} s"),
    }
}

fn cell(found: Option<(&Curve, Reach)>) -> String {
    match found {
        None => "–".into(),
        Some((c, Reach::Measured(s))) => format!("{}, {}", c.method, seconds(s)),
        Some((c, Reach::Continued(s))) => format!("*{}, ≈ {}*", c.method, seconds(s)),
    }
}

/// Seconds a method needs to an error.
type Needs = fn(&Curve, f64) -> Option<Reach>;

fn fastest(out: &mut String, title: &str, problems: &[Problem], needs: Needs) {
    let head = TARGETS.map(|t| format!(" {t:.0e} |")).concat();
    let _ = writeln!(out, "{title}\n\n| problem | class |{head}\n|---|---|{}", "---|".repeat(TARGETS.len()));
    for p in problems {
        let cells = TARGETS.map(|t| format!(" {} |", cell(p.fastest(|c| needs(c, t)))));
        let _ = writeln!(out, "| {} | {} |{}", escaped(&p.name), escaped(&p.class), cells.concat());
    }
    out.push('\n');
}

/// «Fastest method to reach …» for every problem, and what else is to be said.
pub(crate) fn table(problems: &[Problem]) -> String {
    let mut out = String::from("Relative errors; set-up included; *≈: continued from the largest size with the slope −½*.\n\n");
    fastest(&mut out, "Fastest of all settings that were accurate enough", problems, Curve::seconds_to);
    fastest(&mut out, "Fastest that *knew* to be accurate enough: by the error it reports", problems, Curve::seconds_to_known);
    fastest(&mut out, "Fastest walk", problems, |c, t| if is_walk(c) { c.seconds_to(t) } else { None });
    details(&mut out, problems);
    out
}

fn details(out: &mut String, problems: &[Problem]) {
    *out += "Slopes of ln error against ln evaluations\n\n| problem | method | slope |\n|---|---|---|\n";
    for (p, c) in problems.iter().flat_map(|p| p.curves.iter().filter(|c| is_walk(c)).map(move |c| (p, c))) {
        if let Some((slope, error)) = c.slope() {
            let _ = writeln!(out, "| {} | {} | {slope:.2} ± {error:.2} |", escaped(&p.name), c.method);
        }
    }
    *out += "\nRefused\n\n| problem | method | why |\n|---|---|---|\n";
    for (p, c) in problems.iter().flat_map(|p| p.curves.iter().map(move |c| (p, c))) {
        if let Some(why) = &c.refusal {
            let _ = writeln!(out, "| {} | {} | {} |", escaped(&p.name), c.method, escaped(why));
        }
    }
}

/// Deterministic solves whose true error is larger than the one they reported.
pub(crate) fn too_sure(problems: &[Problem]) -> Vec<String> {
    let all = problems.iter().flat_map(|p| p.curves.iter().filter(|c| !is_walk(c)).map(move |c| (p, c)));
    let points = all.flat_map(|(p, c)| c.points.iter().map(move |q| (p, c, q)));
    // NaN: those that report none
    let wrong = points.filter(|(_, _, q)| !q.reported.is_nan() && q.error > q.reported.max(1e-14));
    wrong.map(|(p, c, q)| format!("{}: {} {}: error {:.1e}, reported {:.1e}", p.name, c.method, q.setting, q.error, q.reported)).collect()
}
