//! The domain of an equation as text.
//!
//! | text | domain |
//! |---|---|
//! | `[0, 1]`, `[-pi, pi]`, `[0, 2*a]` | interval; the ends are formulas |
//! | `[0, infinity)`, `(-infinity, infinity)` | half line, whole line |
//! | `unit disk` | disk around 0 with radius 1 |
//! | `[0,1]^3`, `[0,1]^d`, `[0,1] x [0,2]` | box |
//! | `[0, 2] x {1..4}` | interval × components: a system |
//! | `surfaces` | components alone: a finite linear system |
//! | `… z in [-1,1] …` | words around exactly one interval |

use super::expression::constant;
use super::fields::message;
use super::translate::Parameters;
use crate::error::Error;

/// A domain that can be stated.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Region {
    Interval(f64, f64),
    HalfLine(f64),
    Line,
    Disk,
    Box(Vec<(f64, f64)>),
    System(f64, f64, usize),
    Surfaces,
}

/// Most coordinates of a box.
pub(super) const MOST_COORDINATES: usize = 64;
/// Most components of a system.
const MOST_COMPONENTS: f64 = 256.0;

#[derive(Clone, Copy)]
enum Factor {
    Finite(f64, f64),
    HalfLine(f64),
    Components(usize),
}

/// Reads a domain.
pub(super) fn region(text: &str, parameters: &Parameters) -> Result<Region, Error> {
    let refuse = |why: &str| Error::Formula(format!("domain `{text}`: {why}"));
    let trimmed = text.trim();
    if trimmed == "surfaces" {
        return Ok(Region::Surfaces);
    }
    if trimmed == "unit disk" {
        return Ok(Region::Disk);
    }
    if let Some((lower, upper)) = trimmed.trim_matches(['(', ')', '[', ']']).split_once(',')
        && lower.trim().strip_prefix(['-', '−']).is_some_and(is_infinity)
        && is_infinity(upper)
    {
        return Ok(Region::Line);
    }
    if !trimmed.starts_with(['[', '(']) {
        let Some((_, described)) = trimmed.split_once(" in [").filter(|_| trimmed.matches('[').count() == 1) else {
            return Err(refuse("neither an interval, a half line, a box nor a system on an interval"));
        };
        let bracket = &trimmed[trimmed.len() - described.len() - 1..];
        return match factor(bracket, parameters).map_err(|why| refuse(&why))?.0 {
            Factor::Finite(a, b) => Ok(Region::Interval(a, b)),
            _ => Err(refuse("only an interval may be given in words")),
        };
    }
    let mut factors = Vec::new();
    let mut rest = trimmed;
    loop {
        let (f, power, length) = factor(rest, parameters).map_err(|why| refuse(&why))?;
        if factors.len() + power > MOST_COORDINATES + 1 {
            return Err(refuse(&format!("more than {MOST_COORDINATES} coordinates")));
        }
        let boxed = power > 1 || rest[..length].contains('^');
        factors.extend(std::iter::repeat_n((f, boxed), power));
        rest = rest[length..].trim_start();
        match rest.strip_prefix(['x', '×']) {
            _ if rest.is_empty() => break,
            Some(more) => rest = more.trim_start(),
            None => return Err(refuse(&format!("`{rest}` is neither `x` nor the end"))),
        }
    }
    assemble(&factors).map_err(|why| refuse(&why))
}

fn assemble(factors: &[(Factor, bool)]) -> Result<Region, String> {
    match factors {
        [(Factor::Finite(a, b), false)] => return Ok(Region::Interval(*a, *b)),
        [(Factor::HalfLine(a), false)] => return Ok(Region::HalfLine(*a)),
        [(Factor::Finite(a, b), false), (Factor::Components(n), _)] => return Ok(Region::System(*a, *b, *n)),
        _ => {}
    }
    let sides = factors.iter().map(|(f, _)| match f {
        Factor::Finite(a, b) => Ok((*a, *b)),
        Factor::HalfLine(_) => Err("a half line times something else cannot be stated".to_string()),
        Factor::Components(_) => Err("components need exactly one interval before them".to_string()),
    });
    let sides = sides.collect::<Result<Vec<_>, _>>()?;
    if sides.len() > MOST_COORDINATES {
        return Err(format!("{} coordinates, more than {MOST_COORDINATES}", sides.len()));
    }
    Ok(Region::Box(sides))
}

/// One `[a, b]`, `[a, infinity)` or `{1..n}` with an optional `^power`; also its power and its length in bytes.
fn factor(text: &str, parameters: &Parameters) -> Result<(Factor, usize, usize), String> {
    if text.starts_with('{') {
        let close = text.find('}').ok_or("`{` is never closed")?;
        return Ok((Factor::Components(components(&text[1..close], parameters)?), 1, close + 1));
    }
    let (comma, close) = bracket(text)?;
    let end = |text: &str| constant(text, parameters).map_err(|e| message(&e));
    let lower = end(&text[1..comma])?;
    let infinite = is_infinity(&text[comma + 1..close]);
    let f = if infinite { Factor::HalfLine(lower) } else { Factor::Finite(lower, end(&text[comma + 1..close])?) };
    match f {
        Factor::Finite(a, b) if b <= a => return Err(format!("the interval from {a} to {b} is empty or reversed")),
        _ => {}
    }
    let after = &text[close + 1..];
    let Some(power) = after.strip_prefix('^') else { return Ok((f, 1, close + 1)) };
    let length = power.find(|c: char| !c.is_alphanumeric()).unwrap_or(power.len());
    let count = whole(&power[..length], "the power", MOST_COORDINATES as f64, parameters)?;
    Ok((f, count, close + 2 + length))
}

fn is_infinity(text: &str) -> bool {
    matches!(text.trim(), "infinity" | "inf" | "oo" | "∞")
}

/// Places of the comma and of the closing bracket of `[a, b]`.
fn bracket(text: &str) -> Result<(usize, usize), String> {
    if !text.starts_with(['[', '(']) {
        return Err(format!("`{text}` does not start with `[`"));
    }
    let (mut depth, mut comma) = (0, None);
    for (i, c) in text.char_indices().skip(1) {
        match c {
            '(' => depth += 1,
            ')' if depth > 0 => depth -= 1,
            ',' if depth == 0 && comma.is_none() => comma = Some(i),
            ']' | ')' => return comma.map(|comma| (comma, i)).ok_or_else(|| "an interval needs two ends".into()),
            _ => {}
        }
    }
    Err("`[` is never closed".into())
}

fn components(text: &str, parameters: &Parameters) -> Result<usize, String> {
    let (first, last) = text.split_once("..").ok_or_else(|| format!("components `{{{text}}}` are not of the form {{1..n}}"))?;
    whole(first, "the first component", 1.0, parameters)?;
    whole(last, "the last component", MOST_COMPONENTS, parameters)
}

fn whole(text: &str, what: &str, most: f64, parameters: &Parameters) -> Result<usize, String> {
    let value = constant(text, parameters).map_err(|e| message(&e))?;
    if value.fract() == 0.0 && (1.0..=most).contains(&value) {
        return Ok(value as usize);
    }
    Err(format!("{what} is {value}, not a whole number from 1 to {most}"))
}
