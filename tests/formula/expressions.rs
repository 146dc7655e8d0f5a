//! Python's arithmetic, special functions, and errors that say what is wrong.

use fredholm::formula::Expression;

fn value(text: &str) -> f64 {
    Expression::<0>::new(text, [], &[]).unwrap_or_else(|e| panic!("{e}")).eval(&[])
}

fn at(text: &str, x: f64, y: f64) -> f64 {
    Expression::new(text, ["x", "y"], &[("a", 2.0), ("E1", 5.0)]).unwrap_or_else(|e| panic!("{e}")).eval(&[x, y])
}

#[test]
fn precedence_is_that_of_python() {
    for (text, expected) in [
        ("-2**2", -4.0),
        ("(-2)**2", 4.0),
        ("2**-1", 0.5),
        ("2**-3", 0.125),
        ("-2**-2", -0.25),
        ("2**3**2", 512.0),
        ("2**-1**2", 0.5),
        ("(2**3)**2", 64.0),
        ("10-4-3", 3.0),
        ("10-(4-3)", 9.0),
        ("16/4/2", 2.0),
        ("1/2*6", 3.0),
        ("2*3**2", 18.0),
        ("2*-3", -6.0),
        ("2--3", 5.0),
        ("2-+-3", 5.0),
        ("--2", 2.0),
        ("-2*-3", 6.0),
        ("6/-2*3", -9.0),
        ("1e-4*1E4", 1.0),
        ("2.5E+3", 2500.0),
        (".5+5.", 5.5),
        ("1+2*3-4/2", 5.0),
        ("mn(1, 2)*mx(3, 4)", 4.0),
        ("min(2,mx(0,1))**2", 1.0),
        ("heav(0)+heav(1e-300)", 1.0),
        ("abs(-3)", 3.0),
        ("log10(1000)", 3.0),
        (" 2 *( 3+ 4 ) ", 14.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    assert_eq!(value("(3/2)**(3/2)"), 1.5f64.powf(1.5));
    assert_eq!(value("8/3**2"), 8.0 / 9.0);
    assert_eq!(value("e"), std::f64::consts::E);
    assert_eq!(value("0.1*3-0.3"), 0.1 * 3.0 - 0.3, "no regrouping, the same rounding");
}

#[test]
fn variables_and_parameters() {
    assert_eq!(at("-x**2", 3.0, 0.0), -9.0);
    assert_eq!(at("x-y-a", 5.0, 1.0), 2.0);
    assert_eq!(at("x**y**a", 2.0, 3.0), 512.0);
    assert_eq!(at("1/2*x", 3.0, 0.0), 1.5);
    assert_eq!(at("y", 1.0, 2.0), 2.0, "only the second variable occurs");
    assert_eq!(at("7", 1.0, 2.0), 7.0);
    // a parameter may be called like a function
    assert_eq!(at("E1*E1(x)", 1.0, 0.0), 5.0 * 0.219_383_934_395_520_27);
    assert_eq!(at("a*mn(x,y)-x*y", 0.5, 0.25), 0.375);
    // parameters are negative or tiny numbers, not text
    let f = Expression::new("a**2 + b", ["x"], &[("a", -3.0), ("b", 1e-300)]).unwrap();
    assert_eq!(f.eval(&[0.0]), 9.0);
    assert!(!f.uses(0));
}

#[test]
fn errors_name_what_is_wrong() {
    for (text, wanted) in [
        ("x + z", "unknown name `z`"),
        ("foo(x)", "unknown function `foo`"),
        ("exp", "needs an argument"),
        ("exp x", "needs an argument"),
        ("mn(x)", "takes 2 argument(s), 1 given"),
        ("exp(x, y)", "takes 1 argument(s), 2 given"),
        ("x y", "unexpected `y`"),
        ("2x", "unexpected `x`"),
        ("(x", "expected `)`, found the end"),
        ("x)", "unexpected `)`"),
        ("x +", "found the end"),
        ("", "found the end"),
        ("x ^ 2", "power is written `**`"),
        ("x // 2", "found `/`"),
        ("x = 2", "`=` has no meaning"),
        ("1e999", "too large"),
        ("1..2", "unexpected"),
        ("x; y", "`;` has no meaning"),
    ] {
        let e = Expression::new(text, ["x", "y"], &[]).expect_err(text).to_string();
        assert!(e.contains(wanted) && e.contains(text), "{text}: {e}");
    }
    let deep = format!("{}x{}", "(".repeat(100_000), ")".repeat(100_000));
    assert!(Expression::new(&deep, ["x"], &[]).unwrap_err().to_string().contains("deep"));
    assert!(Expression::new(&format!("{}x", "-".repeat(100_000)), ["x"], &[]).unwrap_err().to_string().contains("deep"));
}

/// Values by mpmath, as printed.
#[allow(clippy::excessive_precision)]
const DIGITS: [(&str, f64); 36] = [
    ("erf(0.1)", 0.112_462_916_018_284_89),
    ("erf(0.5)", 0.520_499_877_813_046_5),
    ("erf(2.0)", 0.995_322_265_018_952_7),
    ("gamma(0.3)", 2.991_568_987_687_590_6),
    ("gamma(2.5)", 1.329_340_388_179_137),
    ("gamma(10.7)", 1_799_844.078_931_375_4),
    ("J0(0.5)", 0.938_469_807_240_812_9),
    ("J0(3.7)", -0.399_230_203_371_191_1),
    ("J0(20)", 0.167_024_664_340_583_15),
    ("J1(0.5)", 0.242_268_457_674_873_89),
    ("J1(3.7)", 0.053_833_987_745_461_864),
    ("J1(20)", 0.066_833_124_175_850_05),
    ("I0(0.1)", 1.002_501_562_934_095_6),
    ("I0(2.3)", 2.829_605_600_627_585_7),
    ("I0(14.9)", 308_375.578_687_439_1),
    ("I0(15.1)", 374_103.411_190_409_1),
    ("I0(30)", 781_672_297_823.977_5),
    ("I1(0.1)", 0.050_062_526_047_092_69),
    ("I1(2.3)", 2.097_800_027_517_421_5),
    ("I1(14.9)", 297_840.694_779_574_2),
    ("I1(15.1)", 361_495.566_185_401_7),
    ("I1(30)", 768_532_038_938.957),
    ("E1(1e-06)", 13.238_295_893_062_491),
    ("E1(0.5)", 0.559_773_594_776_160_8),
    ("E1(3.0)", 0.013_048_381_094_197_037),
    ("E1(25.0)", 5.348_899_755_340_217e-13),
    ("E2(0.0)", 1.0),
    ("E2(1e-06)", 0.999_985_761_704_606_9),
    ("E2(0.5)", 0.326_643_862_324_553),
    ("E2(3.0)", 0.010_641_925_085_272_83),
    ("E3(0.0)", 0.5),
    ("E3(0.5)", 0.221_604_364_275_178_46),
    ("E3(3.0)", 0.008_930_646_556_022_725),
    ("ellipE(0.3)", 1.534_833_464_923_249),
    ("ellipE(0.9)", 1.171_697_052_781_614_1),
    ("ellipE(0.999)", 1.003_994_409_965_507_8),
];

#[test]
fn special_functions_keep_their_digits() {
    for (text, expected) in DIGITS {
        let error = (value(text) / expected - 1.0).abs();
        assert!(error < 5e-15, "{text} = {}, off by {error:.1e}", value(text));
    }
    assert!(value("ellipE(1.5)").is_nan() && value("mn(0, log(-1))").is_nan() && value("mx(log(-1), 0)").is_nan());
}
