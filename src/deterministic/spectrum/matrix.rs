//! T on the nodes of a rule as a real or complex matrix, and its inverse iteration.

use super::ritz;
use crate::deterministic::grid::Grid;
use crate::deterministic::lu::Lu;
use crate::deterministic::near::components;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::sampling::{Pcg, Sampler, Sequence};
use crate::value::{Value, Weight};
use nalgebra::{Complex, DMatrix, DVector, Schur};

/// Up to this size all eigenvalues are computed, beyond only the leading ones.
const DENSE: usize = 160;
/// Steps of the QR iteration an unknown may take.
const QR_STEPS: usize = 60;

pub(super) type Vector = DVector<Complex<f64>>;

/// T_n.
#[derive(Clone, Debug)]
pub(super) enum Matrix {
    Real(DMatrix<f64>),
    Complex(DMatrix<Complex<f64>>),
}

/// Whether the values of a kernel's equation are complex numbers.
pub(super) fn is_complex<K: Kernel>() -> bool {
    <<K::Weight as Weight>::Value as Value>::COMPLEX
}

/// Components of an eigenfunction.
pub(super) fn fields<K: Kernel>() -> usize {
    if is_complex::<K>() { components::<K>() / 2 } else { components::<K>() }
}

/// A row of T, given in real components, times complex values at the nodes: all fields at one place.
pub(super) fn apply_row<K: Kernel>(row: &[f64], values: &[Complex<f64>], out: &mut [Complex<f64>]) {
    let (c, width) = (components::<K>(), row.len() / components::<K>());
    for (a, out) in out.iter_mut().enumerate() {
        *out = if is_complex::<K>() {
            let (re, im) = (&row[2 * a * width..(2 * a + 1) * width], &row[(2 * a + 1) * width..(2 * a + 2) * width]);
            re.iter().zip(im).step_by(2).zip(values).map(|((re, im), v)| Complex::new(*re, *im) * v).sum()
        } else {
            row[a * width..(a + 1) * width].iter().zip(values).map(|(t, v)| v * *t).sum()
        };
    }
    debug_assert!(c * width == row.len());
}

impl Matrix {
    /// The matrix and the kernel evaluations it took.
    pub(super) fn assemble<K: Kernel + HasDomain>(kernel: &K, grid: &Grid<K::Point>) -> Result<(Self, u64), Error> {
        let (rows, evaluations) = grid.matrix(kernel)?;
        let width = grid.nodes.len() * components::<K>();
        let matrix = if is_complex::<K>() {
            let entry = |i: usize, j: usize| Complex::new(rows[2 * i * width + 2 * j], rows[(2 * i + 1) * width + 2 * j]);
            Matrix::Complex(DMatrix::from_fn(width / 2, width / 2, entry))
        } else {
            Matrix::Real(DMatrix::from_row_slice(width, width, &rows))
        };
        Ok((matrix, evaluations))
    }

    pub(super) fn unknowns(&self) -> usize {
        match self {
            Matrix::Real(a) => a.nrows(),
            Matrix::Complex(a) => a.nrows(),
        }
    }

    /// The real matrix of the same map.
    pub(super) fn embedded(self) -> DMatrix<f64> {
        match self {
            Matrix::Real(a) => a,
            Matrix::Complex(a) => embedding(a.nrows(), |i, j| a[(i, j)]),
        }
    }

    /// ‖T_n‖∞.
    pub(super) fn norm(&self) -> f64 {
        match self {
            Matrix::Real(a) => a.row_iter().map(|r| r.iter().map(|v| v.abs()).sum()).fold(0.0, f64::max),
            Matrix::Complex(a) => a.row_iter().map(|r| r.iter().map(|v| v.norm()).sum()).fold(0.0, f64::max),
        }
    }

    pub(super) fn times(&self, v: &Vector) -> Vector {
        match self {
            Matrix::Real(a) => {
                let (re, im) = (a * v.map(|z| z.re), a * v.map(|z| z.im));
                re.zip_map(&im, Complex::new)
            }
            Matrix::Complex(a) => a * v,
        }
    }

