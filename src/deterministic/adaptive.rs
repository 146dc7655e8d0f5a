//! A tolerance instead of a rule.
//!
//! 0. The kernel is [classified](super::classify), or the user's word taken: what is not smooth on the diagonal goes straight to panels.
//! 1. Gauss–Legendre on the whole domain, doubled while it converges geometrically: smooth kernels end here.
//! 2. In one dimension, else: panels with product integration towards the diagonal. A panel is cut where the Legendre tail of f, weighted by the mass
//!    of K on it, or the tail of K(x, ·) for x elsewhere is above the tolerance (both: the kernel, not only f, sets the error of a rule). Towards the
//!    ends of the domain, where f may be singular, the Nyström interpolant of one coarse solve plans several cuts at once.
//! 3. Accepted only after the checks of [`verify`](super::verify). Otherwise [`Error::NotConverged`].
//!
//! References: Atkinson, *The numerical solution of integral equations of the second kind* (1997), ch. 4; Kress, *Linear integral equations*, ch. 12.

use super::basis::Basis;
use super::class::{Diagonal, classify};
use super::grid::{Grid, Panels};
use super::jumps::jumps;
use super::near::{Target, components};
use super::nystrom::{Factorised, Nystrom, graded_breaks};
use super::solution::NystromSolution;
use super::verify::{Verdict, rounding, verify};
use crate::domain::{Domain, Node};
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::{Value, Weight};

/// Order of the panels, and of the solve that verifies them.
const ORDER: usize = 16;
const VERIFYING: usize = ORDER + 4;
/// No panel is cut below this share of the domain.
const SMALLEST: f64 = 1.0 / (1u64 << 42) as f64;
/// Where rounding of K may cost this share of the tolerance, rounding of the elimination is taken out.
const ILL_CONDITIONED: f64 = 1e-3;
/// An error that falls by less than this when all panels are halved is one of rounding.
const STAGNANT: f64 = 0.3;
/// Least error that panels report, as a share of the tolerance: three unresolved tails.
const PROMISED: f64 = 3.0 * SHARE;
/// Share of a panel's mass beyond its outermost node.
const BEYOND: f64 = 0.05;
/// A tail counts as resolved below this share of the tolerance: there are many panels.
const SHARE: f64 = 0.1;
/// Cuts towards an end in one round, each to a quarter: a singular end is planned in few rounds, and a poor interpolant is not followed for ever.
const DEPTH: usize = 4;
const QUARTER: f64 = 0.25;
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
    let mut search = Search { equation, tolerance, most, evaluations: 0, error: f64::INFINITY, largest: 0 };
    if equation.kernel().domain().dimension() > 1 {
        return search.globally()?.ok_or_else(|| search.failure());
    }
    let class = classify(equation.kernel())?;
    let segments = joined(segments, jumps(equation));
    let diagonal = settings.declared.unwrap_or(class.diagonal);
    let smooth = segments.len() == 2 && matches!(diagonal, Diagonal::Smooth | Diagonal::Peaked { width: WIDE.. });
    let found = match if smooth { search.globally()? } else { None } {
        Some(found) => found,
        None => search.by_panels(&segments)?.ok_or_else(|| search.failure())?,
    };
    let contradicted = std::mem::discriminant(&diagonal) != std::mem::discriminant(&class.diagonal);
    let warning = contradicted.then(|| format!("declared: {diagonal}; values look like: {}", class.diagonal));
    Ok(found.with_class(class, warning))
}

/// Peaks of this width or more, in units of the coordinate, are tried without panels.
const WIDE: f64 = 0.02;

impl<G, K> Search<'_, G, K> {
    fn failure(&self) -> Error {
        Error::NotConverged { error: self.error, tolerance: self.tolerance, unknowns: self.largest }
    }
}

struct Search<'a, G, K> {
    equation: &'a Equation<G, K>,
    tolerance: f64,
    most: usize,
    evaluations: u64,
    /// of the best attempt
    error: f64,
    largest: usize,
}

impl<G, K> Search<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    fn domain(&self) -> &K::Domain {
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

    fn allowed(&self, f: &NystromSolution<G, K>) -> f64 {
        self.tolerance * f.magnitude().max(1.0)
    }

    fn verified(&mut self, coarse: &NystromSolution<G, K>, fine: &NystromSolution<G, K>) -> Result<Verdict, Error> {
        let verdict = verify(self.equation, coarse, fine, self.allowed(fine))?;
        self.error = self.error.min(verdict.error);
        Ok(verdict)
    }

