//! The source g, and how to sample it for next-event estimation.

mod closure;
mod tabulated;

pub use closure::{SourceFn, source_fn};
pub use tabulated::TabulatedSource;

use crate::domain::{Node, Point};
use crate::error::Error;
use crate::sampling::Sampler;
use crate::value::Value;

/// The source g of f = g + Tf.
#[diagnostic::on_unimplemented(message = "`{Self}` is not a source", note = "implement `Source`, or use `source_fn(domain, |x| …)`")]
pub trait Source: Send + Sync {
    /// Where g is evaluated.
    type Point: Point;
    /// What g is.
    type Value: Value;

    /// g(x).
    fn eval(&self, x: &Self::Point) -> Self::Value;

    /// Refuses parameters outside their range; called before every solve.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the parameter and its value.
    fn validate(&self) -> Result<(), Error> {
        Ok(())
    }
}

/// Draws points of the source as seen from x.
///
/// Laws: `sample_for(x).weight == 1/pdf_for(x, sample_for(x).point)`; ∫ pdf_for(x, y) dμ(y) = 1; `pdf_for(x, y) > 0` wherever K(x, y) g(y) ≠ 0.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be sampled",
    note = "next-event estimation and MIS draw points of the source: implement `SampleSource`, or use `source_fn(domain, g)`"
)]
pub trait SampleSource: Source {
    /// A point y ~ q(· given x) with `weight` = 1/q; `None` where nothing can be seen from x.
    fn sample_for<S: Sampler>(&self, x: &Self::Point, u: &mut S) -> Option<Node<Self::Point>>;

    /// q(y given x).
    fn pdf_for(&self, x: &Self::Point, y: &Self::Point) -> f64;
}

/// Where a forward (adjoint) walk starts, with its weight g/q₀.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Birth<X, V> {
    /// X₀ ~ q₀.
    pub point: X,
    /// g(X₀)/q₀(X₀).
    pub weight: V,
}

/// Starts forward walks.
///
/// Law: `E[weight · φ(point)] = ∫ g φ dμ` for every φ; q₀ > 0 wherever g ≠ 0.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot start a forward walk",
    note = "forward walks begin at a point of the source: implement `Emit`, or use `source_fn(domain, g)`"
)]
pub trait Emit: Source {
    /// States of forward walks: points of the source, unless [adjoint](crate::kernel::HasAdjoint) walks live elsewhere.
    type State: Point;

    /// A birth.
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<Self::State, Self::Value>;
}

impl<T: Emit> Emit for &T {
    type State = T::State;
    #[inline]
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<Self::State, Self::Value> {
        (**self).emit(u)
    }
}

impl<T: Source + ?Sized> Source for &T {
    type Point = T::Point;
    type Value = T::Value;
    #[inline]
    fn eval(&self, x: &Self::Point) -> Self::Value {
        (**self).eval(x)
    }
    fn validate(&self) -> Result<(), Error> {
        (**self).validate()
    }
}

impl<T: SampleSource> SampleSource for &T {
    #[inline]
    fn sample_for<S: Sampler>(&self, x: &Self::Point, u: &mut S) -> Option<Node<Self::Point>> {
        (**self).sample_for(x, u)
    }
    #[inline]
    fn pdf_for(&self, x: &Self::Point, y: &Self::Point) -> f64 {
        (**self).pdf_for(x, y)
    }
}

/// The density of births.
///
/// Law: for every set B, `∫_B emit_pdf(z) dμ(z) = P(emit().point ∈ B)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not state the density of its births",
    note = "bidirectional walks weigh the strategies of a path by their densities: implement `EmitPdf`, or use `source_fn(domain, g)`"
)]
pub trait EmitPdf: Emit {
    /// q₀(z); infinite for sources of no extent, which no backward walk can find.
    fn emit_pdf(&self, z: &Self::State) -> f64;
}

impl<T: EmitPdf> EmitPdf for &T {
    #[inline]
    fn emit_pdf(&self, z: &T::State) -> f64 {
        (**self).emit_pdf(z)
    }
}
