//! Replaying a forward walk vertex by vertex.

use crate::error::Error;
use crate::value::{Value, Weight};
use crate::walk::{End, Observer};
use std::fmt::Debug;
use std::marker::PhantomData;

/// A forward walk, vertex by vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct ForwardTrace<Z, V> {
    /// Z₀, Z₁, … and the values W₀, W₁, … carried there.
    pub vertices: Vec<(Z, V)>,
    /// Cells and what was added there, in order.
    pub scores: Vec<(usize, V)>,
    /// How it ended.
    pub end: End,
}

/// Collects a trace and the first fault.
pub(super) struct Recorder<Z, W: Weight> {
    pub(super) vertices: Vec<(Z, W::Value)>,
    pub(super) scores: Vec<(usize, W::Value)>,
    pub(super) fault: Option<Error>,
    walk: u64,
    weight: PhantomData<W>,
}

impl<Z: Copy + Debug, W: Weight> Recorder<Z, W> {
    pub(super) fn new(walk: u64) -> Self {
        Recorder { vertices: Vec::new(), scores: Vec::new(), fault: None, walk, weight: PhantomData }
    }

    fn blame(&mut self, wrong: bool, error: impl FnOnce() -> Error) {
        if wrong && self.fault.is_none() {
            self.fault = Some(error());
        }
    }

    /// The fault, or what is left: a sum that overflows.
    pub(super) fn cause(self, cell: usize) -> Error {
        let (vertex, walk) = (self.vertices.len() as u64 - 1, self.walk);
        let (at, value) = self.vertices.last().expect("a walk has a start");
        let overflow = Error::Overflow { cell, walk, vertex, at: format!("{at:?}"), weight: format!("{value:?}") };
        self.fault.unwrap_or(overflow)
    }
}

impl<Z: Copy + Debug, W: Weight> Observer<Z, W> for Recorder<Z, W> {
    fn value(&mut self, z: &Z, v: &W::Value) {
        let (walk, vertex, finite) = (self.walk, self.vertices.len() as u64, v.all_finite());
        let (at, weight) = (|| format!("{z:?}"), || format!("{v:?}"));
        self.blame(!finite && vertex == 0, || Error::NonFiniteBirth { walk, at: at(), weight: weight() });
        self.blame(!finite, || Error::Overflow { cell: 0, walk, vertex, at: at(), weight: weight() });
        self.vertices.push((*z, *v));
    }
    fn refused(&mut self, z: &Z, cell: usize, why: impl FnOnce() -> Option<&'static str>) {
        if let Some(why) = why() {
            self.blame(true, || Error::NotScored { cell, at: format!("{z:?}"), why });
        }
    }
    fn tally(&mut self, z: &Z, cell: usize, score: &W::Value) {
        self.blame(!score.all_finite(), || Error::NonFiniteDetector { cell, at: format!("{z:?}"), value: format!("{score:?}") });
        self.scores.push((cell, *score));
    }
    fn singular(&mut self, x: &Z, y: &Z, needed_by: &'static str) {
        self.blame(true, || Error::SingularStep { x: format!("{x:?}"), y: format!("{y:?}"), needed_by });
    }
    fn source(&mut self, x: &Z, g: &W::Value) {
        self.blame(!g.all_finite(), || Error::non_finite_source(x, g));
    }
    fn kernel(&mut self, x: &Z, y: &Z, k: &W) {
        self.blame(!k.entries_finite(), || Error::non_finite_kernel(x, y, k));
    }
    fn step(&mut self, x: &Z, y: &Z, weight: &W, pdf: f64) {
        let (cell, walk) = (0, self.walk);
        self.blame(!weight.entries_finite(), || Error::NonFiniteWeight {
            x: format!("{x:?}"),
            y: format!("{y:?}"),
            weight: format!("{weight:?}"),
            density: pdf,
            cell,
            walk,
        });
    }
    fn unstated(&mut self, x: &Z, y: &Z, needed_by: &'static str) {
        self.blame(true, || Error::UnstatedDensity { x: format!("{x:?}"), y: format!("{y:?}"), needed_by });
    }
    fn survival(&mut self, x: &Z, probability: f64) {
        self.blame(true, || Error::InvalidProbability { at: format!("{x:?}"), value: probability });
    }
}
