//! Exponential integrals E_n(x) = ∫₁^∞ e^{−xt} t^{−n} dt for n = 1, 2, 3: the kernels of slab transport.
//!
//! Below x = 3/4 the convergent series E₁ = −γ − ln x − Σ_{k≥1} (−x)^k/(k·k!) (Abramowitz, Stegun 5.1.11); above, e^x E_n(x) is a Stieltjes
//! function and has rational approximations P/Q with positive coefficients, which lose nothing to cancellation (the form of Cody, Thacher,
//! *Math. Comp.* 22 (1968) 641). The coefficients interpolate at Chebyshev points in 60 digits; their own error is below 4·10⁻¹⁸. Relative error
//! against 40-digit values: at most 6·10⁻¹⁶ over [10⁻³⁰⁰, 700].
//!
//! `statrs::function::exponential::integral` serves as the independent check in the tests; it takes up to 1 µs near x = 1, errs by 10⁻¹⁴ and
//! sometimes finds nothing, which a kernel evaluated millions of times cannot afford.

/// P/Q in ascending powers.
struct Rational {
    numerator: [f64; 10],
    denominator: [f64; 10],
}

impl Rational {
    /// P and Q have independent chains, and so have their even and odd parts: four short Horner chains run at once.
    #[inline]
    fn at(&self, x: f64) -> f64 {
        polynomial(&self.numerator, x) / polynomial(&self.denominator, x)
    }
}

#[inline]
fn polynomial(c: &[f64; 10], x: f64) -> f64 {
    let y = x * x;
    let even = (((c[8] * y + c[6]) * y + c[4]) * y + c[2]) * y + c[0];
    let odd = (((c[9] * y + c[7]) * y + c[5]) * y + c[3]) * y + c[1];
    odd * x + even
}

/// Where the series gives way to e^{−x} P(x)/Q(x).
const SERIES_END: f64 = 0.75;
/// Where P and Q change to polynomials in 1/x.
const MIDDLE_END: f64 = 6.0;
const EULER: f64 = 0.577_215_664_901_532_9;
/// 1/(k·k!) for k = 1 … 15, alternating.
const SERIES: [f64; 15] = {
    let (mut c, mut k, mut factorial) = ([0.0; 15], 0, 1.0);
    while k < 15 {
        let n = (k + 1) as f64;
        factorial *= -n;
        c[k] = -1.0 / (n * factorial);
        k += 1;
    }
    c
};

/// E₁(x) = ∫ₓ^∞ e^{−t}/t dt for x > 0; ∞ at 0, NaN for x < 0.
///
/// ```
/// use fredholm::special::e1;
/// assert!((e1(1.0) - 0.219_383_934_395_520_3).abs() < 1e-16);
/// assert_eq!(e1(0.0), f64::INFINITY);
/// ```
#[inline]
#[must_use]
pub fn e1(x: f64) -> f64 {
    if x < SERIES_END { small(x) } else { beyond(x, &MIDDLE_1, &LARGE_1) }
}

/// E₂(x) = e^{−x} − x E₁(x) for x ≥ 0; NaN for x < 0.
///
/// ```
/// assert!((fredholm::special::e2(1.0) - 0.148_495_506_775_922_05).abs() < 1e-16);
/// ```
#[inline]
#[must_use]
pub fn e2(x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    if x < SERIES_END { (-x).exp() - x * small(x) } else { beyond(x, &MIDDLE_2, &LARGE_2) }
}

/// E₃(x) = (e^{−x} − x E₂(x))/2 for x ≥ 0; NaN for x < 0.
///
/// ```
/// assert!((fredholm::special::e3(1.0) - 0.109_691_967_197_760_14).abs() < 1e-16);
/// ```
#[inline]
#[must_use]
pub fn e3(x: f64) -> f64 {
    if x < SERIES_END { 0.5 * ((-x).exp() - x * e2(x)) } else { beyond(x, &MIDDLE_3, &LARGE_3) }
}

