//! A tolerance instead of a rule.
//!
//! 0. The kernel is [classified](super::classify), or the user's word taken: what is not smooth on the diagonal goes straight to panels.
//! 1. Gauss–Legendre on the whole domain, half as many nodes again while it converges geometrically: smooth kernels end here. Where K or g is singular at an
//!    [end](super::ends), [double-exponential](super::double_exponential) nodes instead; equidistant ones where both continue periodically.
//! 2. In one dimension, else: panels with product integration towards the diagonal. A panel is cut where the Legendre tail of f, weighted by the mass
//!    of K on it, or the tail of K(x, ·) for x elsewhere is above the tolerance (both: the kernel, not only f, sets the error of a rule). Towards the
//!    ends of the domain, where f may be singular, the Nyström interpolant of one coarse solve plans several cuts at once.
//!    What to cut is [`refine`](super::refine)'s.
//!    Jumps and kinks of K along lines y = x + c or x + y = c are found, and rows integrated towards them ([`lines`](super::lines)).
//! 3. Accepted only after the checks of [`verify`](super::verify). Otherwise [`Error::NotConverged`].
//!
//! References: Atkinson, *The numerical solution of integral equations of the second kind* (1997), ch. 4; Kress, *Linear integral equations*, ch. 12.

use super::class::{Diagonal, classified};
use super::ends::{Ends, Tail, is_periodic, tail};
use super::factorised::Factorised;
use super::grid::Grid;
use super::integrable;
use super::jumps::{along_rows, jumps, singular_columns};
use super::lines::{Line, kinks, lines};
use super::nystrom::Nystrom;
use super::solution::NystromSolution;
use super::verify::{self, Verdict, rounding, same_resolvent, verify};
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};

