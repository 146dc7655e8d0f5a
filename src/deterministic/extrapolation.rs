//! ∫ K over distances too small to be told apart, extrapolated from those that are not; formulas in [`near`](super::near).

/// S₁/S₂ from which on a singularity r^{−α} counts as not integrable: α > 0.978.
const NOT_INTEGRABLE: f64 = 0.985;
/// Ratios this close speak of one power of r.
const SAME_POWER: f64 = 0.02;

/// (1/s) ∫₀^s K and the power of r by which ∫₀^r K grows, from the means over [s, 2s], [2s, 4s], [4s, 8s]; the ratio ρ if not integrable.
pub(super) fn below(means: [f64; 3]) -> Result<(f64, f64), f64> {
    let (ratio, outer) = (0.5 * means[0] / means[1], 0.5 * means[1] / means[2]);
    if ratio >= NOT_INTEGRABLE {
        // a kernel that falls within s faster than any power is not resolved here, and no singularity
        return if (ratio - outer).abs() < SAME_POWER { Err(ratio) } else { Ok((means[0], 1.0)) };
    }
    let steps = [means[1] - means[0], means[2] - means[1]];
    let delta = steps[1] / steps[0];
    // the growth of a kernel that changes sign or vanishes here is not known; near x it is then bounded
    let power = if ratio > 0.0 { -ratio.log2() } else { 1.0 };
    if (0.8..=4.0).contains(&delta) {
        return Ok((means[0] - 2.0 * steps[0] / (2.0 * delta - 1.0), power));
    }
    let whole = if ratio > 0.5 { means[0] * ratio / (1.0 - ratio) } else { means[0] };
    Ok((whole, power))
}

#[cfg(test)]
mod tests {
    use super::below;

    #[test]
    fn extrapolates_what_it_claims() {
        let s = 1e-11f64;
        let means = |primitive: &dyn Fn(f64) -> f64| {
            std::array::from_fn(|k| {
                let r = s * (1 << k) as f64;
                (primitive(2.0 * r) - primitive(r)) / r
            })
        };
        let logarithm = |r: f64| 3.0 * r - 2.0 * r * (r.ln() - 1.0);
        assert!((below(means(&logarithm)).unwrap().0 / (logarithm(s) / s) - 1.0).abs() < 1e-12);
        for beta in [-0.25, -0.5, -0.9] {
            let power = |r: f64| 0.5 * r.powf(1.0 + beta);
            let (whole, growth) = below(means(&power)).unwrap();
            assert!((whole / (power(s) / s) - 1.0).abs() < 1e-11, "{beta}");
            assert!((growth - 1.0 - beta).abs() < 1e-11);
        }
        assert!((below([2.0, 2.0, 2.0]).unwrap().0 - 2.0).abs() < 1e-15);
        assert_eq!(below([0.0, 0.0, 0.0]).unwrap().0, 0.0);
        assert!(below([1.0, 0.5, 0.25]).is_err()); // 1/r
    }
}
