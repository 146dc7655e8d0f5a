//! Array-RQMC: walks in lockstep, sorted by state, each step of all of them from one fresh randomised point set.
//!
//! ```text
//! n chains X_0^(i);  for every step j:  sort the chains that live by their state; chain of rank i reads point i of a fresh set, U_{j,i}
//! (i/n, U_{j,i}) is evenly spread, so the empirical distribution of the states stays nearer to the true one than independent walks can
//! ```
//!
//! Every U_{j,i} is uniform, so each replicate is unbiased; but the chains of one depend on each other, and only independent replicates tell the
//! error (theory (4.14.4), (4.14.6)). A step uses a few coordinates however long the walk is, so the set may be low-dimensional: that is why this
//! works where a Sobol' point a *walk* fails, its late coordinates being no better than random.
//!
//! Wins on state spaces of one or two dimensions and many steps, where the next state is a smooth function of the state and of the point: a kernel's
//! own step by inversion. Loses where it is not: a tabulated proposal has jumps, one that ignores the state (uniform) leaves the weight as a second,
//! hidden coordinate ([`Sort::StateAndWeight`]). Losses at a boundary are jumps of the score and cost some of the
//! gain. On short walks with smooth weights a Sobol' point a walk may be better still. No order keeps neighbours together in many dimensions, and sorting costs:
//! some ten times as much as the walks of a cheap kernel.
//! Reference: L'Ecuyer, Lécot, Tuffin, *A randomized quasi-Monte Carlo simulation method for Markov chains*, Oper. Res. 56 (2008) 958.

use super::Walk;
use super::backward::{Backward, met_nothing, start};
use super::driver::{Driver, End};
use super::ending::{Ending, Roulette};
use super::observer::Recorder;
use super::order::{Order, Sort};
use super::scoring::{Collision, Scoring};
use crate::detector::Detector;
use crate::equation::{Equation, Method};
use crate::error::Error;
use crate::kernel::{HasDomain, Operator, Transition};
use crate::parallel;
use crate::sampling::hash::word;
use crate::sampling::{Purpose, Sampler, Sequence};
use crate::source::Source;
use crate::statistics::{Estimate, Moments, Pooled, Tail, Truncation};
use crate::value::{Value, Weight};
use std::time::Instant;

/// The rule and the budget of a [`Walk`], walked by arrays of sorted chains.
///
/// `samples_per_cell` are chains in all replicates together; powers of two in each replicate suit Sobol' points. A step reads the coordinates that the
/// [`Layout`](crate::sampling::Layout) gives to vertex 0, whatever the step: give it no more than it needs. A sequence without replicates (PCG: an array of
/// independent chains) is repeated 16 times.
///
/// ```
/// use fredholm::sampling::{Layout, Sobol};
/// use fredholm::{Equation, Walk, walk::ArrayRqmc};
/// let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
/// // walks that start at a point: one number for roulette, one for the step
/// let sobol = Sobol::new(7).layout(Layout::of_dimension(1).start(0).event(0));
/// let (walks, array) = (Walk::collision(), ArrayRqmc::new(Walk::collision().sequence(sobol)));
/// let (f, g) = (eq.at(0.5).solve(&walks)?, eq.at(0.5).solve(&array)?);
/// assert!(g.agrees_with(1.15, 6.0) && g.degrees_of_freedom == 15);
/// assert!(g.std_error < f.std_error.map(|e| e / 3.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct ArrayRqmc<C = Collision, E = Roulette, Q = crate::sampling::Pcg> {
    walk: Walk<C, E, Q>,
    sort: Sort,
}

/// Replicates of sequences that have none of their own.
const REPLICATES: u32 = 16;

impl<C, E, Q> ArrayRqmc<C, E, Q> {
    /// Scoring, ending, sequence and budget of `walk`.
    pub fn new(walk: Walk<C, E, Q>) -> Self {
        ArrayRqmc { walk, sort: Sort::State }
    }

    /// What the chains are sorted by.
    pub fn sorted_by(self, sort: Sort) -> Self {
        ArrayRqmc { sort, ..self }
    }
}

/// A sampler on the points of single steps: it moves to the purposes of the first vertex, however far the walk has come.
#[derive(Clone, Debug)]
struct OneStep<S>(S);

impl<S: Sampler> Sampler for OneStep<S> {
    #[inline]
    fn next_1d(&mut self) -> f64 {
        self.0.next_1d()
    }
    #[inline]
    fn seek(&mut self, _: u64, purpose: Purpose) {
        self.0.seek(0, purpose);
    }
}

