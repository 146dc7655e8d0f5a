//! One chain.

use super::Tally;
use super::point::{Cursor, Mutation, Point};
use crate::error::Error;
use crate::parallel;
use crate::sampling::{Pcg, PcgSampler, Sampler, Sequence};
use crate::statistics::Moments;
use crate::value::Value;

/// What all chains have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    pub(super) seed: u64,
    pub(super) mutations: u64,
    pub(super) pool: u64,
    pub(super) large: f64,
    pub(super) steps: (f64, f64),
    /// β of the combined large steps
    pub(super) scale: Option<f64>,
}

/// Streams: pools, chains, and the pool that β comes from.
const POOLS: u32 = 0;
const CHAINS: u32 = 1;
const SCALE: u32 = 2;

/// Σ yᵏ of the scores of one cell. Most tallies of a cell are 0, so that power sums lose no digits that matter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<V> {
    nonzero: u64,
    powers: [V; 4],
}

impl<V: Value> Sums<V> {
    fn add(&mut self, y: V) {
        self.nonzero += u64::from(y.magnitude() != 0.0);
        let mut power = y;
        for sum in &mut self.powers {
            *sum += power;
            power = power.zip(y, |a, b| a * b);
        }
    }

    /// As central moments of `count` scores.
    pub(super) fn moments(&self, count: u64) -> Moments<V> {
        let n = count as f64;
        let central = |c: usize| {
            let [s1, s2, s3, s4] = self.powers.map(|p| p.component(c));
            let m = s1 / n;
            let m3 = s3 - 3.0 * m * s2 + 2.0 * n * m * m * m;
            [m, (s2 - m * s1).max(0.0), m3, (s4 - 4.0 * m * s3 + 6.0 * m * m * s2 - 3.0 * n * m * m * m * m).max(0.0)]
        };
        let [mean, m2, m3, m4] = std::array::from_fn(|k| V::from_components(|c| central(c)[k]));
        Moments { count, nonzero: self.nonzero, mean, m2, m3, m4 }
    }
}

/// What one chain found.
#[derive(Debug)]
pub(super) struct Outcome<V> {
    pub(super) pool: Moments<f64>,
    pub(super) cells: Vec<Sums<V>>,
    /// Small steps proposed and accepted.
    pub(super) small: (u64, u64),
    /// Fresh points proposed and accepted.
    pub(super) large: (u64, u64),
    /// Of the pool, which the start is from.
    pub(super) before: Spent,
    /// Of the mutations.
    pub(super) after: Spent,
}

/// Steps and evaluations.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spent {
    pub(super) steps: u64,
    pub(super) evaluations: u64,
}

impl Spent {
    pub(super) fn add(&mut self, (steps, evaluations): (u64, u64)) {
        self.steps += steps;
        self.evaluations += evaluations;
    }

    pub(super) fn and(mut self, other: Spent) -> Spent {
        self.add((other.steps, other.evaluations));
        self
    }
}

impl<V> Outcome<V> {
    fn count(&mut self, large: bool, accepted: bool) {
        let count = if large { &mut self.large } else { &mut self.small };
        count.0 += 1;
        count.1 += u64::from(accepted);
    }
}

/// A point and what it scores.
struct State<V> {
    point: Point,
    scores: Vec<(usize, V)>,
    /// C
    target: f64,
}

impl<V> Default for State<V> {
    fn default() -> Self {
        State { point: Point::default(), scores: Vec::new(), target: 0.0 }
    }
}

impl<V: Value> State<V> {
    /// Becomes the point that `mutation` makes.
    fn visit<T: Tally<Value = V>>(
        &mut self,
        tally: &T,
        mutation: Mutation<'_>,
        rng: &mut PcgSampler,
        scratch: &mut T::Scratch,
    ) -> Result<(u64, u64), Error> {
        let State { point, scores, target } = self;
        scores.clear();
        *target = 0.0;
        let mut u = Cursor::new(point, mutation, rng);
        let cost = tally.tally(&mut u, scratch, &mut |cell, score| {
            *target += score.magnitude();
            scores.push((cell, score));
        });
        // NaN is lost in `magnitude`, which compares
        if !(target.is_finite() && scores.iter().all(|s| s.1.all_finite())) {
            u.rewind();
            let unexplained = Error::NonFiniteScore { sample: 0, replicate: 0, score: format!("{:?}", scores.last().map(|s| s.1)) };
            return Err(tally.explain(&mut u).unwrap_or(unexplained));
        }
        Ok(cost)
    }
}

impl Setting {
    fn stream(&self, purpose: u32, chain: u64, index: u64) -> PcgSampler {
        Pcg::new(self.seed).point(chain, purpose, index)
    }

