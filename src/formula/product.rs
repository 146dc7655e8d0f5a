//! Products over coordinates: `lam*prod_i k(x_i,y_i), k=exp(x*y)`.
//!
//! The text before the first comma is a formula in which each `prod_i name(…)` stands for ∏ᵢ of a factor; the definitions that follow give the
//! factors as formulas in one coordinate, `x` (and `y`, `t` = |x − y| in kernels).

use super::expression::Expression;
use super::translate::Parameters;
use crate::error::Error;

/// Most different products in a formula.
const MOST: usize = 8;

/// A formula over products of factors.
#[derive(Clone, Debug)]
pub(super) struct Product {
    main: Expression<MOST>,
    factors: Vec<Expression<3>>,
}

impl Product {
    /// Whether a formula is of this form.
    pub(super) fn occurs_in(text: &str) -> bool {
        text.contains("prod_i")
    }

    /// Reads the formula; `arguments` is what stands in the parentheses of every product, `x_i,y_i` or `x_i`.
    pub(super) fn parse(text: &str, arguments: &str, parameters: &Parameters) -> Result<Self, Error> {
        let wrong = |why: String| Error::Formula(format!("product formula `{text}`: {why}"));
        let pieces = split_top_level(text);
        let (main, definitions) = pieces.split_first().expect("splitting gives at least one piece");
        let (main, names) = replace_products(main, arguments).map_err(wrong)?;
        let variables: Vec<String> = (0..names.len()).map(placeholder).collect();
        let coordinates: Vec<String> =
            ["x", "y", "t"].iter().take(if arguments.contains('y') { 3 } else { 1 }).map(|s| (*s).into()).collect();
        let mut factors = Vec::new();
        for name in &names {
            let definition = definitions.iter().find_map(|d| d.split_once('=').filter(|(n, _)| n.trim() == name));
            let (_, body) = definition.ok_or_else(|| wrong(format!("`{name}` is not defined; add `, {name}=…`")))?;
            factors.push(Expression::parse(body.trim(), &coordinates, parameters)?);
        }
        Ok(Product { main: Expression::parse(&main, &variables, parameters)?, factors })
    }

    /// The value, the pairs of coordinates read from `pairs`.
    #[inline]
    pub(super) fn eval(&self, pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
        let mut products = [1.0; MOST];
        for (product, factor) in products.iter_mut().zip(&self.factors) {
            *product = pairs.clone().map(|(x, y)| factor.eval(&[x, y, (x - y).abs()])).product();
        }
        self.main.eval(&products)
    }
}

fn placeholder(i: usize) -> String {
    format!("product_{i}")
}

/// Pieces between commas that stand outside all parentheses.
pub(super) fn split_top_level(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut pieces) = (0, 0, Vec::new());
    for (i, c) in text.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' if depth == 0 => {
                pieces.push(&text[start..i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    pieces.push(&text[start..]);
    pieces
}

/// Replaces every `prod_i name(arguments)` by a placeholder; also the names, in order of first appearance.
fn replace_products(text: &str, arguments: &str) -> Result<(String, Vec<String>), String> {
    let mut names: Vec<String> = Vec::new();
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("prod_i") {
        out.push_str(&rest[..at]);
        let after = rest[at + "prod_i".len()..].trim_start();
        let open = after.find('(').ok_or("`prod_i` needs `name(x_i…)` after it")?;
        let close = open + after[open..].find(')').ok_or("`(` is never closed")?;
        let given: String = after[open + 1..close].split_whitespace().collect();
        if given != arguments {
            return Err(format!("a product here is written `prod_i {}({arguments})`, not with `({given})`", after[..open].trim()));
        }
        let name = after[..open].trim().to_string();
        let index = names.iter().position(|n| *n == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        });
        out.push_str(&placeholder(index));
        rest = &after[close + 1..];
    }
    if names.len() > MOST {
        return Err(format!("more than {MOST} different products"));
    }
    out.push_str(rest);
    Ok((out, names))
}
