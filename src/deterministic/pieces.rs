//! One panel, cut into pieces towards y = x; the method is [`near`](super::near)'s.

use super::basis::Basis;
use super::near::{Target, components};
use super::split::SplitRule;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Singularity};
use crate::value::Weight;

/// Pieces smaller than this share of the panel are extrapolated.
const SMALLEST_PIECE: f64 = 1.0 / (1u64 << 44) as f64;
/// Halvings after which the rest of a side is tested for smoothness; each test costs three pieces.
const TESTED: [u32; 5] = [0, 2, 5, 11, 19];
/// Halvings after which pieces reach to a quarter: what is left of a panel is small enough for its polynomials to be of low degree, and a rule of 16
/// nodes integrates what is analytic but for y = x to 3^{−32} on r ∈ [ρ, 4ρ].
const WIDE_PIECES: u32 = 3;
/// Halvings after which the extrapolation may do: each test costs five pieces.
const SETTLED: [u32; 3] = [23, 29, 35];
/// Shares of a side at which its interpolant is compared with K, and how closely: extrapolation to x multiplies rounding by the square of the order.
const TOWARDS: [f64; 5] = [1.0 / 128.0, 1.0 / 4096.0, 1e-6, 1e-8, 1e-10];
const INTERPOLATED: f64 = 1e-11;
/// Relative difference of two rules up to which a side counts as smooth.
const SMOOTH: f64 = 4e-15;

pub(super) struct Pieces<'a, 'b, K: HasDomain> {
    pub(super) target: &'b Target<'a, K>,
    pub(super) state: usize,
    /// from the target's origin
    pub(super) panel: (f64, f64),
    pub(super) basis: &'b Basis,
    rule: &'b Basis,
    pub(super) values: Vec<f64>,
    /// ∫ K P_n over the pieces so far
    pub(super) integrals: Vec<f64>,
    /// P_{n−1}, P_n and the argument at the nodes of the piece
    recurrence: Vec<[f64; 3]>,
    /// of the piece at hand, node by node: K dμ/dt, distances from x, shifts in units of the piece, weights
    densities: Vec<f64>,
    distances: Vec<f64>,
    shifts: Vec<f64>,
    weights: Vec<f64>,
    /// ∫ K ℓ_k where it does not come from `integrals`
    pub(super) moments: Vec<f64>,
    pub(super) evaluations: u64,
}

impl<'a, 'b, K: Kernel + HasDomain> Pieces<'a, 'b, K> {
    pub(super) fn of(target: &'b Target<'a, K>, state: usize, panel: (f64, f64), basis: &'b Basis, rule: &'b Basis) -> Self {
        let c2 = components::<K>().pow(2);
        Pieces {
            target,
            state,
            panel,
            basis,
            rule,
            values: vec![0.0; basis.len()],
            integrals: vec![0.0; basis.len() * c2],
            recurrence: vec![[0.0; 3]; rule.len()],
            densities: vec![0.0; rule.len() * c2],
            distances: vec![0.0; rule.len()],
            shifts: vec![0.0; rule.len()],
            weights: vec![0.0; rule.len()],
            moments: vec![0.0; basis.len() * c2],
            evaluations: 0,
        }
    }

    /// Adds what was found to `out`; returns kernel evaluations.
    pub(super) fn finish(self, out: &mut [f64]) -> u64 {
        out.iter_mut().zip(&self.moments).for_each(|(o, m)| *o += m);
        self.basis.add_from_legendre(&self.integrals, components::<K>().pow(2), out);
        self.evaluations
    }

    /// One side of x: distances from `nearest` to `farthest`.
    pub(super) fn side(&mut self, sign: f64, nearest: f64, farthest: f64) -> Result<(), Error> {
        let smallest = self.target.resolved.max(SMALLEST_PIECE * (self.panel.1 - self.panel.0).min(self.target.scale));
        let stop = nearest.max(smallest);
        let mut outer = farthest;
        let mut halvings = 0;
        while outer > stop {
            // what is left of the panel is small enough for its polynomials to be of low degree
            if let (WIDE_PIECES, true, Some((singularity, stretch))) = (halvings, nearest < smallest, self.target.split) {
                return self.split_piece(sign, outer, singularity, stretch);
            }
            if SETTLED.contains(&halvings) && nearest < smallest && self.is_settled(sign, outer)? {
                return self.innermost(sign, nearest, outer, outer);
            }
            if nearest < smallest && outer > 64.0 * smallest && TESTED.contains(&halvings) && self.is_smooth(sign, outer)? {
                return self.add(sign, nearest, outer);
            }
            let levels = if halvings < WIDE_PIECES { 1 } else { 2 };
            let next = outer * 0.5f64.powi(levels as i32);
            // no sliver as the last piece
            let inner = if next <= 1.2 * stop { stop } else { next };
            self.add(sign, inner, outer)?;
            outer = inner;
            halvings += levels;
        }
        if nearest < smallest { self.innermost(sign, nearest, outer, smallest) } else { Ok(()) }
    }

