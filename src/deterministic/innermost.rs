//! What lies closer to the centre than distances can be told apart.

use super::extrapolation::below;
use super::near::components;
use super::pieces::Pieces;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel};

/// Relative difference of the means over [s, 2s] and [2s, 4s] of what has a limit: a logarithm has more.
const FLAT: f64 = 0.01;
/// Error of what is extrapolated, as a share of ∫ K over the panel.
const EXTRAPOLATED: f64 = 2e-17;
/// Halvings of r at which K must be what the extrapolation takes it for, and how closely.
const BELOW: [i32; 4] = [2, 5, 9, 13];
const FORESEEN: f64 = 1e-5;

impl<K: Kernel + HasDomain> Pieces<'_, '_, K> {
    /// Distances from `nearest` to `farthest`, all below `s`: extrapolated from [s, 8s].
    pub(super) fn innermost(&mut self, sign: f64, nearest: f64, farthest: f64, s: f64) -> Result<(), Error> {
        let (a, b) = self.panel;
        let (c2, t) = (components::<K>().pow(2), self.target.t);
        // within 8s of the domain's end the other side must serve
        let reach = if self.target.reaches(sign, 8.0 * s) { sign } else { -sign };
        let count = if self.target.reaches(reach, 16.0 * s) && 16.0 * s < self.target.scale { 4 } else { 3 };
        let means = self.means(reach, s, count)?;
        let bounded = means.iter().all(|m| (m[1] - m[0]).abs() <= FLAT * m[0].abs());
        if reach != sign && bounded && self.by_one_value(sign, nearest, farthest)? {
            return Ok(());
        }
        for (e, means) in means.into_iter().enumerate() {
            let (whole, power) = below(&means).map_err(|ratio| self.not_integrable(ratio))?;
            let share = (farthest / s).powf(power) - (nearest / s).powf(power);
            // centre of the mass r^{power − 1} dr: a straight line is integrated exactly
            let centre = nearest + (farthest - nearest) * power / (1.0 + power);
            self.basis.values(((t + sign * centre - a) / (b - a)).clamp(0.0, 1.0), &mut self.values);
            self.values.iter().enumerate().for_each(|(l, v)| self.moments[l * c2 + e] += s * whole * share * v);
        }
        Ok(())
    }

    /// Distances from `nearest` to `farthest` by the value in the middle, if there is one: K has a limit, which may not be that of the other side.
    fn by_one_value(&mut self, sign: f64, nearest: f64, farthest: f64) -> Result<bool, Error> {
        let ((a, b), c2) = (self.panel, components::<K>().pow(2));
        let (middle, mut density) = (0.5 * (nearest + farthest), vec![0.0; c2]);
        if self.target.density(self.state, sign, middle, &mut density)?.is_none() {
            return Ok(false);
        }
        self.basis.values(((self.target.t + sign * middle - a) / (b - a)).clamp(0.0, 1.0), &mut self.values);
        for (out, l) in self.moments.chunks_exact_mut(c2).zip(&self.values) {
            out.iter_mut().zip(&density).for_each(|(o, k)| *o += (farthest - nearest) * l * k);
        }
        Ok(true)
    }

    fn not_integrable(&self, ratio: f64) -> Error {
        let x = format!("{:?}", self.target.x);
        match self.target.end {
            Some(_) => Error::NotIntegrableAtEnd { x, end: format!("{:?}", self.target.centre), ratio },
            None => Error::NotIntegrable { x, ratio },
        }
    }

    /// Whether ∫ K over distances below s may be extrapolated: from [2s, 16s] it must come out as from [s, 8s], up to a share of what there is of K on the
    /// panel, and K must go on as foreseen.
    pub(super) fn is_settled(&mut self, sign: f64, s: f64) -> Result<bool, Error> {
        if !self.target.reaches(sign, 16.0 * s) {
            return Ok(false);
        }
        let (c2, means) = (components::<K>().pow(2), self.means(sign, s, 4)?);
        // the integrals against P₀ come first
        for (means, panel) in means.into_iter().zip(&self.integrals) {
            let (Ok((inner, _)), Ok((outer, _))) = (below(&means[..3]), below(&means[1..])) else {
                return Ok(false);
            };
            if !(s * (2.0 * outer - inner - means[0]).abs() <= EXTRAPOLATED * panel.abs()) {
                return Ok(false);
            }
        }
        let mut values = vec![0.0; c2 * (3 + BELOW.len())];
        for (k, out) in [-2, -1, 0].into_iter().chain(BELOW).zip(values.chunks_exact_mut(c2)) {
            if self.target.density(self.state, sign, s * 0.5f64.powi(k), out)?.is_none() {
                return Ok(false);
            }
        }
        self.evaluations += (3 + BELOW.len()) as u64;
        Ok((0..c2).all(|e| {
            let k = |i: usize| values[i * c2 + e];
            let (step, size) = (k(2) - k(1), k(0).abs().max(k(2).abs()));
            let growth = if step.abs() > FORESEEN * FORESEEN * size { step / (k(1) - k(0)) } else { 0.5 };
            BELOW.iter().enumerate().all(|(i, halvings)| {
                let foreseen = k(2) + step * (1..=*halvings).map(|j| growth.powi(j)).sum::<f64>();
                (k(3 + i) - foreseen).abs() <= FORESEEN * foreseen.abs().max(size)
            })
        }))
    }
}
