//! Van der Corput's sequence: the radical inverse in one base, the one-dimensional ancestor of Halton and Sobol' points.
//!
//! van der Corput, *Verteilungsfunktionen*, 1935; scrambling as in [`radical`](super::radical).

use super::Layout;
use super::cursor::{Coordinates, PointSampler};
use super::radical::Radix;
use super::settings::{Scrambling, Settings, common_settings};
use crate::error::Error;
use crate::sampling::Sequence;
use crate::sampling::hash::word;

/// The radical inverse in any base. It has one coordinate; all others are independent random numbers. A walk makes its first step by it,
/// unless the [layout](Self::layout) says otherwise.
///
/// ```
/// use fredholm::sampling::{Sampler, Sequence, VanDerCorput};
/// let decimal = VanDerCorput::new(10)?.unscrambled();
/// assert!((decimal.point(0, 0, 1935).next_1d() - 0.5391).abs() < 1e-15);
/// assert!(VanDerCorput::new(1).is_err());
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VanDerCorput {
    settings: Settings,
    base: u32,
}

impl VanDerCorput {
    /// In base `base`, scrambled by seed 0, 16 replicates.
    ///
    /// # Errors
    /// [`Error::Invalid`] for bases 0 and 1.
    pub fn new(base: u32) -> Result<Self, Error> {
        if base < 2 {
            return Err(Error::invalid("base", f64::from(base), "must be at least 2"));
        }
        let layout = Layout::of_dimension(0).survival(0).step(1);
        Ok(VanDerCorput { settings: Settings { layout, ..Settings::new(0) }, base })
    }
}

common_settings!(VanDerCorput);

impl Sequence for VanDerCorput {
    type Sampler = PointSampler<VanDerCorputPoint>;

    #[inline]
    fn point(&self, cell: u64, replicate: u32, index: u64) -> Self::Sampler {
        let Settings { scrambling, layout, .. } = self.settings;
        let point = VanDerCorputPoint { base: self.base, key: self.settings.key(cell, replicate), index, scrambling };
        PointSampler::new(point, layout)
    }

    fn with_seed(self, seed: u64) -> Self {
        VanDerCorput { settings: self.settings.with_seed(seed), ..self }
    }

    fn replicates(&self) -> Option<u32> {
        Some(self.settings.replicates)
    }

    fn is_randomised(&self) -> bool {
        self.settings.is_randomised()
    }
}

/// One number of van der Corput's sequence.
#[derive(Clone, Debug)]
pub struct VanDerCorputPoint {
    base: u32,
    key: u64,
    index: u64,
    scrambling: Scrambling,
}

impl Coordinates for VanDerCorputPoint {
    #[inline]
    fn count(&self) -> u32 {
        1
    }

    #[inline]
    fn coordinate(&self, _: u32) -> f64 {
        let radix = Radix::new(u64::from(self.base));
        match self.scrambling {
            Scrambling::Nested => radix.scrambled(self.index, self.key, Radix::shuffled),
            Scrambling::None => radix.inverse(self.index),
        }
    }

    fn key(&self) -> u64 {
        word(!self.key, self.index)
    }
}
