//! A tolerance instead of a rule.
//!
//! 0. The kernel is [classified](super::classify), or the user's word taken: what is not smooth on the diagonal goes straight to panels.
//! 1. Gauss–Legendre on the whole domain, doubled while it converges geometrically: smooth kernels end here. Where K or g is singular at an
//!    [end](super::ends), [double-exponential](super::double_exponential) nodes instead.
//! 2. In one dimension, else: panels with product integration towards the diagonal. A panel is cut where the Legendre tail of f, weighted by the mass
//!    of K on it, or the tail of K(x, ·) for x elsewhere is above the tolerance (both: the kernel, not only f, sets the error of a rule). Towards the
//!    ends of the domain, where f may be singular, the Nyström interpolant of one coarse solve plans several cuts at once.
//!    What to cut is [`refine`](super::refine)'s.
//!    Jumps of K along lines y = x + c or x + y = c are found, and rows integrated towards them ([`lines`](super::lines)).
//! 3. Accepted only after the checks of [`verify`](super::verify). Otherwise [`Error::NotConverged`].
//!
//! References: Atkinson, *The numerical solution of integral equations of the second kind* (1997), ch. 4; Kress, *Linear integral equations*, ch. 12.

use super::class::{Diagonal, classify};
use super::ends::{Ends, Tail, tail};
use super::factorised::Factorised;
use super::grid::Grid;
use super::jumps::jumps;
use super::lines::{Line, kinks, lines};
use super::nystrom::{Nystrom, graded_breaks};
use super::solution::NystromSolution;
use super::verify::{self, Verdict, rounding, verify};
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};

/// Order of the panels, and of the solve that verifies them.
const ORDER: usize = 16;
const VERIFYING: usize = ORDER + 4;
/// Where rounding of K may cost this share of the tolerance, rounding of the elimination is taken out.
const ILL_CONDITIONED: f64 = 1e-3;
/// An error that falls by less than this when all panels are halved is one of rounding.
const STAGNANT: f64 = 0.3;
/// Two solves that differ by less than this share of f have found its size.
const SETTLED: f64 = 1e-3;
/// Least error that panels report, as a share of the tolerance: three unresolved tails.
const PROMISED: f64 = 3.0 * SHARE;
/// A tail counts as resolved below this share of the tolerance: there are many panels.
pub(super) const SHARE: f64 = 0.1;
const ROUNDS: usize = 24;

pub(super) fn solve<G, K>(
    equation: &Equation<G, K>,
    settings: &Nystrom,
    tolerance: f64,
    most: usize,
) -> Result<NystromSolution<G, K>, Error>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::invalid("tolerance", tolerance, "must be positive and finite"));
    }
    let segments = settings.segments(equation.kernel().domain())?;
    let mut search = Search {
        equation,
        tolerance,
        most,
        evaluations: 0,
        error: f64::INFINITY,
        largest: 0,
        ends: Ends::default(),
        tail: None,
        lines: Vec::new(),
    };
    if equation.kernel().domain().dimension() > 1 {
        let tensor = search.globally(tensor_orders(equation.kernel().domain().dimension()), |domain, order| Grid::plain(domain, 1, order));
        let centred = equation.kernel().domain().around(&any_place(equation.kernel().domain()), 1).is_some();
        let found = match tensor {
            // singular on the diagonal, or a kink there
            Ok(None) | Err(Error::NonFiniteKernel { .. }) if centred => search.globally(tensor_orders(2), Grid::centred)?,
            other => other?,
        };
        return found.ok_or_else(|| search.failure());
    }
    let class = classify(equation.kernel())?;
    search.ends = Ends::of(equation);
    search.tail = tail(equation.kernel());
    search.lines = lines(equation.kernel());
    let segments = joined(segments, jumps(equation));
    let kinks = kinks(&search.lines, &segments);
    let segments = joined(segments, kinks);
    let diagonal = settings.declared.unwrap_or(class.diagonal);
    let smooth =
        segments.len() == 2 && search.lines.is_empty() && matches!(diagonal, Diagonal::Smooth | Diagonal::Peaked { width: WIDE.. });
    let found = search.on_line(smooth, &segments).map_err(|e| search.in_words(e))?;
    let contradicted = !diagonal.is_like(class.diagonal);
    let warning = contradicted.then(|| format!("declared: {diagonal}; values look like: {}", class.diagonal));
    Ok(found.with_class(class, warning))
}

/// Orders of global rules along a coordinate.
const GAUSS: [usize; 5] = [12, 24, 48, 96, 192];
const DOUBLE_EXPONENTIAL: [usize; 4] = [32, 64, 128, 256];