    /// Distances from 0 to `outer` by the rule of a declared singularity.
    fn split_piece(&mut self, sign: f64, outer: f64, singularity: Singularity, stretch: f64) -> Result<(), Error> {
        let (target, (a, b), c) = (self.target, self.panel, components::<K>());
        let split = SplitRule::new(singularity, self.rule);
        for (k, n) in self.rule.rule().iter().enumerate() {
            let r = outer * n.point;
            let y = target.kernel.domain().displaced(target.x, self.state, sign * r);
            let Some(parts) = target.kernel.split(target.x, &y.point, -sign * r * stretch) else {
                return Err(Error::invalid("split", r, "must be declared everywhere or nowhere"));
            };
            for part in [parts.factor, parts.rest] {
                if !part.entries_finite() {
                    return Err(Error::non_finite_kernel(target.x, &y.point, &part));
                }
            }
            let singular = split.weight(self.rule, k, outer * stretch);
            self.basis.values((target.t + sign * r - a) / (b - a), &mut self.values);
            for (out, l) in self.moments.chunks_exact_mut(c * c).zip(&self.values) {
                let entry = |e: usize| singular * parts.factor.entry(e / c, e % c) + n.weight * parts.rest.entry(e / c, e % c);
                out.iter_mut().enumerate().for_each(|(e, o)| *o += outer * y.weight * l * entry(e));
            }
        }
        self.evaluations += self.rule.len() as u64;
        Ok(())
    }

    /// Evaluates K on the nodes of the piece at distances [inner, outer].
    fn visit(&mut self, sign: f64, inner: f64, outer: f64) -> Result<(), Error> {
        let c2 = components::<K>().pow(2);
        let h = outer - inner;
        for (k, n) in self.rule.rule().iter().enumerate() {
            let r = inner + h * n.point;
            let density = &mut self.densities[k * c2..(k + 1) * c2];
            let at = self.target.density(self.state, sign, r, density)?.unwrap_or(r);
            self.distances[k] = at;
            self.shifts[k] = (at - r) / h;
        }
        self.rule.shifted_weights(&self.shifts, &mut self.weights);
        self.evaluations += self.rule.len() as u64;
        Ok(())
    }

    /// Adds the piece at distances [inner, outer].
    pub(super) fn add(&mut self, sign: f64, inner: f64, outer: f64) -> Result<(), Error> {
        self.visit(sign, inner, outer)?;
        let (a, b) = self.panel;
        let (c2, t) = (components::<K>().pow(2), self.target.t);
        for ((p, r), (w, density)) in
            self.recurrence.iter_mut().zip(&self.distances).zip(self.weights.iter().zip(self.densities.chunks_exact_mut(c2)))
        {
            *p = [0.0, 1.0, 2.0 * ((t + sign * r - a) / (b - a)) - 1.0];
            density.iter_mut().for_each(|k| *k *= w * (outer - inner));
        }
        // node by node within a degree: nothing waits for the recurrence of another node
        for (n, out) in self.integrals.chunks_exact_mut(c2).enumerate() {
            let (up, down) = ((2 * n + 1) as f64 / (n + 1) as f64, n as f64 / (n + 1) as f64);
            for (p, density) in self.recurrence.iter_mut().zip(self.densities.chunks_exact(c2)) {
                let [before, now, x] = *p;
                out.iter_mut().zip(density).for_each(|(o, k)| *o += now * k);
                (p[0], p[1]) = (now, up * x * now - down * before);
            }
        }
        Ok(())
    }

    /// Whether one piece integrates K over distances [0, outer] as well as two do, and its interpolant is K on the way to x: of a peak on the diagonal
    /// that is narrower than the innermost nodes, no integral tells.
    fn is_smooth(&mut self, sign: f64, outer: f64) -> Result<bool, Error> {
        let whole = self.mass(sign, 0.0, outer)?;
        if !self.is_interpolated(sign, outer)? {
            return Ok(false);
        }
        let (inner, rest) = (self.mass(sign, 0.0, 0.5 * outer)?, self.mass(sign, 0.5 * outer, outer)?);
        let size = whole.iter().fold(0.0f64, |m, w| m.max(w.abs()));
        Ok(whole.iter().zip(inner.iter().zip(&rest)).all(|(w, (a, b))| (w - a - b).abs() <= SMOOTH * size))
    }

    /// Whether the interpolant of the piece [0, outer] just visited is K at distances far below its nodes.
    fn is_interpolated(&mut self, sign: f64, outer: f64) -> Result<bool, Error> {
        let c2 = components::<K>().pow(2);
        let size = self.densities.iter().fold(0.0f64, |m, k| m.max(k.abs()));
        let (mut values, mut here) = (vec![0.0; self.rule.len()], vec![0.0; c2]);
        for share in TOWARDS {
            let Some(r) = self.target.density(self.state, sign, share * outer, &mut here)? else { break };
            self.evaluations += 1;
            self.rule.values(r / outer, &mut values);
            for (e, k) in here.iter().enumerate() {
                let interpolated: f64 = values.iter().zip(self.densities.iter().skip(e).step_by(c2)).map(|(v, d)| v * d).sum();
                if !((k - interpolated).abs() <= INTERPOLATED * size) {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Means of K dμ/dt over `count` distances [s, 2s], [2s, 4s], …, entry by entry.
    pub(super) fn means(&mut self, sign: f64, s: f64, count: usize) -> Result<Vec<Vec<f64>>, Error> {
        let mut means = vec![Vec::with_capacity(count); components::<K>().pow(2)];
        let mut length = s;
        for _ in 0..count {
            let masses = self.mass(sign, length, 2.0 * length)?;
            means.iter_mut().zip(masses).for_each(|(means, mass)| means.push(mass / length));
            length *= 2.0;
        }
        Ok(means)
    }

    /// ∫ K dμ over distances [inner, outer], entry by entry.
    fn mass(&mut self, sign: f64, inner: f64, outer: f64) -> Result<Vec<f64>, Error> {
        self.visit(sign, inner, outer)?;
        let mut sum = vec![0.0; components::<K>().pow(2)];
        for (w, density) in self.weights.iter().zip(self.densities.chunks_exact(sum.len())) {
            sum.iter_mut().zip(density).for_each(|(s, k)| *s += w * (outer - inner) * k);
        }
        Ok(sum)
    }
}
