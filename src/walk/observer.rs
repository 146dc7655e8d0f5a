//! Replaying a walk vertex by vertex: for teaching, and to find the place of a NaN.

use super::driver::End;
use crate::error::Error;
use crate::value::{Value, Weight};
use std::fmt::Debug;

/// Looks over a walk's shoulder. The walks that count use `()`, which compiles to nothing.
pub trait Observer<X, W: Weight> {
    /// A vertex was reached with weight `w`.
    #[inline]
    fn vertex(&mut self, x: &X, w: &W) {
        let _ = (x, w);
    }
    /// A vertex of a forward walk was reached with the value `v`.
    #[inline]
    fn value(&mut self, z: &X, v: &W::Value) {
        let _ = (z, v);
    }
    /// A forward walk at z scored in a cell of the detector.
    #[inline]
    fn tally(&mut self, z: &X, cell: usize, score: &W::Value) {
        let _ = (z, cell, score);
    }
    /// A forward walk at z is about to score in a cell of the detector, which may refuse such scores.
    #[inline]
    fn refused(&mut self, z: &X, cell: usize, why: impl FnOnce() -> Option<&'static str>) {
        let _ = (z, cell, why);
    }
    /// A step from x to y goes along a Dirac part of the kernel, which a scoring rule cannot account for.
    #[inline]
    fn singular(&mut self, x: &X, y: &X, needed_by: &'static str) {
        let _ = (x, y, needed_by);
    }
    /// g(x) was evaluated.
    #[inline]
    fn source(&mut self, x: &X, g: &W::Value) {
        let _ = (x, g);
    }
    /// K(x, y) was evaluated outside a step.
    #[inline]
    fn kernel(&mut self, x: &X, y: &X, k: &W) {
        let _ = (x, y, k);
    }
    /// A step from x to y was made.
    #[inline]
    fn step(&mut self, x: &X, y: &X, weight: &W, pdf: f64) {
        let _ = (x, y, weight, pdf);
    }
    /// A scoring rule needs the density of the step from x to y, which the step does not state.
    #[inline]
    fn unstated(&mut self, x: &X, y: &X, needed_by: &'static str) {
        let _ = (x, y, needed_by);
    }
    /// The walk was asked to survive at x with a probability that is none.
    #[inline]
    fn survival(&mut self, x: &X, probability: f64) {
        let _ = (x, probability);
    }
    /// Something was scored.
    #[inline]
    fn score(&mut self, value: &W::Value) {
        let _ = value;
    }
}

impl<X, W: Weight> Observer<X, W> for () {}

/// One vertex of a traced walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedVertex<X, W: Weight> {
    /// X_n.
    pub point: X,
    /// W_n.
    pub weight: W,
    /// What the walk scored here, all rules together.
    pub score: W::Value,
}

/// A walk, vertex by vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace<X, W: Weight> {
    /// X₀, X₁, ….
    pub vertices: Vec<TracedVertex<X, W>>,
    /// Total score.
    pub score: W::Value,
    /// How it ended.
    pub end: End,
}

/// Collects a trace and the first fault.
pub(super) struct Recorder<X, W: Weight> {
    pub(super) vertices: Vec<TracedVertex<X, W>>,
    pub(super) fault: Option<Error>,
    pub(super) cell: usize,
    pub(super) walk: u64,
}

impl<X: Copy + Debug, W: Weight> Recorder<X, W> {
    fn blame(&mut self, error: impl FnOnce() -> Error) {
        if self.fault.is_none() {
            self.fault = Some(error());
        }
    }
}

impl<X: Copy + Debug, W: Weight> Observer<X, W> for Recorder<X, W> {
    fn vertex(&mut self, x: &X, w: &W) {
        let (cell, walk, vertex) = (self.cell, self.walk, self.vertices.len() as u64);
        if !w.entries_finite() && vertex == 0 {
            self.blame(|| Error::NonFiniteStart { cell, walk, at: format!("{x:?}"), weight: format!("{w:?}") });
        } else if !w.entries_finite() {
            self.blame(|| Error::Overflow { cell, walk, vertex, at: format!("{x:?}"), weight: format!("{w:?}") });
        }
        self.vertices.push(TracedVertex { point: *x, weight: *w, score: W::Value::ZERO });
    }
    fn source(&mut self, x: &X, g: &W::Value) {
        if !g.all_finite() {
            self.blame(|| Error::non_finite_source(x, g));
        }
    }
    fn kernel(&mut self, x: &X, y: &X, k: &W) {
        if !k.entries_finite() {
            self.blame(|| Error::non_finite_kernel(x, y, k));
        }
    }
    fn step(&mut self, x: &X, y: &X, weight: &W, pdf: f64) {
        let (cell, walk) = (self.cell, self.walk);
        if !weight.entries_finite() {
            self.blame(|| Error::NonFiniteWeight {
                x: format!("{x:?}"),
                y: format!("{y:?}"),
                weight: format!("{weight:?}"),
                density: pdf,
                cell,
                walk,
            });
        }
    }
    fn unstated(&mut self, x: &X, y: &X, needed_by: &'static str) {
        self.blame(|| Error::UnstatedDensity { x: format!("{x:?}"), y: format!("{y:?}"), needed_by });
    }
    fn survival(&mut self, x: &X, probability: f64) {
        self.blame(|| Error::InvalidProbability { at: format!("{x:?}"), value: probability });
    }
    fn score(&mut self, value: &W::Value) {
        if let Some(v) = self.vertices.last_mut() {
            v.score += *value;
        }
    }
}
