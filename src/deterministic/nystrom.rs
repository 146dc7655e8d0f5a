//! The Nyström method.
//!
//! ```text
//! f(x) ≈ f_n(x) = g(x) + Σ_j w_j K(x, y_j) f_n(y_j)               Nyström 1930; Atkinson 1997, ch. 4
//! ```
//!
//! At x = y_i a linear system of `nodes × components` unknowns; anywhere else the same formula interpolates f with the order of the rule. The
//! error is ‖f − f_n‖ ≤ ‖(I − T_n)⁻¹‖ ‖(T − T_n) f‖: as good as the rule integrates K(x, ·)f, so smooth kernels converge geometrically with
//! Gauss nodes, and a kink on the diagonal only as n⁻². [`Nystrom::graded`] cuts panels towards the diagonal and the ends of the interval instead
//! and keeps its order for kinks, jumps, logarithms and mild algebraic singularities.

use super::adaptive;
use super::alternative::explained;
use super::class::Diagonal;
use super::erased::by_values;
use super::grid::{Grid, check_size};
use super::solution::NystromSolution;
use crate::domain::Domain;
use crate::equation::{Equation, Everywhere, Method};
use crate::error::Error;
use crate::kernel::{HasDomain, Kernel, Operator};
use crate::parallel;
use crate::source::Source;
use crate::value::Weight;

