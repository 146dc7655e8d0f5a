//! Eigenpairs to a tolerance: Gauss rules while they converge, else panels that are cut where an eigenfunction is not resolved.

use super::matrix::fields;
use super::pairs::{Eigenpair, on_grid};
use crate::deterministic::class::{Diagonal, classified};
use crate::deterministic::ends::Ends;
use crate::deterministic::erased::erased;
use crate::deterministic::grid::{Grid, Panels};
use crate::deterministic::jumps::{along_rows, jumps};
use crate::deterministic::lines::{Line, kinks, lines};
use crate::deterministic::nystrom::{Nystrom, graded_breaks};
use crate::deterministic::scan::Scan;
use crate::deterministic::seen::Sight;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::source_fn;
use crate::value::{Value, Weight};
use std::collections::BTreeSet;

const ORDER: usize = 16;
/// Peaks of this width or more, in units of the coordinate, are tried without panels.
const WIDE: f64 = 0.01;
/// A tail counts as resolved below this share of the tolerance at first: eigenvalues feel its square. Then below less and less.
const SHARE: f64 = 10.0;
const STRICTER: f64 = 0.03;
const STRICTEST: f64 = 1e-3;
const ROUNDS: usize = 24;
/// An error that falls by less than this when all panels are halved is one of rounding.
const STAGNANT: f64 = 0.3;
/// No panel is cut below this share of the domain.
const SMALLEST: f64 = 1.0 / (1u64 << 40) as f64;
/// Where an end panel is cut.
const QUARTER: f64 = 0.25;

pub(super) fn adaptive<K: Kernel + HasDomain + Clone>(
    kernel: &K,
    settings: &Nystrom,
    tolerance: f64,
    most: usize,
    count: usize,
) -> Result<Vec<Eigenpair<K>>, Error> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::invalid("tolerance", tolerance, "must be positive and finite"));
    }
    let (ends, lines_of_k) = (Ends::default(), Vec::new());
    let mut search = Search { kernel, tolerance, most, count, ends, lines: lines_of_k, error: f64::INFINITY, largest: 0 };
    if kernel.domain().dimension() > 1 {
        return search.globally()?.ok_or_else(|| search.failure());
    }
    let (class, ends) = classified(&erased(kernel))?;
    let diagonal = settings.declared.unwrap_or(class.diagonal);
    let mut segments = settings.segments(kernel.domain())?;
    let silent = source_fn(kernel.domain().clone(), |_: &K::Point| <<K::Weight as Weight>::Value as Value>::ZERO);
    let rows = along_rows(&erased(kernel));
    search.lines = lines(kernel.domain(), &rows);
    search.ends = ends;
    segments.extend(kinks(&search.lines, &[0.0, 1.0]));
    segments.extend(jumps(&Equation::new(silent, kernel), &rows));
    segments.sort_by(f64::total_cmp);
    segments.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let smooth =
        segments.len() == 2 && ends.rows == [false; 2] && matches!(diagonal, Diagonal::Smooth | Diagonal::Peaked { width: WIDE.. });
    if smooth && let Some(found) = search.globally()? {
        return Ok(found);
    }
    search.by_panels(&segments)?.ok_or_else(|| search.failure())
}

struct Search<'a, K> {
    kernel: &'a K,
    tolerance: f64,
    most: usize,
    count: usize,
    ends: Ends,
    lines: Vec<Line>,
    error: f64,
    largest: usize,
}

