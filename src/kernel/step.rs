//! One step of a walk.

/// What a step states about its density π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// π(x, y) with respect to μ, the kernel's own survival included.
    Known(f64),
    /// Not computed yet: this factor, the method's survival so far, times [`TransitionPdf::pdf`](super::TransitionPdf::pdf).
    Deferred(f64),
    /// The step has no density: a Dirac part of the kernel, such as a mirror. Only the walk itself can produce it.
    Singular,
    /// The step has a density but does not state it; next event and MIS refuse it.
    Unstated,
}

impl Density {
    /// From one word; see [`Step`]'s field.
    #[inline]
    pub(crate) fn decode(pdf: f64) -> Self {
        if pdf.is_nan() {
            Density::Unstated
        } else if pdf == f64::INFINITY {
            Density::Singular
        } else if pdf < 0.0 {
            Density::Deferred(-pdf)
        } else {
            Density::Known(pdf)
        }
    }
}

/// Where a walk goes from x, with the weight K/π that makes it unbiased.
///
/// ```
/// use fredholm::kernel::{Density, Step};
/// assert_eq!(Step::with_pdf(0.3, 0.5, 2.0).density(), Density::Known(2.0));
/// assert_eq!(Step::regular(0.3, 0.5).density(), Density::Deferred(1.0));
/// assert_eq!(Step::singular(0.3, 1.0).density(), Density::Singular);
/// assert_eq!(Step::new(0.3, 1.0).density(), Density::Unstated);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<X, W> {
    point: X,
    weight: W,
    /// NaN = unstated, +∞ = singular, −1 = deferred: one word instead of two in the inner loop. A product with a survival probability
    /// keeps each mark, and a deferred density keeps the product in it
    pdf: f64,
}

impl<X: Copy, W: Copy> Step<X, W> {
    /// A step that states no density: enough for collision and absorption estimators.
    #[inline]
    pub fn new(point: X, weight: W) -> Self {
        Step { point, weight, pdf: f64::NAN }
    }

    /// A step of density `pdf` = π(x, point) > 0.
    #[inline]
    pub fn with_pdf(point: X, weight: W, pdf: f64) -> Self {
        // a negative number is no density, and would read as the mark of a deferred one
        Step { point, weight, pdf: if pdf >= 0.0 { pdf } else { f64::NAN } }
    }

    /// A step of a density that costs something to compute: scoring rules that need it ask [`TransitionPdf::pdf`](super::TransitionPdf::pdf), the others
    /// never pay for it.
    #[inline]
    pub fn regular(point: X, weight: W) -> Self {
        Step { point, weight, pdf: -1.0 }
    }

    /// A step along a Dirac part of the kernel.
    #[inline]
    pub fn singular(point: X, weight: W) -> Self {
        Step { point, weight, pdf: f64::INFINITY }
    }

    /// The new point y.
    #[inline]
    pub fn point(&self) -> X {
        self.point
    }

    /// K(x, y)/π(x, y).
    #[inline]
    pub fn weight(&self) -> W {
        self.weight
    }

    /// What is stated about π(x, y).
    #[inline]
    pub fn density(&self) -> Density {
        Density::decode(self.pdf)
    }

    /// The raw density: NaN if unstated, infinite if singular, −1 if deferred.
    #[inline]
    pub(crate) fn raw_pdf(&self) -> f64 {
        self.pdf
    }
}
