//! An equation read from text, on one type of domain, with what is known about its solution.

use super::fields::{Fields, formula, kind, malformed, message, number, refuse, within};
use super::functional::KnownFunctional;
use super::translate::Parameters;
use crate::domain::Domain;
use crate::equation::{ClosureEquation, Equation};
use crate::error::Error;
use serde_json::Value;
use std::fmt;
use std::sync::Arc;

/// g, borrowed from a [`Stated`].
pub type SourceText<'a, D> = &'a (dyn Fn(&<D as Domain>::Point) -> f64 + Send + Sync);
/// K, borrowed from a [`Stated`].
pub type KernelText<'a, D> = &'a (dyn Fn(&<D as Domain>::Point, &<D as Domain>::Point) -> f64 + Send + Sync);
/// What text becomes: an equation like one of closures, walked by the domain's own density until it gets another proposal.
pub type TextEquation<'a, D> = ClosureEquation<D, f64, f64, SourceText<'a, D>, KernelText<'a, D>>;

/// A formula of one point.
pub(super) type Unary<D> = Arc<dyn Fn(&<D as Domain>::Point) -> f64 + Send + Sync>;
/// A formula of two points.
pub(super) type Binary<D> = Arc<dyn Fn(&<D as Domain>::Point, &<D as Domain>::Point) -> f64 + Send + Sync>;

/// A point, and f there if the file knows it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Known<X> {
    /// x.
    pub point: X,
    /// How the file writes it.
    pub label: String,
    /// f(x).
    pub value: Option<f64>,
}

/// An equation with the questions its file asks.
#[derive(Clone)]
#[non_exhaustive]
pub struct Stated<D: Domain> {
    /// Where the file wants f; three points inside the domain if it does not say.
    pub points: Vec<Known<D::Point>>,
    /// Integrals of f.
    pub functionals: Vec<KnownFunctional<D>>,
    domain: D,
    source: Unary<D>,
    kernel: Binary<D>,
}

impl<D: Domain> fmt::Debug for Stated<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stated")
            .field("domain", &self.domain)
            .field("points", &self.points)
            .field("functionals", &self.functionals)
            .finish_non_exhaustive()
    }
}

impl<D: Domain> Stated<D> {
    /// The equation. Each call gives a new one, so that each may get its own proposal.
    pub fn equation(&self) -> TextEquation<'_, D> {
        Equation::on_domain(self.domain.clone(), &*self.source, &*self.kernel)
    }

    /// The same equation on `domain`, another description of Ω: one type for several domains, so that what is compiled for each is compiled once.
    pub fn on<E: Domain<Point = D::Point>>(&self, domain: E) -> Stated<E> {
        let known = |k: &Known<D::Point>| Known { point: k.point, label: k.label.clone(), value: k.value };
        Stated {
            points: self.points.iter().map(known).collect(),
            functionals: self.functionals.iter().map(|f| f.on(domain.clone())).collect(),
            domain,
            source: self.source.clone(),
            kernel: self.kernel.clone(),
        }
    }

    /// Ω.
    pub fn domain(&self) -> &D {
        &self.domain
    }

    /// g(x).
    pub fn source(&self, x: &D::Point) -> f64 {
        (self.source)(x)
    }

    /// K as a closure.
    pub(super) fn kernel_text(&self) -> KernelText<'_, D> {
        &*self.kernel
    }

    /// K(x, y).
    pub fn kernel(&self, x: &D::Point, y: &D::Point) -> f64 {
        (self.kernel)(x, y)
    }
}

/// How the formulas and points of one kind of domain are read.
pub(super) struct Reader<'a, D: Domain> {
    pub(super) domain: D,
    pub(super) parameters: &'a Parameters,
    pub(super) kernel: Binary<D>,
    /// one formula, or a list of one for each component
    pub(super) function: Box<dyn Fn(&Value) -> Result<Unary<D>, Error> + 'a>,
    /// the states at one entry of `points`, with their labels
    pub(super) place: Box<dyn Fn(&Value) -> Result<Vec<(D::Point, String)>, Error> + 'a>,
}

