//! The one walk of the crate. It does not know which equation, detector or estimator it drives, nor in which direction.
//!
//! ```text
//! X₀ from the detector, W₀ = h/p₀                    backward; forward: Z₀ from the source, W₀ = g/q₀
//! loop   score arrival at X_n                        collision, MIS
//!        P = survival probability of X_n
//!        score at X_n                                next event: before the survival test, theory (2.2.4)
//!        die with probability 1 − P                  absorption scores here
//!        X_{n+1} from the kernel's step, W_{n+1} = W_n (K/π)/P               forward: from the adjoint's, W_{n+1} = (K/π*) W_n/P
//! ```
//!
//! What a walk carries and scores is its [`Errand`]. Walks go in lockstep, some hundred abreast, and the survivors close ranks after every test. What
//! one walk does depends on its own point of the sequence alone; going abreast hides latencies and mispredicted roulette
//! (`cargo bench --bench walk_step`).

use super::ending::{Ending, Survival};
use super::observer::Observer;
use super::scoring::{Arrival, Visit};
use crate::kernel::{Operator, Step, Transition};
use crate::sampling::{Purpose, Sampler};

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

/// What walks along a kernel carry, and what they score on the way.
pub(super) trait Errand<K: Operator> {
    /// A matrix W_n backward, a value W_n forward.
    type Load: Copy;
    /// What a walk has scored, where it keeps that itself.
    type Score: Copy;
    /// At the start.
    const NOTHING: Self::Score;

    /// The load after a step of weight `step` = K/π, survived with probability 1/`reciprocal`.
    fn carry(load: &Self::Load, reciprocal: f64, step: K::Weight) -> Self::Load;

    /// |W_n|, for roulette.
    fn magnitude(load: &Self::Load) -> f64;

    /// Whether the load is a number; a walk that has lost it must not pass for one that scores nothing.
    fn is_sound(load: &Self::Load) -> bool;

    /// Scores on arrival at a vertex.
    fn arrival<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &mut self,
        at: At<'_, K::Point, Self::Load, S>,
        arrival: Arrival<K::Point, Self::Load>,
        score: &mut Self::Score,
        observer: &mut O,
    );

    /// Scores at a vertex that is not cut, before the survival test.
    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &mut self,
        at: At<'_, K::Point, Self::Load, S>,
        score: &mut Self::Score,
        observer: &mut O,
    );

    /// Scores where the walk ended.
    fn end<O: Observer<K::Point, K::Weight>>(
        &mut self,
        walk: usize,
        visit: &Visit<K::Point, Self::Load>,
        score: &mut Self::Score,
        observer: &mut O,
    );

    /// Makes the score of a walk NaN.
    fn poison(&mut self, walk: usize, score: &mut Self::Score);
}

/// A walk at a vertex.
pub(super) struct At<'a, X, L, S> {
    /// Its number in the front.
    pub(super) walk: usize,
    pub(super) depth: u64,
    pub(super) visit: &'a Visit<X, L>,
    pub(super) u: &'a mut S,
}

/// One walk on its way.
pub(super) struct Lane<K: Operator, A: Errand<K>, S> {
    walk: usize,
    visit: Visit<K::Point, A::Load>,
    /// 1/P of the test just survived
    reciprocal: f64,
    /// the step just made, towards the next vertex
    step: Option<Step<K::Point, K::Weight>>,
    score: A::Score,
    u: S,
}

impl<K: Operator, A: Errand<K>, S> Lane<K, A, S> {
    /// Walk number `walk` of its front.
    #[inline]
    pub(super) fn new(walk: usize, point: K::Point, load: A::Load, u: S) -> Self {
        let visit = Visit { point, weight: load, survival: 1.0 };
        Lane { walk, visit, reciprocal: 1.0, step: None, score: A::NOTHING, u }
    }