/// Two solves that differ by less than this share of f have found its size.
const SETTLED: f64 = 1e-3;
/// On infinite domains ‖(I − T_n)⁻¹‖ that grows by this with the order of the rule grows without end.
const APPROACHED: f64 = 1.1;
/// A tail counts as resolved below this share of the tolerance: there are many panels.
pub(super) const SHARE: f64 = 0.1;

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
        periodic: false,
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
    let (class, ends) = classified(equation.kernel())?;
    search.ends = Ends::of(equation, ends);
    search.tail = tail(equation.kernel());
    if let Some(Tail { power, mass: f64::INFINITY }) = search.tail {
        return Err(Error::SlowDecay { power, mass: f64::INFINITY, error: f64::INFINITY, tolerance });
    }
    search.periodic = class.periodic && is_periodic(equation);
    let rows = along_rows(equation.kernel());
    search.lines = lines(equation.kernel().domain(), &rows);
    search.lines.extend(singular_columns(equation.kernel(), &rows).into_iter().map(Line::at));
    let segments = joined(segments, jumps(equation, &rows));
    integrable::source(equation, &segments)?;
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
const GAUSS: [usize; 8] = [10, 16, 24, 36, 54, 80, 120, 180];
/// Beyond this order an error must fall from one to the next to less than this.
const PATIENCE: usize = 40;
const SLOW: f64 = 0.1;
/// So many coarse rules may make a system singular that is not.
const BY_CHANCE: usize = 2;
/// Of periodic kernels: a peak of width w takes 5/w nodes. Beyond an order the error must be bound to be small enough before another.
const EQUIDISTANT: [usize; 18] = [10, 16, 24, 36, 54, 80, 120, 180, 270, 400, 600, 900, 1400, 2000, 2500, 3000, 3500, 4000];
const PERIODIC_PATIENCE: usize = 600;
const FARTHEST: f64 = 6000.0;
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
    pub(super) evaluations: u64,
    /// of the best attempt
    error: f64,
    largest: usize,
    pub(super) ends: Ends,
    tail: Option<Tail>,
    pub(super) lines: Vec<Line>,
    /// K and g continue periodically
    periodic: bool,
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

    pub(super) fn attempt(&mut self, grid: Grid<K::Point>) -> Result<NystromSolution<G, K>, Error> {
        self.largest = self.largest.max(grid.nodes.len() * G::Value::COMPONENTS);
        let f = Factorised::on_grid(self.equation.kernel(), grid)?.solve(self.equation.source())?;
        self.evaluations += f.evaluations();
        Ok(f)
    }

    /// Whether the limit of unknowns allows that many nodes in each state.
    pub(super) fn affordable(&self, nodes: f64) -> bool {
        nodes * self.domain().states() as f64 * G::Value::COMPONENTS as f64 <= self.most as f64
    }

    pub(super) fn allowed(&self, f: &NystromSolution<G, K>) -> f64 {
        self.tolerance * f.bulk().max(1.0)
    }

    pub(super) fn verified(&mut self, coarse: &NystromSolution<G, K>, fine: &NystromSolution<G, K>) -> Result<Verdict, Error> {
        let allowed = self.allowed(fine);
        let mut verdict = verify(self.equation, coarse, fine, allowed)?;
        verdict.error *= self.tail.map_or(1.0, |tail| tail.alike(coarse.unknowns(), fine.unknowns()));
        let rounding = verify::ROUNDING * rounding(fine);
        // the farther nodes reach, the closer 1 comes to the spectrum
        if !self.domain().volume().is_finite() && rounding > allowed && fine.inverse_norm() > APPROACHED * coarse.inverse_norm() {
            return Err(Error::ContinuousSpectrum { rcond: fine.rcond(), unknowns: fine.unknowns() });
        }
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
        if self.periodic
            && let Some(found) = self.globally(&EQUIDISTANT, Grid::equidistant)?
        {
            return Ok(Some(found));
        }
        if self.ends.rows == [false; 2] { self.globally(&GAUSS, |domain, order| Grid::plain(domain, 1, order)) } else { Ok(None) }
    }

    fn globally(
        &mut self,
        orders: &[usize],
        rule: impl Fn(&K::Domain, usize) -> Result<Grid<K::Point>, Error>,
    ) -> Result<Option<NystromSolution<G, K>>, Error> {
        let dimension = self.domain().dimension();
        let (mut last, mut before, mut change): (Option<NystromSolution<G, K>>, usize, f64) = (None, 0, f64::INFINITY);
        let mut singular = 0;
        for &order in orders {
            if !self.affordable((order as f64).powi(dimension as i32)) {
                break;
            }
            let fine = match self.attempt(rule(self.domain(), order)?) {
                // singular on the diagonal: panels never evaluate it there
                Err(Error::NonFiniteKernel { .. }) if dimension == 1 => return Ok(None),
                Err(Error::Singular { .. }) if singular < BY_CHANCE && order != orders[orders.len() - 1] => {
                    singular += 1;
                    continue;
                }
                other => other?,
            };
            if let Some(coarse) = last {
                let error = self.verified(&coarse, &fine)?.error;
                if error <= self.allowed(&fine) {
                    return Ok(Some(fine.with_error(error, self.evaluations)));
                }
                // not geometric: panels will do better
                let hopeless = if fine.system().grid.is_equidistant() {
                    order > PERIODIC_PATIENCE && !(order_at(self.allowed(&fine), (before, change), (order, error)) < FARTHEST)
                } else {
                    order > PATIENCE && error > SLOW * change
                };
                if dimension == 1 && hopeless {
                    return Ok(None);
                }
                change = error;
            }
            (last, before) = (Some(fine), order);
        }
        Ok(None)
    }
}

/// Order at which an error that falls geometrically, from one (order, error) to another, comes to `allowed`; no number if it does not fall.
fn order_at(allowed: f64, (before, earlier): (usize, f64), (order, error): (usize, f64)) -> f64 {
    let rate = (earlier / error).ln() / (order - before) as f64;
    if rate > 0.0 { order as f64 + (error / allowed).ln() / rate } else { f64::NAN }
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
