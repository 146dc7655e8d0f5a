//! Whether g has an integral, as far as values tell: f − g = T f does not make up for it.
//!
//! Where g ~ |x − c|^{−α}, its integral over distances [r, 2r] falls to 2^{α−1} of itself when r is halved, and there is none from α = 1 on.

use super::class::Diagonal;
use super::ends::is_end;
use super::side::Side;
use crate::domain::Domain;
use crate::equation::Equation;
use crate::error::Error;
use crate::kernel::{HasDomain, Operator};
use crate::source::Source;
use crate::value::{Value, Weight};

/// Distances: so far from the place, and halved so often.
const NEAR: f64 = 1.0 / 64.0;
const HALVINGS: i32 = 34;
/// Distances that rounding of points changes by more than this share tell nothing.
const KEPT: f64 = 1e-3;

/// Refuses a g that has no integral at one of the coordinates `places`: where it jumps or is singular, and the ends of a line.
pub(super) fn source<G, K>(equation: &Equation<G, K>, places: &[f64]) -> Result<(), Error>
where
    G: Source,
    K: HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    let domain = equation.kernel().domain();
    let rough = places.iter().filter(|t| (0.0 < **t && **t < 1.0) || is_end(domain, **t));
    for (t, state) in rough.flat_map(|t| (0..domain.states()).map(move |s| (*t, s))) {
        for (sign, e) in [-1.0, 1.0].into_iter().flat_map(|sign| (0..G::Value::COMPONENTS).map(move |e| (sign, e))) {
            if let Side::Singular(Diagonal::NotIntegrable { exponent }) = side(equation, t, state, sign, e) {
                let at = format!("{:?}", domain.place(state, || t).point);
                return Err(Error::SourceNotIntegrable { at, ratio: (exponent - 1.0).exp2() });
            }
        }
    }
    Ok(())
}

/// Component `e` of g towards coordinate `t` from one side.
fn side<G, K>(equation: &Equation<G, K>, t: f64, state: usize, sign: f64, e: usize) -> Side
where
    G: Source,
    K: HasDomain + Operator<Point = G::Point>,
    K::Weight: Weight<Value = G::Value>,
{
    let domain = equation.kernel().domain();
    let at = domain.place(state, || t).point;
    let room = NEAR.min(0.9 * if sign > 0.0 { 1.0 - t } else { t });
    let (mut distances, mut values) = (Vec::new(), Vec::new());
    for d in (0..HALVINGS).map(|k| room * 0.5f64.powi(k)) {
        let x = domain.displaced(&at, state, sign * d).point;
        let r = sign * domain.separation(&at, &x);
        let g = equation.source().eval(&x).component(e);
        if !((r - d).abs() <= KEPT * d && d > 0.0 && g.is_finite()) {
            break;
        }
        distances.push(r);
        values.push(g);
    }
    Side::of(&distances, &values)
}
