//! Spectral radii of non-negative matrices.

use nalgebra::{DMatrix, DVector};

/// Spectral radius of a non-negative matrix: power iteration with Collatz–Wielandt bounds, else Gelfand's formula by repeated squaring.
pub(super) fn spectral_radius(a: &DMatrix<f64>) -> f64 {
    let mut v = DVector::from_element(a.nrows(), 1.0);
    for _ in 0..200 {
        let w = a * &v;
        let ratios = w.iter().zip(v.iter()).map(|(w, v)| w / v);
        let (lo, hi) = ratios.fold((f64::INFINITY, 0.0f64), |(lo, hi), r| (lo.min(r), hi.max(r)));
        let norm = w.amax();
        if norm == 0.0 || (lo > 0.0 && hi - lo <= 1e-9 * hi) {
            return if norm == 0.0 { 0.0 } else { 0.5 * (lo + hi) };
        }
        v = w / norm;
        if v.iter().any(|x| *x <= 1e-100) {
            break; // reducible: the bounds do not close
        }
    }
    gelfand(a.clone())
}

/// ρ = lim ‖A^m‖^{1/m} by repeated squaring, m up to 2³²: right whatever the Jordan form.
///
/// Once A^m, normalised, has rank one, squaring multiplies it by its trace for ever, and the rest of the limit is a geometric series.
pub(crate) fn gelfand(mut a: DMatrix<f64>) -> f64 {
    let (mut log, mut power) = (0.0, 1.0f64);
    let mut last = f64::NAN;
    for _ in 0..32 {
        let norm = a.amax();
        if norm == 0.0 {
            return 0.0;
        }
        if (norm - last).abs() <= 1e-13 * norm {
            return (log + 2.0 * norm.ln() / power).exp();
        }
        log += norm.ln() / power;
        a /= norm;
        a = &a * &a;
        power *= 2.0;
        last = norm;
    }
    log.exp()
}
