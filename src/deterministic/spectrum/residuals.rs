//! How far Tφ is from λφ.

use super::matrix::{Vector, apply_row, fields};
use super::pairs::Found;
use crate::deterministic::grid::Grid;
use crate::deterministic::near::components;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::parallel;
use crate::sampling::{Pcg, Sequence};
use nalgebra::Complex;

/// Places off the nodes where residuals are looked at.
const PROBES: u64 = 8;

type Residuals = (Vec<Vector>, Vec<Vec<Complex<f64>>>);

/// Tφ − λφ with T by a rule of other nodes: at the nodes of the solve, and at places beside them.
pub(super) fn residuals<K: Kernel + HasDomain>(kernel: &K, grid: &Grid<K::Point>, found: &[Found]) -> Result<Residuals, Error> {
    let (domain, c, m) = (kernel.domain(), components::<K>(), fields::<K>());
    let other = grid.independent(domain)?;
    // T by a rule times the functions, all fields of each at one place
    let image = |grid: &Grid<K::Point>, values: &[Vec<Complex<f64>>], x: &K::Point| -> Result<Vec<Complex<f64>>, Error> {
        let mut row = vec![0.0; c * c * grid.nodes.len()];
        grid.row(kernel, x, &mut row)?;
        let mut out = vec![Complex::from(0.0); m * values.len()];
        out.chunks_mut(m).zip(values).for_each(|(out, v)| apply_row::<K>(&row, v, out));
        Ok(out)
    };
    let solved: Vec<Vec<Complex<f64>>> = found.iter().map(|f| f.right.iter().copied().collect()).collect();
    let interpolated = |x: &K::Point| -> Result<Vec<Complex<f64>>, Error> {
        let image = image(grid, &solved, x)?;
        Ok(image.iter().enumerate().map(|(i, v)| v / found[i / m].value).collect())
    };
    let on_other = parallel::map(other.nodes.len(), |j| interpolated(&other.nodes[j].point));
    let on_other = on_other.into_iter().collect::<Result<Vec<_>, _>>()?;
    let functions: Vec<Vec<Complex<f64>>> =
        (0..found.len()).map(|k| on_other.iter().flat_map(|v| v[k * m..(k + 1) * m].iter().copied()).collect()).collect();
    let at_nodes = parallel::map(grid.nodes.len(), |i| image(&other, &functions, &grid.nodes[i].point));
    let at_nodes = at_nodes.into_iter().collect::<Result<Vec<_>, _>>()?;
    let residual = |k: usize| {
        let flat = at_nodes.iter().flat_map(|v| v[k * m..(k + 1) * m].iter().copied());
        let flat: Vec<_> = flat.zip(&solved[k]).map(|(t, v)| t - found[k].value * v).collect();
        Vector::from_vec(flat)
    };
    let mut at_probes = vec![Vec::new(); found.len()];
    for i in 0..PROBES {
        let x = domain.sample(&mut Pcg::default().point(u64::MAX - 6, 0, i)).point;
        let (image, phi) = (image(&other, &functions, &x)?, interpolated(&x)?);
        image.iter().zip(phi).enumerate().for_each(|(i, (t, v))| at_probes[i / m].push(t - found[i / m].value * v));
    }
    Ok(((0..found.len()).map(residual).collect(), at_probes))
}
