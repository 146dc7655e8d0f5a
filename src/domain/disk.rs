//! Disks in the plane.

use super::{Domain, Node};
use crate::deterministic::quadrature::unit_rule;
use crate::error::Error;
use crate::sampling::Sampler;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A disk with the measure of the plane.
///
/// Rules are Gauss–Legendre along the radius times trapezoidal around the centre; for kernels that are singular or have a kink at y = x,
/// [`Nystrom::centred`](crate::deterministic::Nystrom::centred) takes polar coordinates around x.
///
/// ```
/// use fredholm::{domain::{Disk, Domain}, Equation, deterministic::Nystrom};
/// let disk = Disk::unit();
/// assert!((disk.volume() - std::f64::consts::PI).abs() < 1e-15 && !disk.contains(&[0.8, 0.8]));
/// // f = 1 − 0.1 ∫ f/|x − y|
/// let distance = |x: &[f64; 2], y: &[f64; 2]| (x[0] - y[0]).hypot(x[1] - y[1]);
/// let eq = Equation::on_domain(disk, |_| 1.0, move |x, y| -0.1 / distance(x, y));
/// let f = eq.solve(&Nystrom::centred(10))?;
/// assert!(f.residual([0.3, 0.4])?.abs() < 1e-4);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    centre: [f64; 2],
    radius: f64,
}

impl Disk {
    /// Around 0 with radius 1.
    #[must_use]
    pub fn unit() -> Self {
        Disk::new([0.0, 0.0], 1.0)
    }

    /// All points within `radius` of `centre`.
    #[must_use]
    pub fn new(centre: [f64; 2], radius: f64) -> Self {
        Disk { centre, radius }
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    fn polar(&self, r: f64, angle: f64) -> [f64; 2] {
        [self.centre[0] + r * angle.cos(), self.centre[1] + r * angle.sin()]
    }

    fn off_centre(&self, x: &[f64; 2]) -> f64 {
        (x[0] - self.centre[0]).hypot(x[1] - self.centre[1])
    }
}

impl Domain for Disk {
    type Point = [f64; 2];

    fn validate(&self) -> Result<(), Error> {
        if let Some(c) = self.centre.iter().find(|c| !c.is_finite()) {
            return Err(Error::invalid("disk centre", *c, "must be finite"));
        }
        if !(self.radius > 0.0 && self.volume().is_finite() && self.volume() > 0.0) {
            return Err(Error::invalid("disk radius", self.radius, "must be positive, and its square finite and not 0"));
        }
        Ok(())
    }

    #[inline]
    fn volume(&self) -> f64 {
        PI * self.radius * self.radius
    }

    fn contains(&self, x: &[f64; 2]) -> bool {
        // a point placed on the edge may lie beyond it by rounding
        self.off_centre(x) <= self.radius * (1.0 + 4.0 * f64::EPSILON)
    }

    fn dimension(&self) -> usize {
        2
    }

    fn is_periodic(&self, axis: usize) -> bool {
        axis == 1
    }

    /// Polar coordinates: r = Rt, not of uniform density; [`sample`](Domain::sample) is.
    #[inline]
    fn place(&self, _: usize, mut next: impl FnMut() -> f64) -> Node<[f64; 2]> {
        let (t, turn) = (next(), next());
        Node { point: self.polar(self.radius * t, TAU * turn), weight: TAU * self.radius * self.radius * t }
    }

    fn density(&self, x: &[f64; 2]) -> f64 {
        if self.contains(x) { 1.0 / self.volume() } else { 0.0 }
    }

    #[inline]
    fn sample<S: Sampler>(&self, u: &mut S) -> Node<[f64; 2]> {
        let (t, turn) = (u.next_1d(), u.next_1d());
        Node { point: self.polar(self.radius * t.sqrt(), TAU * turn), weight: self.volume() }
    }

    fn coordinate(&self, x: &[f64; 2], axis: usize) -> f64 {
        if axis == 0 {
            return (self.off_centre(x) / self.radius).min(1.0);
        }
        let turn = (x[1] - self.centre[1]).atan2(x[0] - self.centre[0]) / TAU;
        if turn < 0.0 { turn + 1.0 } else { turn }
    }

    /// Polar coordinates around x: ρ = ρ_max s³, so that ρ ln ρ and whatever else is integrable in the plane becomes smooth enough, and panels of angles
    /// towards the two tangents, where ρ_max changes quickly for x near the edge.
    fn around(&self, x: &[f64; 2], order: usize) -> Option<Vec<Node<[f64; 2]>>> {
        let d = self.off_centre(x).min(self.radius);
        let outward = if d > 0.0 { (x[1] - self.centre[1]).atan2(x[0] - self.centre[0]) } else { 0.0 };
        let gap = (1.0 - d / self.radius).max(1e-12).sqrt();
        let mut breaks = vec![0.0];
        breaks.extend((1..).map(|k| 0.5f64.powi(k)).take_while(|s| *s > 0.7 * gap).collect::<Vec<_>>().into_iter().rev());
        breaks.push(1.0);
        let (radial, angular) = (unit_rule(order + order / 2 + 8), unit_rule(order + 6));
        let mut nodes = Vec::new();
        // quarters: from a tangent towards the centre, or away from it
        for (side, towards) in [(1.0, 0.0), (1.0, 1.0), (-1.0, 0.0), (-1.0, 1.0)] {
            for e in breaks.windows(2) {
                for n in &angular {
                    let from_tangent = FRAC_PI_2 * (e[0] + (e[1] - e[0]) * n.point);
                    let angle: f64 = side * (FRAC_PI_2 + if towards == 0.0 { from_tangent } else { -from_tangent });
                    let sine = d * angle.sin();
                    let chord = ((self.radius - sine) * (self.radius + sine)).max(0.0).sqrt();
                    // outwards the difference cancels near the edge
                    let reach = if angle.cos() > 0.0 {
                        (self.radius - d) * (self.radius + d) / (d * angle.cos() + chord)
                    } else {
                        chord - d * angle.cos()
                    };
                    let (cos, sin) = ((outward + angle).cos(), (outward + angle).sin());
                    for m in &radial {
                        let s = m.point;
                        let rho = reach * s * s * s;
                        let weight = m.weight * 3.0 * s * s * reach * rho * n.weight * FRAC_PI_2 * (e[1] - e[0]);
                        let point = [x[0] + rho * cos, x[1] + rho * sin];
                        // at the edge ρ may vanish in rounding, and what belongs to it with it
                        if point != *x {
                            nodes.push(Node { point, weight });
                        }
                    }
                }
            }
        }
        Some(nodes)
    }
}
