//! Several boxes or triangles at once, by the instructions that the machine has.
//!
//! The loops over lanes are written once, as loops over arrays: no operation is fused with another, so that every machine gets the same bits.
//! What they compile to is decided at run time: AVX2 where there is, else what the target has at least. `fearless_simd` does it without unsafe code here.

use super::build::IN_LEAF;
use super::tree::LANES;
#[cfg(target_arch = "x86_64")]
use fearless_simd::{Avx2, f32x8, f64x4, prelude::*};

/// What a machine can do beyond plain loops.
pub(super) trait Lanes: Copy {
    /// The numbers below 0 of eight, as bits.
    fn below(self, values: &[f32; LANES]) -> u32;

    /// The numbers below 0 of four, as bits.
    fn below64(self, values: &[f64; IN_LEAF]) -> u32;

    /// Brings the cache line near in which data begin that will be read soon.
    fn prefetch<T>(self, data: &T);
}

/// Any machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

impl Lanes for Portable {
    #[inline(always)]
    fn below(self, values: &[f32; LANES]) -> u32 {
        values.iter().enumerate().fold(0, |bits, (i, v)| bits | u32::from(*v < 0.0) << i)
    }

    #[inline(always)]
    fn below64(self, values: &[f64; IN_LEAF]) -> u32 {
        values.iter().enumerate().fold(0, |bits, (i, v)| bits | u32::from(*v < 0.0) << i)
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
}

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx2 {
    #[inline(always)]
    fn below(self, values: &[f32; LANES]) -> u32 {
        let values: f32x8<Avx2> = (*values).simd_into(self);
        values.simd_lt(0.0).to_bitmask() as u32
    }

    #[inline(always)]
    fn below64(self, values: &[f64; IN_LEAF]) -> u32 {
        let values: f64x4<Avx2> = (*values).simd_into(self);
        values.simd_lt(0.0).to_bitmask() as u32
    }

    #[inline(always)]
    fn prefetch<T>(self, data: &T) {
        safe_arch::prefetch_t0(data);
    }
}

/// Something to be done with the lanes of this machine.
pub(super) trait Task {
    type Output;
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// The instructions found on this machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Machine {
    #[cfg(target_arch = "x86_64")]
    avx2: Option<Avx2>,
}

impl Machine {
    pub(super) fn detect() -> Self {
        Machine {
            #[cfg(target_arch = "x86_64")]
            avx2: fearless_simd::Level::new().as_avx2(),
        }
    }

    #[inline]
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2.vectorize(
                #[inline(always)]
                || task.run(avx2),
            );
        }
        task.run(Portable)
    }
}