fn tensor_orders(dimension: usize) -> &'static [usize] {
    match dimension {
        2 => &[5, 8, 12, 18, 27, 40],
        3 => &[3, 5, 7, 9, 12],
        _ => &[2, 3, 4, 5, 6],
    }
}

fn any_place<D: Domain>(domain: &D) -> D::Point {
    domain.place(0, || 0.5).point
}

/// A jump this close to a declared one is that one, found more exactly.
const SAME_JUMP: f64 = 1e-6;
/// Peaks of this width or more, in units of the coordinate, are tried without panels.
const WIDE: f64 = 0.02;

impl<G, K> Search<'_, G, K> {
    /// The same error, told by its cause where K falls slowly.
    fn in_words(&self, error: Error) -> Error {
        match (&error, self.tail) {
            (Error::NotConverged { .. } | Error::NotIntegrable { .. }, Some(Tail { power, mass })) => {
                Error::SlowDecay { power, mass, error: self.error, tolerance: self.tolerance }
            }
            _ => error,
        }
    }

    fn failure(&self) -> Error {
        Error::NotConverged { error: self.error, tolerance: self.tolerance, unknowns: self.largest }
    }
}

pub(super) struct Search<'a, G, K> {
    pub(super) equation: &'a Equation<G, K>,
    tolerance: f64,
    most: usize,
    evaluations: u64,
    /// of the best attempt
    error: f64,
    largest: usize,
    pub(super) ends: Ends,
    tail: Option<Tail>,
    lines: Vec<Line>,
}

