//! Sequences, distributions, discrepancy.

#[path = "../common/mod.rs"]
mod common;

mod any;
mod discrepancies;
mod distributions;
mod rates;
mod scrambling;
mod sequences;
mod walks;
