//! How much of the light a smooth interface reflects.

use crate::scene::Rgb;

/// Schlick's F = F₀ + (1 − F₀)(1 − cos θ)⁵ (Schlick, *An inexpensive BRDF model for physically-based rendering*, CGF 13 (1994) 233).
#[inline]
pub(super) fn schlick(f0: Rgb, cosine: f64) -> Rgb {
    let w = fifth(cosine);
    crate::Spectrum(f0.0.map(|f| f + (1.0 - f) * w))
}

/// (1 − cos θ)⁵.
#[inline]
pub(super) fn fifth(cosine: f64) -> f64 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Fresnel's reflectance for unpolarised light, and the cosine of the refracted ray; `cosine` > 0 on the side of the light, `ratio` = index of the other
/// side over that of this one. `(1, 0)` for total reflection.
#[inline]
pub(super) fn dielectric(cosine: f64, ratio: f64) -> (f64, f64) {
    let sine2 = (1.0 - cosine * cosine).max(0.0) / (ratio * ratio);
    if sine2 >= 1.0 {
        return (1.0, 0.0);
    }
    let refracted = (1.0 - sine2).sqrt();
    let parallel = (ratio * cosine - refracted) / (ratio * cosine + refracted);
    let perpendicular = (cosine - ratio * refracted) / (cosine + ratio * refracted);
    (0.5 * (parallel * parallel + perpendicular * perpendicular), refracted)
}

#[cfg(test)]
mod tests {
    use super::dielectric;

    #[test]
    fn known_reflectances() {
        assert!((dielectric(1.0, 1.5).0 - 0.04).abs() < 1e-15);
        assert!((dielectric(1.0, 1.0 / 1.5).0 - 0.04).abs() < 1e-15);
        assert_eq!(dielectric(0.5, 1.0 / 1.5), (1.0, 0.0));
        // Brewster's angle: no parallel reflection
        let brewster = 1.5f64.atan().cos();
        let (f, t) = dielectric(brewster, 1.5);
        let perpendicular = (brewster - 1.5 * t) / (brewster + 1.5 * t);
        assert!((f - 0.5 * perpendicular * perpendicular).abs() < 1e-15);
    }
}
