//! Lines, verdicts, sums and the CSV file.

use crate::options::Options;
use fredholm::statistics::student_quantile;
use std::io::Write;

/// A number found, and the one known.
#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    pub label: String,
    pub value: f64,
    /// Standard error of a walk, reported error of a deterministic method.
    pub error: f64,
    /// Degrees of freedom of a walk's error; none for deterministic methods.
    pub freedom: Option<u64>,
    /// Bound of a known bias.
    pub bias: f64,
    pub reference: Option<f64>,
    pub evaluations: u64,
    /// Why the estimate must not be used, in its own words.
    pub refusal: Option<String>,
}

impl Comparison {
    /// By a deterministic method, with the error that it reports.
    pub(crate) fn deterministic(label: String, value: f64, error: f64, reference: Option<f64>) -> Self {
        Comparison { label, value, error, freedom: None, bias: 0.0, reference, evaluations: 0, refusal: None }
    }
}

/// What a method made of a file.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub method: &'static str,
    pub seconds: f64,
    /// Unknowns, condition and class of the kernel, from methods that know them.
    pub note: String,
    pub result: Result<Vec<Comparison>, String>,
}

/// One file and method.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub file: String,
    pub class: String,
    pub digits: Option<u32>,
    pub outcome: Outcome,
}

/// Verdicts in order of severity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Verdict {
    Ok,
    Refused(String),
    Wrong,
}

/// Decides what chance allows.
#[derive(Debug)]
pub(crate) struct Judge {
    /// two-sided false-alarm probability of one comparison
    alpha: f64,
    all_points: bool,
}

/// False alarms of a whole run.
const FALSE_ALARM: f64 = 1e-6;

impl Judge {
    pub(crate) fn new(comparisons: usize, options: &Options) -> Self {
        // Šidák: 1 − (1 − α)^{1/n}, by ln(1 + x) because α is small
        let alpha = -f64::exp_m1(f64::ln_1p(-FALSE_ALARM) / comparisons.max(1) as f64);
        Judge { alpha, all_points: options.all_points }
    }

    /// Standard errors that chance allows.
    fn bound(&self, freedom: u64) -> f64 {
        student_quantile(freedom.max(1), self.alpha / 2.0).map_or(f64::INFINITY, |t| -t)
    }

    /// |error| in units of what is allowed: above 1 is wrong.
    pub(crate) fn ratio(&self, c: &Comparison, digits: Option<u32>) -> Option<f64> {
        let reference = c.reference?;
        let known = reference.abs() * 10f64.powi(1 - digits.map_or(15, |d| d.min(15)) as i32);
        let rounding = 64.0 * f64::EPSILON * c.value.abs().max(reference.abs());
        let claimed = match c.freedom {
            Some(freedom) => self.bound(freedom) * c.error + c.bias,
            None => c.error,
        };
        Some((c.value - reference).abs() / (claimed + known + rounding).max(f64::MIN_POSITIVE))
    }

    pub(crate) fn verdict(&self, c: &Comparison, digits: Option<u32>) -> Verdict {
        match (&c.refusal, self.ratio(c, digits)) {
            (Some(why), _) => Verdict::Refused(why.clone()),
            // `!(≤)`: NaN is wrong
            (None, Some(ratio)) if !(ratio <= 1.0) => Verdict::Wrong,
            _ => Verdict::Ok,
        }
    }
}

impl Line {
    pub(crate) const HEADER: &'static str = "file                                         class            method       value ± error             at the worst point            reference         z or error   evaluations    time  verdict";

