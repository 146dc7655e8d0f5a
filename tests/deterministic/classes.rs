//! Kernels are recognised from their values.

use crate::erased::kernel_fn;
use fredholm::Error;
use fredholm::deterministic::{Diagonal, KernelClass, classify};
use fredholm::domain::{Cuboid, Grouped, HalfLine, Interval};
use fredholm::special::e1;

fn of(k: impl Fn(f64, f64) -> f64 + Send + Sync) -> KernelClass {
    classify(&kernel_fn(Interval::from(-1.0..=2.0), move |x: &f64, y: &f64| k(*x, *y))).unwrap()
}

#[test]
fn diagonals() {
    assert_eq!(of(|x, y| (x * y).exp()).diagonal, Diagonal::Smooth);
    assert_eq!(of(|x, y| (3.0 * (x - y)).cos()).diagonal, Diagonal::Smooth);
    assert_eq!(of(|x, y| (-(x - y).abs()).exp()).diagonal, Diagonal::Kink);
    assert_eq!(of(f64::min).diagonal, Diagonal::Kink);
    assert_eq!(of(|x, y| f64::from(x > y)).diagonal, Diagonal::Jump);
    assert_eq!(of(|x, y| 1e-3 * f64::from(x > y) + y.cos()).diagonal, Diagonal::Jump);
    assert_eq!(of(|x, y| (2.0 + x) * (x - y).abs().ln() + y).diagonal, Diagonal::Logarithmic);
    assert_eq!(of(|x, y| 0.5 * e1((x - y).abs())).diagonal, Diagonal::Logarithmic);
    for alpha in [0.25, 0.5, 0.9, -0.5] {
        let Diagonal::Algebraic { exponent } = of(move |x, y| (1.0 + 0.1 * x * y) * (x - y).abs().powf(-alpha)).diagonal else {
            panic!("{alpha}")
        };
        assert!((exponent - alpha).abs() < 0.02, "{alpha}: {exponent}");
    }
    for width in [1e-2, 1e-5] {
        let Diagonal::Peaked { width: found } = of(move |x, y| width / (width * width + (x - y) * (x - y))).diagonal else {
            panic!("{width}")
        };
        // in units of the interval's length 3, by octaves
        assert!(found > 0.2 * width && found < 1.2 * width, "{width}: {found}");
    }
    assert!(matches!(of(|x, y| 1.0 / (x - y).abs()).diagonal, Diagonal::NotIntegrable { exponent } if (exponent - 1.0).abs() < 0.01));
}

/// What is left of a slope next to the diagonal is no jump, however small K is there.
#[test]
fn zero_on_the_diagonal() {
    assert_eq!(of(|x, y| (x - y).abs()).diagonal, Diagonal::Kink);
    assert_eq!(of(|x, y| (x - y).abs() + 1e-3 * (x - y)).diagonal, Diagonal::Kink);
    assert_eq!(of(|x, y| 0.3 * (x - y)).diagonal, Diagonal::Smooth);
    assert_eq!(of(|x, y| (x - y).sin()).diagonal, Diagonal::Smooth);
    assert_eq!(of(|x, y| (x - y) * (x - y)).diagonal, Diagonal::Smooth);
    assert_eq!(of(|x, y| (x - y).signum() * (x - y).powi(2).max(1e-3)).diagonal, Diagonal::Jump);
}

#[test]
fn other_properties() {
    let love = of(|x, y| 1.0 / (1.0 + (x - y) * (x - y)));
    assert!(love.toeplitz && love.symmetric && !love.periodic && love.half_wave.is_none());
    assert_eq!(of(|x, y| x * y + (x + y).sin()).rank, Some(3));
    assert_eq!(of(|x, y| (-(x - y).abs()).exp()).rank, None);
    let wave = of(|x, y| (100.0 * (x - y)).cos());
    assert!((wave.half_wave.unwrap() - std::f64::consts::PI / 100.0 / 3.0).abs() < 1e-3, "{wave}");
    let turn = 2.0 * std::f64::consts::PI / 3.0;
    assert!(of(move |x, y| 1.0 / (1.25 - (turn * (x + y)).cos())).periodic);
    assert!(!of(|x, y| (x + 2.0 * y).exp()).symmetric);
    assert_eq!(of(|x, y| f64::from(x > y)).to_string(), "a jump on the diagonal, a function of x − y");
}

#[test]
fn systems_half_lines_and_refusals() {
    // the worst pair of states counts
    let system =
        kernel_fn(
            Grouped::new(Interval::from(0.0..=1.0), 2),
            |x: &(f64, usize), y: &(f64, usize)| {
                if (x.1, y.1) == (1, 0) { (x.0 - y.0).abs().ln() } else { x.0 * y.0 }
            },
        );
    assert_eq!(classify(&system).unwrap().diagonal, Diagonal::Logarithmic);
    let half = kernel_fn(HalfLine::new(0.0), |x: &f64, y: &f64| (-(x - y).abs()).exp());
    let class = classify(&half).unwrap();
    assert!(class.diagonal == Diagonal::Kink && !class.toeplitz && class.symmetric);
    let square = kernel_fn(Cuboid::<2>::unit(), |x: &[f64; 2], y: &[f64; 2]| x[0] * y[1]);
    assert!(matches!(classify(&square), Err(Error::Invalid { parameter: "dimension", .. })));
    let broken = kernel_fn(Interval::from(0.0..=1.0), |x: &f64, y: &f64| if *y > 0.9 { f64::NAN } else { x * y });
    assert!(matches!(classify(&broken), Err(Error::NonFiniteKernel { .. })));
}
