//! Pictures: their files, their words, and what they refuse.
#![cfg(feature = "plot")]

#[path = "common/erased.rs"]
mod erased;

use erased::Equation;
use fredholm::plot::{Comparison, Convergence, Profile};
use fredholm::{Error, Estimate, Walk};
use std::path::PathBuf;

/// A folder of this test, gone at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::remove_dir_all(&path).ok();
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

const XS: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];

/// f(x) = 1 + 3x/10.
fn estimates(walk: &Walk) -> Vec<Estimate> {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * (0.1 + x) * y);
    eq.on(&XS).solve(walk).unwrap()
}

fn decay(constant: f64, slope: f64) -> Vec<(f64, f64)> {
    (6..=20).map(|k| 2f64.powi(k)).map(|n| (n, constant * n.powf(slope) * (1.0 + 0.2 * (3.0 * n.ln()).sin()))).collect()
}

fn convergence() -> Convergence {
    Convergence::against_samples("Error of f(½) & its <rate>")
        .subtitle("K = ½xy, 64 repetitions")
        .error_label("root mean square error")
        .series("collision", decay(0.8, -0.5))
        .series("next event", decay(0.3, -0.5))
        .series("absorption", decay(2.1, -0.5))
        .series("Sobol", decay(0.5, -0.9))
}

fn profile() -> Profile<'static> {
    let (a, b) = (estimates(&Walk::collision().samples_per_cell(4096)), estimates(&Walk::collision().samples_per_cell(4096).seed(1)));
    // f = 1 + c (0.1 + x), c = ½ ∫ y f(y) dy: c (1 − ½(0.05 + 1/3)) = ¼
    let c = 0.25 / (1.0 - 0.5 * (0.05 + 1.0 / 3.0));
    Profile::new("Solution", 0.0..=1.0)
        .subtitle("4096 walks a point")
        .curve("exact", move |x| 1.0 + c * (0.1 + x))
        .estimates("seed 0", &XS, &a)
        .estimates("seed 1", &XS, &b)
}

fn comparison() -> Comparison {
    Comparison::new("Efficiency of the estimators", "efficiency 1/(V·W)")
        .bar("collision", 3.1)
        .bar("next event", 45.0)
        .bar("MIS, balance", 61.0)
        .bar("absorption", 0.082)
        .missing("subcritical", "refused: no row mass")
}

/// Start and end tags match and every ampersand begins an entity: the part of well-formedness a generator can get wrong.
fn well_formed(svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, text) = tag.split_once('>').expect("every tag ends");
        assert!(!text.contains('>'), "bare > in {text:?}");
        for entity in text.split('&').skip(1).chain(tag.split('&').skip(1)) {
            let name = entity.split_once(';').expect("an entity ends").0;
            assert!(["amp", "lt", "gt", "quot", "apos", "#39"].contains(&name), "entity {name:?}");
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "quotes of {tag:?}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name.to_owned()));
        } else if !tag.ends_with('/') && !tag.starts_with(['?', '!']) {
            open.push(tag.split_whitespace().next().unwrap().to_owned());
        }
    }
    assert!(open.is_empty(), "never closed: {open:?}");
}

