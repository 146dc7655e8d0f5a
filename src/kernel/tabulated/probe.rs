//! Measuring |K| for the rows of a table.

use super::Row;
use super::shell::{OCTAVES, SHELLS, Shell, scale};
use crate::domain::{Domain, Node};
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
/// Most of a row that may lie below the spacing of floating-point numbers.
const LOST: f64 = 1e-4;
/// Least density of an entry, as a share of its neighbours'.
const NEIGHBOURS: f64 = 0.1;
/// Neighbouring shells on each side, a factor of 1.5 to 2 of the distance.
const NEAR_SHELLS: usize = 3;
/// Octaves over which the decay of the mass towards y = x is measured.
const SPAN: usize = 8;

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
        let x = domain.place(self.state, || (self.cell as f64 + X_OFFSETS[0]) * h);
        let lost = self.below_rounding(&x, reach, &weights[domain.states() * self.cells..]);
        if lost > LOST * mass {
            return Err(Error::BelowRounding { x: format!("{:?}", x.point), share: lost / mass });
        }
        let (cells, shells) = weights.split_at_mut(domain.states() * self.cells);
        cells.chunks_mut(self.cells).for_each(|row| spread(row, 1, |_| 1.0));
        shells.chunks_mut(SHELLS).for_each(|side| {
            spread(side, NEAR_SHELLS, |level| {
                let (inner, outer) = Shell::of_index(level).bounds();
                outer - inner
            });
        });
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

    /// Mass between y = x and its neighbours among floating-point numbers: of |x − y|^{−α} octaves of the distance have masses that fall by q = 2^{α−1}
    /// from one to the next, and all beyond octave n together q/(1 − q) of its own.
    fn below_rounding(&self, x: &Node<K::Point>, reach: f64, shells: &[f64]) -> f64 {
        let domain = self.kernel.domain();
        let (t, reach) = (domain.coordinate(&x.point, 0), 1.0 / scale(x.weight, reach));
        let of_side = |state: usize, right: bool| {
            let told_apart = |octave: &usize| {
                let distance = 0.5f64.powi(*octave as i32) * reach;
                let s = if right { t + distance } else { t - distance };
                !(0.0..=1.0).contains(&s) || domain.coordinate(&domain.place(state, || s).point, 0) != t
            };
            let last = (0..OCTAVES).take_while(told_apart).last().unwrap_or(0);
            let mass = |octave: usize| Shell::octave(state, right, octave).map(|i| shells[i]).sum::<f64>();
            let (outer, inner) = (mass(last.saturating_sub(2 * SPAN)), mass(last.saturating_sub(SPAN)));
            let ratio = (inner / outer).powf(1.0 / SPAN as f64);
            match ratio {
                r if !(r > 0.0) || last < 2 * SPAN => 0.0,
                r if r < 1.0 => inner * r.powi(SPAN as i32) * r / (1.0 - r),
                _ => f64::INFINITY,
            }
        };
        (0..domain.states()).flat_map(|state| [of_side(state, false), of_side(state, true)]).sum()
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

/// Gives every entry a share of the densities of those at most `near` away: a K that ends between samples, or elsewhere for another x of the cell, is not 0
/// just beyond the last that saw it. Where only the domain's own density leads walks come too seldom, with too large weights, to show what they miss.
fn spread(weights: &mut [f64], near: usize, width: impl Fn(usize) -> f64) {
    let seen: Vec<f64> = weights.iter().enumerate().map(|(i, w)| w / width(i)).collect();
    for (i, w) in weights.iter_mut().enumerate() {
        let around = &seen[i.saturating_sub(near)..(i + near + 1).min(seen.len())];
        *w = w.max(NEIGHBOURS * width(i) * around.iter().fold(0.0, |m: f64, d| m.max(*d)));
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
