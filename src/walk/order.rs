//! The order of walks in lockstep: neighbours in rank shall be neighbours in state.

use crate::domain::Domain;

/// Chains in the order of their states: by the discrete state, then along the first coordinate; in d dimensions in n^{1/d} batches along the
/// first, each sorted along the next (the batch sort of L'Ecuyer, Lécot, Tuffin 2008, §5).
#[derive(Debug)]
pub(super) struct Order<'a, D> {
    domain: &'a D,
    keys: Vec<(usize, f64, u32)>,
}

impl<'a, D: Domain> Order<'a, D> {
    pub(super) fn new(domain: &'a D) -> Self {
        Order { domain, keys: Vec::new() }
    }

    pub(super) fn sort(&mut self, ranks: &mut [u32], place: impl Fn(u32) -> D::Point) {
        self.batch(ranks, &place, 0);
    }

    fn batch(&mut self, ranks: &mut [u32], place: &impl Fn(u32) -> D::Point, axis: usize) {
        let key = |rank: &u32| {
            let x = place(*rank);
            (if axis == 0 { self.domain.state(&x) } else { 0 }, self.domain.coordinate(&x, axis), *rank)
        };
        self.keys.clear();
        self.keys.extend(ranks.iter().map(key));
        // the chain's number breaks ties: an order that depends on nothing else
        self.keys.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        ranks.iter_mut().zip(&self.keys).for_each(|(rank, key)| *rank = key.2);
        let left = self.domain.dimension().saturating_sub(axis + 1);
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
