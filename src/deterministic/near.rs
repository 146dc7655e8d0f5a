//! Product integration towards the diagonal: ∫ K(x, y) ℓ_k(y) dμ(y) over one panel for a target x in or near it.
//!
//! The panel is cut at y = x, and each side into pieces r ∈ [ρ, 2ρ] or [ρ, 4ρ] of the distance r = |t_y − t_x|, on which a kernel with a kink, a jump, a
//! logarithm or an algebraic singularity at r = 0 (or a peak of any width) is analytic in a fixed ellipse: the same Gauss rule converges
//! geometrically on every piece (problems §4, algorithm 2). K is never evaluated at y = x nor outside the domain.
//!
//! Where the rest of a side proves smooth, one piece takes it all: kinks and jumps cost hardly more than smooth kernels.
//!
//! A point of floating-point numbers lies up to half an ulp off the node it stands for, and a singularity feels where it is: nodes are taken at the
//! distances they have, with weights for those (first order; [`Basis::shifted_weights`]). Below a distance s that keeps 16 bits of y − x, the integral is
//! extrapolated from the means m_k of K over [2ᵏs, 2ᵏ⁺¹s]. With δ = (m₂ − m₁)/(m₁ − m₀),
//!
//! ```text
//! ∫₀^s K = s (m₀ − 2 (m₁ − m₀)/(2δ − 1))        exact for A + B r^β (δ = 2^β) and for A + B ln r (δ = 1)
//! ∫₀^s K = s m₀ ρ/(1 − ρ),   ρ = m₀/(2 m₁)      exact for B r^β alone; used for strong singularities. ρ → 1: not integrable
//! ```

use super::basis::Basis;
use super::split::SplitRule;
use crate::domain::Domain;
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Singularity};
use crate::value::{Value, Weight};

/// Components of the values that a kernel acts on.
pub(crate) fn components<K: Kernel>() -> usize {
    <<K::Weight as Weight>::Value as Value>::COMPONENTS
}

/// The end of the domain, 0 or 1, from which coordinates near t keep their digits. Infinity is no end to count from.
pub(crate) fn nearer_end<D: Domain>(domain: &D, t: f64) -> f64 {
    if t > 0.5 && domain.volume().is_finite() { 1.0 } else { 0.0 }
}

/// A point x at which rows of the operator are wanted, with what its place in the map implies.
#[derive(Debug)]
pub(crate) struct Target<'a, K: HasDomain> {
    kernel: &'a K,
    x: &'a K::Point,
    /// the end of the domain, 0 or 1, that coordinates are counted from: the nearer one, so that they keep their digits
    origin: f64,
    /// coordinate of x
    t: f64,
    /// smallest distance at which y − x keeps 16 bits
    resolved: f64,
    /// a declared singularity, and |x − y| for a unit of distance
    split: Option<(Singularity, f64)>,
}

/// Relative precision of distances: 16 bits. What the weights do not correct is its square.
const DISTANCE_BITS: f64 = 1.0 / 65_536.0;
/// Pieces smaller than this share of the panel are extrapolated.
const SMALLEST_PIECE: f64 = 1.0 / (1u64 << 44) as f64;
/// No coordinate needs finer distances: far out on a half line, 2^{−80} is a millionth of x at x = 10⁹.
const FINEST: f64 = 1.0 / (1u128 << 80) as f64;
/// S₁/S₂ from which on a singularity r^{−α} counts as not integrable: α > 0.978.
const NOT_INTEGRABLE: f64 = 0.985;
/// Ratios this close speak of one power of r.
const SAME_POWER: f64 = 0.02;
/// Halvings after which the rest of a side is tested for smoothness; each test costs three pieces.
const TESTED: [u32; 5] = [0, 2, 5, 11, 19];
/// Halvings after which pieces reach to a quarter: what is left of a panel is small enough for its polynomials to be of low degree, and a rule of 16
/// nodes integrates what is analytic but for y = x to 3^{−32} on r ∈ [ρ, 4ρ].
const WIDE_PIECES: u32 = 3;
/// Halvings after which the extrapolation may do: each test costs five pieces.
const SETTLED: [u32; 3] = [23, 29, 35];
/// Error of what is extrapolated, as a share of ∫ K over the panel.
const EXTRAPOLATED: f64 = 2e-17;
/// Halvings of r at which K must be what the extrapolation takes it for, and how closely.
const BELOW: [i32; 4] = [2, 5, 9, 13];
const FORESEEN: f64 = 1e-5;
/// Shares of a side at which its interpolant is compared with K, and how closely: extrapolation to x multiplies rounding by the square of the order.
const TOWARDS: [f64; 5] = [1.0 / 128.0, 1.0 / 4096.0, 1e-6, 1e-8, 1e-10];
const INTERPOLATED: f64 = 1e-11;
/// Relative difference of two rules up to which a side counts as smooth.
const SMOOTH: f64 = 4e-15;

