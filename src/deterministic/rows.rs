//! Rows of T on the nodes of a rule.

use super::ends;
use super::erased::erased;
use super::grid::{Grid, Panels, check_size};
use super::near::{Target, components};
use crate::domain::{Domain, Point};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};
use crate::parallel;
use crate::value::Weight;

/// Matrices up to this size are done before a thread is awake.
const SMALL: usize = 32;

/// Entries of a row at `count` nodes from `first` on, by the values of K there.
type Far<'a> = &'a dyn Fn(usize, usize, &mut [f64]) -> Result<(), Error>;

impl<X: Point> Grid<X> {
    /// Coordinates where the row at a target crosses lines in or near a panel.
    fn crossings<K: Kernel<Point = X> + HasDomain>(&self, target: &Target<'_, K>, (a, b): (f64, f64)) -> impl Iterator<Item = f64> {
        let t = target.place();
        self.lines.iter().filter_map(move |line| line.crossing(t)).filter(move |u| (a - u).max(u - b) < b - a)
    }

    /// Whether the row at a target is integrated piece by piece on panel `p`.
    pub(crate) fn is_product<K: Kernel<Point = X> + HasDomain>(&self, target: &Target<'_, K>, p: usize) -> bool {
        self.panels.as_ref().is_some_and(|panels| {
            let near = target.is_near(panels.panel(p)) || self.crossings(target, panels.panel(p)).next().is_some();
            near || self.ends.at(p, panels.count()).is_some()
        })
    }

    /// The row of T at x: `out[(a n + j) c + b]` is the weight of component b of f(y_j) in component a of (Tf)(x). Returns kernel evaluations.
    pub(crate) fn row<K>(&self, kernel: &K, x: &X, out: &mut [f64]) -> Result<u64, Error>
    where
        K: Kernel<Point = X> + HasDomain,
    {
        if let Some(order) = self.centred {
            return self.around(&erased(kernel), x, order, out);
        }
        let Some(panels) = &self.panels else {
            self.far(kernel, x, 0, self.nodes.len(), out)?;
            return Ok(self.nodes.len() as u64);
        };
        let x = &self.ends.held_off(kernel.domain(), x);
        let far = |first: usize, count: usize, out: &mut [f64]| self.far(kernel, x, first, count, out);
        self.row_in_panels(&erased(kernel), panels, x, &far, out)
    }

    /// The row at x, with `far` for the panels where K(x, ·) is smooth.
    fn row_in_panels<K>(&self, kernel: &K, panels: &Panels, x: &X, far: Far<'_>, out: &mut [f64]) -> Result<u64, Error>
    where
        K: Kernel<Point = X> + HasDomain,
    {
        let (c, n) = (components::<K>(), self.nodes.len());
        let target = Target::new(kernel, x);
        let p = panels.basis.len();
        let mut block = vec![0.0; p * c * c];
        let mut evaluations = 0;
        for index in 0..n / p {
            let (state, panel) = (index / panels.count(), panels.panel(index % panels.count()));
            if !self.is_product(&target, index % panels.count()) {
                far(index * p, p, out)?;
                evaluations += p as u64;
                continue;
            }
            block.fill(0.0);
            let rules = (&panels.basis, &panels.pieces);
            let mut towards: Vec<_> = self.crossings(&target, panel).map(|u| Target::towards(kernel, x, u)).collect();
            if !towards.is_empty() {
                towards.extend(Some(target).filter(|target| target.is_near(panel)));
                evaluations += ends::moments_among(towards, state, panel, rules, &mut block)?;
            } else {
                evaluations += match self.ends.at(index % panels.count(), panels.count()) {
                    Some(end) => ends::moments(&target, end, state, panel, rules, &mut block)?,
                    None => target.moments(state, panel, &panels.basis, &panels.pieces, &mut block)?,
                };
            }
            for (l, entries) in block.chunks_exact(c * c).enumerate() {
                entries.iter().enumerate().for_each(|(e, w)| out[((e / c) * n + index * p + l) * c + e % c] = *w);
            }
        }
        Ok(evaluations)
    }

    /// ∫ K(x, y) ℓ_j(y) dμ(y) by a rule around x.
    fn around<K>(&self, kernel: &K, x: &X, order: usize, out: &mut [f64]) -> Result<u64, Error>
    where
        K: Kernel<Point = X> + HasDomain,
    {
        let (domain, c, n) = (kernel.domain(), components::<K>(), self.nodes.len());
        out.fill(0.0);
        let rule = domain.around(x, order).unwrap_or_default();
        let mut weights = vec![0.0; self.stencil_width()];
        for y in &rule {
            let k = kernel.eval(x, &y.point);
            if !k.entries_finite() {
                return Err(Error::non_finite_kernel(x, &y.point, &k));
            }
            let Some(first) = self.stencil_into(domain, &y.point, &mut weights) else { continue };
            for e in 0..c * c {
                let k = y.weight * k.entry(e / c, e % c);
                let out = out[((e / c) * n + first) * c + e % c..].iter_mut().step_by(c);
                out.zip(&weights).for_each(|(o, w)| *o += k * w);
            }
        }
        Ok(rule.len() as u64)
    }

    fn far<K: Kernel<Point = X>>(&self, kernel: &K, x: &X, first: usize, count: usize, out: &mut [f64]) -> Result<(), Error> {
        let (c, n) = (components::<K>(), self.nodes.len());
        for (j, y) in self.nodes.iter().enumerate().skip(first).take(count) {
            let k = kernel.eval(x, &y.point);
            if !k.entries_finite() {
                return Err(Error::non_finite_kernel(x, &y.point, &k));
            }
            for e in 0..c * c {
                out[((e / c) * n + j) * c + e % c] = y.weight * k.entry(e / c, e % c);
            }
        }
        Ok(())
    }

    /// The matrix of T on the nodes, row by row, and the kernel evaluations it took.
    pub(crate) fn matrix<K>(&self, kernel: &K) -> Result<(Vec<f64>, u64), Error>
    where
        K: Kernel<Point = X> + HasDomain,
    {
        let c = components::<K>();
        let width = self.nodes.len() * c;
        check_size(width as f64)?;
        let mut matrix = vec![0.0; width * width];
        let row = |i: usize, row: &mut [f64]| self.row(kernel, &self.nodes[i].point, row);
        let evaluations = if width <= SMALL {
            matrix.chunks_mut(c * width).enumerate().map(|(i, values)| row(i, values)).sum::<Result<_, _>>()?
        } else {
            parallel::chunks(&mut matrix, c * width, row).into_iter().sum::<Result<_, _>>()?
        };
        Ok((matrix, evaluations))
    }
}
