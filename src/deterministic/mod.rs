//! Deterministic solves: quadrature, Nyström, Galerkin and collocation finite elements, spectra, predicted variances.
//!
//! | | what | formula |
//! |---|---|---|
//! | [`Nystrom`] | f everywhere, by a quadrature rule | f(x) = g(x) + Σ w_j K(x, y_j) f_j |
//! | [`NystromSolution::corrected_functional`] | ∫ h f with doubled accuracy | ⟨h, f̃⟩ + ⟨ψ, g + T f̃ − f̃⟩ |
//! | [`Factorised`] | many sources for one kernel | (I − T)⁻¹ kept as L U |
//! | [`classify`] | what K looks like on the diagonal, in words | Δ_{k+1}/Δ_k along r = 2^{−k} |
//! | [`Galerkin`] | f among piecewise polynomials, and g + T f_h of twice the order | ⟨φ_i, f_h − T f_h⟩ = ⟨φ_i, g⟩ |
//! | [`Collocation`] | the same from fewer rows of T | f_h(x_i) − (T f_h)(x_i) = g(x_i) |
//! | [`eigenpairs`], [`eigenvalues`], [`spectral_radius`] | λ and φ with their errors; when Σ Tⁿ converges | λφ = Tφ |
//! | [`determinant`] | det(I − zT) | Π (1 − zλ_k) |
//! | [`Equation::predict`](crate::Equation::predict) | variance and cost of a walk before it starts | σ² = ν + (K²/π) σ² |

mod adaptive;
mod adjoint;
mod alternative;
mod axis;
mod basis;
mod class;
mod coarse;
mod collocation;
mod double_exponential;
mod elements;
mod ends;
mod erased;
mod extrapolation;
mod factorised;
mod fast;
mod galerkin;
mod grid;
mod independent;
mod innermost;
mod integrable;
mod jumps;
mod krylov;
pub(crate) mod linear;
mod lines;
mod low_rank;
mod lu;
mod mesh;
mod near;
mod nystrom;
mod one_step;
mod panels;
mod pieces;
pub mod quadrature;
mod refine;
mod residual;
mod rows;
mod scan;
mod seen;
mod side;
mod solution;
mod spectrum;
mod split;
mod stencil;
mod stored;
mod strategies;
mod toeplitz;
mod unseen;
mod variance;
mod verify;
mod words;

pub use adjoint::Functional;
pub use alternative::Alternative;
pub use class::{Diagonal, KernelClass, classify};
pub use collocation::Collocation;
pub use elements::{ElementErrors, ElementSolution};
pub(crate) use erased::erased;
pub use factorised::Factorised;
pub use galerkin::Galerkin;
pub use nystrom::Nystrom;
pub use one_step::Predictable;
pub use solution::NystromSolution;
pub use spectrum::{Determinant, Eigenpair, determinant, eigenpairs, eigenvalues, spectral_radius};
pub use strategies::PredictedStrategy;
pub use variance::{PredictedVariance, Prediction};
