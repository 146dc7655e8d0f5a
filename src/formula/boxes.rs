//! Equations on boxes [a₁, b₁] × … × [a_d, b_d], and on disks.
//!
//! Points have D coordinates known at compile time, of which the first d ≤ D belong to the equation; the others run over [0, 1] and occur nowhere,
//! which leaves every integral as it is.

use super::expression::Expression;
use super::fields::{Fields, formula, kind, malformed, number, within};
use super::product::Product;
use super::region::MOST_COORDINATES;
use super::stated::{Binary, Reader, Stated, Unary};
use super::translate::Parameters;
use crate::domain::{Cuboid, Domain};
use crate::error::Error;
use serde_json::Value;
use std::sync::Arc;

/// x, y and t of the largest box.
const VARIABLES: usize = 2 * MOST_COORDINATES + 1;
/// x, y and t in up to three dimensions.
const FEW: usize = 7;

/// The equation on the box with these sides.
pub(super) fn boxed<const D: usize>(
    fields: &Fields,
    parameters: &Parameters,
    sides: &[(f64, f64)],
) -> Result<(Stated<Cuboid<D>>, Vec<String>), Error> {
    let domain = Cuboid::from(std::array::from_fn(|i| sides.get(i).map_or(0.0..=1.0, |&(a, b)| a..=b)));
    in_space(fields, parameters, domain, sides.len())
}

/// The equation on a domain of points of D coordinates, of which the first `d` occur.
pub(super) fn in_space<const D: usize, M: Domain<Point = [f64; D]>>(
    fields: &Fields,
    parameters: &Parameters,
    domain: M,
    d: usize,
) -> Result<(Stated<M>, Vec<String>), Error> {
    // the distance, as people write it
    let text = formula(fields.required("kernel")?, "field `kernel`")?.replace("|x-y|", "t");
    let kernel = kernel::<D>(&text, d, parameters).map_err(|e| within("kernel", e))?;
    let function = move |value: &Value| source::<D>(&formula(value, "it")?, d, parameters);
    let place = move |value: &Value| {
        let Value::Array(list) = value else { return malformed(format!("it is {}, not a list of {d} coordinates", kind(value))) };
        if list.len() != d {
            return malformed(format!("{} coordinates where {d} are needed", list.len()));
        }
        let mut x = [0.5; D];
        for (x, value) in x.iter_mut().zip(list) {
            *x = number(value, "a coordinate", parameters)?;
        }
        Ok(vec![(x, format!("{:?}", &x[..d]))])
    };
    Reader { domain, parameters, kernel, function: Box::new(function), place: Box::new(place) }.read(fields)
}

fn names(letter: char, d: usize) -> impl Iterator<Item = String> {
    (1..=d).map(move |i| format!("{letter}{i}"))
}

fn kernel<const D: usize>(text: &str, d: usize, parameters: &Parameters) -> Result<Binary<Cuboid<D>>, Error> {
    if Product::occurs_in(text) {
        let product = Product::parse(text, "x_i,y_i", parameters)?;
        return Ok(Arc::new(move |x, y| product.eval(x[..d].iter().copied().zip(y[..d].iter().copied()))));
    }
    let variables: Vec<String> = names('x', d).chain(names('y', d)).chain(["t".to_string()]).collect();
    if variables.len() <= FEW {
        general::<D, FEW>(text, d, &variables, parameters)
    } else {
        general::<D, VARIABLES>(text, d, &variables, parameters)
    }
}

fn general<const D: usize, const N: usize>(
    text: &str,
    d: usize,
    variables: &[String],
    parameters: &Parameters,
) -> Result<Binary<Cuboid<D>>, Error> {
    let k = Expression::<N>::parse(text, variables, parameters)?;
    let needs_distance = k.uses(2 * d);
    Ok(Arc::new(move |x, y| {
        let mut arguments = [0.0; N];
        arguments[..d].copy_from_slice(&x[..d]);
        arguments[d..2 * d].copy_from_slice(&y[..d]);
        if needs_distance {
            arguments[2 * d] = x[..d].iter().zip(&y[..d]).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
        }
        k.eval(&arguments)
    }))
}

fn source<const D: usize>(text: &str, d: usize, parameters: &Parameters) -> Result<Unary<Cuboid<D>>, Error> {
    if Product::occurs_in(text) {
        let product = Product::parse(text, "x_i", parameters)?;
        return Ok(Arc::new(move |x| product.eval(x[..d].iter().map(|&x| (x, 0.0)))));
    }
    let h = Expression::<MOST_COORDINATES>::parse(text, &names('x', d).collect::<Vec<_>>(), parameters)?;
    Ok(Arc::new(move |x| {
        let mut arguments = [0.0; MOST_COORDINATES];
        arguments[..d].copy_from_slice(&x[..d]);
        h.eval(&arguments)
    }))
}
