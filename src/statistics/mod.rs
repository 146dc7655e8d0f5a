//! From scores to a number with an honest error: moments, tails, intervals, verdicts, stopping.

mod estimate;
mod moments;
mod rate;
mod stopping;
mod tail;

pub use estimate::{Estimate, Truncation, Verdict};
pub use moments::Moments;
pub use rate::Rate;
pub use stopping::{Progress, Target};
pub use tail::Tail;
