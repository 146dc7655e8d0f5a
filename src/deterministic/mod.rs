//! Deterministic solves: quadrature, Nyström, Galerkin finite elements, spectra.

pub mod quadrature;
