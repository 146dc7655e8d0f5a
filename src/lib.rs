//! Fredholm integral equations of the second kind,
//!
//! ```text
//! f(x) = g(x) + ∫ K(x, y) f(y) dμ(y),          f = g + T f,
//! ```
//!
//! solved by random walks *and* by deterministic methods on one problem object, with errors that are true.
//!
//! An **equation** is a source and a kernel on a state space. A **detector** is what you want to know about f: a value, a grid, a functional
//! ⟨h, f⟩, a histogram. A **method** is how to find it: a random walk, a Nyström or a finite-element solve. A **sampler** is one point of the
//! unit cube. An **estimate** is a value with an honest error. The verb is `solve`.
//!
//! ```
//! use fredholm::{Equation, Method, Walk, deterministic::Nystrom, walk::Roulette};
//!
//! // f(x) = 1 + ∫₀¹ ½xy f(y) dy, whose solution is 1 + 3x/10
//! let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
//! let f = eq.at(0.5).solve(&Walk::collision().samples_per_cell(1 << 16).seed(7))?;   // prints like 1.14984(48)
//!
//! // the deterministic answer is a function; the two are compared, not believed
//! let exact = eq.solve(&Nystrom::gauss_legendre(32))?;
//! assert!(f.agrees_with(exact.eval(0.5), 4.0));
//!
//! // every estimator in a list: `Method` is object-safe at the outermost call and only there
//! for method in [&Walk::collision() as &dyn Method<_, _, _, Solution = _>, &Walk::next_event(), &Walk::mis()] {
//!     println!("{}", eq.at(0.5).solve(method)?);
//! }
//! # Ok::<(), fredholm::Error>(())
//! ```
//!
//! # Methods and what they need
//!
//! | method | needs of the kernel | needs of the source | unbiased | finite variance if |
//! |---|---|---|---|---|
//! | [`Walk::collision`] | [`Transition`](kernel::Transition) | [`Source`](source::Source) | yes | ρ(K²/π) < 1 |
//! | [`Walk::subcritical`] | [`RowMass`](kernel::RowMass) | `Source` | yes | weights near 1 |
//! | [`Walk::absorption`] | [`Absorbing`](kernel::Absorbing), or a constant roulette | `Source` | yes, if walks may end wherever g ≠ 0 | as collision |
//! | [`Walk::next_event`] | [`Kernel`](kernel::Kernel) | [`SampleSource`](source::SampleSource) | yes | and ∫K²g²/q < ∞ along the walk |
//! | [`Walk::mis`] | `Kernel`, [`TransitionPdf`](kernel::TransitionPdf) | `SampleSource` | yes | as the better of both |
//! | [`Walk::fixed_depth`] | `Transition` | `Source` | no: the bound is printed | always |
//! | [`Bidirectional`] | `Kernel`, `TransitionPdf`, [`HasAdjoint`](kernel::HasAdjoint) | [`EmitPdf`](source::EmitPdf) | yes | of one of its strategies where it matters |
//! | [`ArrayRqmc`](walk::ArrayRqmc) of any walk | and [`HasDomain`](kernel::HasDomain) | as the walk | yes | as the walk; falls faster than 1/n |
//! | [`Forward::new`] | [`HasAdjoint`](kernel::HasAdjoint) | [`Emit`](source::Emit) | yes | ρ(K²/π*) < 1 |
//! | [`Forward::next_event`] | `Kernel`, `HasAdjoint` | `Emit` | yes, at points too | and ∫K(η, ·)² < ∞ along the walk |
//! | [`Forward::profile`] by [tallies](walk::Tally) | as its tally | `Emit` | [says so](statistics::Bias) | as above |
//! | [`Nystrom`](deterministic::Nystrom), [`Galerkin`](deterministic::Galerkin), [`Collocation`](deterministic::Collocation) | `Kernel`, [`HasDomain`](kernel::HasDomain) | `Source` | deterministic | – |
//!
//! Several techniques share a point by average, maximum, balance or power weights ([`walk::Heuristic`]), or by optimal ones from a pilot ([`Query::optimal`],
//! [`Bidirectional::optimal`]); [`Equation::predict`] says what variance they will have.
//!
//! Plain integrals ∫f dμ, on which walks stand, are [`Integral`]s with the same verb and the same [`Estimate`]: [`integral`] has importance sampling,
//! strata, combined sampling, control functions. [`Study`](statistics::Study) measures bias, variance and coverage of any estimator.
//!
//! Unbiased walks are functions on the unit cube ([`estimator`]): several of one quantity are combined with weights of least variance, Metropolis' rule drives
//! one through the cube for many cells at once, randomised truncation makes a convergent sequence unbiased.
//!
//! A kernel that can only be evaluated gets its walk from a [proposal](kernel::Proposal): uniform, tabulated ∝ |K(x, ·)|, or your own; and its adjoint walk,
//! from the source to every cell of a detector at once, for nothing. [`Forward::profile`] finds the whole of f with a band that holds for all points.
//!
//! # Guarantees
//!
//! - *Honest errors.* Intervals are Student's; skewness, the variance of the variance and the tail index give a [verdict](Estimate::verdict) in
//!   words. Bias has a name in the API and a bound or a count in the result; nothing is clamped, dropped or regularised silently.
//! - *Refusals with numbers.* A Neumann series of |T| that diverges is refused before the first walk; NaN and infinities are named with their place.
//! - *Same bits.* Same binary and seed give the same bits for any number of threads, with the feature `parallel` on or off, interrupted and
//!   resumed or not. No clock, entropy or globals: the default seed is 0.
//!
//! # Features (all on by default; none changes a number)
//!
//! `parallel` (rayon), `plot` (plotters), `formula` (equations as JSON text), `scene` (geometry and light), `serde` (checkpoints).
//!
//! # Reading order
//!
//! `value` → [`integral`] → [`kernel`] → `walk/scoring/collision.rs` → `walk/driver.rs` → [`deterministic`] → [`transport`]: about 700 lines to the whole idea.
//! `scene/light_transport.rs` then shows that a path tracer is one more kernel.
//! «theory (4.2.1)» in comments numbers the formulas; each file that uses one states it.

pub mod check;
mod complex;
mod contained;
pub mod detector;
pub mod deterministic;
pub mod domain;
mod equation;
mod error;
pub mod estimator;
#[cfg(feature = "formula")]
pub mod formula;
pub mod integral;
pub mod kernel;
#[cfg(any(feature = "plot", feature = "scene"))]
mod output;
mod parallel;
#[cfg(feature = "plot")]
pub mod plot;
pub mod sampling;
#[cfg(feature = "scene")]
pub mod scene;
pub mod source;
pub mod special;
pub mod statistics;
pub mod transport;
mod value;
pub mod walk;

pub use equation::{ClosureEquation, Equation, Everywhere, IntervalEquation, Method, Query};
pub use error::Error;
pub use integral::Integral;
pub use nalgebra::Complex;
pub use statistics::Estimate;
pub use value::{GroupMatrix, Spectrum, Value, Weight};
pub use walk::{Bidirectional, Forward, Walk};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
