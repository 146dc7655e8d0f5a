//! Lines y = x + c and x + y = c away from the diagonal along which K jumps, has a kink or is singular, |x − y| < r: found from jumps of
//! rows that move with x. And y = c, where K(x, ·) is singular whatever x.
//!
//! Rows are integrated by pieces cut towards their crossing with a line as they are towards y = x; where a line meets an end of the domain, f may have a kink,
//! and where it meets such a place a weaker one.

use super::jumps::OTHERS;
use crate::domain::Domain;

/// Offsets this close are one line.
const SAME: f64 = 1e-9;
/// Places where f may have a kink, a kink of its derivative, and one of its second derivative; and most of them.
const GENERATIONS: usize = 3;
const MOST: usize = 24;

/// u = offset + slope · t in coordinates, slope ±1, or 0 of a [column](super::jumps::singular_columns) where rows are singular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    slope: f64,
    offset: f64,
}

impl Line {
    /// All rows at coordinate u.
    pub(super) fn at(u: f64) -> Self {
        Line { slope: 0.0, offset: u }
    }

    /// Where the row at coordinate t crosses.
    pub(super) fn crossing(self, t: f64) -> Option<f64> {
        Some(self.offset + self.slope * t).filter(|u| *u > 0.0 && *u < 1.0)
    }

    fn is_like(self, other: Line) -> bool {
        self.slope == other.slope && (self.offset - other.offset).abs() < SAME
    }
}

/// Lines of a kernel on a finite interval, from the jumps along its [rows](super::jumps::along_rows): two of three must agree.
pub(super) fn lines<D: Domain>(domain: &D, rows: &[[Vec<f64>; 3]]) -> Vec<Line> {
    let mut found: Vec<Line> = Vec::new();
    if domain.stretch().is_none() {
        return found;
    }
    for (rows, slope) in rows.iter().flat_map(|rows| [(rows, 1.0), (rows, -1.0)]) {
        let of_row = |i: usize| rows[i].iter().map(|u| Line { slope, offset: u - slope * OTHERS[i] }).collect::<Vec<_>>();
        let lists: Vec<Vec<Line>> = (0..OTHERS.len()).map(of_row).collect();
        for line in lists.iter().flatten() {
            let twice = lists.iter().filter(|list| list.iter().any(|l| l.is_like(*line))).count() >= 2;
            if twice && !found.iter().any(|l| l.is_like(*line)) {
                found.push(*line);
            }
        }
    }
    found
}

/// Coordinates inside (0, 1) at which lines make f less than smooth.
pub(super) fn kinks(lines: &[Line], segments: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = segments.to_vec();
    let mut last = all.clone();
    for _ in 0..GENERATIONS {
        let back = last.iter().flat_map(|u| lines.iter().map(move |l| l.slope * (u - l.offset)));
        let mut new: Vec<f64> = Vec::new();
        for t in back.filter(|t| *t > SAME && *t < 1.0 - SAME) {
            if !all.iter().chain(&new).any(|s| (s - t).abs() < SAME) && all.len() + new.len() < MOST {
                new.push(t);
            }
        }
        all.extend(&new);
        last = new;
    }
    all[segments.len()..].to_vec()
}

#[cfg(test)]
mod tests {
    use super::{kinks, lines};
    use crate::Equation;
    use crate::deterministic::jumps::along_rows;
    use crate::kernel::HasDomain;

    #[test]
    fn lines_are_found_and_nothing_else() {
        type K = fn(f64, f64) -> f64;
        let of = |k: K| {
            let eq = Equation::on_interval(0.0..=2.0, |_| 1.0, k);
            lines(eq.kernel().domain(), &along_rows(eq.kernel()))
        };
        let band = of(|x, y| f64::from((x - y).abs() < 0.6));
        assert!(band.len() == 2 && band.iter().all(|l| l.slope == 1.0 && (l.offset.abs() - 0.3).abs() < 1e-15), "{band:?}");
        let found = kinks(&band, &[0.0, 1.0]);
        assert!(
            found.len() == 6 && [0.3, 0.7, 0.6, 0.4, 0.9, 0.1].iter().all(|t| found.iter().any(|f| (f - t).abs() < 1e-12)),
            "{found:?}"
        );
        let sum = of(|x, y| if x + y < 2.0 { 1.0 } else { 0.3 });
        assert!(sum.len() == 1 && sum[0].slope == -1.0 && (sum[0].offset - 1.0).abs() < 1e-15, "{sum:?}");
        for none in [(|x, y| f64::exp(-f64::abs(x - y))) as K, |x, y| f64::from(x < y), |_, y| f64::from(y < 0.7), |x, y| (x * y).cos()] {
            assert!(of(none).is_empty());
        }
    }
}
