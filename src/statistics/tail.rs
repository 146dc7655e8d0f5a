//! The largest scores and what they say about the variance.
//!
//! Hill, *A simple general approach to inference about the tail of a distribution*, Ann. Statist. 3 (1975) 1163; theory (4.16.2), §5.2.

use crate::value::Value;

/// Largest scores kept.
const KEPT: usize = 256;

/// The largest |y| of all scores, exact and independent of how the work was split.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tail {
    /// Descending.
    largest: Vec<f64>,
    /// Scores different from zero.
    count: u64,
}

impl Tail {
    /// The tail of one block of scores, `count` of them not zero, unordered, given that scores up to `threshold` cannot belong to the largest of all.
    pub(crate) fn of_block<V: Value>(scores: &[V], count: u64, threshold: f64) -> Self {
        // most blocks of a long run hold no candidate: one vectorised pass finds out
        if !scores.iter().fold(false, |any, y| any | (y.magnitude() > threshold)) {
            return Tail { largest: Vec::new(), count };
        }
        let mut largest: Vec<f64> = scores.iter().map(Value::magnitude).filter(|m| *m > threshold).collect();
        if largest.len() > KEPT {
            largest.select_nth_unstable_by(KEPT - 1, |a, b| b.total_cmp(a));
            largest.truncate(KEPT);
        }
        Tail { largest, count }
    }

    /// Joins the tails of many blocks.
    pub(crate) fn merge<'a>(&mut self, blocks: impl IntoIterator<Item = &'a Tail>) {
        for block in blocks {
            self.count += block.count;
            self.largest.extend_from_slice(&block.largest);
        }
        self.keep_the_largest();
    }

    /// A function of its own: sorting is compiled once, not for every iterator of blocks.
    fn keep_the_largest(&mut self) {
        self.largest.sort_unstable_by(|a, b| b.total_cmp(a));
        self.largest.truncate(KEPT);
    }

    /// Scores at or below this cannot enter.
    pub(crate) fn threshold(&self) -> f64 {
        if self.largest.len() < KEPT { 0.0 } else { self.largest[KEPT - 1] }
    }

    /// The largest |y|, descending; at most 256.
    pub fn largest(&self) -> &[f64] {
        &self.largest
    }

    /// Hill's estimate of the tail index α (the variance is finite iff α > 2) and its standard error α/√k.
    ///
    /// From the k = min(256, 2√M, M/20) largest of the M scores different from zero: zeros are no tail. `None` if k < 25, or if half of
    /// these scores are equal to a neighbour: counts and scores piled up at a bound have no tail that the estimate could see.
    pub fn index(&self) -> Option<(f64, f64)> {
        let wanted = (2.0 * (self.count as f64).sqrt()).min(self.count as f64 / 20.0) as usize;
        let k = wanted.min(self.largest.len().saturating_sub(1));
        if k < 25 {
            return None;
        }
        let ties = self.largest[..=k].windows(2).filter(|pair| pair[0] == pair[1]).count();
        if 2 * ties >= k {
            return None;
        }
        let reference = self.largest[k].ln();
        let mean = self.largest[..k].iter().map(|y| y.ln() - reference).sum::<f64>() / k as f64;
        (mean > 0.0).then(|| (1.0 / mean, 1.0 / mean / (k as f64).sqrt()))
    }
}
