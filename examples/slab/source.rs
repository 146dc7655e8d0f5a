//! The three sources as one type: every estimator is compiled once.

use crate::options::SourceChoice;
use fredholm::Error;
use fredholm::domain::Node;
use fredholm::sampling::Sampler;
use fredholm::source::{Birth, Emit, SampleSource, Source};
use fredholm::transport::{BeamSource, Slab, UniformSource};

#[derive(Clone, Copy)]
pub(crate) enum AnySource {
    Uniform(UniformSource),
    /// S = x/a, sampled uniformly
    Ramp(UniformSource, f64),
    Beam(BeamSource),
}

impl AnySource {
    pub(crate) fn new(choice: SourceChoice, slab: &Slab) -> Self {
        match choice {
            SourceChoice::Uniform => AnySource::Uniform(slab.uniform(1.0)),
            SourceChoice::Ramp => AnySource::Ramp(slab.uniform(1.0), slab.thickness()),
            SourceChoice::Beam(cosine) => AnySource::Beam(slab.beam(cosine)),
        }
    }
}

impl Source for AnySource {
    type Point = f64;
    type Value = f64;
    fn eval(&self, x: &f64) -> f64 {
        match self {
            AnySource::Uniform(s) => s.eval(x),
            AnySource::Ramp(_, a) => x / a,
            AnySource::Beam(s) => s.eval(x),
        }
    }
    fn validate(&self) -> Result<(), Error> {
        match self {
            AnySource::Uniform(s) | AnySource::Ramp(s, _) => s.validate(),
            AnySource::Beam(s) => s.validate(),
        }
    }
}

impl SampleSource for AnySource {
    fn sample_for<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Node<f64>> {
        match self {
            AnySource::Uniform(s) | AnySource::Ramp(s, _) => s.sample_for(x, u),
            AnySource::Beam(s) => s.sample_for(x, u),
        }
    }
    fn pdf_for(&self, x: &f64, y: &f64) -> f64 {
        match self {
            AnySource::Uniform(s) | AnySource::Ramp(s, _) => s.pdf_for(x, y),
            AnySource::Beam(s) => s.pdf_for(x, y),
        }
    }
}

impl Emit for AnySource {
    type State = f64;
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<f64, f64> {
        match self {
            AnySource::Uniform(s) => s.emit(u),
            AnySource::Ramp(s, a) => {
                let born = s.emit(u);
                Birth { weight: born.weight * born.point / a, ..born }
            }
            AnySource::Beam(s) => s.emit(u),
        }
    }
}
