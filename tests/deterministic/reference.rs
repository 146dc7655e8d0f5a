//! Stored reference solutions, tests/data/reference/*.json.

use serde_json::Value;

/// The file of one equation.
pub(crate) fn record(name: &str) -> Value {
    let path = format!("{}/tests/data/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    serde_json::from_str(&text).unwrap()
}

/// A number, or a string that holds one.
pub(crate) fn number(v: &Value) -> f64 {
    v.as_f64().or_else(|| v.as_str()?.parse().ok()).unwrap_or_else(|| panic!("not a number: {v}"))
}

/// The ends of a domain written [a, b], b possibly a parameter.
pub(crate) fn interval(file: &Value) -> (f64, f64) {
    let text = file["domain"].as_str().unwrap();
    let end = |s: &str| s.trim().parse().unwrap_or_else(|_| number(&file["parameters"][s.trim()]));
    let (a, b) = text.trim_matches(['[', ']']).split_once(',').unwrap();
    (end(a), end(b))
}

/// (x, f(x)) of scalar equations in one dimension.
pub(crate) fn scalar_values(file: &Value) -> Vec<(f64, f64)> {
    file["points"].as_array().unwrap().iter().map(number).zip(file["values"].as_array().unwrap().iter().map(number)).collect()
}

/// (x, f(x)) of scalar equations in several dimensions.
pub(crate) fn point_values(file: &Value) -> Vec<(Vec<f64>, f64)> {
    let point = |p: &Value| p.as_array().unwrap().iter().map(number).collect();
    file["points"].as_array().unwrap().iter().map(point).zip(file["values"].as_array().unwrap().iter().map(number)).collect()
}
