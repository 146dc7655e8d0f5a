//! T = U Vᵀ of few columns.
//!
//! ```text
//! T ≈ Σ_k u_k v_kᵀ,   u_k = column of the residual / pivot,  v_k = row        Bebendorf, Numer. Math. 86 (2000) 565: adaptive cross approximation
//! (I − U Vᵀ)⁻¹ = I + U (I − Vᵀ U)⁻¹ Vᵀ                                     Woodbury 1950
//! ```
//!
//! r rows and r columns of T are evaluated, 2 n r values of K. That the others are what the crosses make of them is [checked](super::fast) on a sample of
//! rows before anything is solved.

use super::linear::{Factor, LinearMap};
use crate::error::Error;
use nalgebra::{DMatrix, DVector};

/// Crosses smaller than this share of the sum end the approximation, if two in a row are.
const SMALL: f64 = 1e-15;

/// Crosses of a matrix given by its rows and columns; `None` if `most` are not enough.
pub(super) fn cross(
    n: usize,
    most: usize,
    row: impl Fn(usize) -> Result<DVector<f64>, Error>,
    column: impl Fn(usize) -> Result<DVector<f64>, Error>,
) -> Result<Option<(DMatrix<f64>, DMatrix<f64>)>, Error> {
    let (mut us, mut vs): (Vec<DVector<f64>>, Vec<DVector<f64>>) = (Vec::new(), Vec::new());
    let mut used = vec![false; n];
    let (mut next, mut size, mut small, mut empty) = (n / 2, 0.0f64, 0, 0);
    while us.len() <= most {
        used[next] = true;
        let mut v = row(next)?;
        us.iter().zip(&vs).for_each(|(a, b)| v.axpy(-a[next], b, 1.0));
        let pivot = v.icamax();
        let unused = |from: usize| (0..n).map(|k| (from + k) % n).find(|i| !used[*i]);
        // a row that is nothing but rounding has no pivot
        if v[pivot].abs() * (n as f64) <= SMALL * size || v[pivot] == 0.0 {
            empty += 1;
            match unused(next + n / 3) {
                Some(row) if empty < 3 => next = row,
                _ => return Ok(Some(collected(n, &us, &vs))),
            }
            continue;
        }
        empty = 0;
        let mut u = column(pivot)?;
        us.iter().zip(&vs).for_each(|(a, b)| u.axpy(-b[pivot], a, 1.0));
        u /= v[pivot];
        let cross = u.norm() * v.norm();
        size = size.max(cross);
        // the largest of what is left, off the rows that are exact
        let largest = (0..n).filter(|i| !used[*i]).max_by(|a, b| u[*a].abs().total_cmp(&u[*b].abs()).then(b.cmp(a)));
        us.push(u);
        vs.push(v);
        small = if cross <= SMALL * size { small + 1 } else { 0 };
        match largest {
            Some(row) if small < 2 => next = row,
            _ => return Ok(Some(collected(n, &us, &vs))),
        }
    }
    Ok(None)
}

fn collected(n: usize, us: &[DVector<f64>], vs: &[DVector<f64>]) -> (DMatrix<f64>, DMatrix<f64>) {
    if us.is_empty() {
        return (DMatrix::zeros(n, 1), DMatrix::zeros(n, 1));
    }
    (DMatrix::from_columns(us), DMatrix::from_columns(vs))
}

/// I − U Vᵀ with the inverse of I − Vᵀ U.
#[derive(Clone, Debug)]
pub(super) struct Woodbury {
    u: DMatrix<f64>,
    v: DMatrix<f64>,
    small: Factor,
}

impl Woodbury {
    /// U orthonormal after this: I − Vᵀ U is then about as well conditioned as I − U Vᵀ.
    pub(super) fn new(u: DMatrix<f64>, v: DMatrix<f64>) -> Result<Self, Error> {
        let qr = u.qr();
        let (u, v) = (qr.q(), v * qr.r().transpose());
        let small = Factor::new(DMatrix::identity(u.ncols(), u.ncols()) - v.tr_mul(&u))?;
        Ok(Woodbury { u, v, small })
    }

    pub(super) fn rank(&self) -> usize {
        self.u.ncols()
    }

    /// One step of refinement takes out what the cancellation in I − Vᵀ U costs.
    pub(super) fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let once = |b: &DVector<f64>| b + &self.u * self.small.solve(&self.v.tr_mul(b));
        let x = once(b);
        let r = b - &x + self.apply(&x);
        x + once(&r)
    }

    pub(super) fn solve_transposed(&self, b: &DVector<f64>) -> DVector<f64> {
        let once = |b: &DVector<f64>| b + &self.v * self.small.solve_transposed(&self.u.tr_mul(b));
        let x = once(b);
        let r = b - &x + self.apply_transposed(&x);
        x + once(&r)
    }
}

impl LinearMap for Woodbury {
    fn apply(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.u * self.v.tr_mul(x)
    }

    fn apply_transposed(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.v * self.u.tr_mul(x)
    }
}

#[cfg(test)]
mod tests {
    use super::{Woodbury, cross};
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn crosses_reproduce_the_matrix_and_woodbury_its_inverse() {
        let n = 120;
        let a = DMatrix::from_fn(n, n, |i, j| (i as f64 * j as f64 * 1e-4).exp() / n as f64);
        let (u, v) = cross(n, 40, |i| Ok(a.row(i).transpose()), |j| Ok(a.column(j).into_owned())).unwrap().unwrap();
        assert!(u.ncols() < 14 && (&u * v.transpose() - &a).amax() < 1e-15, "{}", u.ncols());
        let w = Woodbury::new(u, v).unwrap();
        let b = DVector::from_fn(n, |i, _| (i as f64).cos());
        let full = DMatrix::identity(n, n) - &a;
        assert!((&full * w.solve(&b) - &b).amax() < 1e-13 && (full.transpose() * w.solve_transposed(&b) - &b).amax() < 1e-13);
    }

    #[test]
    fn full_rank_is_not_forced() {
        let a = DMatrix::from_fn(60, 60, |i, j| if i == j { 1.0 } else { 0.0 });
        assert!(cross(60, 20, |i| Ok(a.row(i).transpose()), |j| Ok(a.column(j).into_owned())).unwrap().is_none());
        let zero = cross(60, 20, |_| Ok(DVector::zeros(60)), |_| Ok(DVector::zeros(60))).unwrap().unwrap();
        assert_eq!((zero.0 * zero.1.transpose()).amax(), 0.0);
    }
}
