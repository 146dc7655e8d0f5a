//! Complex numbers as values and as weights.
//!
//! f = u + iv is a value of two components (u, v), and a kernel value k = a + ib acts on them as the matrix [[a, −b], [b, a]]. Every method
//! therefore solves complex equations as it solves systems; only [spectra](crate::deterministic) look at the complex matrix itself, since the real one
//! has every eigenvalue and its conjugate.

use crate::value::{Value, Weight};
use nalgebra::Complex;

impl Value for Complex<f64> {
    const ZERO: Self = Complex { re: 0.0, im: 0.0 };
    const COMPONENTS: usize = 2;
    const COMPLEX: bool = true;
    #[inline]
    fn component(&self, i: usize) -> f64 {
        if i == 0 { self.re } else { self.im }
    }
    #[inline]
    fn from_components(mut f: impl FnMut(usize) -> f64) -> Self {
        Complex { re: f(0), im: f(1) }
    }
}

/// ```
/// use fredholm::{Complex, Equation, deterministic::Nystrom};
/// // f(x) = 1 + (i/2) ∫₀¹ f = 1/(1 − i/2)
/// let eq = Equation::on_interval(0.0..=1.0, |_| Complex::new(1.0, 0.0), |_, _| Complex::new(0.0, 0.5));
/// let f = eq.solve(&Nystrom::gauss_legendre(4))?;
/// assert!((f.eval(0.3) - Complex::new(0.8, 0.4)).norm() < 1e-15);
/// # Ok::<(), fredholm::Error>(())
/// ```
impl Weight for Complex<f64> {
    type Value = Complex<f64>;
    const ONE: Self = Complex { re: 1.0, im: 0.0 };
    #[inline]
    fn apply(&self, v: Self) -> Self {
        self * v
    }
    #[inline]
    fn then(&self, k: Self) -> Self {
        self * k
    }
    #[inline]
    fn scaled(self, s: f64) -> Self {
        self * s
    }
    #[inline]
    fn transposed(self) -> Self {
        self
    }
    #[inline]
    fn norm(&self) -> f64 {
        self.re.hypot(self.im)
    }
    #[inline]
    fn entry(&self, row: usize, column: usize) -> f64 {
        match (row, column) {
            (0, 1) => -self.im,
            (1, 0) => self.im,
            _ => self.re,
        }
    }
    #[inline]
    fn entries_finite(&self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use crate::value::{Value, Weight};
    use nalgebra::Complex;

    #[test]
    fn matrices_multiply_as_numbers_do() {
        let (w, k, v) = (Complex::new(0.3, -1.2), Complex::new(-0.7, 0.4), Complex::new(2.0, 0.5));
        let by_entries = Complex::from_components(|i| (0..2).map(|j| w.entry(i, j) * v.component(j)).sum());
        assert!((by_entries - w.apply(v)).norm() < 1e-15);
        assert!((w.then(k).apply(v) - w.apply(k.apply(v))).norm() < 1e-15);
        assert_eq!(Complex::<f64>::ONE.apply(v), v);
        assert!(!Complex::new(0.0, f64::NAN).entries_finite());
    }
}
