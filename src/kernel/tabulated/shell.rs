//! Shells of distances around x, finer and finer towards it.

/// Octaves [2^{−n−1}, 2^{−n}) of the distance, in units of R.
pub(super) const OCTAVES: usize = 48;
/// Octaves from the outermost on that are cut into quarters.
const FINE: usize = 16;
/// Parts of a fine octave.
const PARTS: usize = 4;
/// Shells on each side of x; the last one reaches x itself. 2^{−48} of R is near the spacing of floating-point numbers.
pub(super) const SHELLS: usize = FINE * PARTS + OCTAVES - FINE;

/// 1/R in the coordinate s: `stretch` = dμ/ds, `reach` = R in units of μ; R at most the whole interval.
#[inline]
pub(super) fn scale(stretch: f64, reach: f64) -> f64 {
    (stretch / reach).max(1.0)
}

/// A shell: distances between two bounds on one side of x, in one state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shell {
    pub(super) state: usize,
    pub(super) right: bool,
    /// counted from the outermost
    level: usize,
}

impl Shell {
    /// The shell that holds a distance in [0, 1), in units of R.
    #[inline]
    pub(super) fn at(state: usize, right: bool, distance: f64) -> Self {
        let bits = distance.to_bits();
        // the binary exponent is the octave, the first two bits of the mantissa the part
        let octave = 1022usize.saturating_sub((bits >> 52) as usize).min(OCTAVES - 1);
        let part = PARTS - 1 - ((bits >> 50) & 3) as usize;
        Shell { state, right, level: if octave < FINE { octave * PARTS + part } else { FINE * (PARTS - 1) + octave } }
    }

    #[inline]
    pub(super) fn index(self) -> usize {
        (2 * self.state + usize::from(self.right)) * SHELLS + self.level
    }

    #[inline]
    pub(super) fn of_index(i: usize) -> Self {
        Shell { state: i / (2 * SHELLS), right: (i / SHELLS) % 2 == 1, level: i % SHELLS }
    }

    /// Indices of the shells of an octave.
    pub(super) fn octave(state: usize, right: bool, octave: usize) -> impl Iterator<Item = usize> {
        let levels =
            if octave < FINE { octave * PARTS..(octave + 1) * PARTS } else { FINE * (PARTS - 1) + octave..FINE * (PARTS - 1) + octave + 1 };
        levels.map(move |level| Shell { state, right, level }.index())
    }

    /// Inner and outer distance, in units of R.
    #[inline]
    pub(super) fn bounds(self) -> (f64, f64) {
        if self.level < FINE * PARTS {
            let outer = power_of_half(self.level / PARTS);
            let part = (self.level % PARTS) as f64;
            let quarter = 0.5 / PARTS as f64;
            return (outer * (1.0 - quarter * (part + 1.0)), outer * (1.0 - quarter * part));
        }
        let octave = self.level - FINE * (PARTS - 1);
        let outer = power_of_half(octave);
        (if octave + 1 == OCTAVES { 0.0 } else { 0.5 * outer }, outer)
    }
}

/// 2^{−n}, exactly.
#[inline]
fn power_of_half(n: usize) -> f64 {
    f64::from_bits((1023 - n as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shells_cover_the_distances_once() {
        let mut outer = 1.0;
        for level in 0..SHELLS {
            let shell = Shell { state: 1, right: true, level };
            let (inner, end) = shell.bounds();
            assert_eq!(end, outer);
            assert!(inner < end);
            for distance in [inner, 0.5 * (inner + end), end.next_down()] {
                assert_eq!(Shell::at(1, true, distance).level, level, "{distance:e}");
            }
            assert_eq!(Shell::of_index(shell.index()).level, level);
            outer = inner;
        }
        assert_eq!(outer, 0.0);
    }
}
