//! The order of walks in lockstep: neighbours in rank shall be neighbours in state.

use crate::domain::Domain;

/// What chains are sorted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sort {
    /// The state: enough where weights are equal, as in analog walks and those by a kernel's own step.
    #[default]
    State,
    /// The state, then the weight |W| as one more coordinate: what a weighted walk will score depends on both.
    StateAndWeight,
}

/// Chains in the order of their states: by the discrete state, then along one coordinate; along Hilbert's curve through two; through more in
/// n^{1/d} batches along the first, each sorted along the next (the batch sort of L'Ecuyer, Lécot, Tuffin 2008, §5).
#[derive(Debug)]
pub(super) struct Order<'a, D> {
    domain: &'a D,
    sort: Sort,
    keys: Vec<(u64, u32)>,
}

impl<'a, D: Domain> Order<'a, D> {
    pub(super) fn new(domain: &'a D, sort: Sort) -> Self {
        Order { domain, sort, keys: Vec::new() }
    }

    /// Sorts `ranks` by the state and the weight that `place` tells of each.
    pub(super) fn sort(&mut self, ranks: &mut [u32], place: impl Fn(u32) -> (D::Point, f64)) {
        let domain = self.domain;
        if domain.states() == 1 {
            return self.within(ranks, &place, 0);
        }
        let state = |rank: u32| domain.state(&place(rank).0);
        self.by(ranks, |rank| state(rank) as u64);
        for part in ranks.chunk_by_mut(|a, b| state(*a) == state(*b)) {
            self.within(part, &place, 0);
        }
    }

    /// Sorts chains of one discrete state by the coordinates from `axis` on.
    fn within(&mut self, ranks: &mut [u32], place: &impl Fn(u32) -> (D::Point, f64), axis: usize) {
        let (domain, dimension) = (self.domain, self.domain.dimension());
        let axes = dimension + usize::from(self.sort == Sort::StateAndWeight) - axis;
        let coordinate = |rank: u32, axis: usize| {
            let (x, weight) = place(rank);
            if axis < dimension { domain.coordinate(&x, axis) } else { weight }
        };
        if axes == 2 && axis + 1 < dimension {
            return self.by(ranks, |rank| hilbert(coordinate(rank, axis), coordinate(rank, axis + 1)));
        }
        self.by(ranks, |rank| ordered(coordinate(rank, axis)));
        if axes > 1 && !ranks.is_empty() {
            // n = batches · (rest), batches = n^{1/axes}
            let batches = (ranks.len() as f64).powf(1.0 / axes as f64).round().max(1.0) as usize;
            let size = ranks.len().div_ceil(batches);
            ranks.chunks_mut(size).for_each(|batch| self.within(batch, place, axis + 1));
        }
    }

    /// Sorts by a key; the chain's number breaks ties: an order that depends on nothing else.
    fn by(&mut self, ranks: &mut [u32], key: impl Fn(u32) -> u64) {
        self.keys.clear();
        self.keys.extend(ranks.iter().map(|rank| (key(*rank), *rank)));
        self.keys.sort_unstable();
        ranks.iter_mut().zip(&self.keys).for_each(|(rank, key)| *rank = key.1);
    }
}

/// Bits in the order of the numbers.
#[inline]
fn ordered(x: f64) -> u64 {
    let bits = x.to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// Where Hilbert's curve of 2³² × 2³² cells passes through the cell of a point of the unit square (Hilbert, Math. Ann. 38 (1891) 459).
fn hilbert(x: f64, y: f64) -> u64 {
    // coordinates at the upper end belong to the last cell; casts saturate
    let (mut x, mut y) = ((x * 4_294_967_296.0) as u32, (y * 4_294_967_296.0) as u32);
    let mut index = 0u64;
    for level in (0..32).rev() {
        let (right, top) = (x >> level & 1, y >> level & 1);
        index = index << 2 | u64::from((3 * right) ^ top);
        // the curve enters the lower quarters turned over
        if top == 0 {
            if right == 1 {
                (x, y) = (!x, !y);
            }
            (x, y) = (y, x);
        }
    }
    index
}

#[cfg(test)]
mod tests {
    use super::{hilbert, ordered};

    /// Neighbours on the curve are neighbours in the square, and every cell is passed once.
    #[test]
    fn the_curve_is_continuous() {
        const N: u64 = 64;
        let mut cells: Vec<(u64, u64, u64)> = (0..N * N)
            .map(|i| {
                let (x, y) = (i % N, i / N);
                let centre = |k: u64| (k as f64 + 0.5) / N as f64;
                (hilbert(centre(x), centre(y)) >> (64 - 12), x, y)
            })
            .collect();
        cells.sort_unstable();
        for (i, cell) in cells.iter().enumerate() {
            assert_eq!(cell.0, i as u64);
        }
        assert!(cells.windows(2).all(|w| w[0].1.abs_diff(w[1].1) + w[0].2.abs_diff(w[1].2) == 1));
    }

    #[test]
    fn bits_are_in_the_order_of_numbers() {
        let numbers = [f64::NEG_INFINITY, -1e300, -1.0, -1e-300, -0.0, 0.0, 5e-324, 0.5, 1.0, f64::INFINITY];
        assert!(numbers.windows(2).all(|w| ordered(w[0]) < ordered(w[1])));
    }
}