impl<'a, K: Kernel + HasDomain> Target<'a, K> {
    pub(crate) fn new(kernel: &'a K, x: &'a K::Point) -> Self {
        let domain = kernel.domain();
        let state = domain.state(x);
        let t = domain.coordinate(x, 0);
        let origin = nearer_end(domain, t);
        let t = if origin == 1.0 { domain.separation(&domain.place(state, || 1.0).point, x) } else { t };
        let inside = |t: f64| (-origin..=1.0 - origin).contains(&t);
        let kept = |d: f64| {
            let apart = |y: &K::Point| domain.separation(x, y);
            !inside(t + d) || (apart(&domain.displaced(x, state, d).point) - d).abs() <= DISTANCE_BITS * d.abs()
        };
        let mut resolved = 0.125;
        let exact = |d: f64| domain.difference(x, d).is_some_and(|apart| kernel.eval_at_difference(x, x, apart).is_some());
        let kept = |d: f64| kept(d) || exact(d);
        // factors without a short binary expansion: an accidentally exact sum must not pass
        while resolved > FINEST && [0.685, -0.685, 0.597, -0.597].iter().all(|f| kept(f * resolved)) {
            resolved *= 0.5;
        }
        let split = domain.stretch().and_then(|stretch| Some((kernel.split(x, x, stretch)?.singularity, stretch)));
        Target { kernel, x, origin, t, resolved: 2.0 * resolved, split }
    }

    /// A panel in coordinates from the origin: exact where they are close.
    fn relative(&self, (a, b): (f64, f64)) -> (f64, f64) {
        (a - self.origin, b - self.origin)
    }

    /// Whether the domain reaches to distance r on a side of x.
    fn reaches(&self, sign: f64, r: f64) -> bool {
        (-self.origin..=1.0 - self.origin).contains(&(self.t + sign * r))
    }

    /// Whether the panel [a, b] needs product integration: its distance to x is less than its length.
    pub(crate) fn is_near(&self, panel: (f64, f64)) -> bool {
        let (a, b) = self.relative(panel);
        (a - self.t).max(self.t - b) < b - a
    }

    /// Adds ∫ K(x, y) ℓ_k(y) dμ(y) over the panel to `out[(k c + row) c + column]`; `rule` integrates a piece. Returns kernel evaluations.
    pub(crate) fn moments(&self, state: usize, panel: (f64, f64), basis: &Basis, rule: &Basis, out: &mut [f64]) -> Result<u64, Error> {
        let (near, (a, b)) = (self.is_near(panel), self.relative(panel));
        let mut pieces = Pieces {
            target: self,
            state,
            panel: (a, b),
            basis,
            rule,
            values: vec![0.0; basis.len()],
            integrals: vec![0.0; basis.len() * components::<K>().pow(2)],
            recurrence: vec![[0.0; 3]; rule.len()],
            densities: vec![0.0; rule.len() * components::<K>().pow(2)],
            distances: vec![0.0; rule.len()],
            shifts: vec![0.0; rule.len()],
            weights: vec![0.0; rule.len()],
            out,
            evaluations: 0,
        };
        if !near {
            let side = if a > self.t { 1.0 } else { -1.0 };
            pieces.add(side, (a - self.t).max(self.t - b), (b - self.t).max(self.t - a))?;
        } else {
            if a < self.t {
                pieces.side(-1.0, (self.t - b).max(0.0), self.t - a)?;
            }
            if b > self.t {
                pieces.side(1.0, (a - self.t).max(0.0), b - self.t)?;
            }
        }
        basis.add_from_legendre(&pieces.integrals, components::<K>().pow(2), pieces.out);
        Ok(pieces.evaluations)
    }

