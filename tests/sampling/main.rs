//! Sequences, distributions, discrepancy.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/erased.rs"]
mod erased;

mod any;
mod discrepancies;
mod distributions;
mod rates;
mod scrambling;
mod sequences;
mod walks;
