//! Measuring |K| for the rows of a table.

use super::Row;
use super::shell::{SHELLS, Shell, scale};
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::sampling::Table;
use crate::value::Weight;

/// Offsets in a cell of x and of y, and in a shell.
const X_OFFSETS: [f64; 2] = [0.25, 0.75];
const Y_OFFSETS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];
const SHELL_OFFSETS: [f64; 2] = [0.25, 0.75];

/// R in cells.
const REACH: f64 = 8.0;

/// Measures one row.
pub(super) struct Probe<'a, K> {
    pub(super) kernel: &'a K,
    pub(super) cells: usize,
    pub(super) state: usize,
    pub(super) cell: usize,
}

impl<K: Kernel + HasDomain> Probe<'_, K> {
    pub(super) fn row(&self) -> Result<Row, Error> {
        let domain = self.kernel.domain();
        let h = 1.0 / self.cells as f64;
        let mut weights = vec![0.0; domain.states() * (self.cells + 2 * SHELLS)];
        let reach = REACH * h * domain.place(self.state, || (self.cell as f64 + X_OFFSETS[0]) * h).weight;
        for dx in X_OFFSETS {
            let t = (self.cell as f64 + dx) * h;
            let x = domain.place(self.state, || t);
            let at = Seen { x: x.point, t, reach: 1.0 / scale(x.weight, reach) };
            self.add(&at, 1.0 / X_OFFSETS.len() as f64, &mut weights)?;
        }
        let mass = weights.iter().sum();
        Ok(Row { table: Table::new(&weights), mass, reach })
    }

    /// Adds `share` of the row of one x: |K| up to its value at distance R to the cells, what exceeds that nearer than R to the shells.
    fn add(&self, at: &Seen<K::Point>, share: f64, weights: &mut [f64]) -> Result<(), Error> {
        let h = 1.0 / self.cells as f64;
        let states = self.kernel.domain().states();
        let caps = (0..states).map(|state| self.caps(at, state)).collect::<Result<Vec<_>, _>>()?;
        let (cells, shells) = weights.split_at_mut(states * self.cells);
        for (i, w) in cells.iter_mut().enumerate() {
            for dy in Y_OFFSETS {
                let s = ((i % self.cells) as f64 + dy) * h;
                let (k, stretch) = self.magnitude(at, i / self.cells, s)?;
                let near = (s - at.t).abs() < at.reach;
                let k = if near { k.min(caps[i / self.cells][usize::from(s > at.t)]) } else { k };
                *w += share / Y_OFFSETS.len() as f64 * h * k * stretch;
            }
        }
        for (i, w) in shells.iter_mut().enumerate() {
            let shell = Shell::of_index(i);
            let (inner, outer) = shell.bounds();
            for part in SHELL_OFFSETS {
                let distance = (inner + part * (outer - inner)) * at.reach;
                let s = if shell.right { at.t + distance } else { at.t - distance };
                // s = t: below the spacing of floating-point numbers at t
                if s > 0.0 && s < 1.0 && s != at.t {
                    let (k, stretch) = self.magnitude(at, shell.state, s)?;
                    let excess = (k - caps[shell.state][usize::from(shell.right)]).max(0.0);
                    *w += share / SHELL_OFFSETS.len() as f64 * (outer - inner) * at.reach * excess * stretch;
                }
            }
        }
        Ok(())
    }

    /// |K| at distance R to the left and to the right, or at the ends of the domain.
    fn caps(&self, at: &Seen<K::Point>, state: usize) -> Result<[f64; 2], Error> {
        let left = self.magnitude(at, state, (at.t - at.reach).max(f64::EPSILON))?.0;
        let right = self.magnitude(at, state, (at.t + at.reach).min(1.0 - f64::EPSILON))?.0;
        Ok([left, right])
    }

    /// |K(x, y)| and dμ/ds at the point y of coordinate s.
    fn magnitude(&self, at: &Seen<K::Point>, state: usize, s: f64) -> Result<(f64, f64), Error> {
        let domain = self.kernel.domain();
        let y = domain.place(state, || s);
        let k = self.kernel.eval(&at.x, &y.point);
        if k.entries_finite() {
            return Ok((k.norm(), y.weight));
        }
        if domain.coordinate(&y.point, 0) == domain.coordinate(&at.x, 0) {
            return Ok((0.0, y.weight)); // a singularity at y = x, reached by rounding
        }
        Err(Error::non_finite_kernel(&at.x, &y.point, &k))
    }
}

/// One x at which a row is measured.
struct Seen<X> {
    x: X,
    /// its coordinate
    t: f64,
    /// R in the coordinate
    reach: f64,
}