fn words(svg: &str, wanted: &[&str]) {
    well_formed(svg);
    assert!(svg.starts_with("<svg "));
    for word in wanted {
        assert!(svg.lines().any(|line| line.trim() == *word), "{word:?} is not a text of the picture");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn every_label_is_in_the_picture() {
    words(
        &convergence().to_svg().unwrap(),
        &["Error of f(½) &amp; its &lt;rate&gt;", "walks N", "root mean square error", "collision", "Sobol", "slope −1/2", "10⁻³", "10⁴"],
    );
    words(&profile().to_svg().unwrap(), &["Solution", "4096 walks a point", "exact", "seed 1", "x", "f(x)", "deviation / σ", "0.6"]);
    words(&comparison().to_svg().unwrap(), &["MIS, balance", "efficiency 1/(V·W)", "refused: no row mass", "61.0", "0.0820", "–", "10⁻¹"]);
}

#[test]
fn files_are_written_into_folders_that_did_not_exist() {
    let folder = Folder::new("plot-files");
    let svg = folder.0.join("a/b/convergence.svg");
    convergence().save(&svg).unwrap();
    assert_eq!(std::fs::read_to_string(svg).unwrap(), convergence().to_svg().unwrap());
    let png = folder.0.join("c/Comparison.PNG");
    comparison().save(&png).unwrap();
    assert!(std::fs::read(png).unwrap().starts_with(b"\x89PNG\r\n\x1a\n"));
}

#[test]
fn png_has_text_and_the_size_of_two_dots_a_pixel() {
    let (png, svg) = (comparison().to_png().unwrap(), comparison().to_svg().unwrap());
    let decoder = png::Decoder::new(std::io::Cursor::new(png));
    let mut reader = decoder.read_info().unwrap();
    let mut dots = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut dots).unwrap();
    assert!(svg.starts_with(&format!("<svg width=\"{}\" height=\"{}\"", info.width / 2, info.height / 2)));
    // the title is the only ink above the frame: without a font there would be none
    let title = &dots[..(3 * info.width * 100) as usize];
    assert!(title.iter().filter(|d| **d < 100).count() > 1000);
}

#[test]
fn an_error_of_zero_is_drawn_and_named() {
    let with_zero = Convergence::against_samples("t").series("a", [(10.0, 1e-2), (100.0, 0.0), (1000.0, 1e-3)]);
    words(&with_zero.to_svg().unwrap(), &["error exactly 0"]);
    let without = Convergence::against_samples("t").series("a", [(10.0, 1e-2), (1000.0, 1e-3)]).to_svg().unwrap();
    assert!(!without.contains("error exactly 0"));
    assert!(matches!(Convergence::against_samples("t").series("a", [(10.0, 0.0)]).to_svg(), Err(Error::Invalid { value: 0.0, .. })));
}

#[test]
fn what_cannot_be_drawn_is_refused_with_its_place() {
    let one = |point| Convergence::against_samples("t").series("good", [(1.0, 1.0)]).series("bad", [(2.0, 1.0), point]).to_svg();
    for (point, quantity) in
        [((0.0, 1.0), "cost"), ((-1.0, 1.0), "cost"), ((f64::NAN, 1.0), "cost"), ((1.0, -1.0), "error"), ((1.0, f64::INFINITY), "error")]
    {
        match one(point).unwrap_err() {
            Error::Unplottable { series, quantity: q, at, .. } => {
                assert_eq!((series.as_str(), q, at.as_str()), ("bad", quantity, "point 1"))
            }
            other => panic!("{other}"),
        }
    }
    assert!(matches!(Comparison::new("t", "q").bar("a", 0.0).to_svg(), Err(Error::Unplottable { value: 0.0, .. })));
    let pole = Profile::new("t", 0.0..=1.0).curve("1/x", |x| 1.0 / x).to_svg().unwrap_err();
    assert_eq!(pole.to_string(), "cannot plot \"1/x\": value at x = 0 is inf: a curve must be finite on the interval of the plot");
}

#[test]
fn estimates_without_an_error_or_a_place_are_refused() {
    let refused = |plot: Profile<'_>, wanted: &str| match plot.to_svg().unwrap_err() {
        Error::Unplottable { quantity, .. } => assert_eq!(quantity, wanted),
        other => panic!("{other}"),
    };
    let many = estimates(&Walk::collision().samples_per_cell(64));
    refused(
        Profile::new("t", 0.0..=1.0).estimates("one walk", &XS, &estimates(&Walk::collision().samples_per_cell(1))),
        "half-width of the 95 % interval",
    );
    refused(Profile::new("t", 0.0..=1.0).estimates("too few x", &XS[..4], &many), "x");
    refused(Profile::new("t", 0.0..=1.0).estimates("too few estimates", &XS, &many[..4]), "value");
    refused(Profile::new("t", 0.0..=0.5).estimates("outside", &XS, &many), "x");
}

#[test]
fn plots_of_nothing_and_unknown_formats_are_refused() {
    assert!(matches!(Convergence::against_time("t").to_svg(), Err(Error::Invalid { .. })));
    assert!(matches!(Convergence::against_time("t").series("a", []).to_svg(), Err(Error::Invalid { .. })));
    assert!(matches!(Comparison::new("t", "q").missing("a", "why").to_svg(), Err(Error::Invalid { .. })));
    assert!(matches!(Profile::new("t", 0.0..=1.0).to_svg(), Err(Error::Invalid { .. })));
    assert!(matches!(Profile::new("t", 1.0..=0.0).curve("f", |x| x).to_svg(), Err(Error::Invalid { .. })));
    let folder = Folder::new("plot-formats");
    for name in ["plot.pdf", "plot"] {
        let path = folder.0.join(name);
        let Err(Error::Io { path: named, message }) = convergence().save(&path) else { panic!("{name} was written") };
        assert!(named.ends_with(name) && message.contains(".svg or .png"));
    }
    std::fs::create_dir_all(&folder.0).unwrap();
    std::fs::write(folder.0.join("file"), "").unwrap();
    let below_a_file = folder.0.join("file/plot.svg");
    assert!(matches!(convergence().save(&below_a_file), Err(Error::Io { path, .. }) if path.ends_with("plot.svg")));
}
