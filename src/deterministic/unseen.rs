//! What g, f and the rows and columns of K have beside the polynomials through their values at the nodes: jumps and peaks between them.
//!
//! ```text
//! ‖f − f̃‖ ≲ ‖(I − T)⁻¹‖ (‖f‖ sup_x ∫ |δK(x, y)| dμ(y) + ‖T δf‖)              δ: value − interpolant, at the places of the scan
//! ```

use super::near::components;
use super::scan::{Largest, Part, Scan};
use super::seen::{Seen, Sight};
use super::verify::Check;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::{Value, Weight};
use std::collections::BTreeSet;

/// Shares of what is allowed: below it a bound is good enough, above it a panel is cut; and of the largest gap, where others are.
const SHARE: f64 = 0.1;
const AS_LARGE: f64 = 0.2;
/// Share of it that all places may leave together without f being asked there.
const ENOUGH: f64 = 0.5;
/// What is seen at one place may reach so many places farther.
const AROUND: usize = 6;
/// Every so many rows bound what gaps at singular ends do.
const SPARSE: usize = 4;

/// What may have been missed.
#[derive(Default)]
pub(super) struct Unseen {
    /// the error it may make
    pub(super) error: f64,
    /// the panels on which it lies
    pub(super) panels: BTreeSet<usize>,
    /// intervals of the coordinate that hold it
    pub(super) features: Vec<(f64, f64)>,
}

impl<G, K> Check<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    /// An estimate of the error that what is between nodes makes, and where it lies if that is not small beside `allowed`.
    pub(super) fn unseen(&self, probes: &[K::Point], allowed: f64) -> Result<Unseen, Error> {
        let (sight, scan) = (Sight { kernel: self.equation.kernel(), grid: self.grid() }, Scan::of(self.domain(), self.grid()));
        let seen = sight.look(&scan, probes);
        let amplified = self.fine.magnitude() * self.fine.inverse_norm();
        let mut found = Unseen::default();
        let lines = seen.rows.iter().map(|line| (line, 1.0)).chain(seen.columns.iter().map(|line| (line, seen.largest)));
        for (line, factor) in lines {
            if !(factor * amplified * line.gap <= SHARE * allowed) {
                found.panels.extend(sight.panel(&scan, line.at));
                found.features.push(self.around(&scan, line.at));
            }
        }
        let of_f = self.between(&sight, &scan, &seen, allowed, &mut found)?;
        found.error = amplified * seen.row + self.fine.inverse_norm() * of_f;
        Ok(found)
    }

    /// ‖T δ‖ for what g has between the nodes, or f where that is not enough to know.
    fn between(
        &self,
        sight: &Sight<'_, K>,
        scan: &Scan<K::Point>,
        seen: &Seen<K::Point>,
        allowed: f64,
        found: &mut Unseen,
    ) -> Result<f64, Error> {
        let (grid, count) = (self.grid(), scan.places.len());
        let share = SHARE * allowed / self.fine.inverse_norm();
        // |Tδ| ≤ sup|K| ∫|δ| and ≤ ‖T‖ sup|δ|: the second where the domain is infinite
        let image = |part: Part, gaps: &[f64]| {
            let (gap, worst) = scan.sum_and_largest(part, gaps);
            let bound = (seen.largest * gap).min(seen.mass * worst);
            // K may be unbounded and gaps are anything at the very ends: row by row
            if grid.is_double_exponential() && bound > share { bound.min(self.image(scan, &seen.at, gaps)) } else { bound }
        };
        let everywhere = grid.is_centred() || !(seen.largest * seen.column * self.fine.magnitude() <= share);
        let part = if grid.is_centred() { scan.of_row(0) } else { scan.all() };
        let mut worst = Largest::default();
        for a in 0..G::Value::COMPONENTS {
            let g = |x: &K::Point| self.equation.source().eval(x).component(a);
            let at_nodes: Vec<f64> = grid.nodes.iter().map(|n| g(&n.point)).collect();
            let mut gaps = scan.gaps(part, &at_nodes, |i| g(&scan.places[i].point));
            if !everywhere && image(part, &gaps) <= share {
                worst.see(image(part, &gaps));
                continue;
            }
            // a singularity of g that T f takes away is none of f: ask f, which costs more, where g alone says too much
            let says = |i: usize| gaps[i] * (seen.largest * scan.places[i].weight * count as f64).min(seen.mass);
            let asked: Vec<usize> = part.of(count).filter(|i| everywhere || !(says(*i) <= ENOUGH * share)).collect();
            let at_nodes: Vec<f64> = self.fine.values().iter().map(|f| f.component(a)).collect();
            let values = parallel::map(asked.len(), |i| self.fine.value_at(&scan.places[asked[i]].point));
            for (i, value) in asked.into_iter().zip(values) {
                let value = value?.component(a);
                gaps[i] = scan.interpolant(i, &at_nodes).map_or(0.0, |(_, interpolant)| (value - interpolant).abs());
            }
            let of_f = image(part, &gaps);
            if !(of_f <= share) {
                let places: Vec<usize> = widest(scan, &gaps).collect();
                found.panels.extend(places.iter().filter_map(|i| sight.panel(scan, *i)));
                found.features.extend(places.iter().map(|i| self.around(scan, *i)));
            }
            worst.see(of_f);
        }
        Ok(worst.0)
    }

    /// Largest ∫ |K(x, ·)| gaps of some rows, entry by entry; what is not finite counts as nothing, being at an end.
    fn image(&self, scan: &Scan<K::Point>, rows: &[K::Point], gaps: &[f64]) -> f64 {
        let (kernel, c) = (self.equation.kernel(), components::<K>());
        let rows: Vec<&K::Point> = rows.iter().step_by(SPARSE).collect();
        let of_row = |i: usize| {
            let mut sums = vec![0.0; c * c];
            for (n, gap) in scan.places.iter().zip(gaps).filter(|(_, gap)| **gap > 0.0) {
                let k = kernel.eval(rows[i], &n.point);
                for (e, sum) in sums.iter_mut().enumerate() {
                    let value = n.weight * k.entry(e / c, e % c).abs() * gap;
                    *sum += if value.is_finite() { value } else { 0.0 };
                }
            }
            sums.into_iter().fold(0.0, f64::max)
        };
        parallel::map(rows.len(), of_row).into_iter().fold(0.0, f64::max)
    }

    /// The interval from some places before one to some after it.
    fn around(&self, scan: &Scan<K::Point>, place: usize) -> (f64, f64) {
        let (domain, state) = (self.domain(), self.domain().state(&scan.places[place].point));
        let coordinate = |i: usize| {
            let n = scan.places.get(i).filter(|n| domain.state(&n.point) == state);
            n.map(|n| domain.coordinate(&n.point, 0))
        };
        (place.checked_sub(AROUND).and_then(coordinate).unwrap_or(0.0), coordinate(place + AROUND).unwrap_or(1.0))
    }

    fn domain(&self) -> &K::Domain {
        self.equation.kernel().domain()
    }
}

/// Places where gaps are about the largest.
fn widest<'a, X>(scan: &'a Scan<X>, gaps: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
    let weighted = move |i: usize| scan.places[i].weight * gaps[i];
    let largest = (0..gaps.len()).map(weighted).fold(0.0, f64::max);
    (0..gaps.len()).filter(move |i| weighted(*i) > AS_LARGE * largest)
}
