//! Which coordinates of a point a walk reads for what.

use crate::sampling::Purpose;
use std::ops::Range;

/// How many coordinates each [`Purpose`] of a vertex owns, in a point of finitely many coordinates (theory (4.14.1)):
///
/// ```text
/// start | survival step event | survival step event | …
///       |      vertex 0       |      vertex 1       |
/// ```
///
/// Few coordinates a vertex leave the first and best ones to more vertices; what a purpose reads beyond its own is drawn independently. So
/// state how many numbers your kernel consumes: the default, [`Layout::of_dimension`]\(3\), is for walks on domains of up to three
/// dimensions.
///
/// ```
/// use fredholm::{Equation, Walk, sampling::{Layout, Sobol}};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// // starts at a point, one number a step, no point of the source
/// let line = Layout::of_dimension(1).start(0).event(0);
/// let f = eq.at(0.5).solve(&Walk::collision().sequence(Sobol::new(7).layout(line)))?;
/// assert!(f.agrees_with(1.15, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layout {
    start: u16,
    survival: u16,
    step: u16,
    event: u16,
}

impl Default for Layout {
    fn default() -> Self {
        Layout::of_dimension(3)
    }
}

impl Layout {
    /// `d` coordinates for the start, and at every vertex one for survival, `d` for the step and `d` for next-event estimation.
    #[must_use]
    pub const fn of_dimension(d: u16) -> Self {
        Layout { start: d, survival: 1, step: d, event: d }
    }

    /// `n` coordinates for the start: 0 for walks that start at a given point.
    #[must_use]
    pub const fn start(self, n: u16) -> Self {
        Layout { start: n, ..self }
    }

    /// `n` coordinates for the survival test: 0 without roulette.
    #[must_use]
    pub const fn survival(self, n: u16) -> Self {
        Layout { survival: n, ..self }
    }

    /// `n` coordinates for a step.
    #[must_use]
    pub const fn step(self, n: u16) -> Self {
        Layout { step: n, ..self }
    }

    /// `n` coordinates for next-event estimation: 0 for walks without.
    #[must_use]
    pub const fn event(self, n: u16) -> Self {
        Layout { event: n, ..self }
    }

    /// The coordinates of a purpose at a vertex, those from `limit` on left out.
    #[inline]
    pub(super) fn coordinates(&self, vertex: u64, purpose: Purpose, limit: u32) -> Range<u32> {
        let [start, survival, step, event] = [self.start, self.survival, self.step, self.event].map(u64::from);
        let block = start + vertex.min(u64::from(limit)) * (survival + step + event);
        let (from, count) = match purpose {
            Purpose::Start if vertex == 0 => (0, start),
            // walks start once
            Purpose::Start => (0, 0),
            Purpose::Survival => (block, survival),
            Purpose::Move => (block + survival, step),
            Purpose::Event => (block + survival + step, event),
        };
        let limit = u64::from(limit);
        from.min(limit) as u32..(from + count).min(limit) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Purpose::{Event, Move, Start, Survival};

    #[test]
    fn purposes_own_every_coordinate_once() {
        let layout = Layout::of_dimension(2).event(3);
        let mut next = 0;
        for vertex in 0..9 {
            for purpose in [Start, Survival, Move, Event] {
                let range = layout.coordinates(vertex, purpose, 50);
                assert!(range.is_empty() || range.start == next, "{vertex} {purpose:?} {range:?}");
                next = next.max(range.end);
            }
        }
        assert_eq!(next, 50);
    }

    #[test]
    fn late_vertices_own_nothing() {
        for vertex in [8, 1 << 40, u64::MAX] {
            assert!(Layout::of_dimension(2).coordinates(vertex, Move, 40).is_empty());
        }
        // a sequence of one coordinate gives it to the first step
        let first = Layout::of_dimension(0).survival(0).step(1);
        assert_eq!(first.coordinates(0, Move, 1), 0..1);
        assert!(first.coordinates(1, Move, 1).is_empty());
    }
}