/// The points of one chain, one a step: to replay it alone.
struct Replayed<'a, S> {
    points: &'a [OneStep<S>],
    now: OneStep<S>,
    vertex: u64,
}

impl<S: Sampler + Clone> Sampler for Replayed<'_, S> {
    fn next_1d(&mut self) -> f64 {
        self.now.next_1d()
    }
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        // once a vertex: where moving between purposes is free, numbers are read one after the other
        if let Some(point) = self.points.get(vertex as usize).filter(|_| vertex != self.vertex) {
            self.now = point.clone();
            self.vertex = vertex;
        }
        self.now.seek(vertex, purpose);
    }
}

/// The scores of one replicate.
struct Array<V> {
    scores: Vec<V>,
    steps: u64,
    cut: u64,
    truncated: u64,
}

impl<C, E, Q: Sequence> ArrayRqmc<C, E, Q> {
    fn replicates(&self) -> u32 {
        self.walk.sequence.replicates().unwrap_or(REPLICATES)
    }

    /// Cell of the sequence for a step of a detector cell: no two steps share a randomisation.
    fn step_cell(cell: usize, depth: u64) -> u64 {
        word(cell as u64, depth)
    }

    /// All chains of one replicate, from their starts to their ends. `watch` sees the point that every chain reads at every step.
    fn replicate<G, K, D>(
        &self,
        equation: &Equation<G, K>,
        detector: &D,
        (cell, replicate, chains): (usize, u32, u64),
        mut watch: impl FnMut(usize, &OneStep<Q::Sampler>),
    ) -> Result<Array<G::Value>, Error>
    where
        G: Source,
        K: Transition + HasDomain + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
        C: Scoring<G, K>,
        E: Ending<K>,
        D: Detector<Point = G::Point>,
    {
        let Walk { scoring, ending, sequence, max_steps, .. } = &self.walk;
        let mut errand = Backward { equation, scoring };
        let driver = Driver { kernel: equation.kernel(), ending, max_steps: *max_steps };
        let points = |depth, count| sequence.points(Self::step_cell(cell, depth), replicate, 0..count).map(OneStep);
        let mut lanes: Vec<_> = points(0, chains).enumerate().map(|(i, u)| start(detector, cell, i, u)).collect();
        lanes.iter().enumerate().for_each(|(i, lane)| watch(i, lane.sampler()));
        let mut ranks: Vec<u32> = (0..chains as u32).collect();
        let mut out = Array { scores: vec![G::Value::ZERO; chains as usize], steps: 0, cut: 0, truncated: 0 };
        let mut too_long = None;
        let mut order = Order::new(equation.kernel().domain(), self.sort);
        for depth in 0.. {
            if depth > 0 {
                order.sort(&mut ranks, |rank| lanes[rank as usize].destination());
                for (rank, u) in ranks.iter().zip(points(depth, ranks.len() as u64)) {
                    watch(*rank as usize, &u);
                    lanes[*rank as usize].read(u);
                }
            }
            out.steps += driver.advance(&mut errand, &mut lanes, &mut ranks, depth, &mut (), &mut |walk| {
                match walk.end {
                    End::Cut => {
                        out.cut += 1;
                        out.truncated += u64::from(walk.truncated);
                    }
                    End::TooLong => too_long = too_long.or(Some(walk.walk)),
                    End::Absorbed | End::Roulette => {}
                }
                out.scores[walk.walk] = walk.score;
            });
            if let Some(walk) = too_long {
                return Err(Error::WalkTooLong { cell, walk: walk as u64, steps: *max_steps });
            }
            if ranks.is_empty() {
                return Ok(out);
            }
        }
        Ok(out)
    }

