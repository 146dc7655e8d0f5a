//! Deterministic solves: quadrature, Nyström, Galerkin finite elements, spectra, predicted variances.
//!
//! | | what | formula |
//! |---|---|---|
//! | [`Nystrom`] | f everywhere, by a quadrature rule | f(x) = g(x) + Σ w_j K(x, y_j) f_j |

mod adaptive;
mod basis;
mod grid;
mod linear;
mod near;
mod nystrom;
pub mod quadrature;
mod solution;

pub use nystrom::{Factorised, Nystrom};
pub use solution::NystromSolution;
