//! Every estimator, under a common roof.

use crate::truth::Truth;
use fredholm::detector::Points;
use fredholm::kernel::{Operator, Proposed, Series, Tabulated, Uniform};
use fredholm::source::{SampleSource, Source};
use fredholm::transport::Slab;
use fredholm::walk::{Heuristic, OwnAbsorption, Roulette};
use fredholm::{Equation, Error, Estimate, Method, Walk, domain::Interval};

/// A method by name: points and walks a point in, estimates out.
pub struct Entry<'a> {
    pub name: String,
    #[allow(clippy::type_complexity)]
    pub solve: Box<dyn Fn(&[f64], u64) -> Result<Vec<Estimate>, Error> + 'a>,
}

fn entry<'a, G, K, C, E>(name: &str, equation: &Equation<G, K>, walk: Walk<C, E>) -> Entry<'a>
where
    G: Source<Point = f64, Value = f64> + Clone + 'a,
    K: Operator<Point = f64, Weight = f64> + Clone + 'a,
    C: Copy + 'a,
    E: Copy + 'a,
    Walk<C, E>: Method<G, K, Points<f64>, Solution = Vec<Estimate>>,
{
    let equation = equation.clone();
    Entry { name: name.to_string(), solve: Box::new(move |xs, samples| equation.on(xs).solve(&walk.samples_per_cell(samples))) }
}

/// The smallest depth that leaves ρ^depth ≤ 10⁻⁵.
fn sufficient_depth(slab: &Slab) -> Result<u64, Error> {
    let Series::Known(series) = slab.series()? else { return Ok(100) };
    Ok(((1e-5f64).ln() / series.radius().value.min(0.999).ln()).ceil() as u64)
}

pub fn all<'a, G>(slab: &'a Slab, source: &G, seed: u64) -> Result<Vec<Entry<'a>>, Error>
where
    G: SampleSource<Point = f64, Value = f64> + Clone + 'a,
{
    let analog = Equation::new(source.clone(), slab);
    let implicit = Equation::new(source.clone(), slab.implicit_capture());
    let domain = Interval::from(0.0..=slab.thickness());
    let uniform = Equation::new(source.clone(), Proposed::new(slab, Uniform::on(domain)));
    let tabulated = Equation::new(source.clone(), Proposed::new(slab, Tabulated::new(slab, 64)?));
    let depth = sufficient_depth(slab)?;
    let collision = Walk::new(fredholm::walk::Collision, OwnAbsorption).seed(seed);
    let quiet = Roulette::throughput(0.25);
    Ok(vec![
        entry("collision, analog", &analog, collision),
        entry("collision, roulette 0.9", &analog, Walk::collision().roulette(Roulette::constant(0.9)).seed(seed)),
        entry(&format!("collision, fixed depth {depth}"), &analog, Walk::fixed_depth(depth).seed(seed)),
        entry("absorption, analog", &analog, Walk::absorption().seed(seed)),
        entry("next event, analog", &analog, Walk::next_event().seed(seed)),
        entry("MIS balance, analog", &analog, Walk::mis().seed(seed)),
        entry("MIS power 2, analog", &analog, Walk::mis().heuristic(Heuristic::Power(2.0)).seed(seed)),
        entry("MIS maximum, analog", &analog, Walk::mis().heuristic(Heuristic::Maximum).seed(seed)),
        entry("MIS average, analog", &analog, Walk::mis().heuristic(Heuristic::Average).seed(seed)),
        entry("implicit capture, P = |W|", &implicit, Walk::collision().seed(seed)),
        entry("implicit capture, P = 4|W|", &implicit, Walk::collision().roulette(quiet).seed(seed)),
        entry("implicit capture, MIS", &implicit, Walk::mis().roulette(quiet).seed(seed)),
        entry("subcritical, tabulated", &tabulated, Walk::subcritical().seed(seed)),
        entry("uniform proposal, MIS", &uniform, Walk::mis().seed(seed)),
    ])
}

/// Walks a point for about a quarter of a second a method: a walk makes as many steps as the equation says, φ/S on average, whatever the clock.
pub fn affordable(slab: &Slab, truth: &Truth) -> u64 {
    let collisions = truth.mean_flux(0.0, slab.thickness()) * slab.thickness() / truth.births(slab.thickness());
    ((1u64 << 19) / (1 + collisions as u64)).next_power_of_two().clamp(1 << 9, 1 << 17)
}
