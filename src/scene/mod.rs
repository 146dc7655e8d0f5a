//! Scenes: light in a room as one concrete equation.
//!
//! [`geometry`] answers what a ray meets.

pub mod geometry;
pub(crate) mod vector;