/// E₁ by its series; NaN for negative x, from the logarithm.
#[inline]
fn small(x: f64) -> f64 {
    let series = SERIES.iter().rev().fold(0.0, |s, c| s * x + c);
    // the logarithm is the largest term for most x: added last, its rounding counts once
    (series * x - EULER) - x.ln()
}

/// E_n for x ≥ 3/4, and NaN for NaN.
#[inline]
fn beyond(x: f64, middle: &Rational, large: &Rational) -> f64 {
    let decay = (-x).exp();
    if x < MIDDLE_END {
        decay * middle.at(x)
    } else {
        let t = 1.0 / x;
        decay * t * large.at(t)
    }
}

#[rustfmt::skip]
const MIDDLE_1: Rational = Rational { // error 1.8e-18
    numerator: [
        4.835781486937811, 176.86261663584926, 1485.6191551437728, 4587.35590106263, 6264.5842125015815,
        4102.229832264949, 1308.7430424444449, 191.67835873387398, 10.109228288067536, 1.379733507637393e-08,
    ],
    denominator: [
        1.0, 64.52355771097135, 859.0676667054734, 4130.513699674121, 8896.147529872744,
        9502.066085753588, 5249.599819832472, 1490.3132763032288, 201.7875450617083, 10.109229378130696,
    ],
};
#[rustfmt::skip]
const LARGE_1: Rational = Rational { // error 4.6e-20
    numerator: [
        1.0, 50.38945392812192, 989.5577111963466, 9761.350916760108, 51999.292734523624,
        149709.03828402355, 220432.166786278, 145272.0859714683, 31321.842908756855, 573.9520560909447,
    ],
    denominator: [
        1.0, 51.38945392812192, 1038.9471651244687, 10703.519174028283, 60909.25430188087,
        194331.59033324098, 337678.3661585653, 295571.58435507235, 110767.61356140034, 12025.871670082608,
    ],
};
#[rustfmt::skip]
const MIDDLE_2: Rational = Rational { // error 1.5e-18
    numerator: [
        0.9862716552065441, 26.65197368054715, 186.55347386487477, 501.2624227146875, 606.4220023920223,
        354.1547295109032, 100.90089526004866, 13.18584651817626, 0.6198746839110584, 3.1957770098888923e-09,
    ],
    denominator: [
        1.0, 30.443448630566387, 255.04609159765815, 868.5467989249992, 1414.4230623044639,
        1191.2574462753514, 534.53749356601, 126.03313209175336, 14.425585318025341, 0.6198749492687304,
    ],
};
#[rustfmt::skip]
const LARGE_2: Rational = Rational { // error 3.3e-19
    numerator: [
        1.0, 55.257194420572475, 1195.0601719264387, 13034.806747684752, 77049.87035231898,
        246811.37793194808, 404773.16060126806, 296172.9401303772, 68947.09910738101, 319.4780928312562,
    ],
    denominator: [
        1.0, 57.25719442057247, 1303.5745607675847, 15322.41270269612, 101127.42105926717,
        382266.6699541152, 810036.1124093907, 901331.1042812403, 458356.03819049976, 76023.93239398039,
    ],
};
#[rustfmt::skip]
const MIDDLE_3: Rational = Rational { // error 7.5e-19
    numerator: [
        0.4998212337503397, 9.091264094420799, 48.8622774714187, 107.85222920095879, 111.346994092998,
        56.73137693030034, 14.27944513844119, 1.6600389754254896, 0.06969791065738014, 7.653951664094862e-10,
    ],
    denominator: [
        1.0, 19.153787318716276, 113.62971242291421, 292.50772752134657, 375.47753779520576,
        256.73968281209227, 95.63320497685085, 19.05054918394346, 1.8691299472325407, 0.06969797748661367,
    ],
};
#[rustfmt::skip]
const LARGE_3: Rational = Rational { // error 1.3e-18
    numerator: [
        1.0, 60.24325123411216, 1426.864731208501, 17129.08165378181, 112092.48119669288,
        400521.85361739685, 740867.0365528222, 622775.678662285, 171952.73994108575, 179.68080014246138,
    ],
    denominator: [
        1.0, 63.24325123411215, 1604.5944849108419, 21243.94609370353, 160003.78073319464,
        701633.9413091678, 1761919.2388256288, 2391366.305044424, 1546282.057221283, 348103.9464803852,
    ],
};

