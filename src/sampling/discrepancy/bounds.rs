//! Rigorous bounds of the star discrepancy where its exact value costs too much.
//!
//! Between the corners a ≤ y ≤ b of a bracket,
//!
//! ```text
//! #{x < a} ≤ #{x < y} ≤ #{x < b},   so   |local discrepancy of y| ≤ max( vol b − #{x < a}/n,  #{x < b}/n − vol a )
//! ```
//!
//! The cube is cut into brackets, the one of the largest bound first (branch and bound on the brackets of Thiémard, *An algorithm to
//! compute bounds for the star discrepancy*, 2001). From below, boxes at their corners are drawn in or blown up to the nearest critical
//! ones, and their local discrepancy taken.

use super::PointSet;
use crate::error::Error;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Bounds of a star discrepancy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The local discrepancy of some box.
    pub lower: f64,
    /// What no box exceeds.
    pub upper: f64,
}

struct Bracket {
    upper: f64,
    a: Vec<f64>,
    b: Vec<f64>,
}

impl PartialEq for Bracket {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Bracket {}
impl PartialOrd for Bracket {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Bracket {
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper)
    }
}

impl PointSet {
    /// Bounds of the star discrepancy from so many brackets, each of which costs O(n d). The gap falls about as brackets^(−1/d).
    ///
    /// ```
    /// # use fredholm::sampling::{Halton, PointSet};
    /// let points = PointSet::draw(&Halton::new(0).unscrambled(), 3, 2000)?;     // too many for the exact value
    /// let bounds = points.star_bounds(3000)?;
    /// assert!(points.star().is_err() && bounds.lower > 0.004 && bounds.upper < 0.1, "{bounds:?}");
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for no brackets.
    pub fn star_bounds(&self, brackets: usize) -> Result<Bounds, Error> {
        if brackets == 0 {
            return Err(Error::invalid("brackets", 0.0, "must be at least 1"));
        }
        let d = self.dimension();
        let (mut lower, mut queue) = (0.0, BinaryHeap::new());
        queue.push(self.bracket(vec![0.0; d], vec![1.0; d], &mut lower));
        for _ in 1..brackets {
            // a bracket that cannot hold more than what was found is never cut
            let Some(Bracket { a, b, .. }) = queue.pop().filter(|top| top.upper > lower) else { break };
            // the side whose halves differ most in volume
            let k = (0..d).max_by(|i, j| ((b[*i] - a[*i]) / b[*i]).total_cmp(&((b[*j] - a[*j]) / b[*j]))).unwrap_or(0);
            let middle = 0.5 * (a[k] + b[k]);
            let (mut low, mut high) = (b.clone(), a.clone());
            (low[k], high[k]) = (middle, middle);
            queue.push(self.bracket(a, low, &mut lower));
            queue.push(self.bracket(high, b, &mut lower));
        }
        let upper = queue.peek().map_or(lower, |top| top.upper.max(lower));
        Ok(Bounds { lower, upper })
    }

    fn bracket(&self, a: Vec<f64>, b: Vec<f64>, lower: &mut f64) -> Bracket {
        let n = self.count() as f64;
        let below = |corner: &[f64]| self.iter().filter(|x| inside(x, corner)).count() as f64 / n;
        let volume = |corner: &[f64]| corner.iter().product::<f64>();
        let upper = (volume(&b) - below(&a)).max(below(&b) - volume(&a));
        *lower = lower.max(self.drawn_in(&b)).max(self.blown_up(&b));
        Bracket { upper, a, b }
    }

    /// The closed box around the points inside: excess of points.
    fn drawn_in(&self, corner: &[f64]) -> f64 {
        let (mut count, mut least) = (0.0, vec![0.0f64; self.dimension()]);
        for x in self.iter().filter(|x| inside(x, corner)) {
            count += 1.0;
            least.iter_mut().zip(x).for_each(|(l, x)| *l = l.max(*x));
        }
        count / self.count() as f64 - least.iter().product::<f64>()
    }

    /// Side by side until a point is met: excess of volume.
    fn blown_up(&self, corner: &[f64]) -> f64 {
        let mut y = corner.to_vec();
        let count = self.iter().filter(|x| inside(x, &y)).count() as f64;
        for k in 0..y.len() {
            let elsewhere = |x: &&[f64]| x[k] >= y[k] && x.iter().zip(&y).enumerate().all(|(j, (x, y))| j == k || x < y);
            y[k] = self.iter().filter(elsewhere).map(|x| x[k]).fold(1.0, f64::min);
        }
        y.iter().product::<f64>() - count / self.count() as f64
    }
}

fn inside(x: &[f64], corner: &[f64]) -> bool {
    x.iter().zip(corner).all(|(x, c)| x < c)
}
