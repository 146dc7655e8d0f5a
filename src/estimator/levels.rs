//! Convergent sequences of biased estimators.

use crate::contained::contained;
use crate::detector::Detector;
use crate::equation::{Equation, Query};
use crate::error::Error;
use crate::kernel::{Operator, Transition};
use crate::sampling::{Purpose, Sampler};
use crate::source::Source;
use crate::value::{Value, Weight};
use std::marker::PhantomData;
use std::ops::RangeInclusive;

/// A sequence of biased estimators Y₀, Y₁, … whose means converge to what is sought.
///
/// Laws: differences Δ_n = Y_n − Y_{n−1} (Y_{−1} = 0) are functions of the point alone; Σ_n E Δ_n is what is sought; Y_n and Y_{n−1} are *coupled*: computed
/// from the same randomness, so that E Δ_n² → 0.
pub trait Levels: Send + Sync {
    /// What is estimated.
    type Value: Value;

    /// Calls `each(n, Δ_n)` for the levels n given, in any order, all on the point `u`; a level left out counts as 0.
    fn differences<S: Sampler + Clone>(&self, levels: RangeInclusive<u64>, u: S, each: &mut impl FnMut(u64, Self::Value));

    /// Cost of these levels together, in any unit.
    fn cost(&self, levels: RangeInclusive<u64>) -> f64;
}

impl<T: Levels> Levels for &T {
    type Value = T::Value;
    fn differences<S: Sampler + Clone>(&self, levels: RangeInclusive<u64>, u: S, each: &mut impl FnMut(u64, T::Value)) {
        (**self).differences(levels, u, each);
    }
    fn cost(&self, levels: RangeInclusive<u64>) -> f64 {
        (**self).cost(levels)
    }
}

/// Levels given by a closure; see [`levels_fn`].
#[derive(Clone, Copy)]
pub struct LevelsFn<F, V> {
    difference: F,
    growth: f64,
    value: PhantomData<fn() -> V>,
}

impl<F, V> std::fmt::Debug for LevelsFn<F, V> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LevelsFn").field("growth", &self.growth).finish_non_exhaustive()
    }
}

/// Levels from `difference(n, u)` = Δ_n, each on a fresh cursor of the same point; the cost of level n is `growth`ⁿ.
pub fn levels_fn<V: Value, F>(growth: f64, difference: F) -> LevelsFn<F, V>
where
    F: Fn(u64, &mut dyn Sampler) -> V + Send + Sync,
{
    LevelsFn { difference, growth, value: PhantomData }
}

impl<V: Value, F: Fn(u64, &mut dyn Sampler) -> V + Send + Sync> Levels for LevelsFn<F, V> {
    type Value = V;
    fn differences<S: Sampler + Clone>(&self, levels: RangeInclusive<u64>, u: S, each: &mut impl FnMut(u64, V)) {
        levels.for_each(|n| each(n, (self.difference)(n, &mut u.clone())));
    }
    fn cost(&self, levels: RangeInclusive<u64>) -> f64 {
        levels.map(|n| self.growth.powf(n as f64)).sum()
    }
}

/// The walks of fixed depth n = 0, 1, … as levels: Δ_n = W_n g(X_n), the n-th term of the collision estimator (theory (4.2.3)); see [`Query::depths`].
#[derive(Debug)]
pub struct Depths<'a, G, K, D> {
    equation: &'a Equation<G, K>,
    detector: &'a D,
}

impl<'a, G, K, D> Query<'a, G, K, D>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
{
    /// Walks cut at depth 0, 1, … of the detector's first cell, to be [debiased](crate::estimator::Debias).
    ///
    /// # Errors
    /// Those of the equation's and the detector's own checks.
    pub fn depths(&self) -> Result<Depths<'_, G, K, D>, Error> {
        contained(|| {
            self.equation().validate()?;
            self.detector().validate()?;
            Ok(Depths { equation: self.equation(), detector: self.detector() })
        })
    }
}

impl<G, K, D> Levels for Depths<'_, G, K, D>
where
    G: Source,
    K: Transition + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    D: Detector<Point = G::Point>,
{
    type Value = G::Value;

    fn differences<S: Sampler + Clone>(&self, levels: RangeInclusive<u64>, mut u: S, each: &mut impl FnMut(u64, G::Value)) {
        u.seek(0, Purpose::Start);
        let start = self.detector.start(0, &mut u);
        let (mut x, mut w) = (start.point, K::Weight::ONE.scaled(start.weight));
        for n in 0..=*levels.end() {
            if n >= *levels.start() {
                each(n, w.apply(self.equation.source().eval(&x)));
            }
            u.seek(n, Purpose::Move);
            let Some(step) = self.equation.kernel().step(&x, &mut u) else { return };
            (x, w) = (step.point(), w.then(step.weight()));
        }
    }

    /// The last term costs as many steps as all of them.
    fn cost(&self, levels: RangeInclusive<u64>) -> f64 {
        *levels.end() as f64 + 1.0
    }
}