    /// All eigenvalues, largest modulus first; `None` if the QR iteration does not end.
    pub(super) fn eigenvalues(&self) -> Option<Vec<Complex<f64>>> {
        let values = match self {
            Matrix::Real(a) => real_spectrum(a.clone()),
            Matrix::Complex(a) => complex_spectrum(a.clone()),
        };
        values.map(by_modulus)
    }

    /// At least `count` of them if there are as many.
    pub(super) fn leading(&self, count: usize) -> Option<Vec<Complex<f64>>> {
        let found = match self {
            _ if self.unknowns() <= DENSE => None,
            Matrix::Real(a) => ritz::leading(a, count, real_spectrum),
            Matrix::Complex(a) => ritz::leading(a, count, complex_spectrum),
        };
        found.or_else(|| self.eigenvalues())
    }

    pub(super) fn unended(&self) -> Error {
        Error::NotConverged { error: f64::NAN, tolerance: f64::EPSILON, unknowns: self.unknowns() }
    }

    fn entry(&self, i: usize, j: usize) -> Complex<f64> {
        match self {
            Matrix::Real(a) => a[(i, j)].into(),
            Matrix::Complex(a) => a[(i, j)],
        }
    }

    /// I − zT as a determinant.
    pub(super) fn determinant(&self, z: Complex<f64>) -> Complex<f64> {
        let n = self.unknowns();
        let identity = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        match self {
            Matrix::Real(a) if z.im == 0.0 => {
                Lu::new(DMatrix::from_fn(n, n, |i, j| identity(i, j) - z.re * a[(i, j)])).determinant().into()
            }
            _ => DMatrix::from_fn(n, n, |i, j| Complex::from(identity(i, j)) - z * self.entry(i, j)).lu().determinant(),
        }
    }
}

pub(super) fn real_spectrum(a: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let most = QR_STEPS * a.nrows().max(10);
    Some(Schur::try_new(a, f64::EPSILON, most)?.complex_eigenvalues().iter().copied().collect())
}

fn complex_spectrum(a: DMatrix<Complex<f64>>) -> Option<Vec<Complex<f64>>> {
    let most = QR_STEPS * a.nrows().max(10);
    Some(Schur::try_new(a, f64::EPSILON, most)?.unpack().1.diagonal().iter().copied().collect())
}

/// Largest modulus first; of equal ones the larger real part, then the larger imaginary part.
pub(super) fn by_modulus(mut values: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
    // moduli that differ by rounding count as equal: ± pairs and conjugates keep their order
    let rounded = |z: &Complex<f64>| (z.norm() as f32).to_bits();
    values.sort_by(|a, b| rounded(b).cmp(&rounded(a)).then(b.re.total_cmp(&a.re)).then(b.im.total_cmp(&a.im)));
    values
}

/// [[Re, −Im], [Im, Re]].
fn embedding(n: usize, entry: impl Fn(usize, usize) -> Complex<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(2 * n, 2 * n, |i, j| {
        let z = entry(i % n, j % n);
        match (i < n, j < n) {
            (true, false) => -z.im,
            (false, true) => z.im,
            _ => z.re,
        }
    })
}

/// T_n − θI, factorised.
pub(super) struct Shifted {
    lu: Lu,
    n: usize,
}

impl Shifted {
    /// θ moves by some ulps, of itself and of ‖T_n‖, until nothing is divided by zero.
    pub(super) fn new(matrix: &Matrix, theta: Complex<f64>) -> Self {
        let n = matrix.unknowns();
        let mut step = 2.0 * f64::EPSILON * theta.norm().max(f64::MIN_POSITIVE);
        loop {
            let shift = theta + Complex::from(step);
            let entry = |i: usize, j: usize| matrix.entry(i, j) - if i == j { shift } else { Complex::from(0.0) };
            let lu = match matrix {
                Matrix::Real(_) if theta.im == 0.0 => Lu::new(DMatrix::from_fn(n, n, |i, j| entry(i, j).re)),
                _ => Lu::new(embedding(n, entry)),
            };
            if lu.is_invertible() {
                return Shifted { lu, n };
            }
            step = 4.0 * step + f64::EPSILON * matrix.norm() + f64::MIN_POSITIVE;
        }
    }

