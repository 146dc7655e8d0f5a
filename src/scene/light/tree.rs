//! Which of many lights: a binary tree whose nodes know how much of their light can reach a point.
//!
//! ```text
//! importance(x, n) = Φ cos θ′ cos θₙ′/max(d², R²)
//! ```
//!
//! Φ power of the lights below, d distance of x from the middle of their box, R its radius; θ′ the least angle at which some light of the cone of normals can
//! see x, θₙ′ the least angle from the receiving normal n. Both bounds are conservative: 0 means that nothing can arrive. A light is found by going
//! down with probabilities ∝ importance, and its probability is the product on the way. Conty Estevez, Kulla, *Importance sampling of many lights with
//! adaptive tree splitting*, PACMCGIT 1 (2018) 25; Pharr, Jakob, Humphreys, *Physically based rendering*, 4th ed. (2023), §12.6.3.

use crate::scene::frame::Vec3;
use std::f64::consts::PI;

/// What lights, or sets of them, look like from outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightBounds {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
    pub(crate) power: f64,
    /// cone of normals
    pub(crate) axis: Vec3,
    /// its half angle; light leaves up to π/2 beyond
    pub(crate) spread: f64,
}

impl LightBounds {
    fn join(&self, other: &Self) -> Self {
        let (axis, spread) = join_cones((self.axis, self.spread), (other.axis, other.spread));
        LightBounds { low: self.low.inf(&other.low), high: self.high.sup(&other.high), power: self.power + other.power, axis, spread }
    }

    fn centre(&self) -> Vec3 {
        (self.low + self.high) * 0.5
    }

    /// Power × solid angle of the cone × surface of the box: what a good cut makes small.
    fn cost(&self) -> f64 {
        let d = self.high - self.low;
        let wide = (self.spread + 0.5 * PI).min(PI);
        let cone = 2.0 * PI * (1.0 - self.spread.cos())
            + 0.5
                * PI
                * (2.0 * wide * self.spread.sin() - (self.spread - 2.0 * wide).cos() - 2.0 * self.spread * self.spread.sin()
                    + self.spread.cos());
        let box_area = 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x);
        self.power * cone * box_area.max(d.norm_squared() * 1e-3)
    }
}

/// cos max(0, θ − β).
#[inline]
fn cos_minus(cosine: f64, (sin_b, cos_b): (f64, f64)) -> f64 {
    if cosine >= cos_b { 1.0 } else { cosine * cos_b + (1.0 - cosine * cosine).max(0.0).sqrt() * sin_b }
}

/// cos max(0, θ − α − β).
#[inline]
fn cos_less(cosine: f64, a: (f64, f64), b: (f64, f64)) -> f64 {
    if cosine >= a.1 { 1.0 } else { cos_minus(cos_minus(cosine, a), b) }
}

/// A cone around two cones.
fn join_cones((a, s): (Vec3, f64), (b, t): (Vec3, f64)) -> (Vec3, f64) {
    if t > s {
        return join_cones((b, t), (a, s));
    }
    let angle = a.cross(&b).norm().atan2(a.dot(&b));
    if s >= PI || angle + t <= s {
        return (a, s);
    }
    let spread = 0.5 * (s + t + angle);
    let turn = a.cross(&b);
    if spread >= PI || turn.norm() == 0.0 {
        return (a, PI);
    }
    // a turned towards b by spread − s
    let (sine, cosine) = (spread - s).sin_cos();
    let side = turn.cross(&a).normalize();
    (a * cosine + side * sine, spread)
}

/// Bounds, ready to be asked.
#[derive(Clone, Copy, Debug)]
struct Beacon {
    centre: Vec3,
    /// squared radius of the box
    r2: f64,
    power: f64,
    axis: Vec3,
    /// sine and cosine of the cone's half angle; (0, −1) for all directions
    spread: (f64, f64),
}

