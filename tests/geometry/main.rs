//! Geometry: the tree finds what trying everything finds, nothing leaks, nothing hits itself, and bad input has a name.
#![cfg(feature = "scene")]

mod bad_input;
mod found;
mod leaks;
mod random;
mod self_hits;
