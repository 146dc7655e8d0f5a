//! The table of stress: an input, a method, what should happen, what did. The test asserts it, `examples/stress` prints it.

#![allow(dead_code, unreachable_pub, reason = "a module of the example `stress`")]

use fredholm::deterministic::{Nystrom, PredictedVariance};
use fredholm::domain::Interval;
use fredholm::kernel::Tabulated;
use fredholm::statistics::Verdict;
use fredholm::walk::Roulette;
use fredholm::{Equation, Error, Estimate, Walk};
use std::sync::Arc;

/// How long a run may take.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Walks of an estimate.
    pub walks: u64,
    /// Walks where each takes 10⁵ steps and more.
    pub long_walks: u64,
    /// Scores accumulated.
    pub scores: u64,
}

impl Scale {
    /// Seconds, for the test.
    pub const TEST: Scale = Scale { walks: 4096, long_walks: 16, scores: 20_000_000 };
    /// As asked for, for the table.
    pub const FULL: Scale = Scale { walks: 65_536, long_walks: 600, scores: 1_000_000_000 };
}

/// What a method made of an input.
#[derive(Clone, Debug)]
pub enum Happened {
    /// An answer with the error it claims: |value − truth| may be at most `claimed`, but for what is narrower than `blind`, as it says itself.
    Answered { value: f64, claimed: f64, truth: f64, blind: f64 },
    /// An answer that says itself that it should not be trusted.
    Doubted { value: f64, truth: f64, verdict: Verdict },
    /// A named refusal.
    Refused(Error),
}

/// What should happen: never a wrong answer, whatever else.
#[derive(Clone, Copy, Debug)]
pub enum Should {
    /// An answer within its error.
    Answer,
    /// A refusal, or a verdict against the answer.
    Refuse,
    /// Either.
    AnswerOrRefuse,
    /// An answer within its error, a refusal, or one that says that it is blind to what is so narrow: no finite number of values excludes it.
    Blind(f64),
}

impl Happened {
    /// Whether it is what should happen.
    pub fn is_right(&self, should: Should) -> bool {
        let true_answer = match self {
            Happened::Answered { value, claimed, truth, .. } => (value - truth).abs() <= claimed + 8.0 * f64::EPSILON * truth.abs(),
            _ => false,
        };
        // a panic, contained or not, is a fault and no refusal
        let refusal = !matches!(self, Happened::Answered { .. } | Happened::Refused(Error::Panicked { .. }));
        match should {
            Should::Answer => true_answer,
            Should::Refuse => refusal,
            Should::AnswerOrRefuse => true_answer || refusal,
            Should::Blind(_) => true_answer || refusal || self.is_blind(should),
        }
    }

    /// From an estimate: an interval of seven standard errors, if the verdict is good.
    pub fn of(estimate: &Estimate, truth: f64) -> Happened {
        match (estimate.verdict(), estimate.std_error) {
            (Verdict::Trustworthy, Some(se)) => {
                Happened::Answered { value: estimate.value, claimed: 7.0 * se, truth, blind: estimate.resolution() }
            }
            (verdict, _) => Happened::Doubted { value: estimate.value, truth, verdict },
        }
    }

    /// A wrong answer that said what it is blind to.
    pub fn is_blind(&self, should: Should) -> bool {
        let (Happened::Answered { blind, .. }, Should::Blind(width)) = (self, should) else { return false };
        width < *blind && !self.is_right(Should::AnswerOrRefuse)
    }

    /// From a solve that knows its error.
    pub fn solved(value: f64, truth: f64, error: Option<f64>, resolution: Option<f64>) -> Happened {
        Happened::Answered { value, claimed: error.unwrap_or(0.0), truth, blind: resolution.unwrap_or(0.0) }
    }

    /// In words and numbers.
    pub fn describe(&self) -> String {
        match self {
            Happened::Answered { value, claimed, truth, blind } => {
                let said = if *blind > 0.0 { format!(" but for what is narrower than {blind:.0e}") } else { String::new() };
                format!("{value:.9e} ± {claimed:.0e}{said}, true error {:.0e}", (value - truth).abs())
            }
            Happened::Doubted { value, truth, verdict } => format!("{value:.3e} (true {truth:.3e}): {verdict:?}"),
            Happened::Refused(e) => {
                let words = e.to_string();
                let rest = if words.chars().count() > WORDS { "…" } else { "" };
                format!("refused: {}{rest}", words.chars().take(WORDS).collect::<String>())
            }
        }
    }
}

/// Letters of a refusal that a table has room for.
const WORDS: usize = 140;

/// One row.
pub struct Row {
    pub input: String,
    pub method: &'static str,
    pub should: Should,
    pub run: Box<dyn Fn(Scale) -> Happened>,
}

