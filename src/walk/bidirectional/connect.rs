//! The edge that joins a backward walk with a forward walk.

use crate::kernel::{Kernel, Operator};
use crate::value::Weight;

/// Where a walk in the opposite direction would have come from.
#[derive(Clone, Copy, Debug)]
pub enum Beyond<'a, Own, Other> {
    /// From the next vertex of the same walk.
    Own(&'a Own),
    /// From the vertex of the other walk at the far end of the joining edge.
    Other(&'a Other),
    /// From nowhere: it started here.
    Start,
}

/// A kernel whose walks can be joined with those along its adjoint `A`.
///
/// The states of both directions may differ: eye paths leave a surface in a direction in which light paths arrive. What a state of one is to the
/// other depends on where the walk came from, and is asked only when that is known.
///
/// Laws: `join(x, z)` is what T and the forward walk's last factor have left out: over all pairs of independent walks
/// `E[W_x join(x, z) w_z]` = ⟨h, Tᵐ g⟩ of their order. A state turned twice is the same place, and densities depend on nothing that turning forgets.
///
/// Kernels that can be evaluated on a domain have one kind of state, and are joined by K(x, z).
#[diagnostic::on_unimplemented(
    message = "walks along `{Self}` and along its adjoint `{A}` cannot be joined",
    note = "bidirectional estimators evaluate K(x, z) between their ends: implement `Kernel`, or `walk::Connect` where the states of both directions differ"
)]
pub trait Connect<A: Operator>: Operator {
    /// Whether the state that a walk is turned into depends on where it came from. Dirac parts of the kernel then belong to places (a mirror turns
    /// every edge that meets it into one that nothing else can find), otherwise to edges.
    const LOOKS_BEYOND: bool;

    /// The weight of the edge from x, where a backward walk ends, to z, where a forward walk ends; 0 where neither sees the other.
    fn join(&self, x: &Self::Point, z: &A::Point) -> Self::Weight;

    /// The state of a forward walk at the place of x that came from beyond.
    fn forward(&self, x: &Self::Point, from: Beyond<'_, Self::Point, A::Point>) -> A::Point;

    /// The state of a backward walk at the place of z that came from beyond.
    fn backward(&self, z: &A::Point, from: Beyond<'_, A::Point, Self::Point>) -> Self::Point;
}

impl<K, A> Connect<A> for K
where
    K: Kernel,
    K::Weight: Weight,
    A: Operator<Point = K::Point>,
{
    const LOOKS_BEYOND: bool = false;

    #[inline]
    fn join(&self, x: &K::Point, z: &K::Point) -> K::Weight {
        self.eval(x, z)
    }
    #[inline]
    fn forward(&self, x: &K::Point, _: Beyond<'_, K::Point, K::Point>) -> K::Point {
        *x
    }
    #[inline]
    fn backward(&self, z: &K::Point, _: Beyond<'_, K::Point, K::Point>) -> K::Point {
        *z
    }
}