/// Which rule a Nyström solve uses.
///
/// | constructor | for | domain |
/// |---|---|---|
/// | [`gauss_legendre`](Nystrom::gauss_legendre) | smooth K and g | any, few dimensions |
/// | [`composite`](Nystrom::composite) | smooth, peaked, oscillatory | any, few dimensions |
/// | [`graded`](Nystrom::graded) | kink, jump, log, \|x − y\|^{−α}, any peak on the diagonal; end singularities of f | one-dimensional, times groups |
/// | [`centred`](Nystrom::centred) | singularities and kinks at y = x in the plane | [`Disk`](crate::domain::Disk) |
/// | [`adaptive`](Nystrom::adaptive) | when you would rather state a tolerance | any, few dimensions |
///
/// ```
/// use fredholm::{Equation, deterministic::Nystrom};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// let f = eq.solve(&Nystrom::gauss_legendre(8))?;
/// assert!((f.eval(0.5) - 1.15).abs() < 1e-15);
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Nystrom {
    pub(super) rule: Rule,
    pub(super) breakpoints: Breakpoints,
    pub(super) declared: Option<Diagonal>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rule {
    Plain { panels: usize, order: usize },
    Graded { panels: usize, order: usize, levels: usize },
    Centred { order: usize },
    Adaptive { tolerance: f64, most: usize },
}

/// Most declared breakpoints: settings stay a small value.
const MOST_BREAKPOINTS: usize = 16;
/// Dyadic levels of the panels at each end: f ~ d ln d is then resolved to 2^{−32}.
const LEVELS: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Breakpoints {
    at: [f64; MOST_BREAKPOINTS],
    count: usize,
}

impl Nystrom {
    fn new(rule: Rule) -> Self {
        Nystrom { rule, breakpoints: Breakpoints { at: [0.0; MOST_BREAKPOINTS], count: 0 }, declared: None }
    }

    /// `n` Gauss–Legendre nodes along each coordinate.
    pub fn gauss_legendre(n: usize) -> Self {
        Nystrom::composite(1, n)
    }

    /// `panels` equal panels of `order` Gauss–Legendre nodes along each coordinate.
    pub fn composite(panels: usize, order: usize) -> Self {
        Nystrom::new(Rule::Plain { panels, order })
    }

    /// `panels` equal panels of `order` nodes, those at the ends (and at [`breakpoints`](Nystrom::breakpoints)) halved again and again towards them,
    /// with product integration towards y = x. About (panels + 32) · order unknowns on an interval.
    pub fn graded(panels: usize, order: usize) -> Self {
        Nystrom::new(Rule::Graded { panels, order, levels: LEVELS })
    }

    /// `n` nodes along each coordinate of a domain that has rules around a point ([`Domain::around`]), by which rows are integrated: log|x − y|, 1/|x − y| and
    /// kinks at y = x lose none of the order.
    pub fn centred(n: usize) -> Self {
        Nystrom::new(Rule::Centred { order: n })
    }

    /// Refines until two solves of different order and the residual by an independent rule agree within the [tolerance](Nystrom::tolerance); else
    /// [`Error::NotConverged`] with the numbers. The solution carries its error estimate, what the kernel looked like, and the condition number.
    ///
    /// Before it is accepted, g, f and some hundred rows and columns of K are looked at between the nodes. What can still hide: on an interval what is narrower
    /// than 1/3072 of it, or of K what covers less than about 1/5000 of the square; on a half line or line what is narrower than twice the scale of its map
    /// as far as 2¹⁴ scales, and than x/32 beyond.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Nystrom};
    /// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y: f64| -0.3 * (x - y).abs().ln());
    /// let f = eq.solve(&Nystrom::adaptive().tolerance(1e-11))?;
    /// assert!(f.error_estimate().unwrap() <= 1e-11 * f.magnitude());
    /// assert!(f.to_string().contains("logarithmic on the diagonal"));
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn adaptive() -> Self {
        Nystrom::new(Rule::Adaptive { tolerance: 1e-10, most: 6000 })
    }

    /// Largest |error| that an adaptive solve may leave, in units of max(1, max |f|) (default 10⁻¹⁰); no effect on other rules.
    pub fn tolerance(self, tolerance: f64) -> Self {
        match self.rule {
            Rule::Adaptive { most, .. } => Nystrom { rule: Rule::Adaptive { tolerance, most }, ..self },
            _ => self,
        }
    }

    /// Says how K behaves on the diagonal instead of letting an adaptive solve find out. What you say wins; if values contradict it, the solution carries
    /// a [warning](super::NystromSolution::warning).
    pub fn diagonal(self, diagonal: Diagonal) -> Self {
        Nystrom { declared: Some(diagonal), ..self }
    }

    /// How often the end panels of a graded rule are halved (default 16); no effect on other rules. f ~ d^{1−α} at the ends needs more for larger α.
    pub fn levels(self, levels: usize) -> Self {
        match self.rule {
            Rule::Graded { panels, order, .. } => Nystrom { rule: Rule::Graded { panels, order, levels }, ..self },
            _ => self,
        }
    }

    /// Largest number of unknowns that an adaptive solve tries (default 6000); no effect on other rules.
    pub fn max_unknowns(self, most: usize) -> Self {
        match self.rule {
            Rule::Adaptive { tolerance, .. } => Nystrom { rule: Rule::Adaptive { tolerance, most }, ..self },
            _ => self,
        }
    }

    /// Places x inside a one-dimensional domain where K or g jump or have a kink whatever y: panels end there. At most 16; graded and adaptive rules.
    ///
    /// ```
    /// use fredholm::{Equation, deterministic::Nystrom};
    /// let c = |x: f64| if x < 1.0 { 0.2 } else { 0.9 };
    /// let eq = Equation::on_interval(0.0..=3.0, |_| 1.0, move |x, y: f64| c(x) * (-(x - y).abs()).exp() / 2.0);
    /// let f = eq.solve(&Nystrom::graded(2, 12).breakpoints(&[1.0]))?;
    /// assert!(f.residual(0.5)?.abs() < 1e-12);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn breakpoints(self, at: &[f64]) -> Self {
        let mut breakpoints = Breakpoints { at: [0.0; MOST_BREAKPOINTS], count: at.len() };
        breakpoints.at.iter_mut().zip(at).for_each(|(b, x)| *b = *x);
        Nystrom { breakpoints, ..self }
    }

    /// The grid of a rule that is not adaptive.
    pub(super) fn grid<D: Domain>(&self, domain: &D) -> Result<Grid<D::Point>, Error> {
        domain.validate()?;
        match self.rule {
            Rule::Plain { panels, order } if self.breakpoints.count == 0 => Grid::plain(domain, panels, order),
            Rule::Centred { order } if self.breakpoints.count == 0 => Grid::centred(domain, order),
            Rule::Plain { .. } | Rule::Centred { .. } => Err(Error::invalid(
                "breakpoints",
                self.breakpoints.count as f64,
                "need a graded or adaptive rule: Nystrom::graded(panels, order)",
            )),
            Rule::Graded { panels, order, levels } => {
                if panels == 0 {
                    return Err(Error::invalid("panels", 0.0, "must be at least 1"));
                }
                if levels > 40 {
                    return Err(Error::invalid(
                        "levels",
                        levels as f64,
                        "must be at most 40: panels of 2^-40 are the limit of floating point",
                    ));
                }
                // before there are any
                check_size(panels as f64 * order as f64)?;
                let segments = self.segments(domain)?;
                Grid::panelled(domain, graded_breaks(&segments, panels, levels), order)
            }
            Rule::Adaptive { .. } => {
                Err(Error::invalid("Nystrom::adaptive", 0.0, "chooses its rule by solving an equation: state a fixed rule here"))
            }
        }
    }

    /// 0, the declared breakpoints as coordinates of the map, 1.
    pub(super) fn segments<D: Domain>(&self, domain: &D) -> Result<Vec<f64>, Error> {
        let b = &self.breakpoints;
        if b.count > MOST_BREAKPOINTS {
            return Err(Error::invalid("breakpoints", b.count as f64, "must be at most 16"));
        }
        segments_at(domain, &b.at[..b.count])
    }
}