    fn globally(&mut self) -> Result<Option<NystromSolution<G, K>>, Error> {
        let dimension = self.domain().dimension();
        let orders: &[usize] = match dimension {
            1 => &[12, 24, 48, 96, 192],
            2 => &[5, 8, 12, 18, 27, 40],
            3 => &[3, 5, 7, 9, 12],
            _ => &[2, 3, 4, 5, 6],
        };
        let (mut last, mut change): (Option<NystromSolution<G, K>>, f64) = (None, f64::INFINITY);
        for &order in orders {
            if !self.affordable((order as f64).powi(dimension as i32)) {
                break;
            }
            let fine = match self.attempt(Grid::plain(self.domain(), 1, order)?) {
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
                if dimension == 1 && order > 24 && error > 0.03 * change {
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
            let coarse = self.attempt(Grid::panelled(self.domain(), breaks.clone(), ORDER)?)?;
            let finer = self.refine(&coarse, segments)?;
            if finer.len() > breaks.len() {
                breaks = finer;
                continue;
            }
            let mut fine = self.attempt(Grid::panelled(self.domain(), breaks.clone(), VERIFYING)?)?;
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

    /// The panels that f and K ask for.
    fn refine(&self, f: &NystromSolution<G, K>, segments: &[f64]) -> Result<Vec<f64>, Error> {
        let panels = f.system().grid.panels().expect("solved on panels");
        // what rounding makes of f no panel can mend: cutting it up would only worsen the condition
        let allowed = (SHARE * self.allowed(f)).max(4.0 * rounding(f));
        let cuts = parallel::map(panels.count(), |p| {
            let (a, b) = panels.panel(p);
            let end = End::of((a, b), segments);
            if b - a <= SMALLEST {
                return Ok(vec![b]);
            }
            if self.kernel_tail(panels, p)? * f.magnitude() > allowed {
                return Ok(vec![0.5 * (a + b), b]);
            }
            if self.tail_at_nodes(f, panels, p)?.max(self.layer(f, panels, p, end)?) <= allowed {
                return Ok(vec![b]);
            }
            let mut breaks = Vec::new();
            match end {
                End::None => breaks.extend([0.5 * (a + b), b]),
                end => self.towards(end, f, &panels.basis, (a, b), allowed, DEPTH, &mut breaks)?,
            }
            Ok(breaks)
        });
        let mut breaks = vec![panels.breaks[0]];
        for cut in cuts {
            breaks.extend(cut?);
        }
        Ok(breaks)
    }

    /// Appends the ends of the panels into which [a, b], unresolved and at an end of a segment, must be cut.
    fn towards(
        &self,
        end: End,
        f: &NystromSolution<G, K>,
        basis: &Basis,
        (a, b): (f64, f64),
        allowed: f64,
        depth: usize,
        breaks: &mut Vec<f64>,
    ) -> Result<(), Error> {
        let cut = match end {
            End::Left => a + QUARTER * (b - a),
            End::Right => b - QUARTER * (b - a),
            End::Both | End::None => 0.5 * (a + b),
        };
        let sides = [(a, cut, end.left()), (cut, b, end.right())];
        for (low, high, end) in sides {
            let go_on = depth > 1 && end != End::None && high - low > SMALLEST && self.tail_between(f, basis, (low, high))? > allowed;
            if go_on {
                self.towards(end, f, basis, (low, high), allowed, depth - 1, breaks)?;
            } else {
                breaks.push(high);
            }
        }
        Ok(())
    }

    /// Legendre tail of f on panel `p` × the mass of K there: what the unresolved part of f does elsewhere.
    fn tail_at_nodes(&self, f: &NystromSolution<G, K>, panels: &Panels, p: usize) -> Result<f64, Error> {
        let n = panels.basis.len();
        let values = |state: usize| {
            let first = (state * panels.count() + p) * n;
            f.values()[first..first + n].to_vec()
        };
        self.weighted_tail(&panels.basis, panels.panel(p), |state| Ok(values(state)))
    }

    /// How far f at an end of a segment is from what the panel there extrapolates, × the mass of K: boundary layers narrower than the outermost nodes, as
    /// kernels peaked on the diagonal make them.
    fn layer(&self, f: &NystromSolution<G, K>, panels: &Panels, p: usize, end: End) -> Result<f64, Error> {
        let ((a, b), basis, domain) = (panels.panel(p), &panels.basis, self.domain());
        let mut worst = 0.0f64;
        for (inside, at_end) in [(0.0, end.left()), (1.0, end.right())] {
            // nothing happens at infinity within a spacing of the coordinate
            if at_end == End::None || (inside == 1.0 && !domain.volume().is_finite() && b == 1.0) {
                continue;
            }
            let t = a + (b - a) * inside + (0.5 - inside) * SMALLEST;
            let mut values = vec![0.0; basis.len()];
            basis.values(inside, &mut values);
            for state in 0..domain.states() {
                let x = domain.place(state, || t).point;
                let first = (state * panels.count() + p) * basis.len();
                let mut gap = f.try_eval(&x)?;
                f.values()[first..first + basis.len()].iter().zip(&values).for_each(|(f, v)| gap += f.scale(-v));
                worst = worst.max(BEYOND * gap.magnitude() * self.mass(basis, (a, b), state)?.min(1.0));
            }
        }
        Ok(worst)
    }

    /// The same on a part of a panel, by the Nyström interpolant.
    fn tail_between(&self, f: &NystromSolution<G, K>, basis: &Basis, (a, b): (f64, f64)) -> Result<f64, Error> {
        let place = |state: usize, u: f64| self.domain().place(state, || a + (b - a) * u).point;
        self.weighted_tail(basis, (a, b), |state| basis.rule().iter().map(|n| f.try_eval(&place(state, n.point))).collect())
    }

    fn weighted_tail(
        &self,
        basis: &Basis,
        (a, b): (f64, f64),
        values: impl Fn(usize) -> Result<Vec<G::Value>, Error>,
    ) -> Result<f64, Error> {
        let mut worst = 0.0f64;
        for state in 0..self.domain().states() {
            let values = values(state)?;
            let component = |i: usize| basis.tail(&values.iter().map(|v| v.component(i)).collect::<Vec<_>>());
            let tail = (0..G::Value::COMPONENTS).map(component).fold(0.0, f64::max);
            worst = worst.max(tail * self.mass(basis, (a, b), state)?.min(1.0));
        }
        Ok(worst)
    }

    /// ∫ |K| over [a, b] in a state, seen from its middle.
    fn mass(&self, basis: &Basis, (a, b): (f64, f64), state: usize) -> Result<f64, Error> {
        let (kernel, domain, c) = (self.equation.kernel(), self.domain(), components::<K>());
        let mut mass = 0.0f64;
        for from in 0..domain.states() {
            let x = domain.place(from, || 0.5 * (a + b)).point;
            let mut moments = vec![0.0; basis.len() * c * c];
            Target::new(kernel, &x).moments(state, (a, b), basis, basis, &mut moments)?;
            mass = mass.max(moments.iter().map(|m| m.abs()).sum());
        }
        Ok(mass)
    }

    /// What Gauss nodes on panel `p` miss of ∫ K(x, ·) for x on panels that count it as far: Gauss integrates twice the degree it interpolates,
    /// hence the square of the tail.
    fn kernel_tail(&self, panels: &Panels, p: usize) -> Result<f64, Error> {
        let (kernel, domain) = (self.equation.kernel(), self.domain());
        let (a, b) = panels.panel(p);
        let c = components::<K>();
        let nodes: Vec<Vec<Node<K::Point>>> =
            (0..domain.states()).map(|s| panels.basis.rule().iter().map(|n| domain.place(s, || a + (b - a) * n.point)).collect()).collect();
        let mut worst = 0.0f64;
        for q in 0..panels.count() {
            let (low, high) = panels.panel(q);
            for from in 0..domain.states() {
                let x = domain.place(from, || low + 0.5 * (high - low)).point;
                if Target::new(kernel, &x).is_near((a, b)) {
                    continue;
                }
                for (row, e) in nodes.iter().flat_map(|row| (0..c * c).map(move |e| (row, e))) {
                    let values: Vec<f64> = row.iter().map(|y| kernel.eval(&x, &y.point).entry(e / c, e % c) * y.weight * (b - a)).collect();
                    let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                    if largest > 0.0 {
                        worst = worst.max(panels.basis.tail(&values).powi(2) / largest);
                    }
                }
            }
        }
        Ok(worst)
    }
}

/// At which end of a segment a panel lies: f may be singular there.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    None,
    Left,
    Right,
    Both,
}

impl End {
    fn of((a, b): (f64, f64), segments: &[f64]) -> Self {
        match (segments.contains(&a), segments.contains(&b)) {
            (true, true) => End::Both,
            (true, false) => End::Left,
            (false, true) => End::Right,
            (false, false) => End::None,
        }
    }

    /// Of the left part of a panel.
    fn left(self) -> Self {
        if matches!(self, End::Left | End::Both) { End::Left } else { End::None }
    }

    fn right(self) -> Self {
        if matches!(self, End::Right | End::Both) { End::Right } else { End::None }
    }
}

/// The segments cut at further places, unless a cut is already there.
fn joined(mut segments: Vec<f64>, more: Vec<f64>) -> Vec<f64> {
    for t in more {
        if segments.iter().all(|s| (s - t).abs() > 1e-9) {
            segments.push(t);
        }
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