    /// Where the walk is, and its |W|, or will be when its step is done.
    #[inline]
    pub(super) fn destination(&self) -> (K::Point, f64) {
        match &self.step {
            Some(step) => (step.point(), A::magnitude(&A::carry(&self.visit.weight, self.reciprocal, step.weight()))),
            None => (self.visit.point, A::magnitude(&self.visit.weight)),
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

    #[inline]
    fn end<O: Observer<K::Point, K::Weight>>(&mut self, errand: &mut A, end: End, observer: &mut O) -> Outcome<A::Score> {
        errand.end(self.walk, &self.visit, &mut self.score, observer);
        // dying more often than always, or of a load that is lost, would be a silent bias: the replay names the place
        if !(self.visit.survival >= 0.0 && A::is_sound(&self.visit.weight)) {
            errand.poison(self.walk, &mut self.score);
        }
        // a walk of weight 0 has nothing left to lose: no bias
        let truncated = end == End::Cut && A::magnitude(&self.visit.weight) != 0.0;
        Outcome { walk: self.walk, score: self.score, end, truncated }
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

/// How walks go, and how long.
pub(super) struct Driver<'a, K, E> {
    pub(super) kernel: &'a K,
    pub(super) ending: &'a E,
    pub(super) max_steps: u64,
}

/// Steps abreast. Few walks are that long, and one without an end must be found after `max_steps`, not after as many for every walk beside it.
const ABREAST: u64 = 1 << 14;

impl<K: Transition, E: Ending<K>> Driver<'_, K, E> {
    /// Walks all `lanes` to their ends, in no particular order, or to the first that is too long; returns the steps of all together. `ranks` is scratch
    /// space.
    #[inline]
    pub(super) fn walk<A: Errand<K>, S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        errand: &mut A,
        lanes: &mut [Lane<K, A, S>],
        ranks: &mut Vec<u32>,
        observer: &mut O,
        mut ended: impl FnMut(Outcome<A::Score>),
    ) -> u64 {
        ranks.clear();
        ranks.extend(0..lanes.len() as u32);
        let mut steps = 0;
        for depth in 0..ABREAST {
            steps += self.advance(errand, lanes, ranks, depth, observer, &mut ended);
            if ranks.is_empty() {
                return steps;
            }
        }
        for rank in std::mem::take(ranks) {
            ranks.push(rank);
            let mut depth = ABREAST;
            while !ranks.is_empty() {
                steps += self.advance(errand, lanes, ranks, depth, observer, &mut ended);
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
    pub(super) fn advance<A: Errand<K>, S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        errand: &mut A,
        lanes: &mut [Lane<K, A, S>],
        ranks: &mut Vec<u32>,
        depth: u64,
        observer: &mut O,
        ended: &mut impl FnMut(Outcome<A::Score>),
    ) -> u64 {
        let survivors = close_ranks(lanes, ranks, |lane| {
            arrive(errand, lane, depth, observer);
            self.survives(errand, lane, depth, observer)
        });
        let cut = self.ending.cut().is_some_and(|cut| depth >= cut);
        for rank in ranks.drain(survivors..) {
            let lane = &mut lanes[rank as usize];
            if !(lane.visit.survival >= 0.0) {
                observer.survival(&lane.visit.point, lane.visit.survival);
            }
            ended(lane.end(errand, if cut { End::Cut } else { End::Roulette }, observer));
        }
        if depth == self.max_steps {
            ranks.drain(..).for_each(|rank| ended(lanes[rank as usize].end(errand, End::TooLong, observer)));
            return 0;
        }
        let steppers = close_ranks(lanes, ranks, |Lane { visit, step, u, .. }| {
            u.seek(depth, Purpose::Move);
            *step = self.kernel.step(&visit.point, u);
            if let Some(step) = step {
                observer.step(&visit.point, &step.point(), &step.weight(), step.raw_pdf());
            }
            step.is_some()
        });
        ranks.drain(steppers..).for_each(|rank| ended(lanes[rank as usize].end(errand, End::Absorbed, observer)));
        steppers as u64
    }

    /// Scores at the vertex, then whether the walk goes on.
    #[inline]
    fn survives<A: Errand<K>, S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        errand: &mut A,
        lane: &mut Lane<K, A, S>,
        depth: u64,
        observer: &mut O,
    ) -> bool {
        let Lane { walk, visit, reciprocal, score, u, .. } = lane;
        let survival = self.ending.survival(self.kernel, &visit.point, depth, A::magnitude(&visit.weight));
        visit.survival = survival.probability();
        if self.ending.cut().is_none_or(|cut| depth < cut) {
            u.seek(depth, Purpose::Event);
            errand.vertex(At { walk: *walk, depth, visit, u }, score, observer);
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

/// At the start, or where the last step leads.
#[inline]
fn arrive<K: Operator, A: Errand<K>, S: Sampler, O: Observer<K::Point, K::Weight>>(
    errand: &mut A,
    lane: &mut Lane<K, A, S>,
    depth: u64,
    observer: &mut O,
) {
    let Lane { walk, visit, reciprocal, step, score, u } = lane;
    let arrival = match step {
        None => Arrival::Start,
        Some(step) => {
            let arrival = Arrival::Step { from: visit.point, carried: visit.weight, pdf: step.raw_pdf() * visit.survival };
            visit.weight = A::carry(&visit.weight, *reciprocal, step.weight());
            visit.point = step.point();
            arrival
        }
    };
    visit.survival = 1.0;
    errand.arrival(At { walk: *walk, depth, visit, u }, arrival, score, observer);
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
