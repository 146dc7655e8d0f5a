//! Large systems whose matrix need not be formed, and the check that this is true of them.
//!
//! What takes the place of T is compared with rows of T itself, 96 of them spread over the nodes, in the norm that bounds the error of f:
//! Σ_j |T_ij − T̃_ij|. A kernel that differs elsewhere only, in fewer rows than one in n/96, is not noticed; on the diagonal all values are looked at.

use super::coarse::Coarse;
use super::grid::Grid;
use super::linear::{Factor, SMALL};
use super::low_rank::{Woodbury, cross};
use super::near::components;
use super::toeplitz::{BlockSums, Toeplitz};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::parallel;
use crate::value::Weight;
use nalgebra::DVector;
use std::sync::Arc;

/// Rows that are compared.
const ROWS: usize = 96;
/// How closely, relative to the largest Σ_j |T_ij| seen: what rounding of x − y does to a kernel of narrow peaks must pass.
const CLOSE: f64 = 5e-13;
/// Highest rank.
const MOST_RANK: usize = 200;
/// Unknowns of the coarse inverse of a Toeplitz matrix.
const COARSE: usize = 600;

/// I − T without its matrix, and the kernel evaluations that took; `None` where the dense way is as good, or the only one.
pub(super) fn factor<K: Kernel + HasDomain>(kernel: &K, grid: &Grid<K::Point>) -> Result<Option<(Factor, u64)>, Error> {
    let n = grid.nodes.len();
    if components::<K>() > 1 || grid.panels().is_some() || grid.is_centred() || n <= SMALL {
        return Ok(None);
    }
    let rows = Rows { kernel, grid };
    let diagonal = parallel::map(n, |i| rows.entry(i, i));
    diagonal.into_iter().collect::<Result<Vec<_>, _>>()?;
    let uniform = grid.nodes.iter().all(|node| (node.weight - grid.nodes[0].weight).abs() <= 1e-12 * grid.nodes[0].weight);
    if uniform && let Some(factor) = rows.toeplitz()? {
        return Ok(Some((factor, ((ROWS + 3) * n) as u64)));
    }
    match rows.low_rank()? {
        Some((factor, rank)) => Ok(Some((factor, ((ROWS + 2 * rank + 1) * n) as u64))),
        None => Ok(None),
    }
}

struct Rows<'a, K: Kernel> {
    kernel: &'a K,
    grid: &'a Grid<K::Point>,
}

impl<K: Kernel + HasDomain> Rows<'_, K> {
    /// T_ij.
    fn entry(&self, i: usize, j: usize) -> Result<f64, Error> {
        let (x, y) = (&self.grid.nodes[i].point, &self.grid.nodes[j]);
        let k = self.kernel.eval(x, &y.point);
        if !k.entries_finite() {
            return Err(Error::non_finite_kernel(x, &y.point, &k));
        }
        Ok(y.weight * k.entry(0, 0))
    }

    fn row(&self, i: usize) -> Result<DVector<f64>, Error> {
        let n = self.grid.nodes.len();
        let values = (0..n).map(|j| self.entry(i, j)).collect::<Result<Vec<_>, _>>()?;
        Ok(DVector::from_vec(values))
    }

    fn column(&self, j: usize) -> Result<DVector<f64>, Error> {
        let n = self.grid.nodes.len();
        let values = (0..n).map(|i| self.entry(i, j)).collect::<Result<Vec<_>, _>>()?;
        Ok(DVector::from_vec(values))
    }

    /// Whether T is what `substitute` gives for its rows; the first few tell most kernels apart.
    fn agrees(&self, substitute: impl Fn(usize) -> DVector<f64> + Sync + Send) -> Result<bool, Error> {
        let n = self.grid.nodes.len();
        let compared = |k: usize| {
            // golden section: every part of the range soon has its row
            let i = ((k as f64 * 0.618_033_988_749_894_9).fract() * n as f64) as usize;
            let row = self.row(i)?;
            Ok::<_, Error>((row.lp_norm(1), (row - substitute(i)).lp_norm(1)))
        };
        let mut largest = 0.0f64;
        for batch in [0..4, 4..ROWS] {
            let first = batch.start;
            for found in parallel::map(batch.len(), |k| compared(first + k)) {
                let (size, difference) = found?;
                largest = largest.max(size);
                if !(difference <= CLOSE * largest) {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    fn toeplitz(&self) -> Result<Option<Factor>, Error> {
        let n = self.grid.nodes.len();
        let (row, column) = (self.row(0)?, self.column(0)?);
        let (row, column) = (row.as_slice(), column.as_slice());
        if !self.agrees(|i| DVector::from_fn(n, |j, _| if i >= j { column[i - j] } else { row[j - i] }))? {
            return Ok(None);
        }
        let sums = BlockSums::new(column, row);
        // a coarse system that is singular is no help, and no proof that the fine one is
        let Ok(coarse) = Coarse::of_block_sums(n, self.grid.nodes[0].weight, n.div_ceil(COARSE), |i, j| sums.of(i, j)) else {
            return Ok(None);
        };
        match Factor::iterative(Arc::new(Toeplitz::new(column, row)), coarse, n, "FFT and GMRES") {
            Ok(factor) => Ok(Some(factor)),
            Err(e @ Error::Singular { .. }) => Err(e),
            Err(_) => Ok(None),
        }
    }

    fn low_rank(&self) -> Result<Option<(Factor, usize)>, Error> {
        let n = self.grid.nodes.len();
        let Some((u, v)) = cross(n, MOST_RANK, |i| self.row(i), |j| self.column(j))? else { return Ok(None) };
        if !self.agrees(|i| &v * u.row(i).transpose())? {
            return Ok(None);
        }
        let rank = u.ncols();
        Ok(Some((Factor::low_rank(Woodbury::new(u, v)?, n)?, rank)))
    }
}
