//! The leading eigenvalues of a large matrix, from a small space that holds their vectors.
//!
//! ```text
//! Q = orth [V, A V, A² V, …],   H = Qᴴ A Q,   spec(H) → leading spec(A)               block Krylov; Saad, Numerical methods for large eigenvalue problems, ch. 6
//! ```
//!
//! A few random columns more than values are wanted: with a single one, multiple eigenvalues would be found once. For compact T the values settle
//! after few blocks. They serve as shifts of an inverse iteration only, which tells what they are worth.

use super::matrix::by_modulus;
use crate::sampling::{Pcg, Sampler, Sequence};
use nalgebra::{Complex, ComplexField, DMatrix, DVector};

/// Columns beyond the values that are wanted.
const SPARE: usize = 6;
/// Largest space.
const MOST: usize = 480;
/// Change from block to block, relative to the largest value, at which a value has settled.
const SETTLED: f64 = 1e-12;
/// Directions with less than this share of their column are rounding.
const NOTHING: f64 = 1e-13;

/// At least `count` leading eigenvalues, all of small matrices being found by `spectrum`; `None` if they do not settle.
pub(super) fn leading<T: ComplexField<RealField = f64>>(
    a: &DMatrix<T>,
    count: usize,
    spectrum: impl Fn(DMatrix<T>) -> Option<Vec<Complex<f64>>>,
) -> Option<Vec<Complex<f64>>> {
    let n = a.nrows();
    let mut random = Pcg::default().point(u64::MAX - 5, 0, 0);
    let mut block: Vec<DVector<T>> = (0..count + SPARE).map(|_| DVector::from_fn(n, |_, _| T::from_real(random.next_1d() - 0.5))).collect();
    let (mut basis, mut images): (Vec<DVector<T>>, Vec<DVector<T>>) = (Vec::new(), Vec::new());
    let mut last: Option<Vec<Complex<f64>>> = None;
    while basis.len() + block.len() <= MOST.min(n) {
        let before = basis.len();
        for v in block {
            extend(&mut basis, v);
        }
        let exhausted = basis.len() == before;
        if !exhausted {
            let columns = DMatrix::from_columns(&basis[before..]);
            images.extend((a * columns).column_iter().map(|c| c.into_owned()));
        }
        let values = by_modulus(spectrum(DMatrix::from_fn(basis.len(), basis.len(), |i, j| basis[i].dotc(&images[j])))?);
        let largest = values.first()?.norm();
        let settled = |last: &Vec<Complex<f64>>| {
            (0..count).all(|k| match (values.get(k), last.get(k)) {
                (Some(v), Some(l)) => (v - l).norm() <= SETTLED * largest,
                _ => false,
            })
        };
        if exhausted || last.as_ref().is_some_and(settled) {
            return Some(values);
        }
        last = Some(values);
        block = images[before..].to_vec();
    }
    None
}

/// Adds what v has beyond the basis.
fn extend<T: ComplexField<RealField = f64>>(basis: &mut Vec<DVector<T>>, mut v: DVector<T>) {
    let size = v.norm();
    for _ in 0..2 {
        for q in basis.iter() {
            let part = q.dotc(&v);
            v.axpy(-part, q, T::one());
        }
    }
    let rest = v.norm();
    if rest > NOTHING * size {
        basis.push(v.unscale(rest));
    }
}

#[cfg(test)]
mod tests {
    use super::leading;
    use crate::deterministic::spectrum::matrix::real_spectrum;
    use nalgebra::DMatrix;

    #[test]
    fn multiple_eigenvalues_are_found_as_often_as_they_are() {
        // a circulant: eigenvalue 1 once, then pairs e^{−m/2}
        let n = 300;
        let entry = |d: f64| (1..40).map(|m| 2.0 * (-0.5 * f64::from(m)).exp() * (f64::from(m) * d).cos()).sum::<f64>() + 1.0;
        let a = DMatrix::from_fn(n, n, |i, j| entry((i as f64 - j as f64) * std::f64::consts::TAU / n as f64) / n as f64);
        let values = leading(&a, 7, real_spectrum).unwrap();
        let known = [0.0, 0.5, 0.5, 1.0, 1.0, 1.5, 1.5].map(|e: f64| (-e).exp());
        assert!(values.iter().zip(known).all(|(v, k)| (v.re - k).abs() < 1e-12 && v.im.abs() < 1e-12), "{:?}", &values[..7]);
    }

    #[test]
    fn finite_rank() {
        let a = DMatrix::from_fn(250, 250, |i, j| ((i * j % 7) as f64 - 3.0) * 1e-3);
        let n = 250.0 * 1e-3;
        let values = leading(&a, 4, real_spectrum).unwrap();
        assert!(values.len() >= 4 && values[0].norm() < 7.0 * n);
    }
}
