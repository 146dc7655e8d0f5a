//! What is refused before the first walk.

use super::{Divergence, Ending, Scoring, Walk};
use crate::detector::Detector;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{Operator, Series, Transition};
use crate::sampling::Sequence;
use crate::source::Source;
use crate::statistics::Truncation;
use crate::value::Weight;

impl<C, E, Q: Sequence> Walk<C, E, Q> {
    /// Everything that can be refused before the first walk; returns what is known of the truncation bias.
    pub(super) fn prepare<G, K, D>(&self, equation: &Equation<G, K>, detector: &D) -> Result<Option<Truncation>, Error>
    where
        G: Source,
        K: Transition + Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
        C: Scoring<G, K>,
        E: Ending<K>,
        D: Detector<Point = G::Point>,
    {
        equation.validate()?;
        detector.validate()?;
        self.scoring.validate(equation, &self.ending)?;
        self.budgeted(equation, equation.kernel(), || detector.norm())
    }

    /// What can be refused of walks along `along`, the kernel or its adjoint, for a detector of ∫ |h| dμ ≤ `norm`.
    pub(super) fn budgeted<G, K, A>(
        &self,
        equation: &Equation<G, K>,
        along: &A,
        norm: impl FnOnce() -> Option<f64>,
    ) -> Result<Option<Truncation>, Error>
    where
        G: Source,
        K: Operator<Point = G::Point>,
        K::Weight: Weight<Value = G::Value>,
        A: Transition,
        E: Ending<A>,
    {
        self.ending.validate()?;
        if self.samples == 0 {
            return Err(Error::invalid("samples_per_cell", 0.0, "must be at least 1"));
        }
        if self.max_steps == 0 {
            return Err(Error::invalid("max_steps", 0.0, "must be at least 1"));
        }
        if self.sequence.replicates() == Some(0) {
            return Err(Error::invalid("replicates", 0.0, "must be at least 1"));
        }
        Error::held("replicates", self.sequence.replicates().map_or(1, u64::from))?;
        if !self.ending.ends() && along.never_absorbs() {
            return Err(Error::NeverEnds);
        }
        // K and its transpose have one spectrum
        let series = equation.kernel().series()?;
        if let (Series::Known(s), Divergence::Refuse, None) = (&series, self.divergence, self.ending.cut()) {
            let radius = s.radius();
            if radius.diverges() {
                return Err(Error::Divergent { radius: radius.value, uncertainty: radius.uncertainty });
            }
        }
        Ok(self.ending.cut().map(|depth| Truncation {
            depth,
            walks: 0,
            bias_bound: match &series {
                // |⟨h, Σ_{n > D} Tⁿg⟩| ≤ ∫|h| · sup
                Series::Known(s) => {
                    let sup = s.truncation_bound(depth, |x| equation.source().eval(x));
                    sup.zip(norm()).map(|(sup, norm)| sup * norm)
                }
                Series::Unknown => None,
            },
        }))
    }
}
