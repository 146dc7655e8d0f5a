//! Scattering laws: `sample`, `eval` and `pdf` belong together; reciprocity; energy.

use crate::common::{Budget, all_pass};
use fredholm::Spectrum;
use fredholm::sampling::{Pcg, Sampler, Sequence, Sobol};
use fredholm::scene::{Bsdf, MetallicRoughness};

fn laws() -> Vec<(&'static str, Bsdf)> {
    let grey = Spectrum([0.9, 0.5, 0.2]);
    let white = Spectrum([1.0; 3]);
    vec![
        ("Lambertian", Bsdf::Lambertian { albedo: grey }),
        ("conductor 0.3", Bsdf::Conductor { specular: grey, alpha: 0.3 }),
        ("conductor 0.02", Bsdf::Conductor { specular: grey, alpha: 0.02 }),
        ("rough glass in", Bsdf::RoughDielectric { index: 1.5, tint: white, alpha: 0.4 }),
        ("rough glass out", Bsdf::RoughDielectric { index: 1.0 / 1.5, tint: white, alpha: 0.2 }),
        ("plastic", Bsdf::MetallicRoughness(MetallicRoughness::new(grey, 0.0, 0.5))),
        ("half metal", Bsdf::MetallicRoughness(MetallicRoughness::new(grey, 0.5, 0.7))),
    ]
}

fn direction(cosine: f64, angle: f64) -> [f64; 3] {
    let sine = (1.0 - cosine * cosine).sqrt();
    [sine * angle.cos(), sine * angle.sin(), cosine]
}

fn views(bsdf: &Bsdf) -> Vec<[f64; 3]> {
    let mut views = vec![direction(0.95, 0.3), direction(0.3, 2.0)];
    if bsdf.transmits() {
        views.push(direction(-0.6, 1.0));
    }
    views
}

#[test]
fn samples_weights_and_densities_agree() {
    for (name, bsdf) in laws() {
        for wo in views(&bsdf) {
            let mut mean = [0.0; 3];
            const N: u64 = 4000;
            for i in 0..N {
                let mut u = Pcg::new(3).point(0, 0, i);
                let Some(s) = bsdf.sample(wo, &mut u) else { panic!("{name}: nothing from {wo:?}") };
                (0..3).for_each(|i| mean[i] += s.weight[i] / N as f64);
                if s.weight == Spectrum([0.0; 3]) {
                    continue;
                }
                let (pdf, value) = (bsdf.pdf(wo, s.incoming), bsdf.eval(wo, s.incoming));
                assert!((s.pdf / pdf - 1.0).abs() < 1e-9, "{name}: pdf {} of the sample, {pdf} asked for", s.pdf);
                for i in 0..3 {
                    assert!(
                        (s.weight[i] * pdf - value[i]).abs() < 1e-7 * value[i].max(1e-12),
                        "{name}: weight {} pdf {pdf} value {}",
                        s.weight[i],
                        value[i]
                    );
                }
            }
            assert!(mean.iter().all(|m| *m <= 1.0 + 3.0 / (N as f64).sqrt()), "{name}: gives back {mean:?} of 1");
        }
    }
}

#[test]
fn all_laws_are_reciprocal() {
    for (name, bsdf) in laws() {
        let mut u = Pcg::new(7).point(0, 0, 0);
        for _ in 0..2000 {
            let [a, b] = [(); 2].map(|()| direction(2.0 * u.next_1d() - 1.0, 7.0 * u.next_1d()));
            let (there, back) = (bsdf.eval(a, b), bsdf.eval(b, a));
            // n² on the side of a direction
            let square = |d: [f64; 3]| match bsdf {
                Bsdf::RoughDielectric { index, .. } if d[2] < 0.0 => index * index,
                _ => 1.0,
            };
            for i in 0..3 {
                let (f, g) = (there[i] / (b[2].abs() * square(b)), back[i] / (a[2].abs() * square(a)));
                assert!((f - g).abs() <= 1e-7 * f.max(g), "{name}: f({a:?}, {b:?}) = {f}, back {g}");
            }
        }
    }
}

