//! Rays through the scenes of the peers: closest and any hits against stored answers. `tests/data/rays` has one in 512 of those of cornell.

use crate::timed;
use fredholm::Error;
use fredholm::scene::geometry::{Geometry, Mesh, Ray};
use rayon::prelude::*;

/// Rays in a task.
const CHUNK: usize = 2048;

/// The little-endian numbers of a file.
fn read(path: &str) -> Result<Vec<f32>, String> {
    let bytes = std::fs::read(path).map_err(|e| format!("{path}: {e}"))?;
    let (numbers, []) = bytes.as_chunks() else { return Err(format!("{path}: {} bytes are not whole numbers", bytes.len())) };
    Ok(numbers.iter().map(|&b| f32::from_le_bytes(b)).collect())
}

fn geometry(corners: &[f32]) -> Result<Geometry, Error> {
    let (vertices, _) = corners.as_chunks::<3>();
    let triangles = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Geometry::new(vec![Mesh::new(vertices.iter().map(|v| v.map(f64::from)).collect(), triangles)?.into()])
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, String> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| e.to_string())
}

/// The distance of the first hit, or 0 for any hit on a shadow ray; infinite if there is none.
fn distance(geometry: &Geometry, set: &str, ray: &Ray) -> f32 {
    let hit = match set {
        "shadow" => geometry.occluded(ray).then_some(0.0),
        _ => geometry.closest(ray).map(|hit| hit.t),
    };
    hit.map_or(f32::INFINITY, |t| t as f32)
}

/// The share of rays that hit, and of those whose answer is not the stored one.
fn compare(answers: &[f32], stored: &[f32]) -> (f64, f64) {
    let same = |&(&t, &s): &(&f32, &f32)| t == s || (t - s).abs() <= 1e-4 * s.abs().max(1e-3);
    let share = |n: usize| n as f64 / answers.len() as f64;
    (share(answers.iter().filter(|t| t.is_finite()).count()), share(answers.iter().zip(stored).filter(|p| !same(p)).count()))
}

pub(crate) fn rays(folder: &str, scene: &str, repetitions: usize) -> Result<(), String> {
    let file = |name: &str| read(&format!("{folder}/{scene}.{name}.bin"));
    let corners = file("tris")?;
    let build = |threads| pool(threads)?.install(|| timed(2, || geometry(&corners))).map_err(|e| e.to_string());
    let ((one, geometry), (two, _)) = (build(1)?, build(2)?);
    for set in ["primary", "bounce", "shadow"] {
        let (numbers, stored) = (file(&format!("{set}.rays"))?, file(&format!("{set}.hits")).unwrap_or_default());
        let ray = |&[x, y, z, _, u, v, w, until]: &[f64; 8]| Ray::new([x, y, z], [u, v, w]).until(until);
        let rays: Vec<Ray> = numbers.as_chunks().0.iter().map(|r: &[f32; 8]| ray(&r.map(f64::from))).collect();
        let answers: Vec<f32> = rays.iter().map(|ray| distance(&geometry, set, ray)).collect();
        let (hits, mismatch) = compare(&answers, &stored);
        for threads in [1, 2] {
            let pool = pool(threads)?;
            let sum = |chunk: &[Ray]| chunk.iter().map(|ray| distance(&geometry, set, ray)).filter(|t| t.is_finite()).sum::<f32>();
            let all = || pool.install(|| Ok(rays.par_chunks(CHUNK).map(sum).collect::<Vec<f32>>()));
            let (seconds, _) = timed(repetitions, all).map_err(|e| e.to_string())?;
            let rate = |s: f64| rays.len() as f64 / 1e6 / s;
            println!(
                "{{\"scene\":\"{scene}\",\"backend\":\"fredholm\",\"target\":\"default\",\"set\":\"{set}\",\"threads\":{threads},\"best\":{:.3},\
                 \"med\":{:.3},\"build1_ms\":{:.2},\"build2_ms\":{:.2},\"hits\":{hits:.4},\"mismatch\":{mismatch:.2e}}}",
                rate(seconds[0]),
                rate(seconds[repetitions / 2]),
                1e3 * one[0],
                1e3 * two[0],
            );
        }
    }
    Ok(())
}
