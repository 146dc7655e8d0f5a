//! Images against stored ones: exact where there is a closed form, else many passes of another renderer.

use crate::common::{Budget, all_pass};
use crate::scene_file;
use fredholm::scene::{Image, load};
use fredholm::walk::Roulette;
use fredholm::{Estimate, Spectrum, Walk};
use statrs::distribution::{ContinuousCDF, Normal};

const SIZE: usize = 64;

/// A `.npy` file: a header of 128 bytes, then little-endian values, row 0 = top.
fn stored(name: &str) -> Vec<[f64; 3]> {
    let bytes = std::fs::read(scene_file(name)).unwrap();
    let numbers: Vec<f64> = match (bytes.len() - 128) / (3 * SIZE * SIZE) {
        4 => bytes[128..].as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
        8 => bytes[128..].as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
        n => panic!("{name}: {n} bytes a number"),
    };
    numbers.as_chunks::<3>().0.to_vec()
}

fn render(name: &str, samples: u64) -> Image<Estimate<Spectrum<3>>> {
    let loaded = load(scene_file(&format!("{name}.gltf"))).unwrap();
    assert!(loaded.report.is_empty(), "{}", loaded.report);
    let camera = loaded.cameras[0].0;
    let scene = loaded.builder.build().unwrap();
    let walk = Walk::mis().roulette(Roulette::throughput(0.5).after(1)).samples_per_cell(samples).seed(5);
    scene.light_transport().seen_by(&scene.film(camera, SIZE, SIZE)).solve(&walk).unwrap()
}

/// Mean and squared standard error of blocks of 8 × 8 pixels, all components added.
fn blocks(values: impl Fn(usize) -> f64, errors: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let block = |b: usize| {
        let pixels = (0..64).map(|k| (b / 8 * 8 + k / 8) * SIZE + b % 8 * 8 + k % 8);
        pixels.fold((0.0, 0.0), |(m, v), p| (m + values(p) / 64.0, v + (errors(p) / 64.0).powi(2)))
    };
    (0..64).map(block).collect()
}

/// Are the p-values of 64 blocks uniform, and is the mean of the image right?
fn compare(
    name: &str,
    truth: &str,
    deviation: Option<&str>,
    (samples, margin): (u64, f64),
    budget: &mut Budget,
) -> Vec<Result<(), String>> {
    let image = render(name, samples);
    let reference = stored(truth);
    let uncertain = deviation.map_or(vec![[0.0; 3]; SIZE * SIZE], stored);
    let sum = |c: [f64; 3]| c.iter().sum::<f64>();
    let ours = blocks(|p| sum(image.pixels()[p].value.0), |p| sum(image.pixels()[p].std_error.unwrap_or_default().0));
    let theirs = blocks(|p| sum(reference[p]), |p| sum(uncertain[p]));
    let z = ours.iter().zip(&theirs).filter(|(a, b)| a.1 + b.1 > 0.0).map(|(a, b)| (a.0 - b.0) / (a.1 + b.1).sqrt());
    let p: Vec<f64> = z.map(|z| Normal::standard().cdf(z)).collect();
    let total = |list: &[(f64, f64)]| list.iter().fold((0.0, 0.0), |(m, v), b| (m + b.0 / 64.0, v + b.1 / 4096.0));
    let ((mean, variance), (exact, other)) = (total(&ours), total(&theirs));
    vec![
        budget.uniform(&format!("{name}, blocks"), &p),
        budget.mean(&format!("{name}, mean"), (mean, (variance + other).sqrt(), 1e6), exact, margin * exact),
    ]
}

#[test]
fn plates_are_exact() {
    let mut budget = Budget::of("scene::plates");
    all_pass(compare("plates", "plates_exact.npy", None, (64, 0.01), &mut budget));
}

#[test]
fn the_cornell_box_is_that_of_another_renderer() {
    let mut budget = Budget::of("scene::cornell");
    all_pass(compare("cornell", "cornell.npy", Some("cornell_se.npy"), (128, 0.05), &mut budget));
}

#[test]
fn a_thousand_lamps_and_a_door_ajar() {
    let mut budget = Budget::of("scene::hard");
    let mut results = compare("many_lights", "many_lights.npy", Some("many_lights_se.npy"), (128, 0.05), &mut budget);
    results.extend(compare("ajar_door", "ajar_door.npy", Some("ajar_door_se.npy"), (256, 0.08), &mut budget));
    all_pass(results);
}
