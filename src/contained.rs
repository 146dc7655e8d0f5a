//! A panic in a function of the user's becomes an error: what other calls have found, such as the rounds of a run so far, is kept.

use crate::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// `work`, or [`Error::Panicked`].
///
/// Equations and methods are only read by a solve, and what it was making is dropped: nothing half done can be seen afterwards.
pub(crate) fn contained<T>(work: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let text = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
        let message = text.or_else(|| payload.downcast_ref::<String>().cloned());
        Err(Error::Panicked { message: message.unwrap_or_else(|| "no message".into()) })
    })
}