    /// K(x, y) dμ/dt at the point y nearest to distance r on the side `sign`, entry by entry, and the distance that y has; zero where y cannot be told
    /// from x.
    fn density(&self, state: usize, sign: f64, r: f64, out: &mut [f64]) -> Result<Option<f64>, Error> {
        let domain = self.kernel.domain();
        let y = domain.displaced(self.x, state, sign * r);
        let exact = domain.difference(self.x, sign * r).and_then(|apart| self.kernel.eval_at_difference(self.x, &y.point, apart));
        let distance = if exact.is_some() { r } else { sign * domain.separation(self.x, &y.point) };
        if !(distance > 0.0) {
            out.fill(0.0);
            return Ok(None);
        }
        let k = exact.unwrap_or_else(|| self.kernel.eval(self.x, &y.point));
        if !k.entries_finite() {
            return Err(Error::non_finite_kernel(self.x, &y.point, &k));
        }
        let c = components::<K>();
        out.iter_mut().enumerate().for_each(|(e, o)| *o = k.entry(e / c, e % c) * y.weight);
        Ok(Some(distance))
    }
}

struct Pieces<'a, 'b, K: HasDomain> {
    target: &'b Target<'a, K>,
    state: usize,
    /// from the target's origin
    panel: (f64, f64),
    basis: &'b Basis,
    rule: &'b Basis,
    values: Vec<f64>,
    /// ∫ K P_n over the pieces so far
    integrals: Vec<f64>,
    /// P_{n−1}, P_n and the argument at the nodes of the piece
    recurrence: Vec<[f64; 3]>,
    /// of the piece at hand, node by node: K dμ/dt, distances from x, shifts in units of the piece, weights
    densities: Vec<f64>,
    distances: Vec<f64>,
    shifts: Vec<f64>,
    weights: Vec<f64>,
    out: &'b mut [f64],
    evaluations: u64,
}

