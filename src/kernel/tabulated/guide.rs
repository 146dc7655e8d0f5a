//! Importance: steps towards where the walk will score.

use super::shell::{Shell, scale};
use super::{Guidance, Tabulated};
use crate::domain::Domain;
use crate::sampling::Table;

/// Most terms of the sum that guides.
const MOST_POWERS: usize = 300;

impl<D: Domain> Tabulated<D> {
    /// The same table, guided towards where the walk will score: entries ∝ |K(x, y)| u(y), with u = Σ |T|ⁿ 1 from the table itself.
    ///
    /// With p ∝ |K| the operator K²/p has the kernel M(x)|K(x, y)|, M = ∫|K|, and its radius may exceed 1, an infinite variance, although that of |T| is
    /// far below, where M varies: systems, Green's functions. With p ∝ |K| u the radius is that of |T|, squared (theory §4.9).
    ///
    /// ```
    /// use fredholm::{Equation, Walk, kernel::Tabulated};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    /// let table = Tabulated::new(eq.kernel().kernel(), 32)?.guided();
    /// assert!(eq.with_proposal(table).at(0.5).solve(&Walk::collision())?.agrees_with(1.15, 5.0));
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    #[must_use]
    pub fn guided(mut self) -> Self {
        let columns: Vec<_> = (0..self.rows.len()).map(|i| self.columns(i)).collect();
        let u = self.importance(&columns);
        for (i, row) in self.rows.iter_mut().enumerate() {
            let Some(table) = &row.table else { continue };
            let weights: Vec<f64> = table.weights().zip(&columns[i]).map(|(w, &c)| w * u[c]).collect();
            row.table = Table::new(&weights);
        }
        self.guidance = Guidance::Importance;
        self
    }

    /// Σ |T|ⁿ 1 on the cells, by powers of the table; scaled to a maximum of 1.
    fn importance(&self, columns: &[Vec<usize>]) -> Vec<f64> {
        let (mut u, mut scale) = (vec![1.0; self.rows.len()], 1.0);
        for _ in 0..MOST_POWERS {
            let image = crate::parallel::map(self.rows.len(), |i| {
                let row = self.rows[i].table.iter().flat_map(|t| t.weights().zip(&columns[i]));
                scale + row.map(|(w, &c)| w * u[c]).sum::<f64>()
            });
            // a divergent sum grows until it is its fastest-growing part, which is what is wanted then
            let largest = image.iter().fold(0.0, |m: f64, v| m.max(*v));
            let change = image.iter().zip(&u).map(|(new, old)| (new / largest - old).abs()).fold(0.0, f64::max);
            scale /= largest;
            u = image.into_iter().map(|v| v / largest).collect();
            if change < 1e-6 {
                break;
            }
        }
        u
    }

    /// For every entry of a row the row it leads to: its own cell, or for a shell the cell of its middle, seen from the middle of the row's cell.
    fn columns(&self, i: usize) -> Vec<usize> {
        let (state, far) = (i / self.cells, self.groups * self.cells);
        let t = ((i % self.cells) as f64 + 0.5) / self.cells as f64;
        let reach = 1.0 / scale(self.domain.place(state, || t).weight, self.rows[i].reach);
        let entries = self.rows[i].table.as_ref().map_or(0, |table| table.weights().count());
        let lead = |e: usize| {
            if e < far {
                return e;
            }
            let shell = Shell::of_index(e - far);
            let (inner, outer) = shell.bounds();
            let distance = 0.5 * (inner + outer) * reach;
            let s = if shell.right { t + distance } else { t - distance };
            shell.state * self.cells + ((s.max(0.0) * self.cells as f64) as usize).min(self.cells - 1)
        };
        (0..entries).map(lead).collect()
    }
}