impl Beacon {
    fn new(bounds: &LightBounds) -> Self {
        let spread = if bounds.spread >= PI { (0.0, -1.0) } else { bounds.spread.sin_cos() };
        let r2 = 0.25 * (bounds.high - bounds.low).norm_squared();
        Beacon { centre: bounds.centre(), r2, power: bounds.power, axis: bounds.axis, spread }
    }

    /// See the head of this file; `normal` is zero where light arrives from all around.
    #[inline]
    fn importance(&self, x: &Vec3, normal: &Vec3) -> f64 {
        let from = x - self.centre;
        let d2 = from.norm_squared();
        if d2 <= self.r2 {
            return self.power / self.r2.max(f64::MIN_POSITIVE);
        }
        let towards = from / d2.sqrt();
        // the angle that the box subtends
        let box_angle = ((self.r2 / d2).sqrt(), (1.0 - self.r2 / d2).sqrt());
        let emitted = if self.spread.1 == -1.0 { 1.0 } else { cos_less(self.axis.dot(&towards), self.spread, box_angle) };
        let received = if *normal == Vec3::zeros() { 1.0 } else { cos_minus(-normal.dot(&towards), box_angle) };
        self.power * emitted.max(0.0) * received.max(0.0) / d2
    }
}

#[derive(Clone, Copy, Debug)]
enum Node {
    /// the left child follows; the number of the right one
    Inner(u32),
    Leaf(u32),
}

/// The tree; lights are numbered as they are given.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightTree {
    nodes: Vec<(Beacon, Node)>,
    /// the way down to each light: bit k for the choice at depth k
    ways: Vec<u64>,
}

/// From here on parts are halved by number, so that no way is longer than 64 bits.
const DEEP: u32 = 24;

impl LightTree {
    pub(crate) fn new(lights: &[LightBounds]) -> Self {
        let mut tree = LightTree { nodes: Vec::with_capacity(2 * lights.len()), ways: vec![0; lights.len()] };
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        if !order.is_empty() {
            tree.build(lights, &mut order, 0, 0);
        }
        tree
    }

    fn build(&mut self, lights: &[LightBounds], order: &mut [u32], way: u64, depth: u32) {
        let bounds = order[1..].iter().fold(lights[order[0] as usize], |b, i| b.join(&lights[*i as usize]));
        let place = self.nodes.len();
        self.nodes.push((Beacon::new(&bounds), Node::Leaf(order[0])));
        if order.len() == 1 {
            self.ways[order[0] as usize] = way;
            return;
        }
        let cut = split(lights, order, depth);
        let (left, right) = order.split_at_mut(cut);
        self.build(lights, left, way, depth + 1);
        self.nodes[place].1 = Node::Inner(self.nodes.len() as u32);
        self.build(lights, right, way | 1 << depth, depth + 1);
    }

    /// A light and its probability; `None` where none can be seen. What is left of u decides again at the next node.
    #[inline]
    pub(crate) fn sample(&self, x: &Vec3, normal: &Vec3, mut u: f64) -> Option<(u32, f64)> {
        let (mut at, mut probability) = (0, 1.0);
        loop {
            match self.nodes.get(at)?.1 {
                Node::Leaf(light) => return Some((light, probability)),
                Node::Inner(right) => {
                    let left = self.share(at, right, x, normal)?;
                    if u < left {
                        (u, probability, at) = (u / left, probability * left, at + 1);
                    } else {
                        (u, probability, at) = ((u - left) / (1.0 - left), probability * (1.0 - left), right as usize);
                    }
                }
            }
        }
    }

    /// The probability that `sample` returns this light.
    #[inline]
    pub(crate) fn probability(&self, x: &Vec3, normal: &Vec3, light: u32) -> f64 {
        let (mut at, mut way, mut probability) = (0, self.ways[light as usize], 1.0);
        while let Node::Inner(right) = self.nodes[at].1 {
            let Some(left) = self.share(at, right, x, normal) else { return 0.0 };
            (at, probability) = if way & 1 == 0 { (at + 1, probability * left) } else { (right as usize, probability * (1.0 - left)) };
            way >>= 1;
        }
        probability
    }

