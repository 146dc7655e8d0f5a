//! How many samples every stratum gets.
//!
//! ```text
//! proportional  n_i = n v_i                    never worse than no strata (rounded up, n_i ≥ n v_i)
//! equal         n_i = n/k                      may be worse than no strata where volumes differ
//! Neyman        n_i ∝ v_i σ_i, σ_i by a pilot   the least variance, (Σ v_i σ_i)²/n
//! ```
//!
//! A pilot that sees no spread in any stratum tells nothing: Neyman's allocation is then the proportional one.
//!
//! Reference: Neyman, *On the two different aspects of the representative method*, J. R. Stat. Soc. 97 (1934) 558; theory (4.14.5).

use super::strata::Strata;
use crate::error::Error;

/// How samples are shared between strata.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allocation {
    /// n_i ∝ v_i, the volume of the stratum.
    Proportional,
    /// The same number everywhere.
    Equal,
    /// n_i ∝ v_i σ_i, at least 2, with σ_i from this many scores of a pilot in every stratum; proportional if the pilot sees no spread anywhere.
    Neyman {
        /// Scores a stratum, at least 2.
        pilot: u64,
    },
}

impl Allocation {
    pub(super) fn validate(&self) -> Result<(), Error> {
        match self {
            Allocation::Neyman { pilot } if *pilot < 2 => {
                Err(Error::invalid("pilot samples a stratum", *pilot as f64, "must be at least 2"))
            }
            _ => Ok(()),
        }
    }

    /// Samples of every stratum for a budget of `n`, rounded up, at least 1; `spread` are the σ_i of a pilot.
    pub(super) fn counts(&self, strata: &Strata, n: u64, spread: &[f64]) -> Vec<u64> {
        let k = strata.count();
        // up to rounding: (n/k)·k must give n/k, not one more
        let up = |x: f64, least: f64| (x * (1.0 - 1e-12)).ceil().max(least) as u64;
        let proportional = |least: f64| (0..k).map(|i| up(n as f64 * strata.volume(i), least)).collect();
        match self {
            Allocation::Proportional => proportional(1.0),
            Allocation::Equal => vec![n.div_ceil(k as u64).max(1); k],
            Allocation::Neyman { .. } => {
                let shares: Vec<f64> = (0..k).map(|i| strata.volume(i) * spread[i]).collect();
                let total: f64 = shares.iter().sum();
                if total == 0.0 {
                    return proportional(2.0);
                }
                shares.iter().map(|s| up(n as f64 * s / total, 2.0)).collect()
            }
        }
    }
}
