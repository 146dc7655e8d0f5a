//! Times and errors of other programs, as the peers' scripts print them: lines `peer;problem;N;threads;best s;median s;largest error;note`, and for images
//! `scene samples best_ms median_ms Mpaths/s RMSE …` under a heading `# program, …`.

use crate::curve::{Curve, Family, Point};
use std::collections::BTreeMap;
use std::path::Path;

/// Errors in units of f, by problem and program.
#[derive(Default)]
pub(crate) struct Peers(BTreeMap<(String, String), Vec<Point>>);

impl Peers {
    /// Adds the lines of a file; what is no such line, such as a heading, is counted.
    pub(crate) fn read(&mut self, path: &Path) -> Result<usize, String> {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let (mut skipped, mut program) = (0, "");
        for line in text.lines().filter(|l| !l.trim().is_empty()) {
            if let Some(heading) = line.strip_prefix("# ") {
                program = heading.split(',').next().unwrap_or(heading);
            }
            match parse(line).or_else(|| image(line, program)) {
                Some((key, point)) => self.0.entry(key).or_default().push(point),
                None => skipped += 1,
            }
        }
        Ok(skipped)
    }

    /// The curves of a problem or scene; errors relative to `scale`.
    pub(crate) fn curves(&self, problem: &str, scale: f64) -> Vec<Curve> {
        let known = self.0.iter().filter(|((p, _), _)| p == problem);
        let curve = |((_, peer), points): (&(String, String), &Vec<Point>)| {
            let points = points.iter().map(|p| Point { error: p.error / scale, ..p.clone() }).collect();
            Curve { points, ..Curve::new(peer, Family::Peer) }
        };
        known.map(curve).collect()
    }
}

/// One line of a table of images.
fn image(line: &str, program: &str) -> Option<((String, String), Point)> {
    let fields: Vec<_> = line.split_whitespace().collect();
    let [scene, samples, _, median, _, error, ..] = fields[..] else { return None };
    let (seconds, error) = (median.parse::<f64>().ok()? * 1e-3, error.parse().ok()?);
    let point = Point { setting: samples.into(), seconds, evaluations: f64::NAN, error, reported: f64::NAN };
    Some(((scene.to_string(), program.to_string()), point))
}

fn parse(line: &str) -> Option<((String, String), Point)> {
    let fields: Vec<_> = line.split(';').collect();
    let [peer, problem, unknowns, _, _, median, error, ..] = fields[..] else { return None };
    let (seconds, error) = (median.parse().ok()?, error.parse().ok()?);
    let point = Point { setting: unknowns.into(), seconds, evaluations: f64::NAN, error, reported: f64::NAN };
    Some(((problem.to_string(), peer.to_string()), point))
}
