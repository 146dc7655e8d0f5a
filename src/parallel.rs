//! The one file that names rayon: work in, results out, in order.

/// `f(0), …, f(count − 1)`, in order, on all cores if the feature `parallel` is on. Floating-point sums happen elsewhere, serially.
#[cfg(feature = "parallel")]
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    use rayon::prelude::*;
    (0..count).into_par_iter().map(f).collect()
}

/// `f(0), …, f(count − 1)`.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map<T>(count: usize, f: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(f).collect()
}
