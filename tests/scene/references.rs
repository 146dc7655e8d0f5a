//! Images against stored ones: exact where there is a closed form, else many passes of another renderer.
//!
//! ```text
//! χ² = Σ w (I − R)²,    E χ² = Σ w (V_I + V_R) if both have the same mean,    w given beforehand
//! ```
//!
//! over pixels, or over blocks of 8 × 8 pixels where tails are heavy. Squared standard errors are unbiased estimates of V, also where an image is so skewed that
//! z = (I − R)/√(V_I + V_R) is nowhere near normal: no pixel is left out, and none is given a tolerance. The weights are 1/V_R, or 1/V_I of another render:
//! they must not know the luck of the image. What the sum exceeds its expectation by, has an error by the spread of its terms.

use crate::common::{Budget, all_pass};
use crate::{AnyMethod, scene_file, solve};
use fredholm::estimator::Metropolis;
use fredholm::sampling::{Halton, Layout, Sobol};
use fredholm::scene::load;
use fredholm::walk::{Heuristic, Roulette};
use fredholm::{Bidirectional, Estimate, Forward, Spectrum, Walk};
use statrs::distribution::{ContinuousCDF, StudentsT};

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

/// Value and squared error, component by component, of pixels or of blocks.
type Field = Vec<([f64; 3], [f64; 3])>;

fn render(name: &str, method: &AnyMethod) -> Field {
    let loaded = load(scene_file(&format!("{name}.gltf"))).unwrap();
    assert!(loaded.report.is_empty(), "{}", loaded.report);
    let camera = loaded.cameras[0].0;
    let scene = loaded.builder.build().unwrap();
    let image = solve(&scene.light_transport(), &scene.film(camera, SIZE, SIZE), method);
    // where nothing was found there is no error, and none in the sum
    image.pixels().iter().map(|p| (p.value.0, p.std_error.unwrap_or_default().0.map(|e| e * e))).collect()
}

/// Path tracing along Sobol' points, with errors from 16 randomisations; a pixel takes two coordinates, a step and a next event three each.
fn traced(samples: u64, seed: u64) -> AnyMethod {
    let points = Sobol::new(seed).layout(Layout::of_dimension(3).start(2));
    Box::new(Walk::mis().roulette(Roulette::throughput(0.5).after(1)).samples_per_cell(samples).sequence(points))
}

/// In closed rooms walks that only hit are best.
fn hit(samples: u64, seed: u64) -> AnyMethod {
    Box::new(Walk::collision().roulette(Roulette::throughput(0.05)).samples_per_cell(samples).seed(seed))
}

fn reference(truth: &str, deviation: Option<&str>) -> Field {
    let variances = deviation.map_or(vec![[0.0; 3]; SIZE * SIZE], |name| stored(name).iter().map(|e| e.map(|x| x * x)).collect());
    stored(truth).into_iter().zip(variances).collect()
}

/// Means of blocks of 8 × 8 pixels.
fn blocks(field: &Field) -> Field {
    let block = |b: usize| {
        let pixels = (0..64).map(|k| &field[(b / 8 * 8 + k / 8) * SIZE + b % 8 * 8 + k % 8]);
        pixels.fold(([0.0; 3], [0.0; 3]), |(m, v), p| {
            (std::array::from_fn(|i| m[i] + p.0[i] / 64.0), std::array::from_fn(|i| v[i] + p.1[i] / 4096.0))
        })
    };
    (0..64).map(block).collect()
}

/// χ²/E χ² − 1 and its error; places where w is infinite, which are black in all renders, must be black.
fn excess(ours: &Field, truth: &Field, weights: &Field) -> (f64, f64, f64) {
    let (mut terms, mut expected) = (Vec::new(), 0.0);
    for ((a, b), w) in ours.iter().zip(truth).zip(weights) {
        let mut term = 0.0;
        for i in 0..3 {
            if w.1[i] == 0.0 {
                assert_eq!((a.0[i], a.1[i]), (b.0[i], 0.0));
                continue;
            }
            expected += (a.1[i] + b.1[i]) / w.1[i];
            term += ((a.0[i] - b.0[i]).powi(2) - a.1[i] - b.1[i]) / w.1[i];
        }
        terms.push(term);
    }
    // components of a pixel belong together
    let square: f64 = terms.iter().map(|t| t * t).sum();
    (terms.iter().sum::<f64>() / expected, square.sqrt() / expected, terms.len() as f64)
}

/// The mean of an image, component by component.
fn mean(field: &Field, i: usize) -> (f64, f64) {
    let n = field.len() as f64;
    field.iter().fold((0.0, 0.0), |(m, v), p| (m + p.0[i] / n, v + p.1[i] / (n * n)))
}

/// The method for a number of samples a pixel and a seed; pixels or blocks; the excess of χ² that may hide, and the relative bias of the image's mean that may.
struct Demands {
    method: fn(u64, u64) -> AnyMethod,
    samples: u64,
    unit: fn(&Field) -> Field,
    excess: f64,
    bias: f64,
}

