//! ∫ K over distances too small to be told apart, extrapolated from those that are not; formulas in [`near`](super::near).

/// S₁/S₂ from which on a singularity r^{−α} counts as not integrable: α > 0.978.
const NOT_INTEGRABLE: f64 = 0.985;
/// S₁/S₂ from which on what is left out of one power shows: α > 0.14.
const STRONG: f64 = 0.55;
/// A second power, or a logarithm, changes what one power makes of strong singularities by no more than this.
const SLIGHT: f64 = 0.5;
/// Relative rounding of the integrals that two powers are found from.
const ONE_POWER: f64 = 1e-7;
/// Ratios this close speak of one power of r.
const SAME_POWER: f64 = 0.02;

/// (1/s) ∫₀^s K and the power of r by which ∫₀^r K grows, from the means over [s, 2s], [2s, 4s], [4s, 8s] and, where it is known, [8s, 16s]; the ratio ρ
/// if not integrable.
pub(super) fn below(means: &[f64]) -> Result<(f64, f64), f64> {
    let (ratio, outer) = (0.5 * means[0] / means[1], 0.5 * means[1] / means[2]);
    if ratio >= NOT_INTEGRABLE {
        // a kernel that falls within s faster than any power is not resolved here, and no singularity
        return if (ratio - outer).abs() < SAME_POWER { Err(ratio) } else { Ok((means[0], 1.0)) };
    }
    let steps = [means[1] - means[0], means[2] - means[1]];
    let delta = steps[1] / steps[0];
    // the growth of a kernel that changes sign or vanishes here is not known; near x it is then bounded
    let power = if ratio > 0.0 { -ratio.log2() } else { 1.0 };
    let whole = match ratio {
        _ if (0.8..=4.0).contains(&delta) => means[0] - 2.0 * steps[0] / (2.0 * delta - 1.0),
        ratio if ratio > 0.5 => means[0] * ratio / (1.0 - ratio),
        _ => means[0],
    };
    if ratio < STRONG {
        return Ok((whole, power));
    }
    let better = means.get(3).and_then(|last| two_powers([means[0], 2.0 * means[1], 4.0 * means[2], 8.0 * last]));
    Ok((better.filter(|b| (b - whole).abs() < SLIGHT * whole.abs()).unwrap_or(whole), power))
}

/// Σ_{j < 0} M_j for integrals M_j over [2ʲs, 2ʲ⁺¹s] that obey M_{j+2} = p M_{j+1} + q M_j: two powers of r, or one times a logarithm (Prony 1795).
fn two_powers(m: [f64; 4]) -> Option<f64> {
    let determinant = m[1] * m[1] - m[0] * m[2];
    let (p, q) = ((m[1] * m[2] - m[0] * m[3]) / determinant, (m[1] * m[3] - m[2] * m[2]) / determinant);
    // one power alone leaves nothing to find a second one from
    let found = determinant.abs() > ONE_POWER * m[1] * m[1];
    found.then_some(((p - 1.0) * m[0] - m[1]) / (1.0 - p - q))
}

#[cfg(test)]
mod tests {
    use super::below;

    #[test]
    fn extrapolates_what_it_claims() {
        let s = 1e-11f64;
        let means = |primitive: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let mean = |k: i32| {
                let r = s * f64::from(1 << k);
                (primitive(2.0 * r) - primitive(r)) / r
            };
            (0..4).map(mean).collect()
        };
        let logarithm = |r: f64| 3.0 * r - 2.0 * r * (r.ln() - 1.0);
        assert!((below(&means(&logarithm)).unwrap().0 / (logarithm(s) / s) - 1.0).abs() < 1e-12);
        for beta in [-0.25, -0.5, -0.9] {
            let power = |r: f64| 0.5 * r.powf(1.0 + beta);
            let (whole, growth) = below(&means(&power)).unwrap();
            assert!((whole / (power(s) / s) - 1.0).abs() < 1e-11, "{beta}");
            assert!((growth - 1.0 - beta).abs() < 1e-11);
        }
        // r^{−½} ln r, and r^{−0.7} + r^{−0.4}
        let both = |r: f64| 2.0 * r.sqrt() * (r.ln() - 2.0);
        assert!((below(&means(&both)).unwrap().0 / (both(s) / s) - 1.0).abs() < 1e-9);
        let two = |r: f64| r.powf(0.3) / 0.3 + 30.0 * r.powf(0.6) / 0.6;
        let weak = |r: f64| r.powf(0.7) / 0.7 + 1e7 * r.powf(1.7) / 1.7;
        assert!((below(&means(&weak)).unwrap().0 / (weak(s) / s) - 1.0).abs() < 1e-12);
        assert!((below(&means(&two)).unwrap().0 / (two(s) / s) - 1.0).abs() < 1e-9);
        assert!((below(&[2.0, 2.0, 2.0]).unwrap().0 - 2.0).abs() < 1e-15);
        assert_eq!(below(&[0.0, 0.0, 0.0]).unwrap().0, 0.0);
        assert!(below(&[1.0, 0.5, 0.25]).is_err()); // 1/r
    }
}
