//! Errors of all methods over all files, as SVG.

use crate::report::Line;
use plotters::prelude::*;
use plotters::style::register_font;

/// Largest |value − reference|/|reference| of each line.
fn relative_error(line: &Line) -> Option<f64> {
    let all = line.outcome.result.as_ref().ok()?;
    let one = |c: &crate::report::Comparison| Some((c.value - c.reference?).abs() / c.reference?.abs().max(1e-3));
    all.iter().filter_map(one).reduce(f64::max)
}

/// log₁₀ of the error against the number of the file, one colour a method.
pub(crate) fn errors(lines: &[Line]) -> Result<String, Box<dyn std::error::Error>> {
    // the font that is compiled in: no other is looked for
    register_font("sans-serif", FontStyle::Normal, dejavu::sans::regular()).map_err(|_| "the font cannot be read")?;
    let mut svg = String::new();
    let mut files: Vec<&str> = Vec::new();
    let mut methods: Vec<&str> = Vec::new();
    for line in lines {
        if files.last() != Some(&line.file.as_str()) {
            files.push(&line.file);
        }
        if !methods.contains(&line.outcome.method) {
            methods.push(line.outcome.method);
        }
    }
    let root = SVGBackend::with_string(&mut svg, (1200, 600)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption("largest relative error", ("sans-serif", 20))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(0.0..files.len() as f64, (1e-17..1e1).log_scale())?;
    chart.configure_mesh().x_desc("file, in the order of the list").y_desc("|value − reference|/|reference|").draw()?;
    for (i, method) in methods.iter().enumerate() {
        let colour = Palette99::pick(i).to_rgba();
        let points = lines.iter().filter(|l| l.outcome.method == *method).filter_map(|l| {
            let file = files.iter().position(|f| *f == l.file)?;
            Some((file as f64 + (i as f64 + 0.5) / methods.len() as f64, relative_error(l)?.clamp(1e-17, 1e1)))
        });
        chart
            .draw_series(points.map(|p| Circle::new(p, 2, colour.filled())))?
            .label(*method)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, colour.filled()));
    }
    chart.configure_series_labels().background_style(WHITE.mix(0.8)).border_style(BLACK).draw()?;
    root.present()?;
    drop((chart, root));
    Ok(svg)
}
