//! Reading JSON with errors that name the field.

use super::expression::constant;
use super::translate::Parameters;
use crate::error::Error;
use serde_json::{Map, Value};

pub(super) fn refuse<T>(message: impl Into<String>) -> Result<T, Error> {
    Err(Error::Formula(message.into()))
}

pub(super) fn malformed<T>(message: impl Into<String>) -> Result<T, Error> {
    Err(Error::Malformed(message.into()))
}

/// The same error, with the place where it happened before the message.
pub(super) fn within(place: &str, e: Error) -> Error {
    match e {
        Error::Malformed(message) => Error::Malformed(format!("{place}: {message}")),
        other => Error::Formula(format!("{place}: {}", message(&other))),
    }
}

/// The fields of an equation file.
pub(super) struct Fields(Map<String, Value>);

impl Fields {
    pub(super) fn parse(text: &str) -> Result<Self, Error> {
        match serde_json::from_str(text) {
            Ok(Value::Object(map)) => Ok(Fields(map)),
            Ok(other) => malformed(format!("the file holds {}, not an object `{{…}}` of fields", kind(&other))),
            Err(e) => malformed(format!("not JSON: {e}")),
        }
    }

    pub(super) fn required(&self, field: &str) -> Result<&Value, Error> {
        match self.optional(field) {
            Some(value) => Ok(value),
            None => malformed(format!("field `{field}` is missing")),
        }
    }

    /// A field that is there and not null.
    pub(super) fn optional(&self, field: &str) -> Option<&Value> {
        self.0.get(field).filter(|v| !v.is_null())
    }

    /// The same fields but for one.
    pub(super) fn with(mut self, field: &str, value: Value) -> Self {
        self.0.insert(field.into(), value);
        self
    }

    pub(super) fn text(&self, field: &str) -> Result<Option<String>, Error> {
        match self.optional(field) {
            None => Ok(None),
            Some(Value::String(s)) => Ok(Some(s.clone())),
            Some(other) => malformed(format!("field `{field}` is {}, not a text", kind(other))),
        }
    }

    /// A list; empty if the field is missing.
    pub(super) fn list(&self, field: &str) -> Result<&[Value], Error> {
        match self.optional(field) {
            None => Ok(&[]),
            Some(Value::Array(list)) => Ok(list),
            Some(other) => malformed(format!("field `{field}` is {}, not a list", kind(other))),
        }
    }

    /// Numbers by name; texts are formulas of the other parameters, in any order.
    pub(super) fn parameters(&self) -> Result<Parameters, Error> {
        let map = match self.optional("parameters") {
            None => return Ok(Parameters::new()),
            Some(Value::Object(map)) => map,
            Some(other) => return malformed(format!("field `parameters` is {}, not an object of names and numbers", kind(other))),
        };
        let mut parameters = Parameters::new();
        for (name, value) in map {
            let number = match value {
                Value::Number(n) => n.as_f64().filter(|v| v.is_finite()).ok_or_else(|| format!("{n} is too large")),
                Value::String(_) => Err("it refers to itself".into()),
                other => Err(format!("it is {}", kind(other))),
            };
            parameters.insert(name.clone(), number);
        }
        let mut open: Vec<(&String, &String)> = map.iter().filter_map(|(n, v)| Some((n, string(v)?))).collect();
        // one pass a level of dependence; a parameter that stays open is an error only where a formula uses it
        loop {
            let before = open.len();
            let mut solved = Vec::new();
            for (name, formula) in &open {
                match constant(formula, &parameters) {
                    Ok(value) => solved.push(((*name).clone(), Ok(value))),
                    Err(e) => solved.push(((*name).clone(), Err(message(&e)))),
                }
            }
            parameters.extend(solved);
            open.retain(|(name, _)| parameters[*name].is_err());
            if open.len() == before || open.is_empty() {
                return Ok(parameters);
            }
        }
    }
}

fn string(value: &Value) -> Option<&String> {
    if let Value::String(s) = value { Some(s) } else { None }
}

/// The message of an error without the words all formula errors start with.
pub(super) fn message(e: &Error) -> String {
    match e {
        Error::Formula(message) | Error::Malformed(message) => message.clone(),
        other => other.to_string(),
    }
}

/// A formula: a text or a number.
pub(super) fn formula(value: &Value, what: &str) -> Result<String, Error> {
    match value {
        Value::String(s) => Ok(s.clone()),
        Value::Number(n) => Ok(n.to_string()),
        other => malformed(format!("{what} is {}, not a formula", kind(other))),
    }
}

/// A number, given as such or as a formula of the parameters.
pub(super) fn number(value: &Value, what: &str, parameters: &Parameters) -> Result<f64, Error> {
    constant(&formula(value, what)?, parameters).map_err(|e| within(what, e))
}

/// A list written in JSON, or as a text in Python's way with single quotes.
pub(super) fn list(value: &Value, what: &str) -> Result<Vec<Value>, Error> {
    let parsed = match value {
        Value::String(s) => serde_json::from_str(&s.replace('\'', "\"")).unwrap_or(Value::Null),
        other => other.clone(),
    };
    match parsed {
        Value::Array(list) => Ok(list),
        _ => malformed(format!("{what} is {}, not a list", kind(value))),
    }
}

pub(super) fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}
