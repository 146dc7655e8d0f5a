//! Every estimator, under a common roof.

use crate::source::AnySource;
use crate::truth::Truth;
use fredholm::detector::Points;
use fredholm::kernel::{Operator, Series};
use fredholm::transport::Slab;
use fredholm::walk::{Heuristic, OwnAbsorption, Roulette};
use fredholm::{Equation, Error, Estimate, Method, Walk};

/// A method by name: points and walks a point in, estimates out.
pub(crate) struct Entry<'a> {
    pub(crate) name: String,
    #[allow(clippy::type_complexity)]
    pub(crate) solve: Box<dyn Fn(&[f64], u64) -> Result<Vec<Estimate>, Error> + 'a>,
}

fn entry<'a, K, C, E>(name: &str, equation: &Equation<AnySource, K>, walk: Walk<C, E>) -> Entry<'a>
where
    K: Operator<Point = f64, Weight = f64> + Clone + 'a,
    C: Copy + 'a,
    E: Copy + 'a,
    Walk<C, E>: Method<AnySource, K, Points<f64>, Solution = Vec<Estimate>>,
{
    let equation = equation.clone();
    Entry { name: name.to_string(), solve: Box::new(move |xs, samples| equation.on(xs).solve(&walk.samples_per_cell(samples))) }
}

/// ρ of |T|, known before any walk; 1 if it cannot be told.
fn radius(slab: &Slab) -> Result<f64, Error> {
    Ok(match slab.series()? {
        Series::Known(series) => series.radius().value,
        Series::Unknown => 1.0,
    })
}

pub(crate) fn all(slab: &Slab, source: AnySource, seed: u64) -> Result<Vec<Entry<'_>>, Error> {
    let analog = Equation::new(source, slab);
    let implicit = Equation::new(source, slab.implicit_capture());
    let radius = radius(slab)?;
    // the smallest depth that leaves ρ^depth ≤ 10⁻⁵
    let depth = ((1e-5f64).ln() / radius.min(0.999).ln()).ceil() as u64;
    // a survival below ρ would make the variance infinite
    let survival = (50.0 * (1.0 + radius.min(1.0))).round() / 100.0;
    let quiet = Roulette::throughput(0.25);
    // every method draws its own numbers
    let seed = |i: u64| seed.wrapping_mul(100).wrapping_add(i);
    let mis = |h, i| Walk::mis().heuristic(h).seed(seed(i));
    Ok(vec![
        entry("collision, analog*", &analog, Walk::collision().ending(OwnAbsorption).seed(seed(0))),
        entry(&format!("collision, roulette {survival}"), &analog, Walk::collision().roulette(Roulette::constant(survival)).seed(seed(1))),
        entry(&format!("collision, fixed depth {depth}"), &analog, Walk::fixed_depth(depth).seed(seed(2))),
        entry("absorption, analog", &analog, Walk::absorption().seed(seed(3))),
        entry("next event, analog", &analog, Walk::next_event().seed(seed(4))),
        entry("MIS balance, analog", &analog, mis(Heuristic::Balance, 5)),
        entry("MIS power 2, analog", &analog, mis(Heuristic::Power(2.0), 6)),
        entry("MIS maximum, analog", &analog, mis(Heuristic::Maximum, 7)),
        entry("MIS average, analog", &analog, mis(Heuristic::Average, 8)),
        entry("implicit capture, P = |W|", &implicit, Walk::collision().seed(seed(9))),
        entry("implicit capture, P = 4|W|", &implicit, Walk::collision().roulette(quiet).seed(seed(10))),
        entry("implicit capture, MIS", &implicit, Walk::mis().roulette(quiet).seed(seed(11))),
    ])
}

/// Walks a point for about a quarter of a second a method: a walk makes as many steps as the equation says, φ/S on average, whatever the clock.
pub(crate) fn affordable(slab: &Slab, truth: &Truth) -> u64 {
    let collisions = truth.mean_flux(0.0, slab.thickness()) * slab.thickness() / truth.births(slab.thickness());
    ((1u64 << 19) / (1 + collisions as u64)).next_power_of_two().clamp(1 << 9, 1 << 17)
}
