//! Several real numbers at once, and matrices that couple them.

use super::{Value, Weight};
use std::ops::{Add, AddAssign, Index, IndexMut, Sub};

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
