//! P A = L U of a dense matrix, by halving its columns again and again.
//!
//! ```text
//! P₁ [A₁₁; A₂₁] = [L₁₁; L₂₁] U₁₁,  U₁₂ = L₁₁⁻¹ (P₁A)₁₂,  A₂₂ ← (P₁A)₂₂ − L₂₁ U₁₂          Toledo, SIAM J. Matrix Anal. Appl. 18 (1997) 1065
//! ```
//!
//! Nearly all of the work is then products of large blocks, which nalgebra hands to matrixmultiply: level with LAPACK, where nalgebra's own LU, column
//! by column, is about ten times slower at 2000 unknowns. Preferred to the crate faer, which would add some thirty crates and 100 s to every
//! clean build. Right halves are updated in strips of fixed width on all cores: no bit depends on the number of threads.

use crate::parallel;
use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut, DVector, Dyn, MatrixView, MatrixViewMut, U1};

/// Up to this many columns are eliminated one by one.
const LEAF: usize = 8;
/// Columns that are updated together.
const STRIP: usize = 256;

type Block<'a> = MatrixView<'a, f64, Dyn, Dyn, U1, Dyn>;
type BlockMut<'a> = MatrixViewMut<'a, f64, Dyn, Dyn, U1, Dyn>;

/// L (unit diagonal, below) and U in the place of A; step i exchanged the rows i and `pivots[i]` ≥ i.
#[derive(Clone, Debug)]
pub(crate) struct Lu {
    factors: DMatrix<f64>,
    pivots: Vec<usize>,
}

impl Lu {
    /// Partial pivoting; n³/3 multiplications. Never fails: of a singular matrix U has a zero on its diagonal.
    pub(crate) fn new(mut a: DMatrix<f64>) -> Self {
        let mut pivots = vec![0; a.ncols()];
        let n = a.nrows();
        eliminate(a.as_mut_slice(), n, 0, &mut pivots);
        Lu { factors: a, pivots }
    }

    pub(crate) fn unknowns(&self) -> usize {
        self.pivots.len()
    }

    pub(crate) fn is_invertible(&self) -> bool {
        (0..self.unknowns()).all(|i| self.factors[(i, i)] != 0.0)
    }

    /// det A; 0 or infinite where it leaves the range of floating-point numbers.
    pub(crate) fn determinant(&self) -> f64 {
        let exchanges = self.pivots.iter().enumerate().filter(|(i, p)| i != *p).count();
        let sign = if exchanges.is_multiple_of(2) { 1.0 } else { -1.0 };
        (0..self.unknowns()).fold(sign, |product, i| product * self.factors[(i, i)])
    }

    /// x ← A⁻¹ x.
    pub(crate) fn solve(&self, x: &mut DVector<f64>) {
        self.pivots.iter().enumerate().for_each(|(i, p)| x.swap_rows(i, *p));
        let n = self.unknowns();
        let (x, column) = (x.as_mut_slice(), |j: usize| &self.factors.as_slice()[j * n..(j + 1) * n]);
        for j in 0..n {
            let xj = x[j];
            x[j + 1..].iter_mut().zip(&column(j)[j + 1..]).for_each(|(x, l)| *x -= l * xj);
        }
        for j in (0..n).rev() {
            x[j] /= column(j)[j];
            let xj = x[j];
            x[..j].iter_mut().zip(column(j)).for_each(|(x, u)| *x -= u * xj);
        }
    }

    /// x ← A⁻ᵀ x: Uᵀ y = x, Lᵀ z = y, Pᵀ z.
    pub(crate) fn solve_transposed(&self, x: &mut DVector<f64>) {
        for j in 0..self.unknowns() {
            let sum = self.factors.column(j).rows_range(..j).dot(&x.rows_range(..j));
            x[j] = (x[j] - sum) / self.factors[(j, j)];
        }
        for j in (0..self.unknowns()).rev() {
            x[j] -= self.factors.column(j).rows_range(j + 1..).dot(&x.rows_range(j + 1..));
        }
        self.pivots.iter().enumerate().rev().for_each(|(i, p)| x.swap_rows(i, *p));
    }
}

/// Factorises whole columns of height n, the diagonal of the first of them in row `first`; rows above are left alone.
fn eliminate(columns: &mut [f64], n: usize, first: usize, pivots: &mut [usize]) {
    let width = pivots.len();
    if width <= LEAF {
        return eliminate_singly(columns, n, first, pivots);
    }
    let half = (width / 2).next_multiple_of(LEAF);
    let (left, right) = columns.split_at_mut(n * half);
    let (left_pivots, right_pivots) = pivots.split_at_mut(half);
    eliminate(left, n, first, left_pivots);
    parallel::chunks(right, n * STRIP, |_, strip| update(strip, left, n, first, left_pivots));
    eliminate(right, n, first + half, right_pivots);
    exchange(left, n, first + half, right_pivots);
}

fn eliminate_singly(columns: &mut [f64], n: usize, first: usize, pivots: &mut [usize]) {
    for (j, pivot) in pivots.iter_mut().enumerate() {
        let row = first + j;
        *pivot = largest(&columns[j * n..(j + 1) * n], row);
        exchange(columns, n, row, &[*pivot]);
        let (done, rest) = columns.split_at_mut((j + 1) * n);
        let column = &mut done[j * n..];
        let divisor = column[row];
        // nothing below a zero pivot to eliminate
        if divisor != 0.0 {
            column[row + 1..].iter_mut().for_each(|l| *l /= divisor);
        }
        for other in rest.chunks_exact_mut(n) {
            let u = other[row];
            other[row + 1..].iter_mut().zip(&column[row + 1..]).for_each(|(a, l)| *a -= l * u);
        }
    }
}

