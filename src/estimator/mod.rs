//! What can be done with any unbiased estimator: combine several of one quantity, debias a convergent sequence, walk through the cube by Metropolis' rule.
//!
//! An [`Estimator`] is a function on the unit cube: `score(cell, u)` reads what it needs of the point u and has the mean that is sought. Walks are ones
//! ([`Query::estimator`](crate::Query::estimator)), closures too ([`estimator_fn`]).
//!
//! | method | formula | wins when |
//! |---|---|---|
//! | [`Combination`] | Σ a_k Y_k, a = S⁻¹1/(1ᵀS⁻¹1), theory (4.15.1) | no estimator is best everywhere, or errors are correlated |
//! | [`Debias`] | Σ_{n ≤ N} Δ_n/P(N ≥ n), theory (4.12.1) | Y_n → Y without bias in the limit, and only there |
//! | [`Metropolis`] | (b/n) Σ F_j/C along a chain ∝ C, theory (4.13.2) | few points of the cube carry most of *many* cells; never for one number |

mod combination;
mod covariance;
mod debias;
mod levels;
mod metropolis;
mod run;

pub use combination::{Combination, Combined, Coupling};
pub use debias::{Debias, Debiased, Form, Level, Survivors};
pub use levels::{Depths, Levels, LevelsFn, levels_fn};
pub use metropolis::{Chains, LargeSteps, Metropolis, OneCell, Tally};

pub(crate) use covariance::coefficients;
pub(crate) use metropolis::choose;
pub(crate) use run::{estimate, score_block};

use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Value;
use std::marker::PhantomData;

/// What one point of the cube scored, and what that cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score<V> {
    /// The score; not finite if something went wrong, see [`Estimator::explain`].
    pub value: V,
    /// Steps of walks.
    pub steps: u64,
    /// Evaluations of the kernel (a step counts as one), or of the integrand.
    pub evaluations: u64,
}

/// An unbiased estimator of every cell of a detector, as a function on the unit cube.
///
/// Laws: over uniform points `E[score(cell, u).value]` is the cell's value; a score depends on the cell and on what was read from `u`, on nothing else.
///
/// ```
/// use fredholm::{Equation, Walk, estimator::Estimator, sampling::{Pcg, Sequence}};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let query = eq.at(0.5);
/// let walk = query.estimator(&Walk::collision())?;
/// let score = walk.score(0, &mut Pcg::new(7).point(0, 0, 3), &mut Default::default());
/// assert_eq!(score.value, Walk::collision().seed(7).trace(&eq, query.detector(), 0, 3)?.score);
/// # Ok::<(), fredholm::Error>(())
/// ```
pub trait Estimator: Send + Sync {
    /// What is estimated.
    type Value: Value;
    /// Memory reused from score to score; what is left in it never matters.
    type Scratch: Default;

    /// Number of cells.
    fn cells(&self) -> usize;

    /// The score of one point for cell `cell`.
    fn score<S: Sampler>(&self, cell: usize, u: &mut S, scratch: &mut Self::Scratch) -> Score<Self::Value>;

    /// Why the score of a point is not finite, from a fresh cursor on that point, number `walk` of its sequence.
    fn explain<S: Sampler>(&self, cell: usize, walk: u64, u: &mut S) -> Option<Error> {
        let _ = (cell, walk, u);
        None
    }
}

impl<T: Estimator> Estimator for &T {
    type Value = T::Value;
    type Scratch = T::Scratch;
    fn cells(&self) -> usize {
        (**self).cells()
    }
    #[inline]
    fn score<S: Sampler>(&self, cell: usize, u: &mut S, scratch: &mut T::Scratch) -> Score<T::Value> {
        (**self).score(cell, u, scratch)
    }
    fn explain<S: Sampler>(&self, cell: usize, walk: u64, u: &mut S) -> Option<Error> {
        (**self).explain(cell, walk, u)
    }
}

/// An estimator given by a closure; see [`estimator_fn`].
#[derive(Clone, Copy)]
pub struct EstimatorFn<F, V> {
    cells: usize,
    function: F,
    value: PhantomData<fn() -> V>,
}

impl<F, V> std::fmt::Debug for EstimatorFn<F, V> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EstimatorFn").field("cells", &self.cells).finish_non_exhaustive()
    }
}

/// The estimator `score(cell, u)` of `cells` cells; a score counts as one evaluation.
///
/// ```
/// use fredholm::estimator::{Combination, estimator_fn};
/// // ∫₀¹ eˣ dx from u and from 1 − u: each alone has variance 0.242, the best combination of both 0.0039
/// let here = estimator_fn(1, |_, u| u.next_1d().exp());
/// let there = estimator_fn(1, |_, u| (1.0 - u.next_1d()).exp());
/// let both = &Combination::new().with(here).with(there).solve()?[0];
/// assert!(both.estimate.agrees_with(1f64.exp() - 1.0, 5.0) && both.estimate.variance().unwrap() < 0.005);
/// # Ok::<(), fredholm::Error>(())
/// ```
pub fn estimator_fn<V: Value, F>(cells: usize, score: F) -> EstimatorFn<F, V>
where
    F: Fn(usize, &mut dyn Sampler) -> V + Send + Sync,
{
    EstimatorFn { cells, function: score, value: PhantomData }
}

impl<V: Value, F: Fn(usize, &mut dyn Sampler) -> V + Send + Sync> Estimator for EstimatorFn<F, V> {
    type Value = V;
    type Scratch = ();
    fn cells(&self) -> usize {
        self.cells
    }
    #[inline]
    fn score<S: Sampler>(&self, cell: usize, mut u: &mut S, _: &mut ()) -> Score<V> {
        Score { value: (self.function)(cell, &mut u), steps: 0, evaluations: 1 }
    }
}