    /// The comparisons to show: all of them, or the worst.
    fn shown<'a>(&self, all: &'a [Comparison], judge: &Judge) -> Vec<&'a Comparison> {
        if judge.all_points {
            return all.iter().collect();
        }
        let severity = |c: &&Comparison| match judge.verdict(c, self.digits) {
            Verdict::Wrong => 2e300,
            Verdict::Refused(_) => -2.0,
            Verdict::Ok => judge.ratio(c, self.digits).unwrap_or(-1.0),
        };
        all.iter().max_by(|a, b| severity(a).total_cmp(&severity(b))).into_iter().collect()
    }

    /// Wrong if any number is; refused if most are.
    pub(crate) fn verdict(&self, judge: &Judge) -> Verdict {
        let all = match &self.outcome.result {
            Err(why) => return Verdict::Refused(why.clone()),
            Ok(all) => all,
        };
        let verdicts: Vec<_> = all.iter().map(|c| judge.verdict(c, self.digits)).collect();
        let refused: Vec<_> = verdicts.iter().filter(|v| matches!(v, Verdict::Refused(_))).collect();
        match refused.first() {
            _ if verdicts.contains(&Verdict::Wrong) => Verdict::Wrong,
            Some(why) if 2 * refused.len() > all.len() => (*why).clone(),
            _ => Verdict::Ok,
        }
    }

    /// ` (k of n refused)` where that is not all of them.
    fn refused_share(&self, judge: &Judge) -> String {
        let Ok(all) = &self.outcome.result else { return String::new() };
        let count = all.iter().filter(|c| c.refusal.is_some()).count();
        if count == 0 || judge.all_points { String::new() } else { format!(" ({count} of {} refused)", all.len()) }
    }

    pub(crate) fn print(&self, judge: &Judge) {
        let head = format!("{:<44} {:<16} {:<12}", self.file, self.class, self.outcome.method);
        let all = match &self.outcome.result {
            Err(why) => return println!("{head} refused: {why}"),
            Ok(all) => all,
        };
        let evaluations: u64 = all.iter().map(|c| c.evaluations).sum();
        for c in self.shown(all, judge) {
            let bias = if c.bias > 0.0 { format!(" ≤{:.0e}", c.bias) } else { String::new() };
            let value = format!("{:.8e} ± {:.1e}{bias}", c.value, c.error);
            let known = c.reference.map_or_else(|| "-".into(), |r| format!("{r:.10}"));
            let verdict = match if judge.all_points { judge.verdict(c, self.digits) } else { self.verdict(judge) } {
                Verdict::Ok if c.reference.is_none() => "ok (nothing to compare with)".into(),
                Verdict::Ok => format!("ok{}", self.refused_share(judge)),
                Verdict::Refused(why) => format!("refused: {why}{}", self.refused_share(judge)),
                Verdict::Wrong => "WRONG".into(),
            };
            let note = if self.outcome.note.is_empty() { String::new() } else { format!(" [{}]", self.outcome.note) };
            println!(
                "{head} {value:<27} {:<27} {known:>18} {:>14} {evaluations:>12} {:>6.2}s  {verdict}{note}",
                c.label,
                deviation(c),
                self.outcome.seconds
            );
        }
    }
}

/// z-score of a walk, error of a deterministic method.
fn deviation(c: &Comparison) -> String {
    match c.reference {
        None => "-".into(),
        Some(r) if c.freedom.is_some() && c.error > 0.0 => format!("z = {:+.2}", (c.value - r) / c.error),
        Some(r) => format!("{:.1e}", (c.value - r).abs()),
    }
}

/// What came out.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub passed: usize,
    pub failed: usize,
    pub refused: usize,
    pub not_stated: usize,
}

impl Tally {
    pub(crate) fn count(&mut self, line: &Line, judge: &Judge) {
        match line.verdict(judge) {
            Verdict::Ok => self.passed += 1,
            Verdict::Wrong => self.failed += 1,
            Verdict::Refused(_) => self.refused += 1,
        }
    }
}

/// Every number of every line.
pub(crate) fn csv(lines: &[Line], judge: &Judge) -> std::io::Result<Vec<u8>> {
    let mut out = Vec::new();
    writeln!(out, "file,class,method,place,value,error,bias bound,reference,difference,share of allowed,evaluations,seconds,verdict,note")?;
    let quote = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    for line in lines {
        let head = format!("{},{},{}", quote(&line.file), quote(&line.class), line.outcome.method);
        let all = match &line.outcome.result {
            Err(why) => {
                writeln!(out, "{head},,,,,,,,,{},{},", line.outcome.seconds, quote(&format!("refused: {why}")))?;
                continue;
            }
            Ok(all) => all,
        };
        for c in all {
            let or_empty = |v: Option<f64>| v.map_or_else(String::new, |v| format!("{v:e}"));
            let verdict = match judge.verdict(c, line.digits) {
                Verdict::Ok => "ok".into(),
                Verdict::Refused(why) => format!("refused: {why}"),
                Verdict::Wrong => "WRONG".into(),
            };
            writeln!(
                out,
                "{head},{},{:e},{:e},{:e},{},{},{},{},{},{},{}",
                quote(&c.label),
                c.value,
                c.error,
                c.bias,
                or_empty(c.reference),
                or_empty(c.reference.map(|r| c.value - r)),
                or_empty(judge.ratio(c, line.digits)),
                c.evaluations,
                line.outcome.seconds,
                quote(&verdict),
                quote(&line.outcome.note)
            )?;
        }
    }
    Ok(out)
}