/// Place of the largest modulus at or below `row`, the first of equals.
fn largest(column: &[f64], row: usize) -> usize {
    let mut place = row;
    for i in row + 1..column.len() {
        if column[i].abs() > column[place].abs() {
            place = i;
        }
    }
    place
}

fn exchange(columns: &mut [f64], n: usize, first: usize, pivots: &[usize]) {
    for column in columns.chunks_exact_mut(n) {
        pivots.iter().enumerate().for_each(|(i, p)| column.swap(first + i, *p));
    }
}

/// What the elimination of `left` does to columns on its right.
fn update(strip: &mut [f64], left: &[f64], n: usize, first: usize, pivots: &[usize]) {
    exchange(strip, n, first, pivots);
    let middle = first + pivots.len();
    let left = DMatrixView::from_slice(left, n, pivots.len());
    let width = strip.len() / n;
    let mut strip = DMatrixViewMut::from_slice(strip, n, width);
    let (mut u, mut below) = strip.rows_range_pair_mut(first..middle, middle..);
    forward(left.rows_range(first..middle), &mut u);
    below.gemm(-1.0, &left.rows_range(middle..), &u, 1.0);
}

/// x ← L⁻¹ x for unit lower triangular L.
fn forward(l: Block<'_>, x: &mut BlockMut<'_>) {
    let n = l.nrows();
    if n <= LEAF {
        for mut column in x.column_iter_mut() {
            for j in 0..n {
                for i in j + 1..n {
                    column[i] -= l[(i, j)] * column[j];
                }
            }
        }
        return;
    }
    let half = (n / 2).next_multiple_of(LEAF);
    let (mut top, mut bottom) = x.rows_range_pair_mut(..half, half..);
    forward(l.view_range(..half, ..half), &mut top);
    bottom.gemm(-1.0, &l.view_range(half.., ..half), &top, 1.0);
    forward(l.view_range(half.., half..), &mut bottom);
}

#[cfg(test)]
mod tests {
    use super::Lu;
    use crate::sampling::{Pcg, Sampler, Sequence};
    use nalgebra::{DMatrix, DVector};

    /// Entries in [−1, 1).
    fn random(n: usize) -> DMatrix<f64> {
        let mut u = Pcg::default().point(n as u64, 0, 0);
        DMatrix::from_fn(n, n, |_, _| 2.0 * u.next_1d() - 1.0)
    }

    #[test]
    fn factors_multiply_to_the_permuted_matrix() {
        for n in (1..40).chain([63, 64, 65, 127, 128, 129, 257, 300]) {
            let a = random(n);
            let lu = Lu::new(a.clone());
            let l = lu.factors.lower_triangle().map_with_location(|i, j, v| if i == j { 1.0 } else { v });
            assert!(l.amax() <= 1.0, "{n}: the pivot is the largest of its column");
            let mut permuted = a;
            lu.pivots.iter().enumerate().for_each(|(i, p)| permuted.swap_rows(i, *p));
            let error = (&l * lu.factors.upper_triangle() - permuted).amax();
            assert!(error <= 1e-15 * n as f64, "{n}: {error:e}");
        }
    }

    #[test]
    fn solutions_are_those_of_nalgebra() {
        for n in [1, 2, 7, 8, 9, 17, 100, 200] {
            let a = random(n);
            let b = DVector::from_fn(n, |i, _| (i as f64).cos());
            let lu = Lu::new(a.clone());
            for (transposed, a) in [(false, a.clone()), (true, a.transpose())] {
                let mut x = b.clone();
                if transposed {
                    lu.solve_transposed(&mut x)
                } else {
                    lu.solve(&mut x)
                }
                let residual = (&a * &x - &b).amax() / x.amax();
                assert!(residual <= 1e-15 * n as f64, "{n}: {residual:e}");
                let other = a.lu().solve(&b).unwrap();
                assert!((&x - &other).amax() <= 1e-10 * other.amax(), "{n}");
            }
        }
    }

    #[test]
    fn zero_pivots_stay_visible() {
        let mut a = random(40);
        let copy = a.column(3).into_owned();
        a.set_column(29, &copy);
        a.fill_row(7, 0.0);
        let lu = Lu::new(a);
        assert!(!lu.is_invertible());
        assert!(lu.factors.iter().all(|v| v.is_finite()));
        // subnormal pivots have no finite reciprocal, yet their quotients are ordinary numbers
        let tiny = Lu::new(DMatrix::from_row_slice(2, 2, &[3e-310, 1e-310, 1e-310, 2e-310]));
        assert!(tiny.is_invertible() && (tiny.factors[(1, 0)] - 1.0 / 3.0).abs() < 1e-12);
    }

    #[cfg(feature = "parallel")]
    #[test]
    fn threads_do_not_change_a_bit() {
        let a = random(611);
        let factors = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let lu = pool.install(|| Lu::new(a.clone()));
            (lu.pivots, lu.factors.iter().map(|v| v.to_bits()).collect::<Vec<_>>())
        };
        let one = factors(1);
        for threads in [2, 3, 8] {
            assert!(factors(threads) == one, "{threads} threads");
        }
    }
}
