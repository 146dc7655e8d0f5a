//! Panels that are cut until what they report is within the tolerance.

use super::adaptive::{SHARE, Search};
use super::grid::Grid;
use super::nystrom::graded_breaks;
use super::solution::NystromSolution;
use super::verify::rounding;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::source::Source;
use crate::value::Weight;

/// Order of the panels, and of the solve that verifies them.
const ORDER: usize = 16;
const VERIFYING: usize = ORDER + 4;
/// Where rounding of K may cost this share of the tolerance, rounding of the elimination is taken out.
const ILL_CONDITIONED: f64 = 1e-3;
/// An error that falls by less than this when all panels are halved is one of rounding.
const STAGNANT: f64 = 0.3;
/// Least error that panels report, as a share of the tolerance: three unresolved tails.
const PROMISED: f64 = 3.0 * SHARE;
/// Rounds that may pass without the error falling, and how many of large systems.
const PATIENT: usize = 5;
const IMPATIENT: usize = 2;
const LARGE: usize = 1000;
/// After so many of them all panels are cut.
const ELSEWHERE: usize = 2;
/// Most features between nodes around which panels are cut, and the least panel this may make, as a share of the feature.
const FEATURES: usize = 8;
const SLIVER: f64 = 0.05;
const ROUNDS: usize = 24;

impl<G, K> Search<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    pub(super) fn by_panels(&mut self, segments: &[f64]) -> Result<Option<NystromSolution<G, K>>, Error> {
        let mut breaks = graded_breaks(segments, 4, 0);
        let (mut last, mut best, mut stalled) = (f64::INFINITY, f64::INFINITY, 0);
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
            let mut verdict = self.verified(&coarse, &fine)?;
            if verdict.error <= self.allowed(&fine) {
                // panels resolve f to a share of the tolerance: nothing below is promised, however close two solves come
                let promised = verdict.error.max(PROMISED * self.allowed(&fine));
                return Ok(Some(fine.with_error(promised, self.evaluations)));
            }
            // resolved, and no better than before: rounding
            stalled = if verdict.error > STAGNANT * best { stalled + 1 } else { 0 };
            let hopeless = stalled > if fine.unknowns() > LARGE { IMPATIENT } else { PATIENT };
            if hopeless || (verdict.doubtful.is_empty() && verdict.error > STAGNANT * last) {
                return Ok(None);
            }
            // an error shows where f has it, and may come from elsewhere
            if stalled >= ELSEWHERE && verdict.features.is_empty() {
                verdict.doubtful.clear();
            }
            best = best.min(verdict.error);
            last = verdict.error;
            breaks = cut_around(halved(&breaks, &verdict.doubtful), verdict.features);
        }
        Ok(None)
    }
}

/// The panels cut around what was found between nodes, unless that is everywhere.
fn cut_around(mut breaks: Vec<f64>, mut found: Vec<(f64, f64)>) -> Vec<f64> {
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut apart: Vec<(f64, f64)> = Vec::new();
    for (low, high) in found {
        match apart.last_mut() {
            Some(last) if low <= last.1 => last.1 = last.1.max(high),
            _ => apart.push((low, high)),
        }
    }
    for (low, high) in apart.iter().filter(|_| apart.len() <= FEATURES) {
        for t in [*low, *high] {
            let i = breaks.partition_point(|b| *b <= t).clamp(1, breaks.len() - 1);
            if (t - breaks[i - 1]).min(breaks[i] - t) > SLIVER * (high - low) {
                breaks.insert(i, t);
            }
        }
    }
    breaks
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
