//! What all randomised sequences have in common.

use super::Layout;
use crate::sampling::hash;

/// Randomisations by default, from which the error comes: Student's t with 15 degrees of freedom.
const REPLICATES: u32 = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scrambling {
    /// Owen's nested uniform scrambling
    Nested,
    /// the points of the textbook
    None,
}

/// Seed, replicates, scrambling, layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Settings {
    pub(super) seed: u64,
    pub(super) replicates: u32,
    pub(super) scrambling: Scrambling,
    pub(super) layout: Layout,
}

impl Settings {
    pub(super) fn new(seed: u64) -> Self {
        Settings { seed, replicates: REPLICATES, scrambling: Scrambling::Nested, layout: Layout::default() }
    }

    /// Another seed; a seed means a randomisation, so points as they are become scrambled ones.
    pub(super) fn with_seed(self, seed: u64) -> Self {
        Settings { seed, scrambling: Scrambling::Nested, ..self }
    }

    /// The points as they are: they exist only once, so there is no error.
    pub(super) fn unscrambled(self) -> Self {
        Settings { scrambling: Scrambling::None, replicates: 1, ..self }
    }

    /// Copies of the same points are no replicates: more than one needs scrambling.
    pub(super) fn with_replicates(self, replicates: u32) -> Self {
        let scrambling = if replicates > 1 { Scrambling::Nested } else { self.scrambling };
        Settings { replicates, scrambling, ..self }
    }

    pub(super) fn is_randomised(&self) -> bool {
        self.scrambling != Scrambling::None
    }

    #[inline]
    pub(super) fn key(&self, cell: u64, replicate: u32) -> u64 {
        hash::key(self.seed, cell, replicate)
    }
}

/// The methods of a sequence that has a field `settings`.
macro_rules! common_settings {
    ($type:ty) => {
        impl $type {
            /// Independent randomisations, from which the error comes (theory (4.14.4)); 16 by default. With one there is no error; more
            /// than one scramble points that were [`unscrambled`](Self::unscrambled).
            #[must_use]
            pub fn replicates(mut self, replicates: u32) -> Self {
                self.settings = self.settings.with_replicates(replicates);
                self
            }

            /// The points of the textbook, without randomisation: one replicate, hence an estimate without an error. Coordinates beyond its
            /// own are drawn independently. Another seed scrambles again.
            #[must_use]
            pub fn unscrambled(mut self) -> Self {
                self.settings = self.settings.unscrambled();
                self
            }

            /// Which coordinates walks read for what.
            #[must_use]
            pub fn layout(mut self, layout: crate::sampling::Layout) -> Self {
                self.settings.layout = layout;
                self
            }
        }
    };
}
pub(super) use common_settings;
