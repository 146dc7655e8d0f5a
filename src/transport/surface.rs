//! What crosses the surfaces between bins.
//!
//! ```text
//! J⁺(x) = E[Σ w over crossings of x to the right],   J⁻(x) to the left            dJ/dx = S − (1 − c) Φ,   J = J⁺ − J⁻
//! ```
//!
//! Derivation: a particle is counted where it passes, whether or not it collides nearby; the currents at x = 0 and x = a are the leakage. The *flux* at a
//! surface, Σ w/|μ|, is not offered: flights along the surface give it an infinite variance, ∫ dμ/μ; use the [kernel tally](crate::walk::KernelTally), which is
//! unbiased at points too. Reference: Spanier, Gelbard (1969), §2.6; Lux, Koblinger (1991), §3.III.

use super::{Flight, Grid, Tally};
use crate::statistics::Estimate;

/// Counts weights that cross the edges of the bins, faces included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurfaceTally;

/// Currents at the edges of the bins, from 0 to a.
#[derive(Clone, Debug)]
pub struct Currents {
    grid: Grid,
    right: Vec<Estimate>,
    left: Vec<Estimate>,
}

impl Currents {
    /// The bins' places; edge i is at `grid().edge(i)`.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// J⁺ at every edge.
    #[must_use]
    pub fn right(&self) -> &[Estimate] {
        &self.right
    }

    /// J⁻ at every edge.
    #[must_use]
    pub fn left(&self) -> &[Estimate] {
        &self.left
    }
}

impl Tally for SurfaceTally {
    /// J⁺ and J⁻ at every edge.
    type Bins = [Vec<f64>; 2];
    type Flux = Currents;

    fn empty(&self, grid: &Grid) -> Self::Bins {
        [vec![0.0; grid.bins() + 1], vec![0.0; grid.bins() + 1]]
    }

    #[inline]
    fn flight(&self, grid: &Grid, [right, left]: &mut Self::Bins, flight: &Flight) {
        let (from, to) = (grid.bin(flight.from), grid.bin(flight.to));
        let crossed = if flight.to > flight.from {
            let last = if flight.to >= grid.thickness() { grid.bins() } else { to };
            &mut right[from + 1..=last]
        } else {
            let first = if flight.to <= 0.0 { 0 } else { to + 1 };
            &mut left[first..=from]
        };
        crossed.iter_mut().for_each(|edge| *edge += flight.weight);
    }

    fn finish(&self, grid: &Grid, batches: Vec<Self::Bins>, _: u64, estimate: &dyn Fn(&[f64]) -> Estimate) -> Currents {
        let edge = |side: usize, i: usize| estimate(&batches.iter().map(|b| b[side][i]).collect::<Vec<_>>());
        let all = |side: usize| (0..=grid.bins()).map(|i| edge(side, i)).collect();
        Currents { grid: *grid, right: all(0), left: all(1) }
    }
}
