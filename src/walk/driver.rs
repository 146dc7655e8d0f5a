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

use super::ending::{Ending, Survival};
use super::observer::Observer;
use super::scoring::{Arrival, Scoring, Visit};
use crate::detector::Start;
use crate::equation::Equation;
use crate::kernel::{Operator, Transition};
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

/// Score, steps and end of one walk.
pub(super) struct Outcome<V> {
    pub(super) score: V,
    pub(super) steps: u64,
    pub(super) end: End,
}

#[inline]
pub(super) fn backward<G, K, C, E, S, O>(
    equation: &Equation<G, K>,
    scoring: &C,
    ending: &E,
    max_steps: u64,
    start: Start<K::Point>,
    u: &mut S,
    observer: &mut O,
) -> Outcome<G::Value>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    S: Sampler,
    O: Observer<K::Point, K::Weight>,
{
    let kernel = equation.kernel();
    let cut = ending.cut().unwrap_or(u64::MAX);
    let mut visit = Visit { point: start.point, weight: K::Weight::ONE.scaled(start.weight), survival: 1.0 };
    observer.vertex(&visit.point, &visit.weight);
    let mut score = G::Value::ZERO;
    scoring.arrival(equation, &visit, Arrival::Start, &mut score, observer);
    let mut depth = 0;
    let end = loop {
        let survival = ending.survival(kernel, &visit.point, depth, visit.weight.norm());
        visit.survival = survival.probability();
        if depth < cut {
            u.seek(depth, Purpose::Event);
            scoring.vertex(equation, &visit, u, &mut score, observer);
        }
        let mut weight = visit.weight;
        if let Survival::Chance { reciprocal, .. } = survival {
            u.seek(depth, Purpose::Survival);
            // `!(<)`: a NaN probability must end the walk, not prolong it
            if !(u.next_1d() < visit.survival) {
                if !(visit.survival >= 0.0) {
                    // dying more often than always would be a silent bias: poison the score, the replay names the place
                    observer.survival(&visit.point, visit.survival);
                    score = G::Value::from_components(|_| f64::NAN);
                }
                break if depth >= cut { End::Cut } else { End::Roulette };
            }
            weight = weight.scaled(reciprocal);
        }
        if depth == max_steps {
            break End::TooLong;
        }
        u.seek(depth, Purpose::Move);
        let Some(step) = kernel.step(&visit.point, u) else { break End::Absorbed };
        let (from, pdf) = (visit.point, step.raw_pdf());
        observer.step(&from, &step.point(), &step.weight(), pdf);
        let arrival = Arrival::Step { from, pdf: pdf * visit.survival };
        visit = Visit { point: step.point(), weight: weight.then(step.weight()), survival: 1.0 };
        depth += 1;
        observer.vertex(&visit.point, &visit.weight);
        scoring.arrival(equation, &visit, arrival, &mut score, observer);
    };
    scoring.end(equation, &visit, &mut score, observer);
    Outcome { score, steps: depth, end }
}