/// 0, the coordinates of places x, 1; ascending.
pub(super) fn segments_at<D: Domain>(domain: &D, breakpoints: &[f64]) -> Result<Vec<f64>, Error> {
    let mut segments = vec![0.0, 1.0];
    for x in breakpoints {
        match domain.locate(*x) {
            Some(t) if t > 0.0 && t < 1.0 => segments.push(t),
            _ => return Err(Error::invalid("breakpoint", *x, "must lie strictly inside a one-dimensional domain")),
        }
    }
    segments.sort_by(f64::total_cmp);
    segments.dedup();
    Ok(segments)
}

/// `panels` equal panels shared over the segments by length, at least one each; the panels at both ends of every segment halved `levels` times.
pub(super) fn graded_breaks(segments: &[f64], panels: usize, levels: usize) -> Vec<f64> {
    let mut breaks = vec![0.0];
    for ends in segments.windows(2) {
        let (a, b) = (ends[0], ends[1]);
        let count = ((panels as f64 * (b - a)).round() as usize).max(1);
        // one panel has both ends: graded from its middle
        let count = if count == 1 && levels > 0 { 2 } else { count };
        let h = (b - a) / count as f64;
        breaks.extend((1..=levels).rev().map(|k| a + h * 0.5f64.powi(k as i32)));
        breaks.extend((1..count).map(|i| a + h * i as f64));
        breaks.extend((1..=levels).map(|k| b - h * 0.5f64.powi(k as i32)));
        breaks.push(b);
    }
    breaks
}

impl<G, K> Method<G, K, Everywhere> for Nystrom
where
    G: Source + Clone,
    K: Kernel + HasDomain + Operator<Point = G::Point> + Clone,
    K::Weight: Weight<Value = G::Value>,
{
    type Solution = NystromSolution<G, K>;

    fn solve(&self, equation: &Equation<G, K>, _: &Everywhere) -> Result<Self::Solution, Error> {
        let solved = match self.rule {
            Rule::Adaptive { tolerance, most } => {
                equation.validate()?;
                let found = parallel::within(|| adaptive::solve(&by_values(equation), self, tolerance, most));
                found.map(|f| f.of(equation.source().clone(), equation.kernel().clone()))
            }
            _ => equation.factorise(self).and_then(|factors| factors.solve(equation.source())),
        };
        solved.map_err(|e| explained(&by_values(equation), e))
    }
}
