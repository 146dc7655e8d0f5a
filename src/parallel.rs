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

/// `f(i, i-th chunk of size items)` for all chunks of a slice, the last of which may be shorter; results in order.
#[cfg(feature = "parallel")]
pub(crate) fn chunks<T: Send, R: Send>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) -> R + Send + Sync) -> Vec<R> {
    use rayon::prelude::*;
    data.par_chunks_mut(size).enumerate().map(|(i, chunk)| f(i, chunk)).collect()
}

/// `f(i, i-th chunk of size items)` for all chunks of a slice, the last of which may be shorter; results in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn chunks<T, R>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) -> R) -> Vec<R> {
    data.chunks_mut(size).enumerate().map(|(i, chunk)| f(i, chunk)).collect()
}
