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

/// Chains in the order of their states: by the discrete state, then along the first coordinate; in d dimensions in n^{1/d} batches along the
/// first, each sorted along the next (the batch sort of L'Ecuyer, Lécot, Tuffin 2008, §5).
#[derive(Debug)]
pub(super) struct Order<'a, D> {
    domain: &'a D,
    sort: Sort,
    keys: Vec<(usize, f64, u32)>,
}

impl<'a, D: Domain> Order<'a, D> {
    pub(super) fn new(domain: &'a D, sort: Sort) -> Self {
        Order { domain, sort, keys: Vec::new() }
    }

    /// Sorts `ranks` by the state and the weight that `place` tells of each.
    pub(super) fn sort(&mut self, ranks: &mut [u32], place: impl Fn(u32) -> (D::Point, f64)) {
        self.batch(ranks, &place, 0);
    }

    fn axes(&self) -> usize {
        self.domain.dimension() + usize::from(self.sort == Sort::StateAndWeight)
    }

    fn batch(&mut self, ranks: &mut [u32], place: &impl Fn(u32) -> (D::Point, f64), axis: usize) {
        let key = |rank: &u32| {
            let (x, weight) = place(*rank);
            let coordinate = if axis < self.domain.dimension() { self.domain.coordinate(&x, axis) } else { weight };
            (if axis == 0 { self.domain.state(&x) } else { 0 }, coordinate, *rank)
        };
        self.keys.clear();
        self.keys.extend(ranks.iter().map(key));
        // the chain's number breaks ties: an order that depends on nothing else
        self.keys.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        ranks.iter_mut().zip(&self.keys).for_each(|(rank, key)| *rank = key.2);
        let left = self.axes().saturating_sub(axis + 1);
        if left == 0 || ranks.is_empty() {
            return;
        }
        // n = batches · (rest), batches = n^{1/(left + 1)}
        let batches = (ranks.len() as f64).powf(1.0 / (left + 1) as f64).round().max(1.0) as usize;
        let size = ranks.len().div_ceil(batches);
        for batch in ranks.chunks_mut(size) {
            self.batch(batch, place, axis + 1);
        }
    }
}
