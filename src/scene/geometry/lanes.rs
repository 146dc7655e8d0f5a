//! Several boxes or triangles at once, by the instructions that the machine has.
//!
//! The loops over lanes are written once, as loops over arrays: no operation is fused with another, so that every machine gets the same bits.
//! What they compile to is decided at run time: AVX2 where there is, else what the target has at least. `pulp` does it without unsafe code here.

use super::build::IN_LEAF;
use super::tree::LANES;

/// What a machine can do beyond plain loops.
pub(super) trait Lanes: Copy {
    /// The signs of eight numbers as bits.
    fn signs(self, values: &[f32; LANES]) -> u32;

    /// The signs of four numbers as bits.
    fn signs64(self, values: &[f64; IN_LEAF]) -> u32;

    /// Brings data near that will be read soon.
    fn prefetch<T>(self, data: &T);
}

/// Any machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

impl Lanes for Portable {
    #[inline(always)]
    fn signs(self, values: &[f32; LANES]) -> u32 {
        values.iter().enumerate().fold(0, |bits, (i, v)| bits | (v.to_bits() >> 31) << i)
    }

    #[inline(always)]
    fn signs64(self, values: &[f64; IN_LEAF]) -> u32 {
        values.iter().enumerate().fold(0, |bits, (i, v)| bits | ((v.to_bits() >> 63) as u32) << i)
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
}

#[cfg(target_arch = "x86_64")]
impl Lanes for pulp::x86::V3 {
    #[inline(always)]
    fn signs(self, values: &[f32; LANES]) -> u32 {
        self.avx._mm256_movemask_ps(pulp::cast(*values)) as u32
    }

    #[inline(always)]
    fn signs64(self, values: &[f64; IN_LEAF]) -> u32 {
        self.avx._mm256_movemask_pd(pulp::cast(*values)) as u32
    }

    #[inline(always)]
    fn prefetch<T>(self, data: &T) {
        let start = std::ptr::from_ref(data).cast::<i8>();
        for line in 0..size_of::<T>().div_ceil(64) {
            self.sse._mm_prefetch::<3>(start.wrapping_add(64 * line));
        }
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
    v3: Option<pulp::x86::V3>,
}

impl Machine {
    pub(super) fn detect() -> Self {
        Machine {
            #[cfg(target_arch = "x86_64")]
            v3: pulp::x86::V3::try_new(),
        }
    }

    #[inline]
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = self.v3 {
            return v3.vectorize(OnV3(v3, task));
        }
        task.run(Portable)
    }
}

#[cfg(target_arch = "x86_64")]
struct OnV3<T>(pulp::x86::V3, T);

#[cfg(target_arch = "x86_64")]
impl<T: Task> pulp::NullaryFnOnce for OnV3<T> {
    type Output = T::Output;

    #[inline(always)]
    fn call(self) -> T::Output {
        self.1.run(self.0)
    }
}
