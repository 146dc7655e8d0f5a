//! Values as `serde` writes them: a number, or a list of components. Text formats have no numbers that are not finite, and JSON writes `null` for them: there
//! they are words, so that moments that overflow (of scores beyond 10⁷⁷) can be read again.

use super::Value;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// One component.
struct Number(f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() || !to.is_human_readable() { to.serialize_f64(self.0) } else { to.collect_str(&self.0) }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        if from.is_human_readable() { from.deserialize_any(Words) } else { f64::deserialize(from).map(Number) }
    }
}

struct Words;

impl Visitor<'_> for Words {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or one of the words inf, -inf, NaN")
    }
    fn visit_f64<E: Error>(self, v: f64) -> Result<Number, E> {
        Ok(Number(v))
    }
    fn visit_u64<E: Error>(self, v: u64) -> Result<Number, E> {
        Ok(Number(v as f64))
    }
    fn visit_i64<E: Error>(self, v: i64) -> Result<Number, E> {
        Ok(Number(v as f64))
    }
    fn visit_str<E: Error>(self, v: &str) -> Result<Number, E> {
        v.parse().map(Number).map_err(|_| E::invalid_value(serde::de::Unexpected::Str(v), &self))
    }
}

pub(crate) fn serialize<V: Value, S: Serializer>(value: &V, to: S) -> Result<S::Ok, S::Error> {
    if V::COMPONENTS == 1 {
        return Number(value.component(0)).serialize(to);
    }
    to.collect_seq((0..V::COMPONENTS).map(|i| Number(value.component(i))))
}

pub(crate) fn deserialize<'de, V: Value, D: Deserializer<'de>>(from: D) -> Result<V, D::Error> {
    let numbers = if V::COMPONENTS == 1 { vec![Number::deserialize(from)?] } else { Vec::deserialize(from)? };
    if numbers.len() != V::COMPONENTS {
        return Err(D::Error::invalid_length(numbers.len(), &format!("{} components", V::COMPONENTS).as_str()));
    }
    Ok(V::from_components(|i| numbers[i].0))
}
