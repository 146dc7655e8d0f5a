//! Several boxes or triangles at once, by the instructions that the machine has.
//!
//! The arithmetic is written once, in vectors of `fearless_simd`; no operation is fused with another, so that every machine gets the same bits.
//! What it compiles to is decided at run time. `fearless_simd` does it without unsafe code here.

use fearless_simd::{Level, Simd};

/// Something to be done with the lanes of this machine.
pub(super) trait Task {
    type Output;
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// The instructions found on this machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Machine(Level);

impl Machine {
    pub(super) fn detect() -> Self {
        Machine(Level::new())
    }

    /// With AVX2 where there is, else with what every machine of its kind has; AVX-512 was not faster.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        if let Some(avx2) = self.0.as_avx2() {
            return avx2.vectorize(
                #[inline(always)]
                || task.run(avx2),
            );
        }
        let sse2 = self.0.as_sse2().expect("every x86-64 has it");
        task.run(sse2)
    }

    /// With what the target has.
    #[cfg(not(target_arch = "x86_64"))]
    #[inline]
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        fearless_simd::dispatch!(self.0, simd => task.run(simd))
    }
}

/// Brings the cache line near in which data begin that will be read soon.
#[inline(always)]
pub(super) fn prefetch<T>(data: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(data);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = data;
}