impl<K: Kernel + HasDomain + Clone> Search<'_, K> {
    fn affordable(&mut self, nodes: f64) -> bool {
        let unknowns = nodes * self.kernel.domain().states() as f64 * fields::<K>() as f64;
        self.largest = self.largest.max(unknowns as usize);
        unknowns <= self.most as f64
    }

    /// The largest error or residual, relative to |λ₁|.
    fn error_of(&mut self, pairs: &[Eigenpair<K>]) -> f64 {
        let largest = pairs.first().map_or(1.0, |p| p.value().norm());
        let worse = |m: f64, e: f64| if e.is_nan() { f64::INFINITY } else { m.max(e) };
        let error = pairs.iter().flat_map(|p| [p.error(), p.residual()]).fold(0.0, worse) / largest;
        self.error = self.error.min(error);
        error
    }

    fn globally(&mut self) -> Result<Option<Vec<Eigenpair<K>>>, Error> {
        let dimension = self.kernel.domain().dimension();
        let orders: &[usize] = match dimension {
            1 => &[16, 24, 36, 54, 80, 120, 180, 270, 400],
            2 => &[6, 9, 14, 20, 30],
            3 => &[4, 6, 8, 10],
            _ => &[3, 4, 5],
        };
        let mut last: Option<Vec<Eigenpair<K>>> = None;
        for &order in orders {
            if !self.affordable((order as f64).powi(dimension as i32)) {
                break;
            }
            let mut pairs = match on_grid(self.kernel, Grid::plain(self.kernel.domain(), 1, order)?, self.count) {
                Err(Error::NonFiniteKernel { .. }) if dimension == 1 => return Ok(None),
                other => other?,
            };
            let error = self.error_of(&pairs);
            // two rules must agree as well: what falls between the nodes of one shows in the other
            if let Some(last) = &last
                && error.max(self.change(last, &pairs)) <= self.tolerance
                && self.looked_at(&mut pairs).0 <= self.tolerance
            {
                return Ok(Some(pairs));
            }
            if last.is_some() && self.is_noise(&pairs) {
                return Err(self.failure());
            }
            last = Some(pairs);
        }
        Ok(None)
    }

    fn failure(&self) -> Error {
        Error::NotConverged { error: self.error, tolerance: self.tolerance, unknowns: self.largest }
    }

    /// Whether rounding alone is above the tolerance, on any rule.
    fn is_noise(&self, pairs: &[Eigenpair<K>]) -> bool {
        let largest = pairs.first().map_or(1.0, |p| p.value().norm());
        pairs.iter().any(|p| p.rounding() > self.tolerance * largest)
    }

    fn change(&self, coarse: &[Eigenpair<K>], fine: &[Eigenpair<K>]) -> f64 {
        if coarse.len() != fine.len() {
            return f64::INFINITY;
        }
        let largest = fine.first().map_or(1.0, |p| p.value().norm());
        coarse.iter().zip(fine).map(|(a, b)| (a.value() - b.value()).norm()).fold(0.0, f64::max) / largest
    }

    fn by_panels(&mut self, segments: &[f64]) -> Result<Option<Vec<Eigenpair<K>>>, Error> {
        let mut breaks = graded_breaks(segments, 4, 0);
        let (mut last, mut share) = (f64::INFINITY, SHARE);
        for _ in 0..ROUNDS {
            if !self.affordable((breaks.len() - 1) as f64 * ORDER as f64) {
                return Ok(None);
            }
            let grid = Grid::panelled(self.kernel.domain(), breaks.clone(), ORDER)?.towards(self.ends).across(self.lines.clone());
            let mut pairs = on_grid(self.kernel, grid, self.count)?;
            if self.is_noise(&pairs) {
                self.error_of(&pairs);
                return Err(self.failure());
            }
            let mut finer = self.refined(&pairs, segments, share);
            if finer.len() > breaks.len() {
                breaks = finer;
                continue;
            }
            let mut error = self.error_of(&pairs);
            if error <= self.tolerance {
                let (unseen, panels) = self.looked_at(&mut pairs);
                if unseen <= self.tolerance {
                    return Ok(Some(pairs));
                }
                if !panels.is_empty() {
                    breaks = halved(&breaks, |p| panels.contains(&p));
                    continue;
                }
                error = unseen;
            }
            while share > STRICTEST && finer.len() == breaks.len() {
                share *= STRICTER;
                finer = self.refined(&pairs, segments, share);
            }
            if finer.len() > breaks.len() {
                breaks = finer;
                continue;
            }
            if error > STAGNANT * last {
                return Ok(None);
            }
            last = error;
            breaks = halved(&breaks, |_| true);
        }
        Ok(None)
    }

    /// What rows and columns of K have between the nodes, as a relative error of the eigenvalues, and on which panels; the pairs then know it.
    fn looked_at(&mut self, pairs: &mut [Eigenpair<K>]) -> (f64, BTreeSet<usize>) {
        let Some(first) = pairs.first() else { return Default::default() };
        let (kernel, grid, largest) = (erased(self.kernel), first.grid().clone(), first.value().norm());
        let (sight, scan) = (Sight { kernel: &kernel, grid: &grid }, Scan::of(kernel.domain(), &grid));
        let seen = sight.look(&scan, &[]);
        // an eigenfunction has what the columns have
        let missed = seen.row + seen.largest * seen.column / largest;
        let mut worst = 0.0f64;
        for pair in pairs.iter_mut().filter(|_| missed > 0.0) {
            pair.miss(missed);
            worst = worst.max(pair.error() / largest);
        }
        self.error = self.error.max(worst);
        let lines = seen.rows.iter().map(|line| (line, 1.0)).chain(seen.columns.iter().map(|line| (line, seen.largest / largest)));
        let large = lines.filter(|(line, factor)| factor * line.gap > 0.1 * missed);
        (worst, large.filter_map(|(line, _)| sight.panel(&scan, line.at)).collect())
    }

    /// Panels cut where the Legendre tail of an eigenfunction is too large: in the middle, at the end of a segment close to it.
    fn refined(&self, pairs: &[Eigenpair<K>], segments: &[f64], share: f64) -> Vec<f64> {
        let Some(panels) = pairs.first().and_then(|p| p.grid().panels()) else { return Vec::new() };
        let mut breaks = vec![panels.breaks[0]];
        for p in 0..panels.count() {
            let (a, b) = panels.panel(p);
            if b - a > SMALLEST && pairs.iter().any(|pair| tail(pair, panels, p, self.kernel.domain().states()) > share * self.tolerance) {
                match (segments.contains(&a), segments.contains(&b)) {
                    (true, false) => breaks.extend([a + QUARTER * QUARTER * (b - a), a + QUARTER * (b - a)]),
                    (false, true) => breaks.extend([b - QUARTER * (b - a), b - QUARTER * QUARTER * (b - a)]),
                    _ => breaks.push(0.5 * (a + b)),
                }
            }
            breaks.push(b);
        }
        breaks
    }
}