impl<D: Domain> Reader<'_, D> {
    /// Reads source, points, values and functionals; also why functionals were left out.
    pub(super) fn read(&self, fields: &Fields) -> Result<(Stated<D>, Vec<String>), Error> {
        self.domain.validate()?;
        let source = (self.function)(fields.required("source")?).map_err(|e| within("source", e))?;
        let mut skipped = Vec::new();
        let mut functionals = Vec::new();
        for entry in fields.list("functionals")? {
            match self.functional(entry) {
                Ok(f) => functionals.push(f),
                Err((label, why)) => skipped.push(format!("functional `{label}`: {why}")),
            }
        }
        let (domain, kernel) = (self.domain.clone(), self.kernel.clone());
        Ok((Stated { points: self.points(fields)?, functionals, domain, source, kernel }, skipped))
    }

    fn points(&self, fields: &Fields) -> Result<Vec<Known<D::Point>>, Error> {
        let (points, values) = (fields.list("points")?, fields.list("values")?);
        if points.is_empty() {
            return Ok(self.inside());
        }
        if !values.is_empty() && values.len() != points.len() {
            return malformed(format!("{} points, but {} values", points.len(), values.len()));
        }
        let mut known = Vec::new();
        for (i, point) in points.iter().enumerate() {
            let places = (self.place)(point).map_err(|e| within(&format!("points[{i}]"), e))?;
            if let Some((_, label)) = places.iter().find(|(p, _)| !self.domain.contains(p)) {
                return refuse(format!("points[{i}]: {label} lies outside the domain"));
            }
            let values = self.values(values.get(i), places.len(), i)?;
            known.extend(places.into_iter().zip(values).map(|((point, label), value)| Known { point, label, value }));
        }
        Ok(known)
    }

    fn values(&self, value: Option<&Value>, count: usize, i: usize) -> Result<Vec<Option<f64>>, Error> {
        let what = format!("values[{i}]");
        match value {
            None => Ok(vec![None; count]),
            Some(Value::Array(list)) if list.len() == count => list.iter().map(|v| number(v, &what, self.parameters).map(Some)).collect(),
            Some(Value::Array(list)) => malformed(format!("{what} has {} numbers where {count} are needed", list.len())),
            Some(one) if count == 1 => Ok(vec![Some(number(one, &what, self.parameters)?)]),
            Some(other) => malformed(format!("{what} is {}, not a list of {count} numbers", kind(other))),
        }
    }

    /// Quarter, middle and three quarters of every coordinate, for every state.
    fn inside(&self) -> Vec<Known<D::Point>> {
        let states = (0..self.domain.states()).flat_map(|s| [0.25, 0.5, 0.75].map(|t| self.domain.place(s, || t).point));
        states.map(|point| Known { point, label: format!("{point:?}"), value: None }).collect()
    }

    fn functional(&self, entry: &Value) -> Result<KnownFunctional<D>, (String, String)> {
        let Value::Object(f) = entry else { return Err((entry.to_string(), format!("it is {}, not an object", kind(entry)))) };
        let label = f.get("h").or(f.get("name")).map_or("?".into(), |h| h.as_str().map_or_else(|| h.to_string(), String::from));
        let read = || -> Result<KnownFunctional<D>, Error> {
            let scale = f.get("scale").map_or(Ok(1.0), |s| number(s, "scale", self.parameters))?;
            let Some(h) = f.get("py").or(f.get("h")) else { return refuse("it has neither `h` nor `py`") };
            let weight = (self.function)(h)?;
            let weight: Unary<D> = if scale == 1.0 { weight } else { Arc::new(move |x| scale * weight(x)) };
            let value = f.get("value").map(|v| number(v, "value", self.parameters)).transpose()?;
            Ok(KnownFunctional { label: label.clone(), value, domain: self.domain.clone(), weight })
        };
        read().map_err(|e| (label.clone(), format!("not of the form ∫ h f: {}", message(&e))))
    }
}

/// The formulas of a list of `count`, or of a text with `;` between them.
pub(super) fn components(value: &Value, count: usize) -> Result<Vec<String>, Error> {
    let list: Vec<String> = match value {
        Value::Array(list) => list.iter().map(|v| formula(v, "a component")).collect::<Result<_, _>>()?,
        other => formula(other, "a list of components")?.split(';').map(|s| s.trim().to_string()).collect(),
    };
    if list.len() == count { Ok(list) } else { malformed(format!("{} components where {count} are needed", list.len())) }
}
