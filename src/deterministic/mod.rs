//! Deterministic solves: quadrature, Nyström, Galerkin finite elements, spectra, predicted variances.
//!
//! | | what | formula |
//! |---|---|---|
//! | [`Nystrom`] | f everywhere, by a quadrature rule | f(x) = g(x) + Σ w_j K(x, y_j) f_j |
//! | [`Factorised`] | many sources for one kernel | (I − T)⁻¹ kept as L U |
//! | [`Galerkin`] | f in the space of hat functions | ⟨φ_i, f_h − T f_h⟩ = ⟨φ_i, g⟩ |
//! | [`classify`] | what K looks like on the diagonal, in words | Δ_{k+1}/Δ_k along r = 2^{−k} |
//! | [`eigenvalues`], [`spectral_radius`] | when Σ Tⁿ converges | det(λ − T_n) = 0 |
//! | [`Equation::predict`](crate::Equation::predict) | variance and cost of a walk before it starts | σ² = ν + (K²/π) σ² |

mod adaptive;
mod basis;
mod class;
mod galerkin;
mod grid;
// for systems larger than elimination can afford
#[cfg_attr(not(test), expect(dead_code))]
mod krylov;
mod linear;
mod lu;
mod near;
mod nystrom;
pub mod quadrature;
mod solution;
mod spectrum;
mod variance;
mod verify;

pub use class::{Diagonal, KernelClass, classify};
pub use galerkin::{Galerkin, GalerkinSolution};
pub use nystrom::{Factorised, Nystrom};
pub use solution::NystromSolution;
pub use spectrum::{eigenvalues, spectral_radius};
pub use variance::{PredictedVariance, Prediction};
