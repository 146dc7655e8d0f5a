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

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Index, IndexMut, Sub};

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

/// `N` real numbers: a colour, a set of wavelengths, the fluxes of `N` energy groups.
///
/// As a weight it multiplies component by component.
///
/// ```
/// use fredholm::{Spectrum, Value, Weight};
/// let grey = Spectrum([0.5; 3]);
/// assert_eq!(grey.apply(Spectrum([1.0, 2.0, 4.0])), Spectrum([0.5, 1.0, 2.0]));
/// assert_eq!(grey.norm(), 0.5);
/// # assert_eq!(<Spectrum<3> as Value>::COMPONENTS, 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum<const N: usize>(pub [f64; N]);

impl<const N: usize> Default for Spectrum<N> {
    fn default() -> Self {
        Spectrum([0.0; N])
    }
}

impl<const N: usize> Index<usize> for Spectrum<N> {
    type Output = f64;
    fn index(&self, i: usize) -> &f64 {
        &self.0[i]
    }
}

impl<const N: usize> IndexMut<usize> for Spectrum<N> {
    fn index_mut(&mut self, i: usize) -> &mut f64 {
        &mut self.0[i]
    }
}

impl<const N: usize> Add for Spectrum<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Spectrum(std::array::from_fn(|i| self.0[i] + o.0[i]))
    }
}

impl<const N: usize> Sub for Spectrum<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Spectrum(std::array::from_fn(|i| self.0[i] - o.0[i]))
    }
}

impl<const N: usize> AddAssign for Spectrum<N> {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        for (a, b) in self.0.iter_mut().zip(o.0) {
            *a += b;
        }
    }
}

impl<const N: usize> Value for Spectrum<N> {
    const ZERO: Self = Spectrum([0.0; N]);
    const COMPONENTS: usize = N;
    #[inline]
    fn component(&self, i: usize) -> f64 {
        self.0[i]
    }
    #[inline]
    fn from_components(f: impl FnMut(usize) -> f64) -> Self {
        Spectrum(std::array::from_fn(f))
    }
}

impl<const N: usize> Weight for Spectrum<N> {
    type Value = Spectrum<N>;
    const ONE: Self = Spectrum([1.0; N]);
    #[inline]
    fn apply(&self, v: Self) -> Self {
        Spectrum(std::array::from_fn(|i| self.0[i] * v.0[i]))
    }
    #[inline]
    fn then(&self, k: Self) -> Self {
        self.apply(k)
    }
    #[inline]
    fn scaled(self, s: f64) -> Self {
        Spectrum(self.0.map(|w| s * w))
    }
    #[inline]
    fn transposed(self) -> Self {
        self
    }
    #[inline]
    fn norm(&self) -> f64 {
        self.magnitude()
    }
    #[inline]
    fn entry(&self, row: usize, column: usize) -> f64 {
        if row == column { self.0[row] } else { 0.0 }
    }
    #[inline]
    fn entries_finite(&self) -> bool {
        self.all_finite()
    }
}

/// A G × G matrix of couplings between energy groups, acting on [`Spectrum<G>`]; row = group of x, column = group of y.
///
/// ```
/// use fredholm::{GroupMatrix, Spectrum, Weight};
/// let down = GroupMatrix([[0.5, 0.0], [0.3, 0.9]]);
/// assert_eq!(down.apply(Spectrum([1.0, 0.0])), Spectrum([0.5, 0.3]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupMatrix<const G: usize>(pub [[f64; G]; G]);

impl<const G: usize> Weight for GroupMatrix<G> {
    type Value = Spectrum<G>;
    const ONE: Self = {
        let mut one = [[0.0; G]; G];
        let mut i = 0;
        while i < G {
            one[i][i] = 1.0;
            i += 1;
        }
        GroupMatrix(one)
    };
    #[inline]
    fn apply(&self, v: Spectrum<G>) -> Spectrum<G> {
        Spectrum(std::array::from_fn(|i| (0..G).map(|j| self.0[i][j] * v.0[j]).sum()))
    }
    #[inline]
    fn then(&self, k: Self) -> Self {
        GroupMatrix(std::array::from_fn(|i| std::array::from_fn(|j| (0..G).map(|l| self.0[i][l] * k.0[l][j]).sum())))
    }
    #[inline]
    fn scaled(self, s: f64) -> Self {
        GroupMatrix(self.0.map(|row| row.map(|w| s * w)))
    }
    #[inline]
    fn transposed(self) -> Self {
        GroupMatrix(std::array::from_fn(|i| std::array::from_fn(|j| self.0[j][i])))
    }
    #[inline]
    fn norm(&self) -> f64 {
        self.0.iter().flatten().fold(0.0, |m: f64, w| m.max(w.abs()))
    }
    #[inline]
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.0[row][column]
    }
    #[inline]
    fn entries_finite(&self) -> bool {
        self.0.iter().flatten().all(|w| w.is_finite())
    }
}