    /// The direction of (T − θ)⁻¹ v, or of its adjoint's; `None` where it is not finite.
    fn direction(&self, v: &Vector, solve: impl Fn(&mut DVector<f64>)) -> Option<Vector> {
        let n = self.n;
        let solution = if self.lu.unknowns() == n {
            let part = |part: fn(&Complex<f64>) -> f64| {
                let mut x = v.map(|z| part(&z));
                solve(&mut x);
                x
            };
            part(|z| z.re).zip_map(&part(|z| z.im), Complex::new)
        } else {
            let mut x = DVector::from_fn(2 * n, |i, _| if i < n { v[i].re } else { v[i - n].im });
            solve(&mut x);
            DVector::from_fn(n, |i, _| Complex::new(x[i], x[i + n]))
        };
        let scale = solution.iter().fold(0.0f64, |m, z| if z.is_finite() { m.max(z.norm()) } else { f64::NAN });
        let scaled = solution.unscale(scale);
        Some(scaled.unscale(scaled.norm())).filter(|v| v.iter().all(|z| z.is_finite()))
    }

    /// A right and a left eigenvector; the right one orthogonal to those `apart`.
    pub(super) fn vectors(&self, apart: &[&Vector], index: usize) -> Option<(Vector, Vector)> {
        let mut random = Pcg::default().point(u64::MAX - 4, 0, index as u64);
        let real = self.lu.unknowns() == self.n;
        let mut right = DVector::from_fn(self.n, |_, _| {
            let (re, im) = (random.next_1d() - 0.5, random.next_1d() - 0.5);
            Complex::new(re, if real { 0.0 } else { im })
        });
        for _ in 0..4 {
            right = self.direction(&right, |x| self.lu.solve(x))?;
            for other in apart {
                let part = other.dotc(&right);
                right.axpy(-part, other, Complex::from(1.0));
            }
            right = right.unscale(right.norm());
        }
        let mut left = right.clone();
        for _ in 0..3 {
            left = self.direction(&left, |x| self.lu.solve_transposed(x))?;
        }
        Some((right, left))
    }
}

#[cfg(test)]
mod tests {
    use super::{Matrix, Shifted, by_modulus};
    use nalgebra::{Complex, DMatrix};

    #[test]
    fn eigenvectors_of_real_and_complex_matrices() {
        let a = DMatrix::from_fn(12, 12, |i, j| 1.0 / (1 + i + 2 * j) as f64 + if i == j + 1 { 0.4 } else { 0.0 });
        let z = a.map_with_location(|i, j, v| Complex::new(v, 0.3 * ((i * j) as f64).sin()));
        for matrix in [Matrix::Real(a), Matrix::Complex(z)] {
            let values = matrix.eigenvalues().unwrap();
            for (k, theta) in values.iter().take(5).enumerate() {
                let (right, left) = Shifted::new(&matrix, *theta).vectors(&[], k).unwrap();
                assert!((matrix.times(&right) - &right * *theta).norm() < 1e-13);
                let rayleigh = left.dotc(&matrix.times(&right)) / left.dotc(&right);
                assert!((rayleigh - theta).norm() < 1e-13, "{rayleigh} {theta}");
            }
        }
    }

    #[test]
    fn order() {
        let z = |re, im| Complex::new(re, im);
        let sorted = by_modulus(vec![z(-1.0, 0.0), z(0.0, -2.0), z(1.0 - 1e-15, 0.0), z(0.0, 2.0)]);
        assert_eq!(sorted, [z(0.0, 2.0), z(0.0, -2.0), z(1.0 - 1e-15, 0.0), z(-1.0, 0.0)]);
    }
}
