//! Equations as text: what every file of the reference folder states, precedence, and what malformed input is told.

use fredholm::deterministic::Nystrom;
use fredholm::formula::{Expression, Problem, Statement};
use fredholm::{Error, Walk};

fn folder() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference")
}

/// Files that are no equation this crate states, each with the reason it must give.
const REFUSED: [(&str, &str); 5] = [
    ("cavity-", "in words"),
    ("critical-", "eigenproblem"),
    ("disk-exp", "unit disk"),
    ("disk-inverse", "unit disk"),
    ("disk-log", "unit disk"),
];

#[test]
fn every_file_is_stated_or_refused_with_its_reason() {
    let mut stated = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "json") {
            continue;
        }
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let expected = REFUSED.iter().find(|(prefix, _)| name.starts_with(prefix)).map(|r| r.1);
        let expected = if name == "radiosity-coaxial-disks" { Some("two disks") } else { expected };
        match (Problem::read(&path), expected) {
            (Ok(_), None) => stated += 1,
            (Err(Error::Formula(reason)), Some(expected)) => assert!(reason.contains(expected), "{name}: {reason}"),
            (result, _) => panic!("{name}: {:?}", result.map(|p| p.name)),
        }
    }
    assert_eq!(stated, 144);
}

#[test]
fn formulas_have_the_precedence_of_python() {
    let parameters = [("a", 7.0), ("b", 2.0), ("s11", 0.4), ("S1", 1.5)];
    let x = 3.0f64;
    for (text, value) in [
        ("-x**2", -9.0),
        ("(-x)**2", 9.0),
        ("2**-1", 0.5),
        ("a-b-x", 2.0),
        ("a/b/x", 7.0 / 6.0),
        ("b**x**b", 512.0),
        ("1/2*x", 1.5),
        ("-b**-b", -0.25),
        ("(3/2)**(3/2)", 1.5f64.powf(1.5)),
        ("1e-4*x+2.5E+3", 2500.0003),
        ("mn(x,b)+mx(x,a)", 9.0),
        ("heav(x-3)+heav(x-2)", 1.0),
        ("exp(-x*x)*-1", -(-9.0f64).exp()),
        ("s11/2*E1(S1*x)", 0.2 * fredholm::special::e1(4.5)),
        ("abs(b-x)**0.5", 1.0),
        ("pi*x", 3.0 * std::f64::consts::PI),
    ] {
        let got = Expression::new(text, ["x"], &parameters).unwrap().eval(&[x]);
        assert!((got - value).abs() <= 1e-14 * value.abs().max(1.0), "{text}: {got} instead of {value}");
    }
}

#[test]
fn malformed_input_says_what_is_wrong() {
    let of = |domain: &str, kernel: &str, source: &str| {
        format!(r#"{{"domain": "{domain}", "kernel": "{kernel}", "source": "{source}", "parameters": {{"lam": 0.5}}}}"#)
    };
    let cases = [
        ("not JSON".to_owned(), ""),
        ("[1, 2]".to_owned(), ""),
        ("{}".to_owned(), "domain"),
        (r#"{"domain": "[0, 1]"}"#.to_owned(), "kernel"),
        (r#"{"domain": "[0, 1]", "kernel": "1"}"#.to_owned(), "source"),
        (r#"{"domain": 3, "kernel": "1", "source": "1"}"#.to_owned(), "domain"),
        (r#"{"domain": "[0, 1]", "kernel": 3, "source": ["1"]}"#.to_owned(), ""),
        (of("[0, 1", "1", "1"), "domain"),
        (of("", "1", "1"), "domain"),
        (of("[0, zz]", "1", "1"), "zz"),
        (of("the moon", "1", "1"), "the moon"),
        (of("[0, 1]", "lam*nosuch(x)", "1"), "nosuch"),
        (of("[0, 1]", "mu*x", "1"), "mu"),
        (of("[0, 1]", "lam*(x", "1"), ""),
        (of("[0, 1]", "lam**", "1"), ""),
        (of("[0, 1]", "", "1"), ""),
        (of("[0, 1]", "x*y", "q+1"), "q"),
        (of("[0,1]^0", "1", "1"), ""),
        (of("[0,1]^999", "1", "1"), "999"),
        (r#"{"domain": "[0, 1] x {1..2}", "kernel": [["1"]], "source": ["1", "1"]}"#.to_owned(), ""),
    ];
    for (text, part) in cases {
        match Problem::parse(&text) {
            Err(Error::Formula(message)) => assert!(message.contains(part), "{text}: {message}"),
            other => panic!("{text}: {:?}", other.map(|p| p.name)),
        }
    }
    assert!(matches!(Problem::read("no/such/file.json"), Err(Error::Io { .. })));
    // a reversed interval is a valid text; the equation refuses it
    let reversed = Problem::parse(&of("[1, 0]", "lam*x*y", "1"));
    if let Ok(Problem { statement: Statement::Interval(stated), .. }) = &reversed {
        let error = stated.equation().at(0.5).solve(&Walk::collision()).unwrap_err();
        assert!(matches!(error, Error::Invalid { parameter: "interval end", value: 0.0, .. }), "{error}");
    } else {
        assert!(matches!(reversed, Err(Error::Formula(_) | Error::Invalid { .. })), "{:?}", reversed.map(|p| p.name));
    }
}

#[test]
fn kernels_and_sources_are_those_of_the_files() {
    let read = |name: &str| Problem::read(folder().join(format!("{name}.json"))).unwrap().statement;
    let (x, y) = (0.3f64, 0.8f64);
    let Statement::Interval(p) = read("nonsymmetric-exp-xy2") else { panic!("an interval") };
    let lam = p.kernel(&0.0, &0.0);
    assert!((p.kernel(&x, &y) - lam * (-x * y * y).exp() * (1.0 + x - y)).abs() < 1e-15);
    assert!((p.source(&x) - 1.0 - x * x).abs() < 1e-15);
    let Statement::Interval(p) = read("slab-c0.9-a10-uniform") else { panic!("an interval") };
    assert!((p.kernel(&1.0, &2.5) - 0.45 * fredholm::special::e1(1.5)).abs() < 1e-15);
    let Statement::System(p) = read("twogroup-slab-downscatter") else { panic!("a system") };
    assert!((p.kernel(&(1.0, 1), &(2.5, 0)) - 0.15 * fredholm::special::e1(1.5)).abs() < 1e-15);
    assert_eq!(p.kernel(&(1.0, 0), &(2.5, 1)), 0.0);
    assert_eq!((p.source(&(1.0, 0)), p.source(&(1.0, 1))), (1.0, 0.0));
}

#[test]
fn stated_equations_are_solved() {
    for (name, tolerance) in [("expxy-g1-lam0.5", 1e-11), ("green-bridge-lam5", 1e-9), ("slab-c0.9-a1-uniform", 1e-9)] {
        let problem = Problem::read(folder().join(format!("{name}.json"))).unwrap();
        let Statement::Interval(p) = &problem.statement else { panic!("an interval") };
        let equation = p.equation();
        let exact = equation.solve(&Nystrom::adaptive(tolerance)).unwrap();
        for known in &p.points {
            let value = known.value.unwrap();
            assert!((exact.eval(known.point) - value).abs() <= tolerance * value.abs().max(1.0), "{name} at {}", known.label);
        }
    }
}
