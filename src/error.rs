//! Everything that can go wrong, with the numbers.

use crate::deterministic::Alternative;
use std::fmt;

/// Why an equation was not solved. Every message names the parameter or the place and its value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting or a number of the problem is outside its range.
    #[error("invalid {parameter} = {}: {requirement}", Short(*value))]
    Invalid {
        /// Name of the parameter as in the API.
        parameter: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        requirement: &'static str,
    },
    /// The source returned NaN or an infinity.
    #[error("source g is not finite: g({at}) = {value}")]
    NonFiniteSource {
        /// The point x, as printed by its `Debug`.
        at: String,
        /// g(x), as printed by its `Debug`.
        value: String,
    },
    /// An integrand returned NaN or an infinity.
    #[error("integrand f is not finite: f({at}) = {value}")]
    NonFiniteIntegrand {
        /// The point x, as printed by its `Debug`.
        at: String,
        /// f(x), as printed by its `Debug`.
        value: String,
    },
    /// The score of a sample is NaN or infinite, or too large to be added, although the integrand is finite where it was evaluated.
    #[error("sample {sample} of replicate {replicate} scores {score}: the density of its point is zero or too small, or the sum overflows")]
    NonFiniteScore {
        /// Index of the sample in its replicate and stratum.
        sample: u64,
        /// Replicate.
        replicate: u32,
        /// The score, as printed by its `Debug`.
        score: String,
    },
    /// The kernel returned NaN or an infinity.
    #[error("kernel K is not finite: K({x}, {y}) = {value}")]
    NonFiniteKernel {
        /// The first argument.
        x: String,
        /// The second argument.
        y: String,
        /// K(x, y).
        value: String,
    },
    /// A step of a walk carried a weight that is NaN or infinite although no kernel value seen was.
    #[error("step from {x} to {y} has weight {weight}, density {} (walk {walk} of cell {cell})", Short(*density))]
    NonFiniteWeight {
        /// Where the step began.
        x: String,
        /// Where it ended.
        y: String,
        /// Its weight K/π.
        weight: String,
        /// Its density π.
        density: f64,
        /// Detector cell.
        cell: usize,
        /// Index of the walk in the cell.
        walk: u64,
    },
    /// The product of weights along a walk left the range of floating-point numbers.
    #[error("weight of walk {walk} of cell {cell} is {weight} at vertex {vertex} ({at}): the scores overflow")]
    Overflow {
        /// Detector cell.
        cell: usize,
        /// Index of the walk in the cell.
        walk: u64,
        /// Vertex where it happened.
        vertex: u64,
        /// The point.
        at: String,
        /// The weight.
        weight: String,
    },
    /// A survival probability, or the row mass it came from, is negative or NaN.
    #[error("survival probability at {at} is {}: row masses and probabilities must not be negative or NaN", Short(*value))]
    InvalidProbability {
        /// The point, as printed by its `Debug`.
        at: String,
        /// The probability.
        value: f64,
    },
    /// A detector started a walk with a weight that is NaN or infinite.
    #[error("detector cell {cell} starts walk {walk} at {at} with weight {weight}")]
    NonFiniteStart {
        /// Detector cell.
        cell: usize,
        /// Index of the walk in the cell.
        walk: u64,
        /// X₀.
        at: String,
        /// h(X₀)/p₀(X₀).
        weight: String,
    },
    /// A walk did not end.
    #[error("walk {walk} of cell {cell} was still alive after {steps} steps; give it an ending (roulette, fixed depth) or raise max_steps")]
    WalkTooLong {
        /// Detector cell.
        cell: usize,
        /// Index of the walk in the cell.
        walk: u64,
        /// The limit that was reached.
        steps: u64,
    },
    /// Neither the kernel nor the method can end a walk.
    #[error("walks cannot end: the kernel never absorbs and the method has no roulette; add `.roulette(…)` or `.depth(…)`")]
    NeverEnds,
    /// The Neumann series of |T| diverges: walks would not converge.
    #[error(
        "the Neumann series diverges: spectral radius of |T| is {} ± {} ≥ 1; use a deterministic method (`Nystrom`), or `.accept_divergence()`",
        Short(*radius), Short(*uncertainty)
    )]
    Divergent {
        /// Spectral radius of the operator with kernel |K|.
        radius: f64,
        /// Its numerical uncertainty.
        uncertainty: f64,
    },
    /// I − T has (numerically) no inverse.
    #[error(
        "the equation is singular to working precision: reciprocal condition number {rcond:.1e} with {unknowns} unknowns{}",
        alternative.as_ref().map_or_else(String::new, |a| format!("; {a}"))
    )]
    Singular {
        /// Estimated reciprocal condition number.
        rcond: f64,
        /// Size of the linear system.
        unknowns: usize,
        /// Null functions of I − T and the condition of solvability, where a source was at hand and the domain is finite.
        alternative: Option<Box<Alternative>>,
    },
    /// Sums of finite values overflow.
    #[error("the solution of {unknowns} unknowns is not finite: values of source or kernel are too large to be added")]
    NonFiniteSolution {
        /// Size of the system.
        unknowns: usize,
    },
    /// A deterministic solve did not reach its tolerance.
    #[error("not converged: estimated error {error:.1e} > tolerance {tolerance:.1e} with {unknowns} unknowns")]
    NotConverged {
        /// Estimated error, in the units of f.
        error: f64,
        /// What was asked.
        tolerance: f64,
        /// Size of the largest system tried.
        unknowns: usize,
    },
    /// A step states no density, which the scoring rule needs.
    #[error(
        "the step from {x} to {y} states no density, which {needed_by} needs: use `Step::with_pdf`, or `Step::singular` for a Dirac part"
    )]
    UnstatedDensity {
        /// Where the step began.
        x: String,
        /// Where it ended.
        y: String,
        /// The scoring rule.
        needed_by: &'static str,
    },
    /// A step goes along a Dirac part of the kernel, which the scoring rule cannot account for.
    #[error("the step from {x} to {y} goes along a Dirac part of the kernel, which {needed_by} cannot score: use `Forward::new()`")]
    SingularStep {
        /// Where the step began.
        x: String,
        /// Where it ended.
        y: String,
        /// The scoring rule.
        needed_by: &'static str,
    },
    /// A source started a forward walk with a weight that is NaN or infinite.
    #[error("the source starts walk {walk} at {at} with weight {weight}")]
    NonFiniteBirth {
        /// Index of the walk.
        walk: u64,
        /// Z₀.
        at: String,
        /// g(Z₀)/q₀(Z₀).
        weight: String,
    },
    /// A forward walk came to a place whose light a detector gets, but not by scores.
    #[error("detector cell {cell} is not scored at {at}: {why}")]
    NotScored {
        /// Detector cell.
        cell: usize,
        /// The state, as printed by its `Debug`.
        at: String,
        /// Why, and what finds it.
        why: &'static str,
    },
    /// A detector gave a score that is NaN or infinite, although the walk's weight is not.
    #[error("detector cell {cell} scores {value} at {at}")]
    NonFiniteDetector {
        /// Detector cell.
        cell: usize,
        /// The state, as printed by its `Debug`.
        at: String,
        /// The score, as printed by its `Debug`.
        value: String,
    },
    /// Rounding of kernel values alone forbids the tolerance: no finer rule could meet it.
    #[error(
        "not converged: rounding of kernel values alone, with condition number {condition:.1e}, leaves an error of {error:.1e} > tolerance {tolerance:.1e}"
    )]
    IllConditioned {
        /// What rounding leaves, in the units of f.
        error: f64,
        /// What was asked.
        tolerance: f64,
        /// Estimated condition number of I − T.
        condition: f64,
    },
    /// 1 is in the spectrum of an operator on an infinite domain.
    #[error(
        "I − T is singular to working precision on an infinite domain: reciprocal condition number {rcond:.1e} with {unknowns} unknowns; T is not compact there, and 1 may lie in its continuous spectrum, as for half-spaces without absorption: there is no null function, and f does not depend continuously on g"
    )]
    ContinuousSpectrum {
        /// Estimated reciprocal condition number.
        rcond: f64,
        /// Size of the linear system.
        unknowns: usize,
    },
    /// T is so large that f is lost in the rounding of T f, as in an equation of the first kind; of the second kind T may be, if it is far from normal.
    #[error(
        "‖T‖ = {norm:.1e}: f is lost in the rounding of T f, and to working precision the equation is one of the first kind, unless T is far from normal (where K(x, y) w(x)/w(y) is small for some weight w, solve for w f)"
    )]
    FirstKind {
        /// ‖T‖ in L², on the nodes.
        norm: f64,
    },
    /// K(x, ·) falls too slowly towards infinity.
    #[error(
        "K(x, y) falls only like |y|^−{power:.2} towards infinity: what lies beyond the last floating-point places of the map is {mass:.1e} of ∫ |K|, and rules there do not converge (estimated error {error:.1e} > tolerance {tolerance:.1e}); substitute x = s(t) with a finite range, or cut the domain off"
    )]
    SlowDecay {
        /// The power of 1/|y|; at 1 and below there is no integral of K alone.
        power: f64,
        /// ∫ |K(x, y)| dy that no node can see.
        mass: f64,
        /// Estimated error, in the units of f.
        error: f64,
        /// What was asked.
        tolerance: f64,
    },
    /// K(x, ·) has no integral at y = x: a singularity like 1/|x − y|, or stronger, or too close to it to be told apart.
    #[error(
        "the kernel is not integrable at y = x = {x}, or only just (|x − y|^−0.98 and beyond): its integral over [r, 2r] falls only by a factor {ratio:.3} when r is halved"
    )]
    NotIntegrable {
        /// The point.
        x: String,
        /// That factor; 1/2 for a bounded kernel, 1 for 1/|x − y|.
        ratio: f64,
    },
    /// g has no integral: a singularity like 1/|x − c|, or stronger, or too close to it to be told apart.
    #[error(
        "the source is not integrable at {at}, or only just (powers of −0.98 and beyond): its integral over distances [r, 2r] falls only by a factor {ratio:.3} when r is halved"
    )]
    SourceNotIntegrable {
        /// The point.
        at: String,
        /// That factor; 1/2 for a bounded source, 1 for 1/|x − c|.
        ratio: f64,
    },
    /// A singularity at y = x so strong that points told apart by floating-point numbers miss a part of it: walks would be biased by that.
    #[error(
        "{share:.1e} of ∫|K(x, y)| dy at x = {x} lies closer to y = x than floating-point numbers can tell apart: walks would miss it; \
         use a deterministic method (`Nystrom`)"
    )]
    BelowRounding {
        /// The point.
        x: String,
        /// Estimated share of the row that no step can reach.
        share: f64,
    },
    /// Randomised truncation of a sequence whose differences do not fall fast enough for it.
    #[error(
        "debiasing has no finite {series}: its terms have slope {slope:.3} in {variable}, which must be below {limit}; \
         end earlier or later, or couple the levels better"
    )]
    NotSummable {
        /// Which series: variance, or cost.
        series: &'static str,
        /// Slope of the logarithm of its terms.
        slope: f64,
        /// Along what: the level n, or ln(n + 1).
        variable: &'static str,
        /// Where convergence begins.
        limit: f64,
    },
    /// A target density that is 0 wherever it was looked at.
    #[error("the target of Metropolis' walk was 0 at all of {samples} random points: there is nowhere to start")]
    ZeroTarget {
        /// Random points.
        samples: u64,
    },
    /// K(x, ·) has no integral at an end of the domain.
    #[error(
        "the kernel is not integrable at y = {end}, seen from x = {x}, or only just (powers of −0.98 and beyond): its integral over distances [r, 2r] falls only by a factor {ratio:.3} when r is halved"
    )]
    NotIntegrableAtEnd {
        /// The point.
        x: String,
        /// The end.
        end: String,
        /// That factor; 1/2 for a bounded kernel, 1 for 1/y.
        ratio: f64,
    },
    /// A point outside the domain.
    #[error("{x} is outside the domain")]
    Outside {
        /// The point.
        x: String,
    },
    /// A domain has no finite volume where one is needed.
    #[error("{operation} needs a domain of finite volume")]
    InfiniteDomain {
        /// What was attempted.
        operation: &'static str,
    },
    /// A saved state does not belong to this problem and method.
    #[error("checkpoint does not fit: {field} was {saved}, now {now}")]
    Checkpoint {
        /// Which setting differs.
        field: &'static str,
        /// In the checkpoint.
        saved: String,
        /// In the method.
        now: String,
    },
    /// A number that cannot be drawn.
    #[error("cannot plot {series:?}: {quantity} at {at} is {}: {requirement}", Short(*value))]
    Unplottable {
        /// Label of the series.
        series: String,
        /// What the number is.
        quantity: &'static str,
        /// Where: the number of the point in its series, from 0, or its x.
        at: String,
        /// The number.
        value: f64,
        /// What can be drawn.
        requirement: &'static str,
    },
    /// A file that is no equation at all: not JSON, or a field missing or of the wrong type.
    #[error("not an equation file: {0}")]
    Malformed(String),
    /// Text that is not an equation this crate can state.
    #[error("cannot state the equation: {0}")]
    Formula(String),
    /// A vertex of a mesh is NaN, infinite or beyond 10⁷⁵.
    #[error("vertex {vertex} of the mesh is at {at:?}: coordinates must be finite and within ±1e75")]
    Vertex {
        /// Index of the vertex.
        vertex: usize,
        /// Its coordinates.
        at: [f64; 3],
    },
    /// A triangle names a vertex that its mesh has not.
    #[error("triangle {triangle} of the mesh names vertex {index}, but there are {vertices}")]
    VertexIndex {
        /// Index of the triangle.
        triangle: usize,
        /// What it names.
        index: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// More primitives than can be numbered.
    #[error("{primitives} primitives are too many: the limit is 2^29")]
    TooManyPrimitives {
        /// Triangles and spheres together.
        primitives: usize,
    },
    /// A scene file says what no scene can be.
    #[error("{file}: {problem}")]
    SceneFile {
        /// The file.
        file: String,
        /// What is wrong in it, and where.
        problem: String,
    },
    /// A function of yours, or a part of this crate, panicked; the panic hook has said where.
    #[error("a panic during the solve: {message}")]
    Panicked {
        /// What it said.
        message: String,
    },
    /// Reading or writing failed.
    #[error("{path}: {message}")]
    Io {
        /// File.
        path: String,
        /// What the system said.
        message: String,
    },
}

