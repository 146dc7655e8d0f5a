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

/// A convex room of several colours under a ceiling that glows: patch by patch within the errors of the walks, after patches of two sizes have shown that
/// theirs are smaller.
#[test]
fn every_patch_of_a_convex_room() {
    let mut scene = Scene::builder();
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let walls = [([0.0; 3], z, x, 0.7), ([0.0; 3], y, z, 0.2), (x, z, y, 0.5), ([0.0; 3], x, y, 0.8), (z, y, x, 0.6)];
    for (corner, u, v, albedo) in walls {
        let wall = scene.material(Material::diffuse([albedo, 0.5 * albedo, 0.3]).sides(Sides::Front));
        scene.mesh(shapes::parallelogram(corner, u, v).unwrap(), wall).unwrap();
    }
    let ceiling = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]).sides(Sides::Front));
    scene.mesh(shapes::parallelogram(y, x, z).unwrap(), ceiling).unwrap();
    let scene = scene.build().unwrap();
    let equation = scene.light_transport();
    let [coarse, fine] = [0.36, 0.18].map(|size| equation.seen_by(&scene.patches(size).unwrap()).solve(&Radiosity).unwrap());
    let walk = Walk::mis().roulette(Roulette::throughput(0.3)).samples_per_cell(1 << 10).seed(3);
    let walked = equation.seen_by(&scene.patches(0.36).unwrap()).solve(&walk).unwrap();
    // the four triangles of each
    let means: Vec<f64> = fine.as_chunks::<4>().0.iter().map(|part| part.iter().map(|l| l[0] / 4.0).sum()).collect();
    assert_eq!((coarse.len(), means.len(), walked.len()), (192, 192, 192));
    let errors: Vec<f64> = walked.iter().map(|w| w.std_error.unwrap()[0]).collect();
    let square = |of: &dyn Fn(usize) -> f64| (0..192).map(|i| (of(i) / errors[i]).powi(2)).sum::<f64>() / 192.0;
    let mean = |of: &dyn Fn(usize) -> f64| (0..192).map(of).sum::<f64>() / 192.0;
    // between the sizes a third of the coarse patches' error and most of all that the fine ones have left
    let drift = square(&|i| means[i] - coarse[i][0]);
    let drift_of_mean = (mean(&|i| means[i]) - mean(&|i| coarse[i][0])).abs() / mean(&|i| means[i]);
    assert!(drift < 0.2 && drift_of_mean < 1e-3, "χ² of the patches {drift}, their mean {drift_of_mean}");
    let chi = square(&|i| walked[i].value[0] - means[i]);
    let error = errors.iter().map(|e| e * e).sum::<f64>().sqrt() / 192.0;
    let mut budget = Budget::of("scene::radiosity room");
    all_pass([
        budget.at_most("χ² a patch", (chi, (2.0f64 / 192.0).sqrt(), 1e6), 1.0 + drift, 0.9),
        budget.mean("mean of the room", (mean(&|i| walked[i].value[0]), error, 1e6), mean(&|i| means[i]), 0.01 * mean(&|i| means[i])),
    ]);
}