    /// Finds the cause of a score that is not finite: the replicate again, watching one chain, which is then replayed alone.
    #[cold]
    fn explain<G, K, D>(
        &self,
        equation: &Equation<G, K>,
        detector: &D,
        (cell, replicate): (usize, u32),
        scores: &[G::Value],
    ) -> Result<(), Error>
    where
        G: Source,
        K: Transition + HasDomain + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
        C: Scoring<G, K>,
        E: Ending<K>,
        D: Detector<Point = G::Point>,
    {
        let count = scores.len() as f64;
        // finite scores whose fourth power overflows: the moments say ∞, the mean is right
        let Some(chain) = scores.iter().position(|s| !s.scale(count).all_finite()) else { return Ok(()) };
        let mut points = Vec::new();
        self.replicate(equation, detector, (cell, replicate, scores.len() as u64), |i, u| {
            if i == chain {
                points.push(u.clone());
            }
        })?;
        let walk = chain as u64;
        let mut recorder = Recorder { vertices: Vec::new(), fault: None, cell, walk };
        let Walk { scoring, ending, max_steps, .. } = &self.walk;
        let mut errand = Backward { equation, scoring };
        let driver = Driver { kernel: equation.kernel(), ending, max_steps: *max_steps };
        let mut lane = [start(detector, cell, 0, Replayed { points: &points, now: points[0].clone(), vertex: 0 })];
        driver.walk(&mut errand, &mut lane, &mut Vec::new(), &mut recorder, |_| {});
        let (vertex, last) = (recorder.vertices.len() as u64 - 1, recorder.vertices.last().expect("a walk has a start"));
        let unexplained = Error::Overflow { cell, walk, vertex, at: format!("{:?}", last.point), weight: format!("{:?}", last.weight) };
        Err(recorder.fault.unwrap_or(unexplained))
    }
}

impl<G, K, D, C, E, Q> Method<G, K, D> for ArrayRqmc<C, E, Q>
where
    G: Source,
    K: Transition + HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
    C: Scoring<G, K>,
    E: Ending<K>,
    Q: Sequence,
    D: Detector<Point = G::Point>,
{
    type Solution = D::Answer<Estimate<G::Value>>;

    fn solve(&self, equation: &Equation<G, K>, detector: &D) -> Result<Self::Solution, Error> {
        let clock = Instant::now();
        let truncation = self.walk.prepare(equation, detector)?;
        let replicates = self.replicates();
        let chains = self.walk.samples.div_ceil(u64::from(replicates));
        Error::held("chains a replicate", chains)?;
        if !self.walk.sequence.is_randomised() {
            return Err(Error::invalid(
                "replicates",
                1.0,
                "must be randomised for sorted chains: all steps would share the points of the textbook",
            ));
        }
        Error::held("cells × replicates", (detector.cells() as u64).saturating_mul(u64::from(replicates)))?;
        let tasks = detector.cells() * replicates as usize;
        // behind a vtable: one call a replicate
        let one: &(dyn Fn(usize) -> Result<_, Error> + Sync) = &|task| {
            let (cell, replicate) = (task / replicates as usize, (task % replicates as usize) as u32);
            let array = self.replicate(equation, detector, (cell, replicate, chains), |_, _| {})?;
            let moments = Moments::from_scores(&array.scores);
            if !(moments.mean.all_finite() && moments.m4.all_finite()) {
                self.explain(equation, detector, (cell, replicate), &array.scores)?;
            }
            let tail = Tail::of_block(&array.scores, moments.nonzero, 0.0);
            Ok((moments, tail, Array { scores: Vec::new(), ..array }))
        };
        let results = parallel::map(tasks, one).into_iter().collect::<Result<Vec<_>, Error>>()?;
        let elapsed = clock.elapsed();
        let estimate = |(i, cell): (usize, &[(Moments<G::Value>, Tail, Array<G::Value>)])| {
            let parts: Vec<_> = cell.iter().map(|c| c.0).collect();
            let Pooled { moments, std_error, degrees_of_freedom } = Pooled::randomised(&parts);
            let mut tail = Tail::default();
            tail.merge(cell.iter().map(|c| &c.1));
            let sum = |f: fn(&Array<G::Value>) -> u64| cell.iter().map(|c| f(&c.2)).sum::<u64>();
            let steps = sum(|a| a.steps);
            let estimate = Estimate {
                value: moments.mean,
                std_error,
                degrees_of_freedom,
                moments,
                tail: Some(tail),
                steps,
                evaluations: steps + C::EVALUATIONS * (steps + moments.count - sum(|a| a.cut)),
                truncation: truncation.map(|t| Truncation { walks: sum(|a| a.truncated), ..t }),
                elapsed,
            };
            let first = || self.walk.sequence.point(Self::step_cell(i, 0), 0, 0);
            estimate.unless(|score| met_nothing(equation, detector, (i, first()), score))
        };
        Ok(detector.answer(results.chunks(replicates as usize).enumerate().map(estimate).collect()))
    }
}