impl Error {
    /// Refuses a parameter; the value is always part of the message.
    pub(crate) fn invalid(parameter: &'static str, value: f64, requirement: &'static str) -> Self {
        Error::Invalid { parameter, value, requirement }
    }

    /// Refuses what would have to be held in memory beyond all bounds: an allocation that fails ends the program.
    pub(crate) fn held(parameter: &'static str, count: u64) -> Result<(), Self> {
        if count > 1 << 26 { Err(Error::invalid(parameter, count as f64, "must be at most 2^26: all are held in memory")) } else { Ok(()) }
    }

    /// A kernel value that is NaN or infinite, with the place.
    pub(crate) fn non_finite_kernel<X: std::fmt::Debug, W: std::fmt::Debug>(x: &X, y: &X, value: &W) -> Self {
        Error::NonFiniteKernel { x: format!("{x:?}"), y: format!("{y:?}"), value: format!("{value:?}") }
    }

    /// A source value that is NaN or infinite, with the place.
    pub(crate) fn non_finite_source<X: std::fmt::Debug, V: std::fmt::Debug>(x: &X, value: &V) -> Self {
        Error::NonFiniteSource { at: format!("{x:?}"), value: format!("{value:?}") }
    }
}

/// A number in a message: in full, unless that takes a long row of zeros.
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = self.0 == 0.0 || !self.0.is_finite() || (1e-5..1e16).contains(&self.0.abs());
        if plain { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::Error;

    #[test]
    fn numbers_of_any_size_are_short() {
        let said = |value| Error::invalid("x", value, "must be 1").to_string();
        assert_eq!(said(0.25), "invalid x = 0.25: must be 1");
        assert_eq!(said(0.0), "invalid x = 0: must be 1");
        assert_eq!(said(-1e149), "invalid x = -1e149: must be 1");
        let diverges = Error::Divergent { radius: 1e149, uncertainty: 0.5 }.to_string();
        assert!(diverges.contains("is 1e149 ± 0.5 ≥ 1"), "{diverges}");
    }
}
