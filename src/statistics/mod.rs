//! From scores to a number with an honest error: moments, tails, intervals, verdicts, stopping.

mod estimate;
mod moments;
mod rate;
mod replicates;
mod stopping;
mod study;
mod tail;

pub use estimate::{Estimate, Truncation, Verdict};
pub use moments::Moments;
pub use rate::Rate;
pub(crate) use replicates::Pooled;
pub use stopping::{Progress, Target};
pub use study::{Coverage, Measured, Study, Sweep};
pub use tail::Tail;
