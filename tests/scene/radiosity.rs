//! Walks against a linear system of the same kernel, patch by patch.

use crate::common::{Budget, all_pass};
use crate::scene_file;
use fredholm::scene::{Material, Radiosity, Scene, Sides, load, shapes};
use fredholm::{Walk, walk::Roulette};

/// Two plates: the middle of the image is the middle of a plate, known to 15 digits.
#[test]
fn plates_by_radiosity() {
    let scene = load(scene_file("plates.gltf")).unwrap().builder.build().unwrap();
    let patches = scene.patches(0.36).unwrap();
    let radiance = scene.light_transport().seen_by(&patches).solve(&Radiosity).unwrap();
    // means over both plates of ρ = 0.8, 0.5, 0.2, by a self-converged Nyström solve: references/plates
    let areas = patches.areas();
    let mean = |c: usize| radiance.iter().zip(&areas).map(|(l, a)| l[c] * a / 8.0).sum::<f64>();
    let walked = scene.light_transport().seen_by(&scene.patches(10.0).unwrap()).solve(&Walk::mis().samples_per_cell(1 << 14)).unwrap();
    let expected = |c: usize| walked.iter().map(|l| l.value[c] / walked.len() as f64).sum::<f64>();
    for c in 0..3 {
        assert!((mean(c) / expected(c) - 1.0).abs() < 6e-3, "{c}: {} {}", mean(c), expected(c));
    }
}

/// A box with a table in it: shadows, two-sided surfaces, colours.
#[test]
fn patch_by_patch() {
    let mut scene = Scene::builder();
    let (red, white) =
        (scene.material(Material::diffuse([0.8, 0.2, 0.1])), scene.material(Material::diffuse([0.6; 3]).sides(Sides::Front)));
    let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([5.0; 3]));
    scene.mesh(shapes::room([0.0; 3], [1.0; 3]).unwrap(), white).unwrap();
    scene.mesh(shapes::parallelogram([0.3, 0.4, 0.3], [0.0, 0.0, 0.4], [0.4, 0.0, 0.0]).unwrap(), red).unwrap();
    scene.mesh(shapes::parallelogram([0.4, 0.8, 0.4], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2]).unwrap(), lamp).unwrap();
    let scene = scene.build().unwrap();
    let (equation, patches) = (scene.light_transport(), scene.patches(0.45).unwrap());
    let solved = equation.seen_by(&patches).solve(&Radiosity).unwrap();
    let walk = Walk::mis().roulette(Roulette::throughput(0.3)).samples_per_cell(1 << 10).seed(3);
    let walked = equation.seen_by(&patches).solve(&walk).unwrap();
    let mut budget = Budget::of("scene::radiosity");
    let areas = patches.areas();
    // beside the mean: patches that a shadow crosses are dark, and differ most
    let mean = solved.iter().map(|s| s[0]).sum::<f64>() / solved.len() as f64;
    let beyond = |s: f64, w: f64, error: f64| ((s - w).abs() - 2.0 * error).max(0.0);
    let squares = solved.iter().zip(&walked).map(|(s, w)| beyond(s[0], w.value[0], w.std_error.unwrap()[0]).powi(2)).sum::<f64>();
    let rms = (squares / solved.len() as f64).sqrt() / mean;
    assert!(rms < 0.1, "patches differ by {rms} of the mean beyond the error of their walks");
    let total = |c: usize| {
        let squares = walked.iter().zip(&areas).map(|(w, a)| (w.std_error.unwrap()[c] * a).powi(2)).sum::<f64>();
        let (s, w) = solved.iter().zip(&walked).zip(&areas).fold((0.0, 0.0), |t, ((s, w), a)| (t.0 + s[c] * a, t.1 + w.value[c] * a));
        (s, w, squares.sqrt())
    };
    all_pass((0..3).map(|c| {
        let (solved, walked, error) = total(c);
        // the patches' own error is allowed for as a margin on both sides
        let bias = 0.02 * solved;
        let nearest = walked.clamp(solved - bias, solved + bias);
        budget.mean(&format!("radiosity, {c}"), (walked, error, 1e6), nearest, 0.03 * solved)
    }));
}
