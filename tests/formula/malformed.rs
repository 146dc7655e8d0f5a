//! Files that are wrong, each with the error it must give: no panic, no silence.

use fredholm::Error;
use fredholm::formula::Problem;

/// An equation with one field replaced or added; `null` removes it.
fn with(field: &str, value: &str) -> String {
    let mut fields = vec![
        ("domain", r#""[0, 1]""#),
        ("kernel", r#""lam*x*y""#),
        ("source", r#""1""#),
        ("parameters", r#"{"lam": 0.5}"#),
        ("points", "[0.5]"),
        ("values", r#"["1.15"]"#),
    ];
    fields.retain(|(name, _)| *name != field);
    fields.push((field, value));
    let list: Vec<_> = fields.iter().map(|(name, value)| format!("\"{name}\": {value}")).collect();
    format!("{{{}}}", list.join(", "))
}

#[test]
fn the_template_is_right() {
    assert!(Problem::parse(&with("comment", r#"["anything"]"#)).is_ok());
}

/// (field, its value, part of the message)
const MALFORMED: [(&str, &str, &str); 15] = [
    ("domain", "null", "field `domain` is missing"),
    ("kernel", "null", "field `kernel` is missing"),
    ("source", "null", "field `source` is missing"),
    ("domain", "[0, 1]", "field `domain` is a list, not a text"),
    ("kernel", "true", "field `kernel` is true or false, not a formula"),
    ("parameters", "[1, 2]", "field `parameters` is a list"),
    ("points", "0.5", "field `points` is a number, not a list"),
    ("points", "[0.1, 0.2]", "2 points, but 1 values"),
    ("points", "[[0.1]]", "points[0]: it is a list, not a formula"),
    ("values", "[[1, 2]]", "values[0] has 2 numbers where 1 are needed"),
    ("values", r#"{"a": 1}"#, "field `values` is an object, not a list"),
    ("functionals", r#""none""#, "field `functionals` is a text, not a list"),
    ("digits", "-3", "field `digits` is -3"),
    ("digits", r#""many""#, "not a positive whole number"),
    ("name", "7", "field `name` is a number, not a text"),
];

#[test]
fn malformed_files() {
    for (field, value, wanted) in MALFORMED {
        match Problem::parse(&with(field, value)) {
            Err(Error::Malformed(e)) => assert!(e.contains(wanted), "{field} = {value}: {e}"),
            other => panic!("{field} = {value}: {other:?}"),
        }
    }
    for (text, wanted) in
        [("", "not JSON"), ("{", "not JSON"), ("[1]", "a list, not an object"), ("{\"domain\": }", "not JSON"), ("3", "a number")]
    {
        match Problem::parse(text) {
            Err(Error::Malformed(e)) => assert!(e.contains(wanted), "{text}: {e}"),
            other => panic!("{text}: {other:?}"),
        }
    }
}

const UNSTATED: [(&str, &str, &str); 34] = [
    ("kernel", r#""lam*z""#, "kernel: formula `lam*z`: unknown name `z`"),
    ("kernel", r#""mu*x*y""#, "unknown name `mu`"),
    ("kernel", r#""lam*besselk(x)""#, "unknown function `besselk`"),
    ("kernel", r#""lam*(x+y""#, "expected `)`"),
    ("kernel", r#""see equation""#, "given in words"),
    ("kernel", r#""""#, "found the end"),
    ("source", r#""0 (eigenproblem)""#, "eigenproblem"),
    ("source", r#""y""#, "source: formula `y`: unknown name `y`"),
    ("parameters", r#"{"lam": "mu/2", "mu": "lam*2"}"#, "parameter `lam` is no number"),
    ("parameters", r#"{"lam": "1/0"}"#, "not a finite number"),
    ("parameters", r#"{"lam": [1, 2]}"#, "parameter `lam` is no number: it is a list"),
    ("parameters", r#"{"lam": null}"#, "parameter `lam` is no number: it is null"),
    ("domain", r#""""#, "neither an interval"),
    ("domain", r#""the real line""#, "neither an interval"),
    ("domain", r#""half disk""#, "neither an interval"),
    ("domain", r#""[0, 1""#, "never closed"),
    ("domain", r#""[0]""#, "two ends"),
    ("domain", r#""[0, b]""#, "unknown name `b`"),
    ("domain", r#""[1, 0]""#, "empty or reversed"),
    ("domain", r#""[0, 0]""#, "empty or reversed"),
    ("domain", r#""(-infinity, 0]""#, "unknown name `infinity`"),
    ("domain", r#""[0, 1]^0""#, "whole number from 1 to 64"),
    ("domain", r#""[0, 1]^65""#, "whole number from 1 to 64"),
    ("domain", r#""[0, 1]^1.5""#, "neither `x` nor the end"),
    ("domain", r#""[0, 1]^1000000000000""#, "whole number from 1 to 64"),
    ("domain", r#""[0, 1]^40 x [0, 1]^40""#, "coordinates"),
    ("domain", r#""[0, 1] y [0, 1]""#, "neither `x` nor the end"),
    ("domain", r#""[0, infinity) x [0, 1]""#, "half line times"),
    ("domain", r#""[0, 1] x {2..4}""#, "the first component"),
    ("domain", r#""[0, 1] x {1-4}""#, "of the form {1..n}"),
    ("domain", r#""{1..3}""#, "neither an interval"),
    ("domain", r#""a in [0, 1] and b in [0, 1]""#, "neither an interval"),
    ("points", "[2]", "lies outside the domain"),
    ("points", r#"["left"]"#, "unknown name `left`"),
];

#[test]
fn equations_that_cannot_be_stated() {
    for (field, value, wanted) in UNSTATED {
        match Problem::parse(&with(field, value)) {
            Err(Error::Formula(e)) => assert!(e.contains(wanted), "{field} = {value}: {e}"),
            other => panic!("{field} = {value}: {other:?}"),
        }
    }
}

#[test]
fn systems_boxes_and_surfaces() {
    let equation =
        |domain: &str, kernel: &str, source: &str| format!(r#"{{"domain": "{domain}", "kernel": {kernel}, "source": {source}}}"#);
    for (domain, kernel, source, wanted) in [
        ("[0, 1] x {1..2}", r#""0.1""#, r#"["1", "1"]"#, "not a list"),
        ("[0, 1] x {1..2}", r#"[["0.1", "0"]]"#, r#"["1", "1"]"#, "1 rows where 2"),
        ("[0, 1] x {1..2}", r#"[["0.1", "0"], ["0"]]"#, r#"["1", "1"]"#, "kernel row 2: 1 components where 2"),
        ("[0, 1] x {1..2}", r#"[["0.1", "0"], ["0", "q"]]"#, r#"["1", "1"]"#, "unknown name `q`"),
        ("[0, 1] x {1..2}", r#"[["0.1", "0"], ["0", "0.2"]]"#, r#"["1"]"#, "source: 1 components where 2"),
        ("[0,1]^2", r#""x*y""#, r#""1""#, "unknown name `x`"),
        ("[0,1]^3", r#""prod_i k(x_i,y_i)""#, r#""1""#, "`k` is not defined"),
        ("[0,1]^3", r#""prod_i k(x_i), k=x""#, r#""1""#, "is written `prod_i k(x_i,y_i)`"),
        ("[0,1]^3", r#""prod_i k""#, r#""1""#, "needs `name(x_i…)`"),
        ("[0,1]^3", r#""prod_i k(x_i,y_i), k=x*z""#, r#""1""#, "unknown name `z`"),
        ("surfaces", r#""F=[['0','1'],['1','0']]""#, r#""['1','1']""#, "`rho=[…]` is missing"),
        ("surfaces", r#""rho=['0.5','0.5'], F=[['0','1']]""#, r#""['1','1']""#, "F has 1 rows for 2"),
        ("surfaces", r#""rho=[, F=[]""#, r#""['1','1']""#, "not a list"),
    ] {
        let e = Problem::parse(&equation(domain, kernel, source)).expect_err(kernel).to_string();
        assert!(e.contains(wanted), "{domain}, {kernel}: {e}");
    }
    assert!(matches!(Problem::read("no/such/file.json"), Err(Error::Io { path, .. }) if path == "no/such/file.json"));
}

#[test]
fn no_text_panics() {
    let whole = include_str!("../data/reference/fourgroup-slab.json");
    for end in (0..whole.len()).step_by(37).filter(|e| whole.is_char_boundary(*e)) {
        assert!(Problem::parse(&whole[..end]).is_err());
    }
    // every character of the formulas replaced in turn by ones that mean something
    let template = with("domain", r#""[0, 1]^2 x [0, 2]""#).replace("lam*x*y", "lam*prod_i k(x_i,y_i), k=exp(-x*y)");
    for (i, c) in template.char_indices() {
        for other in ["(", ")", "[", ",", "é", "}", "\\\"", "*", "e", "0"] {
            let _ = Problem::parse(&format!("{}{other}{}", &template[..i], &template[i + c.len_utf8()..]));
        }
    }
}
