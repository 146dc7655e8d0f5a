//! The weights of least variance.
//!
//! ```text
//! min aᵀSa  subject to  1ᵀa = 1:      a = S⁻¹1 / (1ᵀS⁻¹1)                                                               theory (4.15.1)
//! ```
//!
//! S may be singular. With S v = 0 and 1ᵀv ≠ 0 some combination has no variance at all: a is then the projection of 1 on the null space, the limit of
//! (S + εI)⁻¹1. Otherwise the null directions, differences of estimators that coincide, are left out: the pseudo-inverse.

use nalgebra::{DMatrix, DVector};

/// Eigenvalues below this share of the largest are taken for zero: rounding of covariances.
const SINGULAR: f64 = 1e-12;

/// The same for controls: those that add up to 0 are common.
const DEPENDENT: f64 = 1e-9;

/// Sample covariance of columns of equally many scores.
pub(super) fn covariance(columns: &[Vec<f64>]) -> DMatrix<f64> {
    let n = columns[0].len() as f64;
    let centred: Vec<Vec<f64>> = columns
        .iter()
        .map(|c| {
            let mean = c.iter().sum::<f64>() / n;
            c.iter().map(|y| y - mean).collect()
        })
        .collect();
    let product = |i: usize, j: usize| centred[i].iter().zip(&centred[j]).map(|(a, b)| a * b).sum::<f64>() / (n - 1.0);
    DMatrix::from_fn(columns.len(), columns.len(), |i, j| product(i.min(j), i.max(j)))
}

/// a of least aᵀSa among those that add up to 1.
pub(super) fn weights(s: &DMatrix<f64>) -> DVector<f64> {
    let n = s.nrows();
    let one = DVector::from_element(n, 1.0);
    let largest = s.diagonal().max();
    if !(largest > 0.0) {
        return one / n as f64;
    }
    let eigen = (s / largest).symmetric_eigen();
    let threshold = SINGULAR * eigen.eigenvalues.max();
    let along = eigen.eigenvectors.tr_mul(&one);
    let is_null = |i: usize| eigen.eigenvalues[i] <= threshold;
    // 1 has a part without variance, beyond rounding
    let free = (0..n).filter(|i| is_null(*i)).map(|i| along[i] * along[i]).sum::<f64>() > 1e-6;
    let coefficient = |i: usize| match (is_null(i), free) {
        (true, true) => along[i],
        (false, false) => along[i] / eigen.eigenvalues[i],
        _ => 0.0,
    };
    let a = &eigen.eigenvectors * DVector::from_fn(n, |i, _| coefficient(i));
    let sum = a.sum();
    a / sum
}

/// a of least variance of Y + Σ a_k D_k, from equally many scores of Y and of controls D_k of mean 0; 0 unless what either half of the scores finds takes
/// variance from the other: controls that were seldom seen would add it. `None` if sums are not finite.
pub(crate) fn coefficients(controls: &[Vec<f64>], y: &[f64]) -> Option<Vec<f64>> {
    // every other score: neighbours may be of one cell
    let half = |first: usize, of: &[f64]| of.iter().copied().skip(first).step_by(2).collect::<Vec<f64>>();
    let halves = [0, 1].map(|first| (controls.iter().map(|d| half(first, d)).collect::<Vec<_>>(), half(first, y)));
    let mut gain = 0.0;
    for ((seen, scores), (controls, y)) in [(&halves[0], &halves[1]), (&halves[1], &halves[0])] {
        let a = regression(seen, scores)?;
        let explained = |i: usize| a.iter().zip(controls).map(|(a, d)| a * d[i]).sum::<f64>();
        let rest: Vec<f64> = y.iter().enumerate().map(|(i, y)| y + explained(i)).collect();
        gain += variation(y) - variation(&rest);
    }
    let all = regression(controls, y)?;
    Some(if gain > 0.0 { all } else { vec![0.0; all.len()] })
}

/// Σ (y − ȳ)².
fn variation(y: &[f64]) -> f64 {
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    y.iter().map(|y| (y - mean).powi(2)).sum()
}

