//! Implicit capture, also called survival biasing.
//!
//! ```text
//! y = x + μ s,   weight c,        π(x, y) = ½ E₁(|x − y|)
//! ```
//!
//! Derivation: the analog walk survives a collision with probability c and weight 1; surviving always with weight c has the same expectation.
//! Walks end by leaving the slab, or by a roulette of the method.
//!
//! Wins where particles must come far through an absorber. Fails for thick slabs without roulette: walks of tiny weight are followed until they
//! leak. The second moment is never larger than the analog one *a walk*, but a walk is longer. Reference: Lux, Koblinger (1991), §5.II.

use super::Slab;
use crate::domain::Interval;
use crate::error::Error;
use crate::kernel::{Absorbing, HasAdjoint, HasDomain, Kernel, Operator, RowMass, Series, Step, Transition, TransitionPdf};
use crate::sampling::Sampler;

/// A [`Slab`] whose walks are never captured and carry the weight c a step; see [`Slab::implicit_capture`].
///
/// ```
/// use fredholm::{transport::Slab, Equation, Walk, walk::Roulette};
/// let slab = Slab::new(1.0).scattering(0.5);
/// let eq = Equation::new(slab.uniform(1.0), slab.implicit_capture());
/// let f = eq.at(0.5).solve(&Walk::collision().roulette(Roulette::throughput(0.25)))?;
/// assert!(f.agrees_with(1.492_549_925_475_10, 5.0));
/// # Ok::<(), fredholm::Error>(())
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct ImplicitCapture {
    slab: Slab,
}

impl ImplicitCapture {
    pub(super) fn new(slab: Slab) -> Self {
        ImplicitCapture { slab }
    }

    /// The slab.
    pub fn slab(&self) -> &Slab {
        &self.slab
    }
}

impl Operator for ImplicitCapture {
    type Point = f64;
    type Weight = f64;
    fn validate(&self) -> Result<(), Error> {
        self.slab.validate()
    }
    fn series(&self) -> Result<Series<f64>, Error> {
        self.slab.series()
    }
}

impl Kernel for ImplicitCapture {
    #[inline]
    fn eval(&self, x: &f64, y: &f64) -> f64 {
        self.slab.eval(x, y)
    }
}

impl HasDomain for ImplicitCapture {
    type Domain = Interval;
    fn domain(&self) -> &Interval {
        self.slab.domain()
    }
}

/// Symmetric in x and y, the flight too: its own adjoint.
impl HasAdjoint for ImplicitCapture {
    type Adjoint = ImplicitCapture;
    fn adjoint(&self) -> Result<ImplicitCapture, Error> {
        Ok(self.clone())
    }
}

impl RowMass for ImplicitCapture {
    #[inline]
    fn mass(&self, x: &f64) -> f64 {
        self.slab.mass(x)
    }
}

impl Transition for ImplicitCapture {
    #[inline]
    fn step<S: Sampler>(&self, x: &f64, u: &mut S) -> Option<Step<f64, f64>> {
        let cosine = 2.0 * u.next_1d() - 1.0;
        self.slab.fly(*x, cosine, u).map(|y| Step::regular(y, self.slab.ratio()))
    }
}

impl TransitionPdf for ImplicitCapture {
    #[inline]
    fn pdf(&self, x: &f64, y: &f64) -> f64 {
        self.slab.flight_pdf(*x, *y)
    }
}

impl Absorbing for ImplicitCapture {
    /// Leakage alone.
    #[inline]
    fn absorption(&self, x: &f64) -> f64 {
        1.0 - self.slab.containment(*x)
    }
}
