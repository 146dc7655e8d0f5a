//! Rules for the same functions that share no nodes with another one: what residuals are taken by.

use super::ends::Ends;
use super::grid::Grid;
use crate::domain::{Domain, Point};
use crate::error::Error;

/// Above so many equidistant nodes others of their kind check them.
const MANY: f64 = 200.0;

impl<X: Point> Grid<X> {
    /// A rule for the same domain that shares neither nodes nor order with this one.
    pub(crate) fn independent<D: Domain<Point = X>>(&self, domain: &D) -> Result<Self, Error> {
        if let Some(p) = &self.panels {
            let grid = Grid::panelled(domain, between(&p.breaks, domain.volume().is_finite()), p.basis.len() + 3)?;
            return Ok(grid.towards(self.ends).across(self.lines.clone()));
        }
        if self.is_double_exponential() {
            // f may be singular at both ends
            return Ok(Grid::panelled(domain, geometric(), 16)?.towards(Ends::all(domain)));
        }
        let per_axis = (self.nodes.len() as f64 / domain.states() as f64).powf(1.0 / domain.dimension().max(1) as f64);
        match domain.dimension() {
            // panels would need as many nodes as the function has waves, and more
            1 if self.is_equidistant() && per_axis > MANY => Grid::equidistant(domain, (1.1 * per_axis) as usize | 1),
            // towards the diagonal as well: a kink that the solve does not see must not hide here
            1 => Grid::panelled(domain, vec![0.0, 0.27, 0.55, 0.81, 1.0], (per_axis / 3.0).ceil() as usize + 7),
            _ if self.is_centred() => Grid::centred(domain, per_axis.round() as usize + 3),
            _ => Grid::plain(domain, 1, per_axis.round() as usize + 3),
        }
    }
}

/// Breaks at 4^{−k}, from both ends.
fn geometric() -> Vec<f64> {
    let shares: Vec<f64> = (1..=20).map(|k| 0.25f64.powi(k)).collect();
    let left = shares.iter().rev().copied();
    std::iter::once(0.0).chain(left).chain([0.51]).chain(shares.iter().map(|t| 1.0 - t)).chain([1.0]).collect()
}

/// The same breaks with one more near the middle of every third panel, so that panels and nodes differ, and two more in the shortest panels around:
/// there f is singular, and more nodes on the same panel would make the same error again.
fn between(breaks: &[f64], finite: bool) -> Vec<f64> {
    let length = |i: usize| breaks.get(i + 1).map_or(f64::INFINITY, |b| b - breaks[i]);
    let mut out = vec![breaks[0]];
    for (i, ends) in breaks.windows(2).enumerate() {
        let (a, h) = (ends[0], ends[1] - ends[0]);
        let before = if i == 0 { f64::INFINITY } else { length(i - 1) };
        // nothing is singular at infinity
        let inside = finite || i + 2 < breaks.len();
        // equal up to rounding counts as shortest
        if inside && h <= 1.001 * before.min(length(i + 1)) && (h < 0.9 * before.max(length(i + 1)) || breaks.len() < 4) {
            out.extend([a + 0.09 * h, a + 0.91 * h]);
        } else if i % 3 == 0 {
            out.push(a + 0.46 * h);
        }
        out.push(ends[1]);
    }
    out
}
