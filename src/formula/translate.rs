//! Python's arithmetic as text that `exmex` evaluates.
//!
//! In exmex a unary minus binds tighter than a power (−x² would be (−x)²) and powers associate to the left. Python, and everybody who writes
//! `-x**2` or `x**y**z`, means −(x²) and x^(y^z). The translation follows Python's grammar
//!
//! ```text
//! expression = factor { (+ | - | * | /) factor }        the order of + - * / is the same in both
//! factor     = (+ | -) factor | power
//! power      = primary [ ** factor ]
//! primary    = number | name | function ( expression {, expression} ) | ( expression )
//! ```
//!
//! and puts parentheses where the two differ. Names become numbers or numbered variables, so that what exmex parses is ASCII of known tokens.

use super::functions::{CONSTANTS, FUNCTIONS};
use std::collections::BTreeMap;

/// A parameter, or why it has no number.
pub(super) type Parameters = BTreeMap<String, Result<f64, String>>;

/// What names mean: variables first, then parameters, then constants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scope<'a> {
    pub(super) variables: &'a [String],
    pub(super) parameters: &'a Parameters,
}

/// The name of variable `i` in translated text: alphabetical order is numerical order.
pub(super) fn variable(i: usize) -> String {
    format!("v{i:03}")
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    Symbol(char),
    Power,
    End,
}

impl Token {
    fn describe(&self) -> String {
        match self {
            Token::Number(n) => format!("`{n}`"),
            Token::Name(n) => format!("`{n}`"),
            Token::Symbol(c) => format!("`{c}`"),
            Token::Power => "`**`".into(),
            Token::End => "the end".into(),
        }
    }
}

/// Deeper nesting is refused: the parser recurses.
const DEEPEST: usize = 100;

/// The formula as exmex reads it, or what is wrong with it.
pub(super) fn translate(text: &str, scope: Scope<'_>) -> Result<String, String> {
    let mut t = Translator { tokens: tokenize(text)?, at: 0, depth: 0, out: String::new(), scope };
    t.expression()?;
    match t.peek() {
        Token::End => Ok(t.out),
        other => Err(format!("unexpected {}", other.describe())),
    }
}

fn tokenize(text: &str) -> Result<Vec<Token>, String> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(c) = rest.chars().next() {
        let length = if c.is_ascii_digit() || c == '.' {
            let length = number_length(rest);
            let number = rest[..length].parse().map_err(|_| format!("`{}` is no number", &rest[..length]))?;
            tokens.push(Token::Number(number));
            length
        } else if c.is_alphabetic() || c == '_' {
            let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
            tokens.push(Token::Name(rest[..length].into()));
            length
        } else if rest.starts_with("**") {
            tokens.push(Token::Power);
            2
        } else if "+-*/(),".contains(c) {
            tokens.push(Token::Symbol(c));
            1
        } else {
            return Err(format!("`{c}` has no meaning here{}", if c == '^' { " (a power is written `**`)" } else { "" }));
        };
        rest = rest[length..].trim_start();
    }
    tokens.push(Token::End);
    Ok(tokens)
}

/// Bytes of the number `text` starts with: digits, a point, digits, an exponent if it has digits.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].find(|c: char| !c.is_ascii_digit()).map_or(text.len(), |n| from + n);
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end = digits(end + 1);
    }
    if text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}

struct Translator<'a> {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
    out: String,
    scope: Scope<'a>,
}

impl Translator<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.at]
    }

    /// The next token; the last one, `End`, stays.
    fn next(&mut self) -> Token {
        let token = self.tokens[self.at].clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }

    fn expect(&mut self, symbol: char) -> Result<(), String> {
        match self.next() {
            Token::Symbol(c) if c == symbol => Ok(()),
            other => Err(format!("expected `{symbol}`, found {}", other.describe())),
        }
    }

    fn expression(&mut self) -> Result<(), String> {
        self.factor()?;
        while let Token::Symbol(c @ ('+' | '-' | '*' | '/')) = *self.peek() {
            self.next();
            self.out.push(c);
            self.factor()?;
        }
        Ok(())
    }

    fn factor(&mut self) -> Result<(), String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("nested more than {DEEPEST} deep"));
        }
        match self.peek() {
            Token::Symbol('-') => {
                self.next();
                self.out.push_str("(-");
                self.factor()?;
                self.out.push(')');
            }
            Token::Symbol('+') => {
                self.next();
                self.factor()?;
            }
            _ => self.power()?,
        }
        self.depth -= 1;
        Ok(())
    }

    fn power(&mut self) -> Result<(), String> {
        let start = self.out.len();
        self.primary()?;
        if *self.peek() == Token::Power {
            self.next();
            self.out.insert(start, '(');
            self.out.push('^');
            self.factor()?;
            self.out.push(')');
        }
        Ok(())
    }

    fn primary(&mut self) -> Result<(), String> {
        match self.next() {
            Token::Number(n) => self.number(n),
            Token::Name(name) if *self.peek() == Token::Symbol('(') => self.call(&name),
            Token::Name(name) => self.name(&name),
            Token::Symbol('(') => {
                self.out.push('(');
                self.expression()?;
                self.out.push(')');
                self.expect(')')
            }
            other => Err(format!("expected a number, a name or `(`, found {}", other.describe())),
        }
    }

    fn number(&mut self, n: f64) -> Result<(), String> {
        if !n.is_finite() {
            return Err("a number is too large".into());
        }
        // Display writes no exponent and reads back to the same bits
        self.out.push_str(&if n.is_sign_negative() { format!("(-{})", -n) } else { n.to_string() });
        Ok(())
    }

    fn name(&mut self, name: &str) -> Result<(), String> {
        if let Some(i) = self.scope.variables.iter().position(|v| v == name) {
            self.out.push_str(&variable(i));
            return Ok(());
        }
        match self.scope.parameters.get(name) {
            Some(Ok(value)) => return self.number(*value),
            Some(Err(reason)) => return Err(format!("parameter `{name}` is no number: {reason}")),
            None => {}
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|(n, _)| *n == name) {
            return self.number(*value);
        }
        if FUNCTIONS.iter().any(|f| f.name == name) {
            return Err(format!("the function `{name}` needs an argument in parentheses"));
        }
        Err(format!("unknown name `{name}` ({})", self.known()))
    }

    fn call(&mut self, name: &str) -> Result<(), String> {
        let function = FUNCTIONS.iter().find(|f| f.name == name).ok_or_else(|| format!("unknown function `{name}`"))?;
        self.expect('(')?;
        // two arguments become an infix operator
        self.out.push_str(if function.arguments == 1 { function.text } else { "(" });
        let mut given = 0;
        loop {
            self.out.push('(');
            self.expression()?;
            self.out.push(')');
            given += 1;
            if *self.peek() != Token::Symbol(',') {
                break;
            }
            self.next();
            self.out.push_str(function.text);
        }
        if given != function.arguments {
            return Err(format!("`{name}` takes {} argument(s), {given} given", function.arguments));
        }
        if function.arguments == 2 {
            self.out.push(')');
        }
        self.expect(')')
    }

    fn known(&self) -> String {
        let names: Vec<_> = self.scope.variables.iter().chain(self.scope.parameters.keys()).map(String::as_str).collect();
        if names.is_empty() { "no names are known here".into() } else { format!("known: {}", names.join(", ")) }
    }
}