    /// β, the mean of C over points of their own, as many as all pools have; and what that cost.
    pub(super) fn scale<T: Tally>(&self, tally: &T, chains: u64) -> Result<(f64, Spent), Error> {
        let pools = parallel::map(chains as usize, |c| self.pool(tally, SCALE, c as u64, &mut (State::default(), T::Scratch::default())));
        let pools = pools.into_iter().collect::<Result<Vec<_>, Error>>()?;
        let spent = pools.iter().fold(Spent::default(), |sum, pool| sum.and(pool.1));
        let mean = Moments::from_scores(&pools.into_iter().flat_map(|pool| pool.0).collect::<Vec<_>>()).mean;
        // any positive number keeps the result unbiased
        Ok((if mean > 0.0 { mean } else { 1.0 }, spent))
    }

    /// C at the independent points of one pool, and what they cost.
    fn pool<T: Tally>(
        &self,
        tally: &T,
        purpose: u32,
        chain: u64,
        (state, scratch): &mut (State<T::Value>, T::Scratch),
    ) -> Result<(Vec<f64>, Spent), Error> {
        let mut spent = Spent::default();
        let one = |i| {
            spent.add(state.visit(tally, Mutation::Large, &mut self.stream(purpose, chain, i), scratch)?);
            Ok(state.target)
        };
        let targets = (0..self.pool).map(one).collect::<Result<_, Error>>()?;
        Ok((targets, spent))
    }

    /// Chain number `chain`.
    pub(super) fn chain<T: Tally>(&self, tally: &T, chain: u64) -> Result<Outcome<T::Value>, Error> {
        let mut memory = (State::default(), T::Scratch::default());
        let (pool, before) = self.pool(tally, POOLS, chain, &mut memory)?;
        let (mut current, mut scratch) = memory;
        let mut rng = self.stream(CHAINS, chain, 0);
        let sums = Sums { nonzero: 0, powers: [T::Value::ZERO; 4] };
        let mut out = Outcome {
            pool: Moments::from_scores(&pool),
            cells: vec![sums; tally.cells()],
            small: (0, 0),
            large: (0, 0),
            before,
            after: Spent::default(),
        };
        let total: f64 = pool.iter().sum();
        match chosen(&pool, rng.next_1d() * total) {
            Some(start) => {
                out.after.add(current.visit(tally, Mutation::Large, &mut self.stream(POOLS, chain, start as u64), &mut scratch)?);
            }
            None => current.target = 0.0,
        }
        self.walk(tally, &mut current, &mut scratch, &mut rng, &mut out)?;
        Ok(out)
    }

    /// The mutations. A chain whose pool scored nothing has no start and b̂ = 0: its fresh points still count where they count by themselves.
    fn walk<T: Tally>(
        &self,
        tally: &T,
        current: &mut State<T::Value>,
        scratch: &mut T::Scratch,
        rng: &mut PcgSampler,
        out: &mut Outcome<T::Value>,
    ) -> Result<(), Error> {
        let b = out.pool.mean;
        // weight of a state in the chain: b/C, or (b/β)/(C/β + p_L) beside a fresh point's 1/(C/β + p_L)
        let weight = |target: f64, share: f64, fresh: f64| match self.scale {
            None => share * b / target,
            Some(beta) => (share * b / beta + fresh) / (target / beta + self.large),
        };
        let mut proposed = State::default();
        for _ in 0..self.mutations {
            let large = rng.next_1d() < self.large;
            if current.target == 0.0 && !(large && self.scale.is_some()) {
                continue;
            }
            let mutation = if large { Mutation::Large } else { Mutation::Small { current: &current.point, steps: self.steps } };
            out.after.add(proposed.visit(tally, mutation, rng, scratch)?);
            let a = if current.target > 0.0 { (proposed.target / current.target).min(1.0) } else { 0.0 };
            if a < 1.0 && current.target > 0.0 {
                record(out, current, weight(current.target, 1.0 - a, 0.0));
            }
            if proposed.target > 0.0 {
                record(out, &proposed, weight(proposed.target, a, f64::from(u8::from(large))));
            }
            let accepted = rng.next_1d() < a;
            out.count(large, accepted);
            if accepted {
                std::mem::swap(current, &mut proposed);
            }
        }
        Ok(())
    }
}

/// Two tallies a mutation, so that the mean over 2n of them needs a factor 2.
fn record<V: Value>(out: &mut Outcome<V>, state: &State<V>, weight: f64) {
    for (cell, score) in &state.scores {
        out.cells[*cell].add(score.scale(2.0 * weight));
    }
}

/// The index at which the running sum of C passes `mark`; `None` if all are 0.
fn chosen(targets: &[f64], mark: f64) -> Option<usize> {
    let mut sum = 0.0;
    let passing = targets.iter().position(|c| {
        sum += c;
        sum > mark
    });
    // rounding may leave the mark at the very end: the last that scores
    passing.or_else(|| targets.iter().rposition(|c| *c > 0.0))
}
