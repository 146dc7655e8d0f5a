//! What an equation is about: the values f(x) takes and the weights K(x, y) that multiply them.
//!
//! | values | weights | use |
//! |---|---|---|
//! | `f64` | `f64` | scalar equations |
//! | [`Spectrum<N>`] | [`Spectrum<N>`], acting diagonally | colours, independent wavelengths |
//! | [`Spectrum<G>`] | [`GroupMatrix<G>`], acting fully | multigroup transport, systems |
//! | [`Complex<f64>`](crate::Complex) | [`Complex<f64>`](crate::Complex) | waves: oscillating kernels, Fox–Li resonators |
//!
//! A walk multiplies weights from the left, `W_{n+1} = W_n K(X_n, X_{n+1}) / π` (theory (4.1.5)): for matrices the order matters
//! and [`Weight::then`] keeps it.

mod spectrum;
#[cfg(feature = "serde")]
pub(crate) mod stored;

pub use spectrum::{GroupMatrix, Spectrum};

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Sub};

/// The value f(x): a real vector space of fixed, small dimension.
///
/// Statistics work on each component on its own, through [`map`](Value::map) and [`zip`](Value::zip).
pub trait Value: Copy + Debug + PartialEq + Send + Sync + 'static + Add<Output = Self> + Sub<Output = Self> + AddAssign {
    /// The additive zero.
    const ZERO: Self;
    /// Number of real components.
    const COMPONENTS: usize;
    /// Whether components are pairs of a real and an imaginary part, and weights linear in complex numbers.
    const COMPLEX: bool = false;

    /// Component `i`, `0 ≤ i < COMPONENTS`.
    fn component(&self, i: usize) -> f64;

    /// The value whose component `i` is `f(i)`.
    fn from_components(f: impl FnMut(usize) -> f64) -> Self;

    /// `f` applied to every component.
    #[inline]
    #[must_use]
    fn map(self, mut f: impl FnMut(f64) -> f64) -> Self {
        Self::from_components(|i| f(self.component(i)))
    }

    /// `f` applied to the components of two values in pairs.
    #[inline]
    #[must_use]
    fn zip(self, other: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        Self::from_components(|i| f(self.component(i), other.component(i)))
    }

    /// `s · self`.
    #[inline]
    #[must_use]
    fn scale(self, s: f64) -> Self {
        self.map(|v| s * v)
    }

    /// Largest absolute component.
    #[inline]
    fn magnitude(&self) -> f64 {
        (0..Self::COMPONENTS).fold(0.0, |m: f64, i| m.max(self.component(i).abs()))
    }

    /// Whether no component is NaN or infinite.
    #[inline]
    fn all_finite(&self) -> bool {
        (0..Self::COMPONENTS).all(|i| self.component(i).is_finite())
    }
}

/// A kernel value K(x, y), or a product of several along a walk: a linear map on [`Value`]s.
///
/// Law: `w.then(k).apply(v) == w.apply(k.apply(v))` up to rounding, and `ONE.apply(v) == v`.
pub trait Weight: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// What the weight acts on.
    type Value: Value;
    /// The identity map.
    const ONE: Self;

    /// W v.
    #[must_use]
    fn apply(&self, v: Self::Value) -> Self::Value;

    /// The product W K, K acting first: the order of theory (4.1.5).
    #[must_use]
    fn then(&self, k: Self) -> Self;

    /// `s · self`.
    #[must_use]
    fn scaled(self, s: f64) -> Self;

    /// Wᵀ: ⟨u, W v⟩ = ⟨Wᵀ u, v⟩ with the bilinear pairing ⟨u, v⟩ = Σ u_i v_i (no conjugation); W itself where products commute.
    ///
    /// ```
    /// use fredholm::{GroupMatrix, Weight};
    /// assert_eq!(GroupMatrix([[1.0, 2.0], [3.0, 4.0]]).transposed(), GroupMatrix([[1.0, 3.0], [2.0, 4.0]]));
    /// ```
    #[must_use]
    fn transposed(self) -> Self;

    /// A norm for roulette decisions: the largest absolute entry.
    fn norm(&self) -> f64;

    /// Entry (row, column) of the matrix of this map in the components of [`Value`].
    fn entry(&self, row: usize, column: usize) -> f64;

    /// Whether no entry is NaN or infinite.
    fn entries_finite(&self) -> bool;
}

impl Value for f64 {
    const ZERO: f64 = 0.0;
    const COMPONENTS: usize = 1;
    #[inline]
    fn component(&self, _: usize) -> f64 {
        *self
    }
    #[inline]
    fn from_components(mut f: impl FnMut(usize) -> f64) -> f64 {
        f(0)
    }
    #[inline]
    fn magnitude(&self) -> f64 {
        self.abs()
    }
}

impl Weight for f64 {
    type Value = f64;
    const ONE: f64 = 1.0;
    #[inline]
    fn apply(&self, v: f64) -> f64 {
        self * v
    }
    #[inline]
    fn then(&self, k: f64) -> f64 {
        self * k
    }
    #[inline]
    fn scaled(self, s: f64) -> f64 {
        self * s
    }
    #[inline]
    fn transposed(self) -> f64 {
        self
    }
    #[inline]
    fn norm(&self) -> f64 {
        self.abs()
    }
    #[inline]
    fn entry(&self, _: usize, _: usize) -> f64 {
        *self
    }
    #[inline]
    fn entries_finite(&self) -> bool {
        self.is_finite()
    }
}