/// χ², the means of the image, and are the p-values of the blocks uniform?
fn compare(name: &str, truth: &Field, demands: &Demands, budget: &mut Budget) -> Vec<Result<(), String>> {
    let Demands { method, samples, unit, excess: most, bias } = *demands;
    let ours = render(name, &method(samples, 5));
    let exact = truth.iter().all(|p| p.1 == [0.0; 3]);
    // an exact image has no errors: those of blocks of a render of its own
    let weights = if exact { spread(&blocks(&render(name, &method(samples, 6)))) } else { truth.clone() };
    let mut results = vec![budget.at_most(&format!("{name}, χ²"), excess(&unit(&ours), &unit(truth), &unit(&weights)), 0.0, most)];
    results.extend((0..3).map(|i| {
        let ((m, v), (t, e)) = (mean(&ours, i), mean(truth, i));
        budget.mean(&format!("{name}, mean {i}"), (m, (v + e).sqrt(), 1e3), t, bias * t)
    }));
    let normal = StudentsT::new(0.0, 1.0, 1e3).unwrap();
    let p = |(a, b): (&([f64; 3], [f64; 3]), &([f64; 3], [f64; 3]))| normal.cdf((a.0[1] - b.0[1]) / (a.1[1] + b.1[1]).sqrt());
    let p: Vec<f64> = blocks(&ours).iter().zip(&blocks(truth)).map(p).collect();
    results.push(budget.uniform(&format!("{name}, blocks"), &p));
    results
}

/// Every pixel with what its block has, 64 times as much.
fn spread(blocks: &Field) -> Field {
    let at = |p: usize| blocks[p / SIZE / 8 * 8 + p % SIZE / 8];
    (0..SIZE * SIZE).map(|p| (at(p).0, at(p).1.map(|v| 64.0 * v))).collect()
}

#[test]
fn plates_and_furnaces_are_exact() {
    let mut budget = Budget::of("scene::exact");
    let pixels = |method, samples, bias| Demands { method, samples, unit: Field::clone, excess: 0.5, bias };
    let mut results = compare("plates", &reference("plates_exact.npy", None), &pixels(traced, 128, 4e-3), &mut budget);
    let furnace = |radiance: [f64; 3]| vec![(radiance, [0.0; 3]); SIZE * SIZE];
    results.extend(compare("furnace_box", &furnace([2.0, 5.0, 10.0]), &pixels(hit, 16, 2e-3), &mut budget));
    results.extend(compare("furnace_sphere", &furnace([2.0, 2.5, 2.5]), &pixels(hit, 16, 2e-3), &mut budget));
    all_pass(results);
}

#[test]
fn the_cornell_box_is_that_of_another_renderer() {
    let mut budget = Budget::of("scene::cornell");
    let demands = Demands { method: traced, samples: 256, unit: Field::clone, excess: 0.5, bias: 0.015 };
    all_pass(compare("cornell", &reference("cornell.npy", Some("cornell_se.npy")), &demands, &mut budget));
}

#[test]
fn a_thousand_lamps_and_a_door_ajar() {
    let mut budget = Budget::of("scene::hard");
    let by_block = |samples, excess, bias| Demands { method: traced, samples, unit: blocks, excess, bias };
    let of = |name: &str| reference(&format!("{name}.npy"), Some(&format!("{name}_se.npy")));
    let mut results = compare("many_lights", &of("many_lights"), &by_block(128, 1.5, 0.035), &mut budget);
    results.extend(compare("ajar_door", &of("ajar_door"), &by_block(256, 2.0, 0.06), &mut budget));
    all_pass(results);
}

/// What finds light in other ways: each pixel of a film of 8 × 8 is a block.
fn methods(samples: u64) -> Vec<(&'static str, AnyMethod)> {
    let roulette = Roulette::throughput(0.5);
    let pairs = Bidirectional::new().samples_per_cell(samples / 2);
    vec![
        ("next event", Box::new(Walk::next_event().roulette(roulette).samples_per_cell(samples).seed(1))),
        ("maximum", Box::new(Walk::mis().heuristic(Heuristic::Maximum).roulette(roulette).samples_per_cell(samples).seed(2))),
        ("Halton", Box::new(Walk::mis().roulette(roulette).samples_per_cell(samples).sequence(Halton::new(3)))),
        ("light tracing", Box::new(Forward::new().walks(64 * samples).seed(4))),
        ("pairs", Box::new(pairs.seed(5))),
        ("pairs, power", Box::new(pairs.heuristic(Heuristic::Power(2.0)).seed(6))),
    ]
}

/// All methods find the same image, block by block.
#[test]
fn all_methods_agree() {
    let mut budget = Budget::of("scene::agreement");
    let mut results = Vec::new();
    for (name, samples) in [("cornell", 1 << 10), ("plates", 1 << 10), ("many_lights", 1 << 10), ("ajar_door", 1 << 11)] {
        let truth = match name {
            "plates" => reference("plates_exact.npy", None),
            _ => reference(&format!("{name}.npy"), Some(&format!("{name}_se.npy"))),
        };
        let truth = blocks(&truth);
        let loaded = load(scene_file(&format!("{name}.gltf"))).unwrap();
        let scene = loaded.builder.build().unwrap();
        let (equation, film) = (scene.light_transport(), scene.film(loaded.cameras[0].0, 8, 8));
        let field = |image: &[Estimate<Spectrum<3>>]| -> Field {
            image.iter().map(|p| (p.value.0, p.std_error.unwrap_or_default().0.map(|e| e * e))).collect()
        };
        let mut fields: Vec<(&str, Field)> =
            methods(samples).iter().map(|(method, m)| (*method, field(solve(&equation, &film, m).pixels()))).collect();
        let query = equation.seen_by(&film);
        let pairs = query.bidirectional(&Bidirectional::new()).unwrap().shared();
        let chains = Metropolis::new().mutations(samples).pool(samples / 4).seed(7).solve(&pairs).unwrap();
        fields.push(("Metropolis", field(&chains.cells)));
        // weights of a method must not know its luck: those of next event, and the other way round
        let weights = [fields[0].1.clone(), fields[1].1.clone()];
        for (k, (method, found)) in fields.iter().enumerate() {
            let found = excess(found, &truth, &weights[usize::from(k == 0)]);
            results.push(budget.at_most(&format!("{name}, {method}"), found, 0.0, 4.5));
        }
    }
    all_pass(results);
}
