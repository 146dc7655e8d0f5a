//! Eigenpairs, determinants and critical slabs against closed forms and published digits; adjoint functionals; the Fredholm alternative; linear
//! algebra beyond dense LU; complex equations; further domains; the core gate of problems §2.

#[path = "../common/erased.rs"]
mod erased;

mod adjoint;
mod alternative;
mod core_gate;
mod critical;
mod determinants;
mod domains;
mod linear;
mod pairs;
