//! Several scoring rules and endings as one type each: every walk is compiled once for a domain, not once for every combination.

use fredholm::kernel::Operator;
use fredholm::sampling::Sampler;
use fredholm::source::Source;
use fredholm::walk::{Absorption, Arrival, Collision, Ending, FixedDepth, Mis, NextEvent, Observer, Roulette, Scoring, Survival, Visit};
use fredholm::{Equation, Error};

/// What is scored.
#[derive(Clone, Copy, Debug)]
pub(crate) enum AnyScoring {
    Collision,
    Absorption,
    NextEvent,
    Mis(Mis),
}

macro_rules! by_rule {
    ($rule:ident.$method:ident($($argument:expr),*)) => {
        match $rule {
            AnyScoring::Collision => Collision.$method($($argument),*),
            AnyScoring::Absorption => Absorption.$method($($argument),*),
            AnyScoring::NextEvent => NextEvent.$method($($argument),*),
            AnyScoring::Mis(mis) => mis.$method($($argument),*),
        }
    };
}

impl AnyScoring {
    /// Kernel evaluations at every vertex: a trait's constant cannot tell them.
    pub(crate) fn evaluations(self) -> u64 {
        u64::from(matches!(self, AnyScoring::NextEvent | AnyScoring::Mis(_)))
    }
}

impl<G, K> Scoring<G, K> for AnyScoring
where
    G: Source,
    K: Operator<Point = G::Point>,
    Collision: Scoring<G, K>,
    Absorption: Scoring<G, K>,
    NextEvent: Scoring<G, K>,
    Mis: Scoring<G, K>,
{
    fn arrival<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        arrival: Arrival<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        by_rule!(self.arrival(equation, visit, arrival, score, observer));
    }

    fn vertex<S: Sampler, O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        u: &mut S,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        by_rule!(self.vertex(equation, visit, u, score, observer));
    }

    fn end<O: Observer<K::Point, K::Weight>>(
        &self,
        equation: &Equation<G, K>,
        visit: &Visit<K::Point, K::Weight>,
        score: &mut G::Value,
        observer: &mut O,
    ) {
        by_rule!(self.end(equation, visit, score, observer));
    }

    fn validate<E: Ending<K>>(&self, equation: &Equation<G, K>, ending: &E) -> Result<(), Error> {
        by_rule!(self.validate(equation, ending))
    }
}

/// When walks end.
#[derive(Clone, Copy, Debug)]
pub(crate) enum AnyEnding {
    Roulette(Roulette),
    FixedDepth(FixedDepth),
}

macro_rules! by_ending {
    ($ending:ident, $e:ident => $result:expr) => {
        match $ending {
            AnyEnding::Roulette($e) => $result,
            AnyEnding::FixedDepth($e) => $result,
        }
    };
}

impl<K: Operator> Ending<K> for AnyEnding {
    fn survival(&self, kernel: &K, x: &K::Point, depth: u64, throughput: f64) -> Survival {
        by_ending!(self, e => e.survival(kernel, x, depth, throughput))
    }
    fn cut(&self) -> Option<u64> {
        by_ending!(self, e => Ending::<K>::cut(e))
    }
    fn always_may_end(&self) -> bool {
        by_ending!(self, e => Ending::<K>::always_may_end(e))
    }
    fn ends(&self) -> bool {
        by_ending!(self, e => Ending::<K>::ends(e))
    }
    fn survival_at(&self, kernel: &K, x: &K::Point) -> Option<f64> {
        by_ending!(self, e => e.survival_at(kernel, x))
    }
    fn validate(&self) -> Result<(), Error> {
        by_ending!(self, e => Ending::<K>::validate(e))
    }
}