/// −(DᵀD)⁺ Dᵀ(Y − Ȳ).
fn regression(controls: &[Vec<f64>], y: &[f64]) -> Option<Vec<f64>> {
    let n = controls.len();
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    // in units of their own sizes, so that one threshold serves all
    let sizes: Vec<f64> = controls.iter().map(|d| d.iter().map(|d| d * d).sum::<f64>().sqrt()).collect();
    let units = |i: usize| if sizes[i] > 0.0 { 1.0 / sizes[i] } else { 0.0 };
    let product = |i: usize, j: usize| controls[i].iter().zip(&controls[j]).map(|(a, b)| a * units(i) * b * units(j)).sum::<f64>();
    let gram = DMatrix::from_fn(n, n, |i, j| product(i.min(j), i.max(j)));
    let along = DVector::from_fn(n, |i, _| controls[i].iter().zip(y).map(|(d, y)| d * units(i) * (y - mean)).sum::<f64>());
    if !gram.iter().chain(&along).all(|v| v.is_finite()) {
        return None;
    }
    let eigen = gram.symmetric_eigen();
    let threshold = DEPENDENT * eigen.eigenvalues.max();
    let inverse = eigen.eigenvalues.map(|v| if v > threshold { 1.0 / v } else { 0.0 });
    let a = -&eigen.eigenvectors * eigen.eigenvectors.tr_mul(&along).component_mul(&inverse);
    Some((0..n).map(|i| a[i] * units(i)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[&[f64]]) -> Vec<f64> {
        let n = rows.len();
        weights(&DMatrix::from_fn(n, n, |i, j| rows[i][j])).iter().copied().collect()
    }

    fn close(a: &[f64], b: &[f64]) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?} is not {b:?}");
    }

    #[test]
    fn the_weights_are_those_of_least_variance() {
        // independent: inverse variances; correlated: S⁻¹1 by hand
        close(&of(&[&[1.0, 0.0], &[0.0, 4.0]]), &[0.8, 0.2]);
        close(&of(&[&[1.0, 1.5], &[1.5, 4.0]]), &[1.25, -0.25]);
    }

    #[test]
    fn singular_covariances_have_an_answer() {
        // the same estimator twice, and with a third
        close(&of(&[&[2.0, 2.0], &[2.0, 2.0]]), &[0.5, 0.5]);
        close(&of(&[&[1.0, 1.0, 0.0], &[1.0, 1.0, 0.0], &[0.0, 0.0, 1.0]]), &[0.25, 0.25, 0.5]);
        // antithetic: the mean has no variance; one of no variance at all; none of any
        close(&of(&[&[1.0, -1.0], &[-1.0, 1.0]]), &[0.5, 0.5]);
        close(&of(&[&[0.0, 0.0], &[0.0, 3.0]]), &[1.0, 0.0]);
        close(&of(&[&[0.0, 0.0], &[0.0, 0.0]]), &[0.5, 0.5]);
    }

    #[test]
    fn coefficients_take_away_what_the_controls_explain() {
        // y = 2 + 3 d₀ − d₁ and a control that is a multiple of another, or nothing
        let d = [vec![1.0, -1.0, 1.0, -1.0], vec![1.0, 1.0, -1.0, -1.0], vec![2.0, -2.0, 2.0, -2.0], vec![0.0; 4]];
        let y: Vec<f64> = (0..4).map(|i| 2.0 + 3.0 * d[0][i] - d[1][i]).collect();
        let a = coefficients(&d, &y).unwrap();
        close(&[a[0] + 2.0 * a[2], a[1], a[3]], &[-3.0, 1.0, 0.0]);
        assert!(coefficients(&[vec![f64::INFINITY; 4]], &y).is_none());
        // what was seen once says nothing
        assert_eq!(coefficients(&[vec![1.0, 0.0, 0.0, 0.0]], &[5.0, 1.0, 0.0, 1.0]), Some(vec![0.0]));
    }
}
