//! Equations and systems on an interval or a half line, and finite linear systems.

use super::expression::Expression;
use super::fields::{Fields, formula, list, malformed, number, refuse, within};
use super::product::split_top_level;
use super::stated::{Binary, Reader, Stated, Unary, components};
use super::translate::Parameters;
use crate::domain::{Domain, Grouped, Interval};
use crate::error::Error;
use serde_json::Value;
use std::sync::Arc;

type Read<D> = Result<(Stated<D>, Vec<String>), Error>;

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(|s| (*s).to_string()).collect()
}

fn in_kernel(e: Error) -> Error {
    within("kernel", e)
}

/// K(x, y) and g(x) on a one-dimensional domain.
pub(super) fn scalar<D: Domain<Point = f64>>(fields: &Fields, parameters: &Parameters, domain: D) -> Read<D> {
    let text = formula(fields.required("kernel")?, "field `kernel`")?;
    let kernel = Expression::<3>::parse(&text, &names(&["x", "y", "t"]), parameters).map_err(in_kernel)?;
    let kernel: Binary<D> = Arc::new(move |&x, &y| kernel.eval(&[x, y, (x - y).abs()]));
    let function = |value: &Value| -> Result<Unary<D>, Error> {
        let h = Expression::<1>::parse(&formula(value, "it")?, &names(&["x"]), parameters)?;
        Ok(Arc::new(move |&x| h.eval(&[x])))
    };
    let place = |value: &Value| {
        let x = number(value, "it", parameters)?;
        Ok(vec![(x, x.to_string())])
    };
    Reader { domain, parameters, kernel, function: Box::new(function), place: Box::new(place) }.read(fields)
}

/// f_i(x) = g_i(x) + Σ_j ∫ K_ij(x, y) f_j(y) dy as one scalar equation on points (x, i).
pub(super) fn system(fields: &Fields, parameters: &Parameters, interval: Interval, count: usize) -> Read<Grouped<Interval>> {
    let rows = list(fields.required("kernel")?, "field `kernel`")?;
    if rows.len() != count {
        return malformed(format!("kernel: {} rows where {count} are needed", rows.len()));
    }
    let mut entries = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let row = list(row, "a row").and_then(|r| components(&Value::Array(r), count));
        let row = row.map_err(|e| within(&format!("kernel row {}", i + 1), e))?;
        for text in row {
            entries.push(Expression::<3>::parse(&text, &names(&["x", "y", "t"]), parameters).map_err(in_kernel)?);
        }
    }
    let kernel: Binary<Grouped<Interval>> = Arc::new(move |&(x, i), &(y, j)| entries[i * count + j].eval(&[x, y, (x - y).abs()]));
    let place = move |value: &Value| {
        let x = number(value, "it", parameters)?;
        Ok((0..count).map(|i| ((x, i), format!("{x}, component {}", i + 1))).collect())
    };
    grouped(fields, parameters, Grouped::new(interval, count), kernel, Box::new(place))
}

type Place<'a> = Box<dyn Fn(&Value) -> Result<Vec<((f64, usize), String)>, Error> + 'a>;

fn grouped<'a>(
    fields: &Fields,
    parameters: &'a Parameters,
    domain: Grouped<Interval>,
    kernel: Binary<Grouped<Interval>>,
    place: Place<'a>,
) -> Read<Grouped<Interval>> {
    let count = domain.groups();
    let function = move |value: &Value| -> Result<Unary<Grouped<Interval>>, Error> {
        let texts = components(&list(value, "it").map_or_else(|_| value.clone(), Value::Array), count)?;
        let parse = |text: &String| Expression::<1>::parse(text, &names(&["x"]), parameters);
        let parts = texts.iter().map(parse).collect::<Result<Vec<_>, _>>()?;
        Ok(Arc::new(move |&(x, i)| parts[i].eval(&[x])))
    };
    Reader { domain, parameters, kernel, function: Box::new(function), place }.read(fields)
}

/// B_i = E_i + ρ_i Σ_j F_ij B_j: constant functions on a unit interval, so that ∫₀¹ turns the sum into a Fredholm equation.
pub(super) fn surfaces(fields: &Fields, parameters: &Parameters) -> Read<Grouped<Interval>> {
    let text = formula(fields.required("kernel")?, "field `kernel`")?;
    let definition = |name: &str| -> Result<Vec<Value>, Error> {
        let piece = split_top_level(&text).into_iter().find_map(|p| p.split_once('=').filter(|(n, _)| n.trim() == name));
        let Some((_, body)) = piece else { return refuse(format!("kernel: `{name}=[…]` is missing in `{text}`")) };
        list(&Value::String(body.trim().into()), &format!("kernel: `{name}`"))
    };
    let reflectivity = definition("rho")?;
    let factors = definition("F")?;
    let count = reflectivity.len();
    if count == 0 || factors.len() != count {
        return malformed(format!("kernel: F has {} rows for {count} reflectivities", factors.len()));
    }
    let mut entries = Vec::new();
    for (rho, row) in reflectivity.iter().zip(&factors) {
        let rho = number(rho, "kernel: rho", parameters)?;
        let row = components(row, count).map_err(in_kernel)?;
        for factor in row {
            entries.push(rho * number(&Value::String(factor), "kernel: F", parameters)?);
        }
    }
    let kernel: Binary<Grouped<Interval>> = Arc::new(move |&(_, i), &(_, j)| entries[i * count + j]);
    let (points, values) = (fields.list("points")?, fields.list("values")?);
    if points.len().max(values.len()) > count {
        return malformed(format!("{} points and {} values for {count} surfaces", points.len(), values.len()));
    }
    // points are names of the surfaces, in order
    let place = move |value: &Value| match points.iter().position(|p| p == value) {
        Some(i) => Ok(vec![((0.5, i), value.as_str().map_or_else(|| value.to_string(), String::from))]),
        None => refuse(format!("{value} is no surface")),
    };
    grouped(fields, parameters, Grouped::new(Interval::from(0.0..=1.0), count), kernel, Box::new(place))
}
