//! The one backward walk of the crate. It does not know which equation, detector or estimator it drives.
//!
//! ```text
//! X₀ from the detector, W₀ = h/p₀
//! loop   score arrival at X_n                        collision, MIS
//!        P = survival probability of X_n
//!        score at X_n                                next event: before the survival test, theory (2.2.4)
//!        die with probability 1 − P                  absorption scores here
//!        X_{n+1} from the kernel's step, W_{n+1} = W_n (K/π)/P
//! ```
//!
//! Walks go in lockstep, some hundred abreast, and the survivors close ranks after every test. What one walk does depends on its own point of
//! the sequence alone; going abreast hides latencies and mispredicted roulette (`cargo bench --bench walk_step`).

use super::ending::{Ending, Survival};
use super::observer::Observer;
use super::scoring::{Arrival, Scoring, Visit};
use crate::detector::Start;
use crate::equation::Equation;
use crate::kernel::{Operator, Step, Transition};
use crate::sampling::{Purpose, Sampler};
use crate::source::Source;
use crate::value::{Value, Weight};

/// How a walk ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The kernel absorbed it.
    Absorbed,
    /// It lost the roulette.
    Roulette,
    /// It was cut at a fixed depth.
    Cut,
    /// It reached `max_steps`: an error, not a result.
    TooLong,
}

/// One walk on its way.
#[derive(Debug)]
pub(super) struct Lane<X, W: Weight, S> {
    walk: usize,
    visit: Visit<X, W>,
    /// 1/P of the test just survived
    reciprocal: f64,
    /// the step just made, towards the next vertex
    step: Option<Step<X, W>>,
    score: W::Value,
    u: S,
}

impl<X, W: Weight, S> Lane<X, W, S> {
    /// Walk number `walk` of its front.
    #[inline]
    pub(super) fn new(walk: usize, start: Start<X>, u: S) -> Self {
        let visit = Visit { point: start.point, weight: W::ONE.scaled(start.weight), survival: 1.0 };
        Lane { walk, visit, reciprocal: 1.0, step: None, score: W::Value::ZERO, u }
    }
}

impl<X: Copy, W: Weight, S> Lane<X, W, S> {
    /// Where the walk is, and its |W|, or will be when its step is done.
    #[inline]
    pub(super) fn destination(&self) -> (X, f64) {
        match &self.step {
            Some(step) => (step.point(), self.visit.weight.scaled(self.reciprocal).then(step.weight()).norm()),
            None => (self.visit.point, self.visit.weight.norm()),
        }
    }

    /// Goes on with another sampler.
    #[inline]
    pub(super) fn read(&mut self, u: S) {
        self.u = u;
    }

    #[inline]
    pub(super) fn sampler(&self) -> &S {
        &self.u
    }
}

/// A walk that has ended.
pub(super) struct Outcome<V> {
    /// Its number in the front.
    pub(super) walk: usize,
    pub(super) score: V,
    pub(super) end: End,
    /// Cut while its weight was not zero.
    pub(super) truncated: bool,
}

/// What is walked, and how.
pub(super) struct Driver<'a, G, K, C, E> {
    pub(super) equation: &'a Equation<G, K>,
    pub(super) scoring: &'a C,
    pub(super) ending: &'a E,
    pub(super) max_steps: u64,
}

/// Steps abreast. Few walks are that long, and one without an end must be found after `max_steps`, not after as many for every walk beside it.
const ABREAST: u64 = 1 << 14;

