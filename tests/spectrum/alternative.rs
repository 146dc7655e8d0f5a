//! Equations with 1 in the spectrum of T.

use crate::erased::Equation;
use fredholm::Error;
use fredholm::deterministic::{Alternative, Nystrom};
use std::f64::consts::PI;

fn refusal(g: fn(f64) -> f64, k: fn(f64, f64) -> f64, rule: &Nystrom) -> Alternative {
    let eq = Equation::on_interval(0.0..=1.0, g, k);
    match eq.solve(rule) {
        Err(e @ Error::Singular { alternative: Some(_), .. }) => {
            let words = e.to_string();
            let Error::Singular { alternative: Some(a), .. } = e else { unreachable!() };
            assert!(words.contains(if a.is_solvable() { "are not unique" } else { "no solution" }), "{words}");
            *a
        }
        other => panic!("{other:?}"),
    }
}

/// The function as printed places and values; scaled to its known value at the place nearest ½.
fn deviation(a: &Alternative, known: impl Fn(f64) -> f64) -> f64 {
    let places: Vec<f64> = a.places.iter().map(|p| p.parse().unwrap()).collect();
    let middle = (0..places.len()).min_by(|i, j| (places[*i] - 0.4).abs().total_cmp(&(places[*j] - 0.4).abs())).unwrap();
    let scale = known(places[middle]) / a.null[0][middle];
    places.iter().zip(&a.null[0]).map(|(x, v)| (scale * v - known(*x)).abs()).fold(0.0, f64::max)
}

#[test]
fn null_functions_and_solvability() {
    for rule in [Nystrom::gauss_legendre(12), Nystrom::adaptive()] {
        // K = 3xy: φ = x, solvable iff ∫ x g = 0
        let none = refusal(|_| 1.0, |x, y| 3.0 * x * y, &rule);
        assert!(none.null.len() == 1 && deviation(&none, |x| x) < 1e-12 && none.smallest < 1e-14);
        // ⟨x, 1⟩/(‖x‖ ‖1‖) = √3/2
        assert!((none.solvability[0].abs() - 0.75f64.sqrt()).abs() < 1e-12 && !none.is_solvable());
        let many = refusal(|x| 2.0 - 3.0 * x, |x, y| 3.0 * x * y, &rule);
        assert!(many.is_solvable() && many.solvability[0].abs() < 1e-14);
    }
    // K = 6xy² is not symmetric: φ = x·…, ψ = y²
    let skew = refusal(|x| x.powi(3), |x, y| 4.0 * x * y * y, &Nystrom::gauss_legendre(10));
    let exact = (1.0 / 6.0) / (0.2f64 * (1.0 / 7.0)).sqrt();
    assert!((skew.solvability[0].abs() - exact).abs() < 1e-12 && deviation(&skew, |x| x) < 1e-12);
}

#[test]
fn more_than_one_null_function() {
    // 2 cos 2π(x − y): cos and sin
    let two = refusal(|_| 1.0, |x, y| 2.0 * (2.0 * PI * (x - y)).cos(), &Nystrom::gauss_legendre(24));
    assert!(two.null.len() == 2 && two.is_solvable(), "{two:?}");
    let none = refusal(|x| (2.0 * PI * x).sin(), |x, y| 2.0 * (2.0 * PI * (x - y)).cos(), &Nystrom::adaptive());
    assert!(none.null.len() == 2 && !none.is_solvable());
}

#[test]
fn kinks() {
    // Green's function times π²: φ = sin πx
    let green = refusal(|_| 1.0, |x, y| PI * PI * (x.min(y) - x * y), &Nystrom::graded(4, 16).levels(0));
    assert!(green.null.len() == 1 && deviation(&green, |x| (PI * x).sin()) < 1e-10, "{:e}", green.smallest);
    assert!((green.solvability[0].abs() - 2f64.sqrt() * 2.0 / PI).abs() < 1e-10);
}
