use fredholm::formula::Problem;
#[test]
fn all() {
    let mut files: Vec<_> = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/reference"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    for f in files {
        match Problem::read(&f) {
            Ok(p) => {
                for s in p.skipped {
                    println!("{}: {s}", p.name)
                }
            }
            Err(e) => println!("REFUSED {}: {e}", f.file_stem().unwrap().to_string_lossy()),
        }
    }
    let d = fredholm::formula::Expression::new("(3/2)**(3/2) + 2.5E+3*x - 1e-4", ["x"], &[]).unwrap();
    println!("{d:?} {}", d.eval(&[1.0]));
    for (text, n) in [
        ("0.5*exp(x*y)", 3),
        ("0.5*t**(-1/2)", 3),
        ("0.9/2*E1(t)", 3),
        ("0.8*exp(-t*t/(2*0.01*0.01))/(0.01*sqrt(2*pi))", 3),
        ("(1-0.1)/2*(1-(t**3+6*t)/(t*t+4)**(3/2))", 3),
        ("1", 3),
        ("x", 3),
        ("x*y+1", 3),
    ] {
        let e = fredholm::formula::Expression::new(text, ["x", "y", "t"], &[]).unwrap();
        let c = std::time::Instant::now();
        let mut s = 0.0;
        for i in 0..2_000_000 {
            let x = i as f64 * 1e-7;
            s += e.eval(&[x, 0.3, (x - 0.3).abs()]);
        }
        println!("{text}: {:.1} ns {n} {s}", c.elapsed().as_secs_f64() / 2e6 * 1e9);
    }
}
