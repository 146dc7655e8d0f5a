//! One estimate from independent parts: walks that are independent, or randomisations that are.
//!
//! Points that are not independent of each other (Sobol', Latin hypercube, chains of Array-RQMC) say nothing about their own error; only
//! independent repetitions do, by Student's interval with R − 1 degrees of freedom (theory (4.14.4), (4.16.4)).

use super::Moments;
use crate::value::Value;

/// All scores together, and the error of their mean.
#[derive(Clone, Debug)]
pub(crate) struct Pooled<V> {
    pub(crate) moments: Moments<V>,
    pub(crate) std_error: Option<V>,
    pub(crate) degrees_of_freedom: u64,
}

impl<V: Value> Pooled<V> {
    /// What no score has reached is unknown, not 0 ± 0: no error then.
    pub(crate) fn new(moments: Moments<V>, std_error: Option<V>, degrees_of_freedom: u64) -> Self {
        Pooled { std_error: std_error.filter(|_| moments.nonzero > 0), degrees_of_freedom, moments }
    }

    /// From parts of independent scores: every score counts.
    pub(crate) fn independent(parts: &[Moments<V>]) -> Self {
        let moments = merged(parts);
        Pooled::new(moments, moments.std_error(), moments.count.saturating_sub(1))
    }

    /// From independent randomisations of equally many scores: only their means count. One alone has no error.
    pub(crate) fn randomised(replicates: &[Moments<V>]) -> Self {
        let means: Vec<_> = replicates.iter().map(|m| m.mean).collect();
        let std_error = Moments::from_scores(&means).std_error();
        Pooled::new(merged(replicates), std_error, (replicates.len() as u64).saturating_sub(1))
    }

    /// By what the sequence says of its points ([`Sequence::replicates`](crate::sampling::Sequence::replicates)).
    pub(crate) fn of(replicates: Option<u32>, parts: &[Moments<V>]) -> Self {
        if replicates.is_some() { Pooled::randomised(parts) } else { Pooled::independent(parts) }
    }
}

fn merged<V: Value>(parts: &[Moments<V>]) -> Moments<V> {
    let mut all = Moments::default();
    parts.iter().for_each(|m| all.merge(m));
    all
}
