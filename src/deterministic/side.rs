//! Values towards a place from one side, and what they tell.

use super::class::{Diagonal, MOST_RANK, NOISE};
use nalgebra::DMatrix;

/// Crosses a_i b_j/p around the largest entry p, subtracted until 10⁻¹² of the first p is left (Bebendorf, *Numer. Math.* 86 (2000) 565).
pub(super) fn cross_rank(mut matrix: DMatrix<f64>) -> Option<usize> {
    let mut first = 0.0;
    for rank in 0..=MOST_RANK {
        let (i, j) = matrix.iamax_full();
        let pivot = matrix[(i, j)];
        if rank == 0 {
            first = pivot.abs();
        }
        if pivot.abs() <= 1e-12 * first {
            return Some(rank);
        }
        let (column, row) = (matrix.column(j) / pivot, matrix.row(i).into_owned());
        matrix.ger(-1.0, &column, &row.transpose(), 1.0);
    }
    None
}

/// K towards the diagonal from one side.
pub(super) enum Side {
    /// A limit, the slope against the distance, the distance at which half of the limit is left (1 if nowhere), and the largest |K| on the way.
    Limit {
        value: f64,
        slope: f64,
        half: f64,
        largest: f64,
    },
    Singular(Diagonal),
}

impl Side {
    pub(super) fn of(distances: &[f64], values: &[f64]) -> Self {
        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let value = values.last().copied().unwrap_or(0.0);
        let Some((growth, first)) = growth(values, NOISE * largest) else {
            return Side::Limit { value, slope: 0.0, half: half(distances, values), largest };
        };
        let step = values[first + 4] - values[first + 3];
        let exponent = growth.log2();
        // differences that fall like r² or faster: the slope is 0
        let slope = if growth < 0.35 { 0.0 } else { step / (distances[first + 4] - distances[first + 3]) };
        match growth {
            g if g >= 2f64.powf(0.985) => Side::Singular(Diagonal::NotIntegrable { exponent }),
            g if (g - 1.0).abs() < 0.02 => Side::Singular(Diagonal::Logarithmic),
            // r ln r comes close to ½ slowly
            g if g > 0.57 => Side::Singular(Diagonal::Algebraic { exponent }),
            _ => Side::Limit { value, slope, half: half(distances, values), largest },
        }
    }
}

/// By what the differences of values along halved distances grow in the deepest four in a row above `noise`, and the first of them.
pub(super) fn growth(values: &[f64], noise: f64) -> Option<(f64, usize)> {
    let steps: Vec<f64> = values.windows(2).map(|v| v[1] - v[0]).collect();
    let above = |w: &[f64]| w.iter().all(|d| d.abs() > noise);
    let first = (0..steps.len().saturating_sub(3)).rev().find(|&k| above(&steps[k..k + 4]))?;
    Some((((steps[first + 3] / steps[first]).abs().ln() / 3.0).exp(), first))
}

/// The largest distance below which all values keep more than half of the innermost one.
fn half(distances: &[f64], values: &[f64]) -> f64 {
    let top = values.last().map_or(0.0, |v| v.abs());
    if top == 0.0 {
        return 1.0;
    }
    distances.iter().zip(values).rev().find(|(_, v)| v.abs() < 0.5 * top).map_or(1.0, |(r, _)| *r)
}
