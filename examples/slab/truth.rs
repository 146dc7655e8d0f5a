//! What the walks are compared with.

use crate::options::{Options, SourceChoice};
use crate::source::AnySource;
use fredholm::deterministic::quadrature::unit_rule;
use fredholm::deterministic::{Nystrom, NystromSolution};
use fredholm::source::Source;
use fredholm::special::e2;
use fredholm::transport::Slab;
use fredholm::{Equation, Error};
use std::time::{Duration, Instant};

/// φ for c = 0.9, a = 10, S = 1 at 0, a/10, a/4, a/2, to 18 digits: E₁ as a sum of 350–400 exponentials, for which the equation is solved exactly
/// in ball arithmetic (`tests/data/reference/slab-c0.9-a10-uniform.json`).
const STORED: [f64; 4] = [3.147_896_000_846_786, 6.321_120_372_334_265, 8.266_770_535_792_346, 9.135_261_726_293_376];

/// The Nyström solution, and the values that z-scores refer to.
pub(crate) struct Truth {
    pub(crate) values: Vec<f64>,
    pub(crate) stored: bool,
    pub(crate) nystrom: Vec<f64>,
    pub(crate) unknowns: usize,
    /// ‖(I − T)⁻¹‖ × largest residual at the points
    pub(crate) error: f64,
    pub(crate) elapsed: Duration,
    pub(crate) leakage: [f64; 2],
    pub(crate) profile: Box<dyn Fn(f64) -> f64>,
    source: Box<dyn Fn(f64) -> f64>,
    ratio: f64,
}

impl Truth {
    pub(crate) fn new(options: &Options, slab: &Slab, source: AnySource, xs: &[f64]) -> Result<Self, Error> {
        let clock = Instant::now();
        let panels = 4 + options.thickness.sqrt().ceil() as usize;
        let solution = Equation::new(source, slab.clone()).solve(&Nystrom::graded(panels, 12))?;
        let elapsed = clock.elapsed();
        let nystrom: Vec<f64> = xs.iter().map(|x| solution.eval(*x)).collect();
        let residuals = xs.iter().map(|x| solution.residual(*x).map(f64::abs)).collect::<Result<Vec<_>, _>>()?;
        let stored = options.ratio == 0.9 && options.thickness == 10.0 && options.source == SourceChoice::Uniform;
        Ok(Truth {
            values: if stored { STORED.to_vec() } else { nystrom.clone() },
            stored,
            nystrom,
            unknowns: solution.unknowns(),
            error: solution.inverse_norm() * residuals.into_iter().fold(0.0, f64::max),
            elapsed,
            leakage: leakage(&solution, options.thickness),
            profile: Box::new(move |x| solution.eval(x)),
            source: Box::new(move |x| source.eval(&x)),
            ratio: options.ratio,
        })
    }

    /// ∫ S dx: particles born for each unit of time.
    pub(crate) fn births(&self, a: f64) -> f64 {
        unit_rule(32).iter().map(|n| a * n.weight * (self.source)(a * n.point)).sum()
    }

    /// Mean of the scalar flux (φ − S)/c between two depths.
    pub(crate) fn mean_flux(&self, from: f64, to: f64) -> f64 {
        let flux = |x: f64| ((self.profile)(x) - (self.source)(x)) / self.ratio;
        unit_rule(8).iter().map(|n| n.weight * flux(from + (to - from) * n.point)).sum()
    }
}

/// ½ ∫ E₂(distance to the face) φ dx, for both faces.
fn leakage(solution: &NystromSolution<AnySource, Slab>, a: f64) -> [f64; 2] {
    [solution.functional(|x| 0.5 * e2(x.max(0.0))), solution.functional(|x| 0.5 * e2((a - x).max(0.0)))]
}