#[cfg(test)]
mod tests {
    use super::{e1, e2, e3};
    use statrs::function::exponential::integral;

    /// x, E₁, E₂, E₃ from 40-digit arithmetic.
    #[rustfmt::skip]
    const KNOWN: [(f64, f64, f64, f64); 17] = [
        (1e-300, 690.198_312_233_312_2, 1.0, 0.5),
        (1e-08, 17.843465089050833, 0.999_999_811_565_349_1, 0.49999999000000097),
        (0.001, 6.331_539_364_136_149, 0.992_668_960_469_238_8, 0.499_003_915_436_452_9),
        (0.1, 1.8229239584193906, 0.7225450221940205, 0.41629145790827876),
        (0.5, 0.559_773_594_776_160_8, 0.326_643_862_324_553, 0.22160436427517846),
        (0.7499999, 0.34034087589344435, 0.21711097709167662, 0.15476669443500627),
        (0.75, 0.34034081291123001, 0.2171109430575922, 0.154_766_672_723_910_3),
        (1.0, 0.21938393439552027, 0.14849550677592205, 0.10969196719776014),
        (1.4639186220482303, 0.10555202466683426, 0.076_808_434_775_286_07, 0.059443355641020368),
        (2.5, 0.024914917870269735, 0.019797703948224456, 0.016_295_369_376_668_83),
        (5.999, 0.00036049581861089152, 0.00031861775278560448, 0.000_284_922_134_835_750_7),
        (6.0, 0.000_360_082_452_162_658_7, 0.00031825746369040647, 0.000_284_603_697_261_959_8),
        (6.001, 0.00035966956769407404, 0.00031789758772061905, 0.00028428561977066123),
        (10.0, 4.156_968_929_685_325e-6, 3.830_240_465_631_609e-6, 3.548762553084382e-6),
        (33.0, 1.3713843484487466e-16, 1.3331779522253368e-16, 1.2969945137989303e-16),
        (100.0, 3.683_597_761_682_032e-46, 3.647_821_433_880_379e-46, 3.6127271070228845e-46),
        (700.0, 1.4065187662340329e-307, 1.4045180121540397e-307, 1.4025229340746379e-307),
    ];

    #[test]
    fn known_digits() {
        for (x, a, b, c) in KNOWN {
            for (value, known) in [(e1(x), a), (e2(x), b), (e3(x), c)] {
                assert!((value / known - 1.0).abs() < 8e-16, "x = {x}: {value} is not {known}");
            }
        }
    }

    #[test]
    fn agrees_with_another_implementation() {
        let mut compared = 0;
        for i in 0..4000 {
            let x = 1e-6 * (1.005f64).powi(i);
            for (n, value) in [(1, e1(x)), (2, e2(x)), (3, e3(x))] {
                // near x = 1 its continued fraction sometimes runs out of iterations
                let Some(other) = integral(x, n) else { continue };
                compared += 1;
                assert!((value - other).abs() <= 1.2e-14 * other, "E{n}({x}): {value} and {other}");
            }
        }
        assert!(compared > 11_900, "{compared} of 12 000");
    }

    #[test]
    fn ends_of_the_range() {
        assert_eq!((e1(0.0), e2(0.0), e3(0.0)), (f64::INFINITY, 1.0, 0.5));
        for f in [e1, e2, e3] {
            assert!(f(-1.0).is_nan() && f(f64::NAN).is_nan());
            assert_eq!((f(1e4), f(f64::INFINITY)), (0.0, 0.0));
            assert!(f(f64::MIN_POSITIVE) > 0.0);
        }
    }
}
