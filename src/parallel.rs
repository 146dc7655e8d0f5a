//! The one file that names rayon: work in, results out, in order.
//!
//! Threads are compiled once, in this crate: what differs from task to task hides behind a vtable, one indirect call a task, and results go into slots.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// `f(0), …, f(count − 1)`, in order, on all cores if the feature `parallel` is on. Floating-point sums happen elsewhere, serially.
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    // one task wakes no thread
    if count <= 1 {
        return (0..count).map(f).collect();
    }
    let slots: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    let panicked = AtomicBool::new(false);
    each(count, &|i| {
        // a panic is passed on when all tasks have come to their ends: those that have not begun would only panic too
        if panicked.load(Ordering::Relaxed) {
            return;
        }
        let alarm = Alarm(&panicked);
        let found = Some(f(i));
        drop(alarm);
        // nobody else asks for this slot
        *slots[i].lock().unwrap_or_else(PoisonError::into_inner) = found;
    });
    let result = |slot: Mutex<Option<T>>| slot.into_inner().unwrap_or_else(PoisonError::into_inner);
    slots.into_iter().map(|slot| result(slot).expect("every task has run")).collect()
}

/// Remembers that a panic passed by.
struct Alarm<'a>(&'a AtomicBool);

impl Drop for Alarm<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// The same for many short tasks, in runs of them.
#[cfg(feature = "scene")]
pub(crate) fn map_short<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    const RUN: usize = 1 << 14;
    if count <= RUN {
        return (0..count).map(f).collect();
    }
    let mut all = Vec::with_capacity(count);
    map(count.div_ceil(RUN), |k| (k * RUN..count.min((k + 1) * RUN)).map(&f).collect())
        .into_iter()
        .for_each(|mut run| all.append(&mut run));
    all
}

/// `f()` on one of the threads that [`map`] and [`chunks`] use: many calls of those, each short, wake no thread from outside.
pub(crate) fn within<R: Send>(f: impl FnOnce() -> R + Send) -> R {
    let (mut f, mut found) = (Some(f), None);
    run(&mut || found = f.take().map(|f| f()));
    found.expect("the task has run")
}

#[cfg(feature = "parallel")]
fn run(task: &mut (dyn FnMut() + Send)) {
    rayon::scope(|_| task());
}

#[cfg(not(feature = "parallel"))]
fn run(task: &mut (dyn FnMut() + Send)) {
    task();
}

/// Calls `f` with 0, …, count − 1, each once, in any order.
#[cfg(feature = "parallel")]
fn each(count: usize, f: &(dyn Fn(usize) + Sync)) {
    use rayon::prelude::*;
    (0..count).into_par_iter().for_each(f);
}

/// Calls `f` with 0, …, count − 1.
#[cfg(not(feature = "parallel"))]
fn each(count: usize, f: &(dyn Fn(usize) + Sync)) {
    (0..count).for_each(f);
}

/// `f(i, i-th chunk of size items)` for all chunks of a slice, the last of which may be shorter; results in order.
pub(crate) fn chunks<T: Send, R: Send>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) -> R + Send + Sync) -> Vec<R> {
    let parts: Vec<Mutex<&mut [T]>> = data.chunks_mut(size).map(Mutex::new).collect();
    // nobody else asks for this part
    map(parts.len(), |i| f(i, &mut parts[i].lock().unwrap_or_else(PoisonError::into_inner)))
}
