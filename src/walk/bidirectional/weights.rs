//! How the strategies of one path share it.
//!
//! ```text
//! w_s = 1 / Σ_k (p_k/p_s)^β,        p_{s+1}/p_s = π*(x_{m−s+1} → x_{m−s}) / π(x_{m−s−1} → x_{m−s})                 theory (4.7.5), (4.7.6)
//! Σ_{k > s} (p_k/p_s)^β = R_{t−1} (c_{t−1} + R_{t−2} (c_{t−2} + …)),     R_i = (reverse density/own density)^β of eye vertex i
//! ```
//!
//! and the same towards k < s along the forward walk: two sums that grow with the walks, so that a weight costs two terms whatever the order. c = 0
//! where the joining edge would be a Dirac part. The maximum (β = ∞) compares sums of logarithms instead.

use super::path::Vertex;
use crate::walk::Heuristic;

/// R^β; the average (β = 0) counts the techniques that can find the path.
#[inline]
fn term(heuristic: Heuristic, ratio: f64) -> f64 {
    match heuristic {
        Heuristic::Power(2.0) => ratio * ratio,
        Heuristic::Power(beta) => ratio.powf(beta),
        Heuristic::Average if ratio > 0.0 => 1.0,
        // 0 or NaN
        Heuristic::Average | Heuristic::Balance | Heuristic::Maximum => ratio,
    }
}

/// R^β (c + Σ): 0 where R is, even if the sum beyond has overflowed.
#[inline]
fn onward<X, L>(heuristic: Heuristic, vertex: &Vertex<X, L>, joinable: bool, reverse: f64, beyond: f64) -> f64 {
    let term = term(heuristic, vertex.ratio(reverse));
    if term == 0.0 { 0.0 } else { term * (f64::from(u8::from(joinable)) + beyond) }
}

/// Fills `sum` along a walk whose reverse densities are known, up to where they are.
pub(super) fn accumulate<X, L>(heuristic: Heuristic, path: &mut [Vertex<X, L>]) {
    let mut sum = 0.0;
    for vertex in path {
        sum = onward(heuristic, vertex, vertex.joinable, vertex.reverse, sum);
        vertex.sum = sum;
    }
}

/// One of both walks, cut where it is joined, with the densities of arrival from the other side.
pub(super) struct Side<'a, X, L> {
    pub(super) path: &'a [Vertex<X, L>],
    /// at the last vertex
    pub(super) last: f64,
    /// at the one before, where it depends on the other side
    pub(super) before: Option<f64>,
}

impl<X, L> Side<'_, X, L> {
    /// Of no vertices.
    pub(super) fn empty() -> Self {
        Side { path: &[], last: f64::NAN, before: None }
    }

    /// Σ (p_k/p_s)^β over the strategies that leave vertices of this side to the other.
    #[inline]
    fn sum(&self, heuristic: Heuristic) -> f64 {
        let Some((last, rest)) = self.path.split_last() else { return 0.0 };
        let shorter = match (rest.split_last(), self.before) {
            (None, _) => 0.0,
            (Some((before, _)), None) => before.sum,
            (Some((before, rest)), Some(reverse)) => {
                onward(heuristic, before, before.joinable, reverse, rest.last().map_or(0.0, |v| v.sum))
            }
        };
        onward(heuristic, last, last.regular, self.last, shorter)
    }

    /// Calls `f(i, p_k/p_s)` for the strategies that leave i = 1, 2, … vertices of this side to the other, on a side without Dirac parts.
    #[inline]
    pub(super) fn each(&self, mut f: impl FnMut(usize, f64)) {
        let (n, mut product) = (self.path.len(), 1.0);
        for (i, vertex) in self.path.iter().enumerate().rev() {
            product *= vertex.ratio(if i + 1 == n { self.last } else { vertex.reverse });
            f(n - i, product);
        }
    }

    /// ln(p_k/p_s) of these strategies, nearest first.
    fn logarithms(&self) -> impl Iterator<Item = f64> {
        let n = self.path.len();
        let reverse = move |i: usize| match (n - 1 - i, self.before) {
            (0, _) => self.last,
            (1, Some(before)) => before,
            _ => self.path[i].reverse,
        };
        // a walk that is cut here is joined by a density
        let joinable = move |i: usize| if i + 1 == n { self.path[i].regular } else { self.path[i].joinable };
        let mut sum = 0.0;
        (0..n).rev().filter_map(move |i| {
            sum += self.path[i].ratio(reverse(i)).ln();
            (joinable(i) || sum.is_nan()).then_some(sum)
        })
    }
}

/// Ties of the maximum are exact on paper, and up to rounding in sums of logarithms.
const TIE: f64 = 1e-9;

/// The weight of a strategy; ties of the maximum belong to the one with fewest vertices from the source. NaN if a density is unstated.
#[inline]
pub(super) fn weight<X, Z, L, M>(heuristic: Heuristic, eye: &Side<'_, X, L>, light: &Side<'_, Z, M>) -> f64 {
    if heuristic != Heuristic::Maximum {
        return 1.0 / (1.0 + eye.sum(heuristic) + light.sum(heuristic));
    }
    let mut share: f64 = 1.0;
    for log in eye.logarithms() {
        share = if log.is_nan() || share.is_nan() {
            f64::NAN
        } else if log > TIE {
            0.0
        } else {
            share
        };
    }
    for log in light.logarithms() {
        share = if log.is_nan() || share.is_nan() {
            f64::NAN
        } else if log >= -TIE {
            0.0
        } else {
            share
        };
    }
    share
}
