//! Points of the unit cube, coordinate by coordinate, as far as they were read.

use crate::sampling::{PcgSampler, Purpose, Sampler, midpoint};

/// The coordinates that a score has read: block 0 before the first [`seek`](Sampler::seek), then one for every vertex and purpose.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    blocks: Vec<Vec<f64>>,
}

impl Point {
    /// Forgets all coordinates, but not their memory.
    fn clear(&mut self) {
        self.blocks.iter_mut().for_each(Vec::clear);
    }

    fn get(&self, block: usize, index: usize) -> Option<f64> {
        self.blocks.get(block).and_then(|b| b.get(index)).copied()
    }
}

/// How coordinates of a proposal come from those of the current point.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mutation<'a> {
    /// All afresh.
    Large,
    /// Each moved by a step whose length is uniform in the logarithm between two bounds; what the current point did not read is drawn afresh.
    Small { current: &'a Point, steps: (f64, f64) },
}

/// The cursor on a proposal, which comes into being as it is read.
#[derive(Debug)]
pub(super) struct Cursor<'a> {
    point: &'a mut Point,
    mutation: Mutation<'a>,
    rng: &'a mut PcgSampler,
    block: usize,
    next: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(point: &'a mut Point, mutation: Mutation<'a>, rng: &'a mut PcgSampler) -> Self {
        point.clear();
        let mut cursor = Cursor { point, mutation, rng, block: 0, next: 0 };
        cursor.enter(0);
        cursor
    }

    /// The same point again from its start.
    pub(super) fn rewind(&mut self) {
        self.enter(0);
    }

    fn enter(&mut self, block: usize) {
        if self.point.blocks.len() <= block {
            self.point.blocks.resize_with(block + 1, Vec::new);
        }
        (self.block, self.next) = (block, 0);
    }

    fn fresh(&mut self) -> f64 {
        match self.mutation {
            Mutation::Large => self.rng.next_1d(),
            Mutation::Small { current, steps } => match current.get(self.block, self.next) {
                Some(x) => moved(x, steps, self.rng.next_1d()),
                None => self.rng.next_1d(),
            },
        }
    }
}

/// x ± least·(most/least)^v modulo 1, the sign and v ∈ (0, 1) from one uniform number: symmetric.
fn moved(x: f64, (least, most): (f64, f64), u: f64) -> f64 {
    let (sign, v) = if u < 0.5 { (1.0, 2.0 * u) } else { (-1.0, 2.0 * u - 1.0) };
    let y = x + sign * least * (most / least).powf(v);
    midpoint(y - y.floor())
}

impl Sampler for Cursor<'_> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        let x = match self.point.get(self.block, self.next) {
            Some(x) => x,
            None => {
                let x = self.fresh();
                self.point.blocks[self.block].push(x);
                x
            }
        };
        self.next += 1;
        x
    }

    #[inline]
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        self.enter((vertex as usize) * 4 + purpose as usize + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Pcg, Sequence};

    #[test]
    fn a_point_can_be_read_again_and_mutated() {
        let (mut a, mut b, mut rng) = (Point::default(), Point::default(), Pcg::new(1).point(0, 0, 0));
        let mut u = Cursor::new(&mut a, Mutation::Large, &mut rng);
        let first = u.next_1d();
        u.seek(3, Purpose::Move);
        let pair = u.next_2d();
        u.rewind();
        assert_eq!(u.next_1d(), first);
        u.seek(3, Purpose::Move);
        assert_eq!(u.next_2d(), pair);
        let steps = (1e-3, 1e-2);
        let mut u = Cursor::new(&mut b, Mutation::Small { current: &a, steps }, &mut rng);
        u.seek(3, Purpose::Move);
        let moved = u.next_1d();
        let distance = (moved - pair[0]).abs();
        let wrapped = distance.min(1.0 - distance);
        assert!((1e-3 - 1e-12..1e-2 + 1e-12).contains(&wrapped), "{wrapped}");
    }

    #[test]
    fn steps_stay_strictly_inside() {
        for x in [2f64.powi(-53), 0.5, 1.0 - 2f64.powi(-53)] {
            for i in 0..1000 {
                let y = moved(x, (1e-4, 0.5), (f64::from(i) + 0.5) / 1000.0);
                assert!(y > 0.0 && y < 1.0);
            }
        }
    }
}
