//! Every sequence of the crate behind one type: walks are compiled once, not once a sequence.

use fredholm::sampling::{Halton, Hammersley, LatinHypercube, Pcg, Purpose, Sampler, Sequence, Sobol, Stratified, VanDerCorput};

macro_rules! any {
    ($($kind:ident),*) => {
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum Any {
            $($kind($kind)),*
        }

        #[derive(Clone, Debug)]
        pub(crate) enum AnySampler {
            $($kind(<$kind as Sequence>::Sampler)),*
        }

        impl Sampler for AnySampler {
            fn next_1d(&mut self) -> f64 {
                match self {
                    $(AnySampler::$kind(u) => u.next_1d()),*
                }
            }
            fn seek(&mut self, vertex: u64, purpose: Purpose) {
                match self {
                    $(AnySampler::$kind(u) => u.seek(vertex, purpose)),*
                }
            }
        }

        impl Sequence for Any {
            type Sampler = AnySampler;
            fn point(&self, cell: u64, replicate: u32, index: u64) -> AnySampler {
                match self {
                    $(Any::$kind(s) => AnySampler::$kind(s.point(cell, replicate, index))),*
                }
            }
            fn points(&self, cell: u64, replicate: u32, indices: std::ops::Range<u64>) -> impl Iterator<Item = AnySampler> {
                // through the sequence's own, which may share work
                let all: Vec<AnySampler> = match self {
                    $(Any::$kind(s) => s.points(cell, replicate, indices).map(AnySampler::$kind).collect()),*
                };
                all.into_iter()
            }
            fn fill(&self, cell: u64, replicate: u32, indices: std::ops::Range<u64>, out: &mut [f64]) {
                match self {
                    $(Any::$kind(s) => s.fill(cell, replicate, indices, out)),*
                }
            }
            fn with_seed(self, seed: u64) -> Self {
                match self {
                    $(Any::$kind(s) => Any::$kind(s.with_seed(seed))),*
                }
            }
            fn replicates(&self) -> Option<u32> {
                match self {
                    $(Any::$kind(s) => Sequence::replicates(s)),*
                }
            }
        }
    };
}

any!(Pcg, Sobol, Halton, Hammersley, VanDerCorput, LatinHypercube, Stratified);

/// All of them, randomised, for sets of n = m² points.
pub(crate) fn randomised(m: u64) -> Vec<(&'static str, Any)> {
    let n = m * m;
    vec![
        ("Sobol'", Any::Sobol(Sobol::new(0))),
        ("Halton", Any::Halton(Halton::new(0))),
        ("Hammersley", Any::Hammersley(Hammersley::new(n).unwrap())),
        ("van der Corput 2", Any::VanDerCorput(VanDerCorput::new(2).unwrap())),
        ("van der Corput 10", Any::VanDerCorput(VanDerCorput::new(10).unwrap())),
        ("Latin hypercube", Any::LatinHypercube(LatinHypercube::new(n).unwrap())),
        ("stratified", Any::Stratified(Stratified::new(m, 2).unwrap())),
    ]
}

#[allow(dead_code, reason = "each test directory uses its part")]
/// The first `d` coordinates of points 0 … n−1 of one randomisation.
pub(crate) fn points(sequence: Any, replicate: u32, n: u64, d: usize) -> Vec<Vec<f64>> {
    sequence.points(0, replicate, 0..n).map(|mut u| (0..d).map(|_| u.next_1d()).collect()).collect()
}