/// χ² of 24 × 12 cells of the sphere, in the cosine and the angle.
#[test]
fn samples_have_their_density() {
    const N: u64 = 60_000;
    let (rows, columns) = (24, 12);
    let mut budget = Budget::of("scene::materials");
    let mut results = Vec::new();
    for (name, bsdf) in laws() {
        for wo in views(&bsdf) {
            let mut observed = vec![0u64; rows * columns];
            let mut lost = 0;
            for i in 0..N {
                let s = bsdf.sample(wo, &mut Pcg::new(11).point(0, 0, i)).unwrap();
                // facets whose light goes below the surface, or back through it
                if s.weight == Spectrum([0.0; 3]) {
                    lost += 1;
                    continue;
                }
                let [x, y, z] = s.incoming;
                let row = ((z + 1.0) / 2.0 * rows as f64) as usize;
                let column = (y.atan2(x) / std::f64::consts::TAU + 0.5) * columns as f64;
                observed[row.min(rows - 1) * columns + (column as usize).min(columns - 1)] += 1;
            }
            let mut expected: Vec<f64> =
                (0..rows * columns).map(|k| N as f64 * mass(&bsdf, wo, k / columns, k % columns, rows, columns)).collect();
            observed.push(lost);
            expected.push((N as f64 - expected.iter().sum::<f64>()).max(0.0));
            results.push(budget.counts(name, &observed, &expected));
        }
    }
    all_pass(results);
}

/// ∫ pdf over one cell, by the midpoint rule.
fn mass(bsdf: &Bsdf, wo: [f64; 3], row: usize, column: usize, rows: usize, columns: usize) -> f64 {
    const M: usize = 96;
    let at = |i: usize, k: usize, n: usize| (i as f64 + (k as f64 + 0.5) / M as f64) / n as f64;
    let area = 2.0 / (rows * M) as f64 * std::f64::consts::TAU / (columns * M) as f64;
    let points =
        (0..M * M).map(|k| direction(2.0 * at(row, k / M, rows) - 1.0, std::f64::consts::TAU * (at(column, k % M, columns) - 0.5)));
    area * points.map(|wi| bsdf.pdf(wo, wi)).sum::<f64>()
}

/// Smooth glass gives back all it gets, whichever way it goes.
#[test]
fn smooth_laws_keep_energy() {
    let glass = Bsdf::Dielectric { index: 1.5, tint: Spectrum([1.0; 3]) };
    for wo in [direction(0.9, 0.0), direction(0.1, 1.0), direction(-0.9, 2.0), direction(-0.2, 3.0)] {
        let mut through = 0;
        for i in 0..1000 {
            let s = glass.sample(wo, &mut Pcg::new(1).point(0, 0, i)).unwrap();
            assert_eq!(s.weight, Spectrum([1.0; 3]));
            let [x, y, z] = s.incoming;
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-12);
            through += u32::from(z * wo[2] < 0.0);
        }
        // beyond the critical angle nothing comes out
        assert_eq!(through == 0, wo[2] == -0.2, "{through} of 1000 through");
    }
}

/// The white furnace of every roughness and angle: nothing gives back more than it gets, and narrow lobes lose next to nothing. Light that meets facets twice
/// is lost: of a metal with α = 1, seen from above, E = ∫₀¹ c/(1 + c) dc = 1 − ln 2 is left.
#[test]
fn white_things_are_not_brighter_than_white() {
    let white = Spectrum([1.0; 3]);
    for alpha in [1e-4, 1e-2, 0.1, 0.3, 0.6, 1.0] {
        let plastic = MetallicRoughness { diffuse: white, specular: Spectrum([0.04; 3]), grazing: 1.0, alpha };
        for (name, bsdf, keeps) in [
            ("metal", Bsdf::Conductor { specular: white, alpha }, true),
            ("glass, from outside", Bsdf::RoughDielectric { index: 1.5, tint: white, alpha }, true),
            ("glass, from inside", Bsdf::RoughDielectric { index: 1.0 / 1.5, tint: white, alpha }, true),
            ("plastic", Bsdf::MetallicRoughness(plastic), false),
        ] {
            for cosine in [1.0, 0.8, 0.4, 0.1] {
                const N: u64 = 1 << 12;
                let weight = |i| bsdf.sample(direction(cosine, 0.7), &mut Sobol::new(1).point(0, 0, i)).unwrap().weight[0];
                let (sum, most) = (0..N).map(weight).fold((0.0, 0.0f64), |(s, m), w| (s + w, m.max(w)));
                let given = sum / N as f64;
                let what = format!("{name}, α = {alpha}, cos θ = {cosine}: {given} of 1, weights up to {most}");
                assert!(given <= 1.0 + 2e-3, "{what}");
                // facets drawn as they are seen have weights F G/G₁
                assert!(!keeps || most <= 1.0 + 1e-12, "{what}");
                assert!(!keeps || given >= 1.0 - (alpha / cosine).min(0.75), "{what}");
                if (name, alpha, cosine) == ("metal", 1.0, 1.0) {
                    assert!((given - (1.0 - 2f64.ln())).abs() < 1e-3, "{what}");
                }
            }
        }
    }
}