impl<K: Kernel + HasDomain> Pieces<'_, '_, K> {
    /// One side of x: distances from `nearest` to `farthest`.
    fn side(&mut self, sign: f64, nearest: f64, farthest: f64) -> Result<(), Error> {
        let smallest = self.target.resolved.max(SMALLEST_PIECE * (self.panel.1 - self.panel.0));
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
        let mut moments = vec![0.0; self.basis.len() * c * c];
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
            for (out, l) in moments.chunks_exact_mut(c * c).zip(&self.values) {
                let entry = |e: usize| singular * parts.factor.entry(e / c, e % c) + n.weight * parts.rest.entry(e / c, e % c);
                out.iter_mut().enumerate().for_each(|(e, o)| *o += outer * y.weight * l * entry(e));
            }
        }
        self.evaluations += self.rule.len() as u64;
        self.out.iter_mut().zip(&moments).for_each(|(o, m)| *o += m);
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
    fn add(&mut self, sign: f64, inner: f64, outer: f64) -> Result<(), Error> {
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

    /// Distances from `nearest` to `farthest`, all below `s`: extrapolated from [s, 8s].
    fn innermost(&mut self, sign: f64, nearest: f64, farthest: f64, s: f64) -> Result<(), Error> {
        let (a, b) = self.panel;
        let t = self.target.t;
        // within 8s of the domain's end the other side must serve
        let reach = if self.target.reaches(sign, 8.0 * s) { sign } else { -sign };
        let masses = [self.mass(reach, s, 2.0 * s)?, self.mass(reach, 2.0 * s, 4.0 * s)?, self.mass(reach, 4.0 * s, 8.0 * s)?];
        for e in 0..masses[0].len() {
            let means: [f64; 3] = std::array::from_fn(|k| masses[k][e] / (s * (1 << k) as f64));
            let (whole, power) = below(means).map_err(|ratio| Error::NotIntegrable { x: format!("{:?}", self.target.x), ratio })?;
            let share = (farthest / s).powf(power) - (nearest / s).powf(power);
            // centre of the mass r^{power − 1} dr: a straight line is integrated exactly
            let centre = nearest + (farthest - nearest) * power / (1.0 + power);
            self.basis.values(((t + sign * centre - a) / (b - a)).clamp(0.0, 1.0), &mut self.values);
            self.values.iter().enumerate().for_each(|(l, v)| self.out[l * masses[0].len() + e] += s * whole * share * v);
        }
        Ok(())
    }

    /// Whether ∫ K over distances below s may be extrapolated: from [2s, 16s] it must come out as from [s, 8s], up to a share of what there is of K on the
    /// panel, and K must go on as foreseen.
    fn is_settled(&mut self, sign: f64, s: f64) -> Result<bool, Error> {
        if !self.target.reaches(sign, 16.0 * s) {
            return Ok(false);
        }
        let mut masses = Vec::new();
        for k in 0..4 {
            masses.push(self.mass(sign, s * f64::from(1 << k), s * f64::from(2 << k))?);
        }
        let c2 = masses[0].len();
        for (e, panel) in self.integrals.iter().enumerate().take(c2) {
            let means: [f64; 4] = std::array::from_fn(|k| masses[k][e] / (s * (1 << k) as f64));
            let (Ok((inner, _)), Ok((outer, _))) = (below([means[0], means[1], means[2]]), below([means[1], means[2], means[3]])) else {
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

/// (1/s) ∫₀^s K and the power of r by which ∫₀^r K grows, from the means over [s, 2s], [2s, 4s], [4s, 8s]; the ratio ρ if not integrable.
fn below(means: [f64; 3]) -> Result<(f64, f64), f64> {
    let (ratio, outer) = (0.5 * means[0] / means[1], 0.5 * means[1] / means[2]);
    if ratio >= NOT_INTEGRABLE {
        // a kernel that falls within s faster than any power is not resolved here, and no singularity
        return if (ratio - outer).abs() < SAME_POWER { Err(ratio) } else { Ok((means[0], 1.0)) };
    }
    let steps = [means[1] - means[0], means[2] - means[1]];
    let delta = steps[1] / steps[0];
    // the growth of a kernel that changes sign or vanishes here is not known; near x it is then bounded
    let power = if ratio > 0.0 { -ratio.log2() } else { 1.0 };
    if (0.8..=4.0).contains(&delta) {
        return Ok((means[0] - 2.0 * steps[0] / (2.0 * delta - 1.0), power));
    }
    let whole = if ratio > 0.5 { means[0] * ratio / (1.0 - ratio) } else { means[0] };
    Ok((whole, power))
}

#[cfg(test)]
mod tests {
    use super::below;

    #[test]
    fn extrapolates_what_it_claims() {
        let s = 1e-11f64;
        let means = |primitive: &dyn Fn(f64) -> f64| {
            std::array::from_fn(|k| {
                let r = s * (1 << k) as f64;
                (primitive(2.0 * r) - primitive(r)) / r
            })
        };
        let logarithm = |r: f64| 3.0 * r - 2.0 * r * (r.ln() - 1.0);
        assert!((below(means(&logarithm)).unwrap().0 / (logarithm(s) / s) - 1.0).abs() < 1e-12);
        for beta in [-0.25, -0.5, -0.9] {
            let power = |r: f64| 0.5 * r.powf(1.0 + beta);
            let (whole, growth) = below(means(&power)).unwrap();
            assert!((whole / (power(s) / s) - 1.0).abs() < 1e-11, "{beta}");
            assert!((growth - 1.0 - beta).abs() < 1e-11);
        }
        assert!((below([2.0, 2.0, 2.0]).unwrap().0 - 2.0).abs() < 1e-15);
        assert_eq!(below([0.0, 0.0, 0.0]).unwrap().0, 0.0);
        assert!(below([1.0, 0.5, 0.25]).is_err()); // 1/r
    }
}
