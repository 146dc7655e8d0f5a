//! Point sets, measured: discrepancies of the same sizes and errors on the same integrands as other programs, root mean squares over randomisations.

use fredholm::Error;
use fredholm::sampling::{Halton, LatinHypercube, PointSet, Sequence, Sobol};

/// Prints name, dimension, points, and one number: the root mean square of `measure` over randomisations.
fn row(name: &str, dimension: usize, points: u64, what: &str, sets: &[PointSet], measure: impl Fn(&PointSet) -> f64) {
    let square = sets.iter().map(|set| measure(set).powi(2)).sum::<f64>() / sets.len() as f64;
    println!("qmc,fredholm {name},{dimension},{points},{what},{:.4e}", square.sqrt());
}

/// ∏ (1 + (x_j − ½)/j²), of mean 1: smooth.
fn product(x: &[f64]) -> f64 {
    (1..).zip(x).map(|(j, x)| 1.0 + (x - 0.5) / f64::from(j * j)).product::<f64>() - 1.0
}

/// The indicator of Σ x_j < d/2, less its mean: a jump.
fn corner(x: &[f64]) -> f64 {
    f64::from(x.iter().sum::<f64>() < 0.5 * x.len() as f64) - 0.5
}

fn measure<Q: Sequence>(name: &str, randomisations: u64, sequence: impl Fn(u64) -> Result<Q, Error>) -> Result<(), Error> {
    for (dimension, points) in [(2, 256), (2, 1024), (2, 4096), (4, 1024), (8, 1024), (8, 4096)] {
        let draw = |seed| PointSet::draw(&sequence(points)?.with_seed(seed), dimension, points);
        let sets = (0..randomisations).map(draw).collect::<Result<Vec<_>, _>>()?;
        row(name, dimension, points, "centred L2", &sets, PointSet::centred_l2);
        row(name, dimension, points, "L2 star", &sets, PointSet::l2_star);
        let error = |f: fn(&[f64]) -> f64| move |set: &PointSet| set.iter().map(f).sum::<f64>() / points as f64;
        row(name, dimension, points, "error of a product", &sets, error(product));
        row(name, dimension, points, "error of a corner", &sets, error(corner));
    }
    Ok(())
}

pub(crate) fn qmc(randomisations: u64) -> Result<(), Error> {
    measure("Sobol", randomisations, |_| Ok(Sobol::new(0)))?;
    measure("Halton", randomisations, |_| Ok(Halton::new(0)))?;
    measure("Latin hypercube", randomisations, LatinHypercube::new)
}
