//! From scores to a number with an honest error: moments, tails, intervals, verdicts, stopping.

mod band;
mod estimate;
mod moments;
mod profile;
mod rate;
mod replicates;
mod stopping;
mod student;
mod study;
mod tail;

pub use band::Band;
pub use estimate::{Estimate, Truncation, Verdict};
pub use moments::Moments;
pub use profile::{Bias, Profile};
pub use rate::Rate;
pub(crate) use replicates::Pooled;
pub use stopping::{Progress, Target};
pub use student::student_quantile;
pub use study::{Coverage, Measured, Study, Sweep};
pub use tail::Tail;