/// The panels with some of them cut in the middle.
fn halved(breaks: &[f64], cut: impl Fn(usize) -> bool) -> Vec<f64> {
    let halves = |(p, e): (usize, &[f64])| if cut(p) { vec![e[0], 0.5 * (e[0] + e[1])] } else { vec![e[0]] };
    breaks.windows(2).enumerate().flat_map(halves).chain([1.0]).collect()
}

/// Legendre tail of an eigenfunction on panel `p`, over states and components, × the length of the panel: what it does elsewhere.
fn tail<K: Operator + Kernel>(pair: &Eigenpair<K>, panels: &Panels, p: usize, states: usize) -> f64 {
    let (n, m) = (panels.basis.len(), fields::<K>());
    let mut worst = 0.0f64;
    for state in 0..states {
        let first = (state * panels.count() + p) * n;
        for field in 0..m {
            let values = |part: fn(&nalgebra::Complex<f64>) -> f64| -> Vec<f64> {
                (first..first + n).map(|j| part(&pair.values()[j * m + field])).collect()
            };
            worst = worst.max(panels.basis.tail(&values(|z| z.re))).max(panels.basis.tail(&values(|z| z.im)));
        }
    }
    let (a, b) = panels.panel(p);
    worst * (b - a).sqrt().min(1.0)
}