impl Row {
    pub fn new(
        input: impl Into<String>,
        method: &'static str,
        should: Should,
        run: impl Fn(Scale) -> Result<Happened, Error> + 'static,
    ) -> Row {
        Row { input: input.into(), method, should, run: Box::new(move |scale| run(scale).unwrap_or_else(Happened::Refused)) }
    }
}

pub type G = Arc<dyn Fn(f64) -> f64 + Send + Sync>;
pub type K = Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>;

/// An equation on an interval with f known at a point; one type for all.
#[derive(Clone)]
pub struct Known {
    pub ends: (f64, f64),
    pub kernel: K,
    pub source: G,
    /// x and f(x)
    pub at: (f64, f64),
}

/// On [0, 1].
pub fn known(
    kernel: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
    source: impl Fn(f64) -> f64 + Send + Sync + 'static,
    at: (f64, f64),
) -> Known {
    Known { ends: (0.0, 1.0), kernel: Arc::new(kernel), source: Arc::new(source), at }
}

macro_rules! equation {
    ($known:expr) => {{
        let (g, k) = ($known.source.clone(), $known.kernel.clone());
        Equation::on_domain(Interval::from($known.ends.0..=$known.ends.1), move |x: &f64| g(*x), move |x: &f64, y: &f64| k(*x, *y))
    }};
}

impl Known {
    /// Adaptive Nyström with the tolerance; panels end at `breakpoints`.
    pub fn adaptive(&self, tolerance: f64, breakpoints: &[f64]) -> Result<Happened, Error> {
        let f = equation!(self).solve(&Nystrom::adaptive().tolerance(tolerance).breakpoints(breakpoints))?;
        let (x, truth) = self.at;
        Ok(Happened::solved(f.try_eval(&x)?, truth, f.error_estimate(), f.resolution()))
    }

    /// Collision walks, uniform steps.
    pub fn uniform(&self, walks: u64) -> Result<Happened, Error> {
        let (x, truth) = self.at;
        Ok(Happened::of(&equation!(self).at(x).solve(&Walk::collision().samples_per_cell(walks).seed(1))?, truth))
    }

    /// Next-event walks by a guided table.
    pub fn guided(&self, walks: u64) -> Result<Happened, Error> {
        let (x, truth) = self.at;
        let eq = equation!(self);
        let table = Tabulated::new(eq.kernel().kernel(), 64)?.guided();
        let eq = eq.with_proposal(table).tabulated_source(64)?;
        Ok(Happened::of(&eq.at(x).solve(&Walk::next_event().samples_per_cell(walks).seed(1))?, truth))
    }

    /// Collision walks by a guided table.
    pub fn collision(&self, walks: u64) -> Result<Happened, Error> {
        let (x, truth) = self.at;
        let eq = equation!(self);
        let table = Tabulated::new(eq.kernel().kernel(), 64)?.guided();
        let eq = eq.with_proposal(table);
        Ok(Happened::of(&eq.at(x).solve(&Walk::collision().samples_per_cell(walks).seed(1))?, truth))
    }

    /// Uniform collision walks, if their variance is predicted to be finite.
    pub fn predicted(&self, walks: u64) -> Result<Happened, Error> {
        let (x, truth) = self.at;
        let (eq, walk) = (equation!(self), Walk::collision().roulette(Roulette::constant(0.8)).samples_per_cell(walks).seed(1));
        if eq.predict(&walk)?.verdict() != PredictedVariance::Finite {
            return Ok(Happened::Doubted { value: f64::NAN, truth, verdict: Verdict::InfiniteVariance });
        }
        Ok(Happened::of(&eq.at(x).solve(&walk)?, truth))
    }

    /// Collision walks that survive with a constant probability.
    pub fn constant(&self, survival: f64, walks: u64) -> Result<Happened, Error> {
        let (x, truth) = self.at;
        let walk = Walk::collision().roulette(Roulette::constant(survival)).samples_per_cell(walks).seed(1).max_steps(u64::MAX);
        Ok(Happened::of(&equation!(self).at(x).solve(&walk)?, truth))
    }
}

/// The three ways to solve a known equation, as rows.
pub fn all_ways(rows: &mut Vec<Row>, input: &str, problem: &Known, tolerance: f64, should: [Should; 3]) {
    let [solve, uniform, guided] = [problem.clone(), problem.clone(), problem.clone()];
    rows.push(Row::new(input, "adaptive Nyström", should[0], move |_| solve.adaptive(tolerance, &[])));
    rows.push(Row::new(input, "walks, uniform", should[1], move |s| uniform.uniform(s.walks)));
    rows.push(Row::new(input, "walks, guided", should[2], move |s| guided.guided(s.walks)));
}
