//! The functions and constants of formulas, and the operators exmex evaluates them with.
//!
//! Special functions come from crates that keep full accuracy (`tests/formula.rs` compares them with 20-digit values): `libm` for erf, Γ, J₀, J₁;
//! `puruspe` for I₀, I₁; `ellip` for E(k); [`special`](crate::special) for E₁, E₂, E₃.

use crate::special::{e1, e2, e3};
use exmex::{BinOp, MakeOperators, Operator};
use std::f64::consts;

/// A function of formulas.
pub(super) struct Function {
    /// As users write it.
    pub(super) name: &'static str,
    pub(super) arguments: usize,
    /// As exmex reads it: a prefix, or an infix symbol for two arguments.
    pub(super) text: &'static str,
}

const fn unary(name: &'static str) -> Function {
    Function { name, arguments: 1, text: name }
}

const fn binary(name: &'static str, text: &'static str) -> Function {
    Function { name, arguments: 2, text }
}

/// All functions.
pub(super) const FUNCTIONS: &[Function] = &[
    unary("exp"),
    unary("log"),
    unary("log10"),
    unary("sqrt"),
    unary("abs"),
    unary("sin"),
    unary("cos"),
    unary("tan"),
    unary("asin"),
    unary("acos"),
    unary("atan"),
    unary("sinh"),
    unary("cosh"),
    unary("tanh"),
    unary("erf"),
    unary("gamma"),
    unary("E1"),
    unary("E2"),
    unary("E3"),
    unary("I0"),
    unary("I1"),
    unary("J0"),
    unary("J1"),
    unary("ellipE"),
    unary("heav"),
    binary("mn", "<"),
    binary("min", "<"),
    binary("mx", ">"),
    binary("max", ">"),
];

/// Names that need no definition; parameters of the same name come first.
pub(super) const CONSTANTS: &[(&str, f64)] = &[("pi", consts::PI), ("e", consts::E)];

/// x^p, exactly rounded products where they are cheaper than `powf`.
fn power(x: f64, p: f64) -> f64 {
    if p == 2.0 {
        x * x
    } else if p == 1.0 {
        x
    } else {
        x.powf(p)
    }
}

/// 1 for z > 0, else 0.
fn heaviside(z: f64) -> f64 {
    if z > 0.0 {
        1.0
    } else if z.is_nan() {
        z
    } else {
        0.0
    }
}

/// Smaller of two; NaN if either is, unlike `f64::min`.
fn smaller(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// Larger of two; NaN if either is.
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// E(k) = ∫₀^{π/2} √(1 − k² sin² θ) dθ of the modulus k; NaN for |k| > 1.
fn elliptic(k: f64) -> f64 {
    ellip::ellipe(k * k).unwrap_or(f64::NAN)
}

/// Operators in Python's order of precedence. None is declared commutative: exmex would then regroup constants and change the rounding.
#[derive(Clone, Debug)]
pub(super) struct Python;

impl MakeOperators<f64> for Python {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        let op = |apply, prio| BinOp { apply, prio, is_commutative: false };
        vec![
            Operator::make_bin("<", op(smaller, 4)),
            Operator::make_bin(">", op(larger, 4)),
            Operator::make_bin("^", op(power, 3)),
            Operator::make_bin("*", op(|a, b| a * b, 2)),
            Operator::make_bin("/", op(|a, b| a / b, 2)),
            Operator::make_bin("+", op(|a, b| a + b, 1)),
            Operator::make_bin_unary("-", op(|a, b| a - b, 1), |a: f64| -a),
            Operator::make_unary("exp", f64::exp),
            Operator::make_unary("log", f64::ln),
            Operator::make_unary("log10", f64::log10),
            Operator::make_unary("sqrt", f64::sqrt),
            Operator::make_unary("abs", f64::abs),
            Operator::make_unary("sin", f64::sin),
            Operator::make_unary("cos", f64::cos),
            Operator::make_unary("tan", f64::tan),
            Operator::make_unary("asin", f64::asin),
            Operator::make_unary("acos", f64::acos),
            Operator::make_unary("atan", f64::atan),
            Operator::make_unary("sinh", f64::sinh),
            Operator::make_unary("cosh", f64::cosh),
            Operator::make_unary("tanh", f64::tanh),
            Operator::make_unary("erf", libm::erf),
            Operator::make_unary("gamma", libm::tgamma),
            Operator::make_unary("E1", e1),
            Operator::make_unary("E2", e2),
            Operator::make_unary("E3", e3),
            Operator::make_unary("I0", |z| puruspe::In(0, z)),
            Operator::make_unary("I1", |z| puruspe::In(1, z)),
            Operator::make_unary("J0", libm::j0),
            Operator::make_unary("J1", libm::j1),
            Operator::make_unary("ellipE", elliptic),
            Operator::make_unary("heav", heaviside),
        ]
    }
}
