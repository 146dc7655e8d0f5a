//! Vectors in space, as arrays.

/// a − b.
#[inline(always)]
pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// s·a.
#[inline(always)]
pub(crate) fn scale(s: f64, a: [f64; 3]) -> [f64; 3] {
    [s * a[0], s * a[1], s * a[2]]
}

/// a·b.
#[inline(always)]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Largest absolute coordinate.
#[inline(always)]
pub(crate) fn largest(a: [f64; 3]) -> f64 {
    a[0].abs().max(a[1].abs()).max(a[2].abs())
}

/// |a|, without overflow of its square.
#[inline]
pub(crate) fn length(a: [f64; 3]) -> f64 {
    let m = largest(a);
    if m > 0.0 && m.is_finite() { m * dot(scale(1.0 / m, a), scale(1.0 / m, a)).sqrt() } else { m }
}

/// a/|a|; NaN if a = 0.
#[inline]
pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let b = scale(1.0 / largest(a), a);
    scale(1.0 / dot(b, b).sqrt(), b)
}
