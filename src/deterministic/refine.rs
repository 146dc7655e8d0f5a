//! Which panels an adaptive solve cuts.

use super::adaptive::{SHARE, Search};
use super::basis::Basis;
use super::grid::Panels;
use super::near::{Target, components};
use super::solution::NystromSolution;
use super::verify::rounding;
use crate::domain::{Domain, Node};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::{Value, Weight};

/// No panel is cut below this share of the domain.
const SMALLEST: f64 = 1.0 / (1u64 << 42) as f64;
/// Share of a panel's mass beyond its outermost node.
const BEYOND: f64 = 0.05;
/// The outermost node of a panel, about.
const NEAR_END: f64 = 0.005;
/// Cuts towards an end in one round, each to a quarter: a singular end is planned in few rounds, and a poor interpolant is not followed for ever.
const DEPTH: usize = 4;
const QUARTER: f64 = 0.25;

impl<G, K> Search<'_, G, K>
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    /// The panels that f and K ask for.
    pub(super) fn refine(&self, f: &NystromSolution<G, K>, segments: &[f64]) -> Result<Vec<f64>, Error> {
        let panels = f.system().grid.panels().expect("solved on panels");
        // what rounding makes of f no panel can mend: cutting it up would only worsen the condition
        let allowed = (SHARE * self.allowed(f)).max(4.0 * rounding(f));
        let cuts = parallel::map(panels.count(), |p| {
            let (a, b) = panels.panel(p);
            let end = End::of((a, b), segments);
            if b - a <= SMALLEST {
                return Ok(vec![b]);
            }
            if self.kernel_tail(f, panels, p)? * f.magnitude() > allowed {
                return Ok(vec![end.cut(a, b), b]);
            }
            if self.tail_at_nodes(f, panels, p)?.max(self.layer(f, panels, p, end)?) <= allowed {
                return Ok(vec![b]);
            }
            let mut breaks = Vec::new();
            match end {
                End::None => breaks.extend([0.5 * (a + b), b]),
                end => self.towards(end, f, &panels.basis, (a, b), allowed, DEPTH, &mut breaks)?,
            }
            Ok(breaks)
        });
        let mut breaks = vec![panels.breaks[0]];
        for cut in cuts {
            breaks.extend(cut?);
        }
        Ok(breaks)
    }

    /// Appends the ends of the panels into which [a, b], unresolved and at an end of a segment, must be cut.
    fn towards(
        &self,
        end: End,
        f: &NystromSolution<G, K>,
        basis: &Basis,
        (a, b): (f64, f64),
        allowed: f64,
        depth: usize,
        breaks: &mut Vec<f64>,
    ) -> Result<(), Error> {
        let cut = end.cut(a, b);
        let sides = [(a, cut, end.left()), (cut, b, end.right())];
        for (low, high, end) in sides {
            let go_on = depth > 1 && end != End::None && high - low > SMALLEST && self.tail_between(f, basis, (low, high))? > allowed;
            if go_on {
                self.towards(end, f, basis, (low, high), allowed, depth - 1, breaks)?;
            } else {
                breaks.push(high);
            }
        }
        Ok(())
    }

    /// Legendre tail of f on panel `p` × the mass of K there: what the unresolved part of f does elsewhere.
    fn tail_at_nodes(&self, f: &NystromSolution<G, K>, panels: &Panels, p: usize) -> Result<f64, Error> {
        let n = panels.basis.len();
        let values = |state: usize| {
            let first = (state * panels.count() + p) * n;
            f.values()[first..first + n].to_vec()
        };
        self.weighted_tail(&panels.basis, panels.panel(p), |state| Ok(values(state)))
    }

    /// How far f at an end of a segment is from what the panel there extrapolates, × the mass of K: boundary layers narrower than the outermost nodes, as
    /// kernels peaked on the diagonal make them.
    fn layer(&self, f: &NystromSolution<G, K>, panels: &Panels, p: usize, end: End) -> Result<f64, Error> {
        let ((a, b), basis, domain) = (panels.panel(p), &panels.basis, self.domain());
        let mut worst = 0.0f64;
        for (inside, at_end) in [(0.0, end.left()), (1.0, end.right())] {
            // nothing happens at infinity within a spacing of the coordinate
            if at_end == End::None || !domain.place(0, || a + (b - a) * inside).weight.is_finite() {
                continue;
            }
            let t = a + (b - a) * inside + (0.5 - inside) * SMALLEST;
            let mut values = vec![0.0; basis.len()];
            basis.values(inside, &mut values);
            for state in 0..domain.states() {
                let x = domain.place(state, || t).point;
                let first = (state * panels.count() + p) * basis.len();
                let mut gap = f.value_at(&x)?;
                f.values()[first..first + basis.len()].iter().zip(&values).for_each(|(f, v)| gap += f.scale(-v));
                worst = worst.max(BEYOND * gap.magnitude() * self.mass(basis, (a, b), state)?.min(1.0));
            }
        }
        Ok(worst)
    }

    /// The same on a part of a panel, by the Nyström interpolant.
    fn tail_between(&self, f: &NystromSolution<G, K>, basis: &Basis, (a, b): (f64, f64)) -> Result<f64, Error> {
        let place = |state: usize, u: f64| self.domain().place(state, || a + (b - a) * u).point;
        self.weighted_tail(basis, (a, b), |state| basis.rule().iter().map(|n| f.value_at(&place(state, n.point))).collect())
    }

    fn weighted_tail(
        &self,
        basis: &Basis,
        (a, b): (f64, f64),
        values: impl Fn(usize) -> Result<Vec<G::Value>, Error>,
    ) -> Result<f64, Error> {
        let mut worst = 0.0f64;
        for state in 0..self.domain().states() {
            let values = values(state)?;
            let component = |i: usize| basis.tail(&values.iter().map(|v| v.component(i)).collect::<Vec<_>>());
            let tail = (0..G::Value::COMPONENTS).map(component).fold(0.0, f64::max);
            worst = worst.max(tail * self.mass(basis, (a, b), state)?.min(1.0));
        }
        Ok(worst)
    }

    /// ∫ |K| over [a, b] in a state, seen from its middle.
    fn mass(&self, basis: &Basis, (a, b): (f64, f64), state: usize) -> Result<f64, Error> {
        let (kernel, domain, c) = (self.equation.kernel(), self.domain(), components::<K>());
        let mut mass = 0.0f64;
        for from in 0..domain.states() {
            let x = domain.place(from, || 0.5 * (a + b)).point;
            let mut moments = vec![0.0; basis.len() * c * c];
            Target::new(kernel, &x).moments(state, (a, b), basis, basis, &mut moments)?;
            mass = mass.max(moments.iter().map(|m| m.abs()).sum());
        }
        Ok(mass)
    }

    /// What Gauss nodes on panel `p` miss of ∫ K(x, ·) for x on panels that count it as far: Gauss integrates twice the degree it interpolates,
    /// hence the square of the tail.
    fn kernel_tail(&self, f: &NystromSolution<G, K>, panels: &Panels, p: usize) -> Result<f64, Error> {
        // rows are integrated piece by piece there
        if self.ends.at(p, panels.count()).is_some() {
            return Ok(0.0);
        }
        let (kernel, domain) = (self.equation.kernel(), self.domain());
        let (a, b) = panels.panel(p);
        let c = components::<K>();
        let nodes: Vec<Vec<Node<K::Point>>> =
            (0..domain.states()).map(|s| panels.basis.rule().iter().map(|n| domain.place(s, || a + (b - a) * n.point)).collect()).collect();
        let mut worst = 0.0f64;
        for q in 0..panels.count() {
            let (low, high) = panels.panel(q);
            // at the ends of the domain K may be singular elsewhere than at y = x: that of a circle is, where the circle was cut
            let outermost = [(0, NEAR_END), (panels.count() - 1, 1.0 - NEAR_END)].into_iter().filter(|(end, _)| *end == q);
            let shares = std::iter::once(0.5).chain(outermost.map(|(_, share)| share));
            for (from, share) in shares.flat_map(|share| (0..domain.states()).map(move |from| (from, share))) {
                let x = domain.place(from, || low + share * (high - low)).point;
                if f.system().grid.is_product(&Target::new(kernel, &x), p) {
                    continue;
                }
                for (row, e) in nodes.iter().flat_map(|row| (0..c * c).map(move |e| (row, e))) {
                    let values: Vec<f64> = row.iter().map(|y| kernel.eval(&x, &y.point).entry(e / c, e % c) * y.weight * (b - a)).collect();
                    let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                    if largest > 0.0 {
                        worst = worst.max(panels.basis.tail(&values).powi(2) / largest);
                    }
                }
            }
        }
        Ok(worst)
    }
}

/// At which end of a segment a panel lies: f may be singular there.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    None,
    Left,
    Right,
    Both,
}

impl End {
    fn of((a, b): (f64, f64), segments: &[f64]) -> Self {
        match (segments.contains(&a), segments.contains(&b)) {
            (true, true) => End::Both,
            (true, false) => End::Left,
            (false, true) => End::Right,
            (false, false) => End::None,
        }
    }

    /// Where [a, b] is cut: nearer to the end that it lies at.
    fn cut(self, a: f64, b: f64) -> f64 {
        match self {
            End::Left => a + QUARTER * (b - a),
            End::Right => b - QUARTER * (b - a),
            End::Both | End::None => 0.5 * (a + b),
        }
    }

    /// Of the left part of a panel.
    fn left(self) -> Self {
        if matches!(self, End::Left | End::Both) { End::Left } else { End::None }
    }

    fn right(self) -> Self {
        if matches!(self, End::Right | End::Both) { End::Right } else { End::None }
    }
}