impl<G, K, C, E> Driver<'_, G, K, C, E>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
{
    /// Walks all `lanes` to their ends, in no particular order, or to the first that is too long; returns the steps of all together. `ranks` is scratch
    /// space.
    #[inline]
    pub(super) fn backward<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        lanes: &mut [Lane<K::Point, K::Weight, S>],
        ranks: &mut Vec<u32>,
        observer: &mut O,
        mut ended: impl FnMut(Outcome<G::Value>),
    ) -> u64 {
        ranks.clear();
        ranks.extend(0..lanes.len() as u32);
        let mut steps = 0;
        for depth in 0..ABREAST {
            steps += self.advance(lanes, ranks, depth, observer, &mut ended);
            if ranks.is_empty() {
                return steps;
            }
        }
        for rank in std::mem::take(ranks) {
            ranks.push(rank);
            let mut depth = ABREAST;
            while !ranks.is_empty() {
                steps += self.advance(lanes, ranks, depth, observer, &mut ended);
                depth += 1;
            }
            if depth > self.max_steps {
                break;
            }
        }
        steps
    }

    /// One vertex and one step of all walks in `ranks`, which then holds those that go on; returns how many.
    #[inline]
    pub(super) fn advance<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        lanes: &mut [Lane<K::Point, K::Weight, S>],
        ranks: &mut Vec<u32>,
        depth: u64,
        observer: &mut O,
        ended: &mut impl FnMut(Outcome<G::Value>),
    ) -> u64 {
        let Driver { equation, scoring, .. } = *self;
        let survivors = close_ranks(lanes, ranks, |lane| {
            self.arrive(lane, observer);
            self.survives(lane, depth, observer)
        });
        let cut = self.ending.cut().is_some_and(|cut| depth >= cut);
        for rank in ranks.drain(survivors..) {
            let lane = &mut lanes[rank as usize];
            if !(lane.visit.survival >= 0.0) {
                // dying more often than always would be a silent bias: poison the score, the replay names the place
                observer.survival(&lane.visit.point, lane.visit.survival);
                lane.score = G::Value::from_components(|_| f64::NAN);
            }
            ended(lane.end(equation, scoring, if cut { End::Cut } else { End::Roulette }, observer));
        }
        if depth == self.max_steps {
            ranks.drain(..).for_each(|rank| ended(lanes[rank as usize].end(equation, scoring, End::TooLong, observer)));
            return 0;
        }
        let steppers = close_ranks(lanes, ranks, |Lane { visit, step, u, .. }| {
            u.seek(depth, Purpose::Move);
            *step = equation.kernel().step(&visit.point, u);
            if let Some(step) = step {
                observer.step(&visit.point, &step.point(), &step.weight(), step.raw_pdf());
            }
            step.is_some()
        });
        ranks.drain(steppers..).for_each(|rank| ended(lanes[rank as usize].end(equation, scoring, End::Absorbed, observer)));
        steppers as u64
    }

    /// At the start, or where the last step leads.
    #[inline]
    fn arrive<S: Sampler, O: Observer<K::Point, K::Weight>>(&self, lane: &mut Lane<K::Point, K::Weight, S>, observer: &mut O) {
        let Lane { visit, reciprocal, step, score, .. } = lane;
        let arrival = match step {
            None => Arrival::Start,
            Some(step) => {
                let arrival = Arrival::Step { from: visit.point, pdf: step.raw_pdf() * visit.survival };
                visit.weight = visit.weight.scaled(*reciprocal).then(step.weight());
                visit.point = step.point();
                arrival
            }
        };
        observer.vertex(&visit.point, &visit.weight);
        visit.survival = 1.0;
        self.scoring.arrival(self.equation, visit, arrival, score, observer);
    }

    /// Scores at the vertex, then whether the walk goes on.
    #[inline]
    fn survives<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        lane: &mut Lane<K::Point, K::Weight, S>,
        depth: u64,
        observer: &mut O,
    ) -> bool {
        let Lane { visit, reciprocal, score, u, .. } = lane;
        let survival = self.ending.survival(self.equation.kernel(), &visit.point, depth, visit.weight.norm());
        visit.survival = survival.probability();
        if self.ending.cut().is_none_or(|cut| depth < cut) {
            u.seek(depth, Purpose::Event);
            self.scoring.vertex(self.equation, visit, u, score, observer);
        }
        match survival {
            Survival::Certain => {
                *reciprocal = 1.0;
                true
            }
            Survival::Chance { probability, reciprocal: r } => {
                *reciprocal = r;
                u.seek(depth, Purpose::Survival);
                // a NaN probability must end the walk, not prolong it
                u.next_1d() < probability
            }
        }
    }
}

impl<X: Copy, W: Weight, S> Lane<X, W, S> {
    #[inline]
    fn end<G, K, C, O>(&mut self, equation: &Equation<G, K>, scoring: &C, end: End, observer: &mut O) -> Outcome<W::Value>
    where
        G: Source<Value = W::Value, Point = X>,
        K: Operator<Point = X, Weight = W>,
        C: Scoring<G, K>,
        O: Observer<X, W>,
    {
        scoring.end(equation, &self.visit, &mut self.score, observer);
        // a walk of weight 0 has nothing left to lose: no bias
        let truncated = end == End::Cut && self.visit.weight.norm() != 0.0;
        Outcome { walk: self.walk, score: self.score, end, truncated }
    }
}

/// Moves the ranks of the lanes that `go_on` to the front, in their order; returns how many.
#[inline]
fn close_ranks<T>(lanes: &mut [T], ranks: &mut [u32], mut go_on: impl FnMut(&mut T) -> bool) -> usize {
    let mut kept = 0;
    for i in 0..ranks.len() {
        let goes_on = go_on(&mut lanes[ranks[i] as usize]);
        // an unconditional swap, of numbers and not of lanes: no branch on what no predictor can guess, no copies of walks
        ranks.swap(kept, i);
        kept += usize::from(goes_on);
    }
    kept
}
