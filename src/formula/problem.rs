//! A file, and the equation it states.

use super::boxes::{boxed, in_space};
use super::fields::{Fields, malformed, refuse};
use super::line::{scalar, surfaces, system};
use super::region::{Region, region};
use super::stated::Stated;
use crate::domain::{Cuboid, Disk, Domain, Grouped, HalfLine, Interval, Line};
use crate::error::Error;
use std::path::Path;

/// An equation read from text.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Problem {
    /// Field `name`, else the name of the file.
    pub name: String,
    /// Field `class`: what makes the problem hard, in a word.
    pub class: Option<String>,
    /// Field `digits`: how many significant digits of the known values can be trusted.
    pub digits: Option<u32>,
    /// The equation.
    pub statement: Statement,
    /// Functionals of the file that are not of the form ∫ h f, each with the reason.
    pub skipped: Vec<String>,
}

/// The equation, by type of domain.
// one statement a file: its size does not matter
#[expect(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Statement {
    /// On [a, b].
    Interval(Stated<Interval>),
    /// On [a, ∞).
    HalfLine(Stated<HalfLine>),
    /// On (−∞, ∞).
    Line(Stated<Line>),
    /// On a disk.
    Disk(Stated<Disk>),
    /// A system on [a, b] as one equation on points (x, i).
    System(Stated<Grouped<Interval>>),
    /// On a box of two dimensions.
    Box2(Stated<Cuboid<2>>),
    /// On a box of three dimensions.
    Box3(Stated<Cuboid<3>>),
    /// On a box of up to 8 dimensions; coordinates that the equation does not have run over [0, 1] and occur nowhere.
    Box8(Stated<Cuboid<8>>),
    /// On a box of up to 64 dimensions.
    Box64(Stated<Cuboid<64>>),
}

/// What to do with an equation on any domain.
pub trait Visitor {
    /// Its result.
    type Output;

    /// Called with the equation on its domain.
    fn visit<D: Domain>(&mut self, stated: &Stated<D>) -> Self::Output;
}

impl Statement {
    /// Calls `visitor` with the equation, whatever its domain.
    ///
    /// ```
    /// use fredholm::{domain::Domain, formula::{Problem, Stated, Visitor}};
    /// struct Sources;
    /// impl Visitor for Sources {
    ///     type Output = Vec<f64>;
    ///     fn visit<D: Domain>(&mut self, s: &Stated<D>) -> Vec<f64> {
    ///         s.points.iter().map(|k| s.source(&k.point)).collect()
    ///     }
    /// }
    /// let text = r#"{"domain": "[0,1]^2", "kernel": "0.5*exp(-t)", "source": "x1 + 2*x2", "points": [[1, 1], [0, 0.5]]}"#;
    /// assert_eq!(Problem::parse(text)?.statement.visit(&mut Sources), [3.0, 1.0]);
    /// # Ok::<(), fredholm::Error>(())
    /// ```
    pub fn visit<V: Visitor>(&self, visitor: &mut V) -> V::Output {
        match self {
            Statement::Interval(s) => visitor.visit(s),
            Statement::HalfLine(s) => visitor.visit(s),
            Statement::Line(s) => visitor.visit(s),
            Statement::Disk(s) => visitor.visit(s),
            Statement::System(s) => visitor.visit(s),
            Statement::Box2(s) => visitor.visit(s),
            Statement::Box3(s) => visitor.visit(s),
            Statement::Box8(s) => visitor.visit(s),
            Statement::Box64(s) => visitor.visit(s),
        }
    }
}

impl Problem {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read; [`Error::Malformed`] if it is no equation file; [`Error::Formula`] if this crate cannot state its
    /// equation.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|e| Error::Io { path: path.display().to_string(), message: e.to_string() })?;
        Self::named(&text, path.file_stem().map_or_else(|| "equation".into(), |s| s.to_string_lossy().into_owned()))
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`Error::Malformed`] and [`Error::Formula`], as for [`read`](Problem::read).
    pub fn parse(text: &str) -> Result<Self, Error> {
        Self::named(text, "equation".into())
    }

    fn named(text: &str, name: String) -> Result<Self, Error> {
        let fields = Fields::parse(text)?;
        let name = fields.text("name")?.unwrap_or(name);
        let class = fields.text("class")?;
        let digits = match fields.optional("digits") {
            None => None,
            Some(v) => match v.as_u64().and_then(|d| u32::try_from(d).ok()) {
                Some(d) if d > 0 => Some(d),
                _ => return malformed(format!("field `digits` is {v}, not a positive whole number")),
            },
        };
        let (statement, skipped) = state(&fields)?;
        Ok(Problem { name, class, digits, statement, skipped })
    }
}

fn state(fields: &Fields) -> Result<(Statement, Vec<String>), Error> {
    let Some(domain) = fields.text("domain")? else { return malformed("field `domain` is missing") };
    for field in ["kernel", "source"] {
        let words = fields.required(field)?.as_str().unwrap_or_default();
        if words.contains("eigenproblem") {
            return refuse("an eigenproblem has no source: it is not an equation of the second kind, but an `Eigenproblem`");
        }
        if words.starts_with("see ") {
            return refuse(format!("the {field} is given in words: `{words}`"));
        }
    }
    let p = &fields.parameters()?;
    Ok(match region(&domain, p)? {
        Region::Interval(a, b) => with(scalar(fields, p, Interval::from(a..=b))?, Statement::Interval),
        Region::HalfLine(a) => with(scalar(fields, p, HalfLine::new(a))?, Statement::HalfLine),
        Region::Line => with(scalar(fields, p, Line::new())?, Statement::Line),
        Region::Disk => with(in_space(fields, p, Disk::unit(), 2)?, Statement::Disk),
        Region::System(a, b, n) => with(system(fields, p, Interval::from(a..=b), n)?, Statement::System),
        Region::Surfaces => with(surfaces(fields, p)?, Statement::System),
        Region::Box(sides) => match sides.len() {
            0..=2 => with(boxed(fields, p, &sides)?, Statement::Box2),
            3 => with(boxed(fields, p, &sides)?, Statement::Box3),
            4..=8 => with(boxed(fields, p, &sides)?, Statement::Box8),
            _ => with(boxed(fields, p, &sides)?, Statement::Box64),
        },
    })
}

fn with<S>((stated, skipped): (S, Vec<String>), variant: impl FnOnce(S) -> Statement) -> (Statement, Vec<String>) {
    (variant(stated), skipped)
}
