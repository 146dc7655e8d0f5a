//! Equations as text: a JSON file of formulas becomes an [`Equation`](crate::Equation).
//!
//! ```
//! use fredholm::{formula::{Problem, Statement}, Walk};
//! let problem = Problem::parse(r#"{
//!     "domain": "[0, 1]",
//!     "parameters": {"lam": 0.5},
//!     "kernel": "lam*x*y",
//!     "source": "1",
//!     "points": [0.5]
//! }"#)?;
//! let Statement::Interval(stated) = &problem.statement else { panic!("an interval") };
//! let f = stated.equation().at(stated.points[0].point).solve(&Walk::collision())?;
//! assert!(f.agrees_with(1.15, 5.0));
//! # Ok::<(), fredholm::Error>(())
//! ```
//!
//! `cargo run --release --example solve -- FILE…` solves such files from the command line.
//!
//! | field | what | |
//! |---|---|---|
//! | `domain` | `[a, b]`, `[a, infinity)`, `(-infinity, infinity)`, `unit disk`, `[0,1]^d`, `[a, b] x [c, d]`, `[a, b] x {1..m}`, `surfaces` | required |
//! | `kernel` | K in `x`, `y`, `t` = \|x − y\|; on boxes `x1` … `xd`, `y1` … `yd`, `t`; an m × m list of lists for systems | required |
//! | `source` | g in `x`; on boxes `x1` … `xd`; a list of m for systems | required |
//! | `parameters` | names with numbers or formulas of other parameters | |
//! | `points` | where f is wanted (a list of coordinates on boxes) | |
//! | `values` | f there, if known (a list of m for systems) | |
//! | `functionals` | `{"h": …, "value": …}`: ∫ h f, if known | |
//! | `name`, `class`, `digits` | for reports; digits of `values` that can be trusted | |
//!
//! A file whose source is `0 (eigenproblem)` states λf = Tf instead: [`Eigenproblem`].
//!
//! Other fields are allowed and ignored. Formulas are Python's: `+ - * / **` with Python's precedence (`-x**2` = −(x²), `x**y**z` = x^(y^z)),
//! `exp log log10 sqrt abs sin cos tan asin acos atan sinh cosh tanh erf gamma E1 E2 E3 I0 I1 J0 J1 ellipE heav mn mx min max`, `pi`, `e`.
//! `ellipE(k)` takes the modulus, `heav(z)` is 1 for z > 0 else 0, `mn`/`mx` are minimum and maximum. On boxes, products over coordinates are written
//! `lam*prod_i k(x_i,y_i), k=exp(x*y)`; finite linear systems `B_i = E_i + rho_i sum_j F_ij B_j, F=[[…]], rho=[…]` have the domain `surfaces`.

mod boxes;
mod eigenproblem;
mod expression;
mod fields;
mod functional;
mod functions;
mod line;
mod problem;
mod product;
mod region;
mod stated;
mod translate;

pub use eigenproblem::Eigenproblem;
pub use expression::Expression;
pub use functional::{KnownFunctional, TextFunctional};
pub use problem::{Problem, Statement, Visitor};
pub use stated::{KernelText, Known, SourceText, Stated, TextEquation};