    /// Probability of the left child.
    #[inline]
    fn share(&self, at: usize, right: u32, x: &Vec3, normal: &Vec3) -> Option<f64> {
        let [left, right] = [at + 1, right as usize].map(|i| self.nodes[i].0.importance(x, normal));
        let sum = left + right;
        (sum > 0.0).then(|| left / sum)
    }
}

/// Sorts `order` and returns where to cut it: the cheapest of twelve cuts along the longest axis.
fn split(lights: &[LightBounds], order: &mut [u32], depth: u32) -> usize {
    let centre = |i: &u32| lights[*i as usize].centre();
    let low = order.iter().fold(Vec3::repeat(f64::INFINITY), |m, i| m.inf(&centre(i)));
    let high = order.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |m, i| m.sup(&centre(i)));
    let axis = (high - low).imax();
    // ties by number: the tree depends on the lights alone
    order.sort_unstable_by(|a, b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(b)));
    let half = order.len() / 2;
    if depth >= DEEP || order.len() == 2 {
        return half;
    }
    let join = |part: &[u32]| part[1..].iter().fold(lights[part[0] as usize], |b, i| b.join(&lights[*i as usize]));
    let cost = |cut: usize| join(&order[..cut]).cost() + join(&order[cut..]).cost();
    let cuts = (1..12).map(|k| (order.len() * k / 12).max(1));
    cuts.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(half)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lights() -> Vec<LightBounds> {
        let light = |k: i32| {
            let p = Vec3::new(f64::from(k % 7), f64::from(k / 7), f64::from(k % 3));
            let axis = Vec3::new(f64::from(k % 2), 0.3, -0.5).normalize();
            LightBounds { low: p, high: p + Vec3::repeat(0.1), power: f64::from(1 + k % 5), axis, spread: 0.0 }
        };
        (0..40).map(light).collect()
    }

    /// Probabilities are those of the sampling, and add up to 1 with the chance that nothing is found: parts where no light can be seen after all.
    /// A light that can be seen is always found.
    #[test]
    fn probabilities_are_those_of_the_sampling() {
        let lights = lights();
        let tree = LightTree::new(&lights);
        for (x, n) in [([3.0, 3.0, -2.0], [0.0, 0.0, 1.0]), ([3.1, 2.0, 1.05], [0.0; 3]), ([-5.0, 1.0, -9.0], [0.6, 0.0, 0.8])] {
            let (x, n) = (Vec3::from(x), Vec3::from(n));
            let p: Vec<f64> = (0..40).map(|i| tree.probability(&x, &n, i)).collect();
            let visible = |light: &LightBounds| Beacon::new(light).importance(&x, &n) > 0.0;
            assert!(lights.iter().zip(&p).all(|(light, p)| visible(light) == (*p > 0.0)));
            const N: usize = 40_000;
            let (mut counts, mut nothing) = ([0.0; 40], 0.0);
            for k in 0..N {
                let Some((i, q)) = tree.sample(&x, &n, (k as f64 + 0.5) / N as f64) else {
                    nothing += 1.0 / N as f64;
                    continue;
                };
                assert!((q - p[i as usize]).abs() < 1e-15);
                counts[i as usize] += 1.0 / N as f64;
            }
            assert!(counts.iter().zip(&p).all(|(a, b)| (a - b).abs() < 1e-3));
            assert!((p.iter().sum::<f64>() + nothing - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn cones_hold_what_they_join() {
        let lights = lights();
        let joined = lights[1..].iter().fold(lights[0], |b, l| b.join(l));
        assert!(lights.iter().all(|l| l.axis.dot(&joined.axis).acos() <= joined.spread + 1e-12));
    }
}
