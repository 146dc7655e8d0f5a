//! The double-exponential rule on the coordinate t ∈ [0, 1]: for functions that are analytic inside and anything integrable at the ends.
//!
//! ```text
//! t(u) = 1/(1 + e^{−π sinh u}),   t′(u) = π cosh u · t (1 − t),   ∫₀¹ φ dt ≈ h Σ_k t′(u_k) φ(t(u_k))
//! φ t′ ≈ Σ_k φ(t_k) t′(u_k) sinc((u − u_k)/h)                                         error O(e^{−cn/ln n}) of both
//! ```
//!
//! Takahasi, Mori, *Publ. RIMS* 9 (1974) 721; Stenger, *Numerical methods based on sinc and analytic functions* (1993); as a Nyström method: Okayama, Matsuo,
//! Sugihara, *J. Comput. Appl. Math.* 234 (2010) 1211.

use super::ends::reach;
use crate::domain::{Domain, Node};
use std::f64::consts::PI;

/// Nodes u_k = first + k · step.
#[derive(Clone, Copy, Debug)]
pub(super) struct DoubleExponential {
    first: f64,
    step: f64,
    count: usize,
}

impl DoubleExponential {
    /// `count` nodes as far towards the ends as coordinates can be told from them.
    pub(super) fn on<D: Domain>(domain: &D, count: usize) -> Self {
        let [low, high] = [0.0, 1.0].map(|end| (reach(domain, end).recip().ln() / PI).asinh());
        let step = (low + high) / count as f64;
        DoubleExponential { first: 0.5 * step - low, step, count }
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    fn u(&self, k: usize) -> f64 {
        self.first + k as f64 * self.step
    }

    /// Nodes of one state, each counted from the end that is nearer.
    pub(super) fn nodes<D: Domain>(&self, domain: &D, state: usize) -> Vec<Node<D::Point>> {
        let ends = [0.0, 1.0].map(|end| domain.place(state, || end));
        let node = |k: usize| {
            let u = self.u(k);
            let (near, far) = shares(u);
            let placed = match (u < 0.0, ends[0].weight.is_finite(), ends[1].weight.is_finite()) {
                (true, true, _) => domain.displaced(&ends[0].point, state, near),
                (false, _, true) => domain.displaced(&ends[1].point, state, -near),
                (below, ..) => domain.place(state, || if below { near } else { far }),
            };
            Node { point: placed.point, weight: placed.weight * slope(u) * self.step }
        };
        (0..self.count).map(node).collect()
    }

    /// The coordinates of the nodes: those beyond the middle to the digits that 1 − t leaves.
    pub(super) fn coordinates(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.count).map(|k| coordinate(self.u(k)))
    }

    /// What the value at node k contributes at coordinate t ∈ [0, 1], for functions that need not vanish at the ends.
    pub(super) fn values(&self, t: f64, out: &mut [f64]) {
        // beyond the outermost nodes all that is known is what they say
        let u = (((t / (1.0 - t)).ln() / PI).asinh()).clamp(self.first, self.u(self.count - 1));
        let here = slope(u);
        let phase = (PI * (u - self.first) / self.step).sin();
        for (k, out) in out.iter_mut().enumerate() {
            let d = (u - self.u(k)) / self.step;
            let sinc = if d.abs() < 1e-9 { 1.0 } else { phase * if k.is_multiple_of(2) { 1.0 } else { -1.0 } / (PI * d) };
            *out = sinc * slope(self.u(k)) / here;
        }
    }
}

/// t or 1 − t, whichever is smaller, and the other one.
fn shares(u: f64) -> (f64, f64) {
    let e = (-PI * u.abs().sinh()).exp();
    (e / (1.0 + e), 1.0 / (1.0 + e))
}

fn coordinate(u: f64) -> f64 {
    let (near, far) = shares(u);
    if u < 0.0 { near } else { far }
}

fn slope(u: f64) -> f64 {
    let (near, far) = shares(u);
    PI * u.cosh() * near * far
}

#[cfg(test)]
mod tests {
    use super::DoubleExponential;
    use crate::domain::{Domain, Interval};

    #[test]
    fn singular_ends_are_integrated() {
        let domain = Interval::from(0.0..=2.0);
        let rule = DoubleExponential::on(&domain, 81);
        let integral = |f: &dyn Fn(f64) -> f64| rule.nodes(&domain, 0).iter().map(|n| n.weight * f(n.point)).sum::<f64>();
        assert!((integral(&f64::sqrt) / (2f64.powf(2.5) / 3.0) - 1.0).abs() < 1e-14);
        assert!((integral(&|x| x.powf(-0.5)) / (2.0 * 2f64.sqrt()) - 1.0).abs() < 1e-14, "{}", integral(&|x| x.powf(-0.5)));
        assert!((integral(&|x| (2.0 - x).ln()) - (2.0 * 2f64.ln() - 2.0)).abs() < 1e-13);
    }

    #[test]
    fn singular_ends_are_interpolated() {
        let domain = Interval::from(0.0..=1.0);
        let rule = DoubleExponential::on(&domain, 121);
        let f = |x: f64| x.powf(0.3) + (3.0 * x).cos();
        let nodes: Vec<f64> = rule.nodes(&domain, 0).iter().map(|n| f(n.point)).collect();
        let mut l = vec![0.0; rule.len()];
        for t in [1e-4, 0.1, 0.5, 0.77, 0.999] {
            rule.values(t, &mut l);
            let value: f64 = l.iter().zip(&nodes).map(|(l, f)| l * f).sum();
            assert!((value - f(domain.place(0, || t).point)).abs() < 1e-10, "{t}: {value} {}", f(t));
        }
    }
}