impl<G, K> Search<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    pub(super) fn domain(&self) -> &K::Domain {
        self.equation.kernel().domain()
    }

    fn attempt(&mut self, grid: Grid<K::Point>) -> Result<NystromSolution<G, K>, Error> {
        let f = Factorised::on_grid(self.equation.kernel(), grid)?.solve(self.equation.source())?;
        self.evaluations += f.evaluations();
        Ok(f)
    }

    /// Whether the limit of unknowns allows that many nodes; they count as tried.
    fn affordable(&mut self, nodes: f64) -> bool {
        let unknowns = nodes * self.domain().states() as f64 * G::Value::COMPONENTS as f64;
        self.largest = self.largest.max(unknowns as usize);
        unknowns <= self.most as f64
    }

    pub(super) fn allowed(&self, f: &NystromSolution<G, K>) -> f64 {
        self.tolerance * f.bulk().max(1.0)
    }

    fn verified(&mut self, coarse: &NystromSolution<G, K>, fine: &NystromSolution<G, K>) -> Result<Verdict, Error> {
        let allowed = self.allowed(fine);
        let mut verdict = verify(self.equation, coarse, fine, allowed)?;
        let rounding = verify::ROUNDING * rounding(fine);
        // the same f twice, and no finer rule can do better
        if rounding > allowed && verdict.error <= (SETTLED * fine.bulk()).max(rounding) {
            return Err(Error::IllConditioned {
                error: verdict.error.max(rounding),
                tolerance: self.tolerance,
                condition: fine.condition(),
            });
        }
        if verdict.error <= allowed {
            verdict.error = verdict.error.max(self.beyond(fine));
            if !same_resolvent(coarse, fine) {
                verdict.error = f64::INFINITY;
            }
        }
        self.error = self.error.min(verdict.error);
        Ok(verdict)
    }

    /// What of T f lies beyond the outermost panels, carried to an error.
    fn beyond(&self, f: &NystromSolution<G, K>) -> f64 {
        let Some(tail) = self.tail else { return 0.0 };
        let outermost = f.nodes().zip(f.values()).map(|(x, f)| (self.domain().density(&x), f.magnitude()));
        let far = outermost.fold((f64::INFINITY, 0.0), |a, b| if b.0 < a.0 { b } else { a }).1;
        // the outermost panel is integrated no better than what is beyond it
        if far == 0.0 { 0.0 } else { 4.0 * tail.mass * far * f.inverse_norm() }
    }

    /// One rule for the whole, or panels.
    fn on_line(&mut self, smooth: bool, segments: &[f64]) -> Result<NystromSolution<G, K>, Error> {
        if let Some(found) = if smooth { self.without_panels()? } else { None } {
            return Ok(found);
        }
        self.by_panels(segments)?.ok_or_else(|| self.failure())
    }

    /// One rule for the whole of a line.
    fn without_panels(&mut self) -> Result<Option<NystromSolution<G, K>>, Error> {
        if self.ends.are_for_double_exponential(self.domain()) {
            return self.globally(&DOUBLE_EXPONENTIAL, Grid::double_exponential);
        }
        if self.ends.rows == [false; 2] { self.globally(&GAUSS, |domain, order| Grid::plain(domain, 1, order)) } else { Ok(None) }
    }

    fn globally(
        &mut self,
        orders: &[usize],
        rule: impl Fn(&K::Domain, usize) -> Result<Grid<K::Point>, Error>,
    ) -> Result<Option<NystromSolution<G, K>>, Error> {
        let dimension = self.domain().dimension();
        let (mut last, mut change): (Option<NystromSolution<G, K>>, f64) = (None, f64::INFINITY);
        for &order in orders {
            if !self.affordable((order as f64).powi(dimension as i32)) {
                break;
            }
            let fine = match self.attempt(rule(self.domain(), order)?) {
                // singular on the diagonal: panels never evaluate it there
                Err(Error::NonFiniteKernel { .. }) if dimension == 1 => return Ok(None),
                Err(Error::Singular { .. }) if order != orders[orders.len() - 1] => continue,
                other => other?,
            };
            if let Some(coarse) = last {
                let error = self.verified(&coarse, &fine)?.error;
                if error <= self.allowed(&fine) {
                    return Ok(Some(fine.with_error(error, self.evaluations)));
                }
                // not geometric: panels will do better
                if dimension == 1 && order > orders[1] && error > 0.03 * change {
                    return Ok(None);
                }
                change = error;
            }
            last = Some(fine);
        }
        Ok(None)
    }

    fn by_panels(&mut self, segments: &[f64]) -> Result<Option<NystromSolution<G, K>>, Error> {
        let mut breaks = graded_breaks(segments, 4, 0);
        let mut last = f64::INFINITY;
        for _ in 0..ROUNDS {
            if !self.affordable((breaks.len() - 1) as f64 * VERIFYING as f64) {
                return Ok(None);
            }
            let coarse =
                self.attempt(Grid::panelled(self.domain(), breaks.clone(), ORDER)?.towards(self.ends).across(self.lines.clone()))?;
            let finer = self.refine(&coarse, segments)?;
            if finer.len() > breaks.len() {
                breaks = finer;
                continue;
            }
            let mut fine =
                self.attempt(Grid::panelled(self.domain(), breaks.clone(), VERIFYING)?.towards(self.ends).across(self.lines.clone()))?;
            if rounding(&fine) > ILL_CONDITIONED * self.allowed(&fine) {
                fine = fine.refined()?;
            }
            let verdict = self.verified(&coarse, &fine)?;
            if verdict.error <= self.allowed(&fine) {
                // panels resolve f to a share of the tolerance: nothing below is promised, however close two solves come
                let promised = verdict.error.max(PROMISED * self.allowed(&fine));
                return Ok(Some(fine.with_error(promised, self.evaluations)));
            }
            // resolved, and no better than before: rounding
            if verdict.doubtful.is_empty() && verdict.error > STAGNANT * last {
                return Ok(None);
            }
            last = verdict.error;
            breaks = halved(&breaks, &verdict.doubtful);
        }
        Ok(None)
    }
}

/// Whether two rules agree on how close 1 is to the spectrum: where g has nothing of the null function, f does not tell.
fn same_resolvent<G, K>(coarse: &NystromSolution<G, K>, fine: &NystromSolution<G, K>) -> bool
where
    G: Source,
    K: Kernel + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    const HARMLESS: f64 = 1e4;
    const SAME: f64 = 3.0;
    let (a, b) = (coarse.inverse_norm(), fine.inverse_norm());
    b < HARMLESS || (b < SAME * a && a < SAME * b)
}

/// The segments cut at jumps; one found takes the place of one declared close by.
fn joined(mut segments: Vec<f64>, found: Vec<f64>) -> Vec<f64> {
    for t in found {
        segments.retain(|s| (s - t).abs() > SAME_JUMP || *s == 0.0 || *s == 1.0);
        segments.push(t);
    }
    segments.sort_by(f64::total_cmp);
    segments
}

/// The doubtful panels halved, all if none is doubtful.
fn halved(breaks: &[f64], doubtful: &[usize]) -> Vec<f64> {
    let mut out = vec![breaks[0]];
    for (p, ends) in breaks.windows(2).enumerate() {
        if doubtful.is_empty() || doubtful.contains(&p) {
            out.push(0.5 * (ends[0] + ends[1]));
        }
        out.push(ends[1]);
    }
    out
}
