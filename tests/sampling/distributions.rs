//! Every distribution against its own density: χ², normalisation, tails, and the way back.

use crate::common::{Budget, all_pass};
use fredholm::Error;
use fredholm::deterministic::quadrature::composite_unit_rule;
use fredholm::sampling::distribution::*;
use fredholm::sampling::{Pcg, Sampler, Sequence};
use std::f64::consts::TAU;

const MOST: f64 = 1.0 - f64::EPSILON / 2.0;
const LEAST: f64 = f64::EPSILON / 2.0;
/// Draws of a χ² test of 64 cells: a cell's excess of 3 % would be seen.
const DRAWS: u64 = 1 << 20;

type Line = Box<dyn Inverse<Unit = f64, Point = f64>>;
type Plane = Box<dyn Inverse<Unit = [f64; 2], Point = [f64; 3]>>;

/// Distributions of numbers, and the places where their densities have breaks, the ends of the support first and last.
fn lines() -> Vec<(&'static str, Line, Vec<f64>)> {
    let edges = [-1.0, 0.0, 0.25, 2.0, 2.5, 4.0];
    let rough: Vec<f64> = (0..40).map(|i| if i % 7 == 3 { 0.0 } else { (f64::from(i) * 0.37).fract() }).collect();
    let knots: Vec<f64> = (0..=40).map(|i| f64::from(i) / 40.0).collect();
    vec![
        ("steps", Box::new(PiecewiseConstant::new(&edges, &[0.0, 3.0, 1.0, 0.0, 0.5]).unwrap()), edges.to_vec()),
        ("steps, empty ends", Box::new(PiecewiseConstant::new(&edges, &[0.0, 3.0, 1.0, 2.0, 0.0]).unwrap()), edges.to_vec()),
        ("40 steps", Box::new(PiecewiseConstant::on(0.0..=1.0, &rough).unwrap()), knots.clone()),
        ("polygon", Box::new(PiecewiseLinear::new(&edges, &[0.0, 3.0, 1.0, 0.0, 0.0, 2.0]).unwrap()), edges.to_vec()),
        ("polygon, flat and falling", Box::new(PiecewiseLinear::new(&edges, &[2.0, 2.0, 1.0, 1e-9, 1.0, 0.0]).unwrap()), edges.to_vec()),
        ("40 sides", Box::new(PiecewiseLinear::new(&knots[..40], &rough).unwrap()), knots[..40].to_vec()),
        ("x²", Box::new(Power::new(2.0).unwrap()), vec![0.0, 1.0]),
        ("x⁹", Box::new(Power::new(9.0).unwrap()), vec![0.0, 1.0]),
        ("x^0.5", Box::new(Power::new(0.5).unwrap()), vec![0.0, 1e-8, 1e-5, 1e-3, 0.1, 1.0]),
        ("1", Box::new(Power::new(0.0).unwrap()), vec![0.0, 1.0]),
        ("e^−3x", Box::new(Exponential::new(3.0).unwrap()), vec![0.0, 1.0, 3.0, 6.0, 12.0, 14.0]),
    ]
}

/// ∫ₐᵇ of the density, cut at its breaks.
fn mass(d: &Line, breaks: &[f64], a: f64, b: f64) -> f64 {
    let cuts: Vec<f64> = [a].into_iter().chain(breaks.iter().copied().filter(|x| *x > a && *x < b)).chain([b]).collect();
    let rule = composite_unit_rule(16, 8);
    cuts.windows(2).map(|c| rule.iter().map(|p| p.weight * (c[1] - c[0]) * d.pdf(&(c[0] + (c[1] - c[0]) * p.point))).sum::<f64>()).sum()
}

#[test]
fn lines_follow_their_densities() {
    let mut budget = Budget::of("sampling::lines");
    let mut results = Vec::new();
    for (seed, (name, d, breaks)) in (0..).zip(lines()) {
        let (first, last) = (breaks[0], breaks[breaks.len() - 1]);
        let total = mass(&d, &breaks, first, last);
        assert!((total - 1.0).abs() < 1e-8, "{name}: the density integrates to {total}");
        assert_eq!((d.pdf(&(first - 1.0)), d.invert(&(first - 1.0))), (0.0, None), "{name}");
        let cells: u32 = 64;
        let edge = |i: u32| first + (last - first) * f64::from(i) / f64::from(cells);
        let expected: Vec<f64> = (0..cells).map(|i| DRAWS as f64 * mass(&d, &breaks, edge(i), edge(i + 1))).collect();
        let (mut counts, mut u) = (vec![0u64; cells as usize], Pcg::new(seed).point(0, 0, 0));
        for _ in 0..DRAWS {
            let x = d.sample(u.next_1d());
            counts[(((x - first) / (last - first) * f64::from(cells)) as usize).min(63)] += 1;
            assert!(d.pdf(&x) > 0.0, "{name}: drew {x} of density 0");
        }
        results.push(budget.counts(name, &counts, &expected));
    }
    all_pass(results);
}

/// The mass below the sample of u is u, down to the smallest number and up to the largest; the inverse leads back.
#[test]
fn lines_reach_their_tails_and_come_back() {
    for (name, d, breaks) in lines() {
        let tail = |x: f64| mass(&d, &breaks, breaks[0], x);
        let (mut before, ends) = (f64::NEG_INFINITY, [LEAST, 1e-12, 1e-9, 1e-6, 1e-3]);
        let middle = (1..200).map(|i| f64::from(i) / 200.0);
        for u in ends.into_iter().chain(middle).chain(ends.into_iter().rev().map(|e| 1.0 - e)) {
            let x = d.sample(u);
            assert!(x >= before && x.is_finite() && d.pdf(&x) > 0.0, "{name}: {u} goes to {x}");
            before = x;
            let below = tail(x);
            assert!(
                (below - u).abs() < 1e-8 && (u > 1e-3 || below < 1.01 * u + 4.0 * LEAST),
                "{name}: {below} of the mass is below the sample of {u}"
            );
            let back = d.invert(&x).unwrap();
            assert!((back - u).abs() < 1e-12, "{name}: {u} goes to {x}, which comes from {back}");
        }
        if name != "e^−3x" {
            // closed ends are safe too
            assert!((breaks[0]..=breaks[breaks.len() - 1]).contains(&d.sample(0.0)) && d.sample(1.0) <= breaks[breaks.len() - 1]);
        }
    }
    assert!(Exponential::new(1.0).unwrap().sample(MOST) < 37.0);
    assert!(Power::new(-0.94).unwrap().sample(LEAST) > 0.0);
    assert!((Power::new(-0.5).unwrap().invert(&0.25).unwrap() - 0.5).abs() < 1e-15);
}

/// A distribution in the plane, seen in space.
struct Flat<D>(D);

impl<D: Inverse<Unit = [f64; 2], Point = [f64; 2]>> Distribution for Flat<D> {
    type Unit = [f64; 2];
    type Point = [f64; 3];
    fn sample(&self, u: [f64; 2]) -> [f64; 3] {
        let [x, y] = self.0.sample(u);
        [x, y, 0.0]
    }
    fn pdf(&self, x: &[f64; 3]) -> f64 {
        self.0.pdf(&[x[0], x[1]])
    }
}

impl<D: Inverse<Unit = [f64; 2], Point = [f64; 2]>> Inverse for Flat<D> {
    fn invert(&self, x: &[f64; 3]) -> Option<[f64; 2]> {
        self.0.invert(&[x[0], x[1]])
    }
}

/// Coordinates (s, t) of [0, 1]² that measure the place where a point lies: the point, and the area or solid angle of ds dt.
type Chart = fn(f64, f64) -> ([f64; 3], f64);

fn sphere(s: f64, t: f64) -> ([f64; 3], f64) {
    let (z, sine) = (2.0 * s - 1.0, 2.0 * (s * (1.0 - s)).sqrt());
    ([sine * (TAU * t).cos(), sine * (TAU * t).sin(), z], 2.0 * TAU)
}

/// Finer towards the axis, for peaks: z = 1 − 2q⁴.
fn peaked(q: f64, t: f64) -> ([f64; 3], f64) {
    let w = 2.0 * q.powi(4);
    let sine = (w * (2.0 - w)).sqrt();
    ([sine * (TAU * t).cos(), sine * (TAU * t).sin(), 1.0 - w], TAU * 8.0 * q.powi(3))
}

fn peaked_backward(q: f64, t: f64) -> ([f64; 3], f64) {
    let ([x, y, z], area) = peaked(q, t);
    ([x, y, -z], area)
}

fn unpeaked([x, y, z]: [f64; 3]) -> [f64; 2] {
    let w = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
    [(w / 2.0).powf(0.25), turn(x, y)]
}

fn turn(x: f64, y: f64) -> f64 {
    (y.atan2(x) / TAU).rem_euclid(1.0)
}

fn disk(s: f64, t: f64) -> ([f64; 3], f64) {
    ([s.sqrt() * (TAU * t).cos(), s.sqrt() * (TAU * t).sin(), 0.0], 0.5 * TAU)
}

fn square(s: f64, t: f64) -> ([f64; 3], f64) {
    ([3.0 * s - 1.0, 2.0 * t, 0.0], 6.0)
}

const CORNERS: [[f64; 3]; 3] = [[1.0, 0.0, -1.0], [3.0, 1.0, 0.0], [0.5, 2.0, 4.0]];

/// Of twice the triangle, the parallelogram: half of it is empty.
fn parallelogram(s: f64, t: f64) -> ([f64; 3], f64) {
    let [a, b, c] = CORNERS;
    (std::array::from_fn(|i| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i])), 2.0 * UniformTriangle::new(CORNERS).unwrap().area())
}

fn in_parallelogram(x: [f64; 3]) -> [f64; 2] {
    let [u, v] = UniformTriangle::new(CORNERS).unwrap().invert(&x).unwrap();
    [u.sqrt() * (1.0 - v), u.sqrt() * v]
}

fn planes() -> Vec<(&'static str, Plane, Chart, fn([f64; 3]) -> [f64; 2])> {
    let on_sphere: fn([f64; 3]) -> [f64; 2] = |[x, y, z]| [0.5 + 0.5 * z, turn(x, y)];
    let backward: fn([f64; 3]) -> [f64; 2] = |[x, y, z]| unpeaked([x, y, -z]);
    let rows = [[1.0, 0.0, 3.0], [0.0, 0.0, 0.0], [0.5, 2.0, 0.0], [1.0, 1.0, 1.0]];
    let table = PiecewiseConstant2d::on([(-1.0..=2.0).into(), (0.0..=2.0).into()], &rows).unwrap();
    let phase = |g| Box::new(HenyeyGreenstein::new(g).unwrap());
    vec![
        ("sphere", Box::new(UniformSphere), sphere, on_sphere),
        ("hemisphere", Box::new(UniformHemisphere), sphere, on_sphere),
        ("cosine hemisphere", Box::new(CosineHemisphere), sphere, on_sphere),
        ("cone of 120°", Box::new(UniformCone::new(0.5).unwrap()), sphere, on_sphere),
        ("cone of 11°", Box::new(UniformCone::new(1.0 - 2.0 * 0.25f64.powi(4)).unwrap()), peaked, unpeaked),
        ("g = 0", phase(0.0), sphere, on_sphere),
        ("g = 0.5", phase(0.5), peaked, unpeaked),
        ("g = −0.8", phase(-0.8), peaked_backward, backward),
        ("g = 0.99", phase(0.99), peaked, unpeaked),
        ("disk", Box::new(Flat(UniformDisk)), disk, |[x, y, _]| [x * x + y * y, turn(x, y)]),
        ("triangle", Box::new(UniformTriangle::new(CORNERS).unwrap()), parallelogram, in_parallelogram),
        ("table", Box::new(Flat(table)), square, |[x, y, _]| [(x + 1.0) / 3.0, y / 2.0]),
    ]
}

#[test]
fn planes_follow_their_densities() {
    let mut budget = Budget::of("sampling::planes");
    let mut results = Vec::new();
    for (seed, (name, d, chart, place)) in (100..).zip(planes()) {
        // 12 × 8 cells: a multiple of the table's, of the quarters of the cones and of the triangle's diagonal
        let (rows, columns) = if name == "triangle" { (8usize, 8usize) } else { (12, 8) };
        let rule = composite_unit_rule(if name == "triangle" { 64 } else { 4 }, 4);
        let cell = |i: usize, j: usize| {
            let at = |s: f64, t: f64| {
                let (x, area) = chart((i as f64 + s) / rows as f64, (j as f64 + t) / columns as f64);
                d.pdf(&x) * area
            };
            rule.iter().flat_map(|s| rule.iter().map(move |t| (s, t))).map(|(s, t)| s.weight * t.weight * at(s.point, t.point)).sum::<f64>()
                / (rows * columns) as f64
        };
        let masses: Vec<f64> = (0..rows * columns).map(|c| cell(c / columns, c % columns)).collect();
        let total: f64 = masses.iter().sum();
        // the diagonal of the triangle is a jump, which no Gauss rule likes
        let tolerance = if name == "triangle" { 1e-3 } else { 1e-6 };
        assert!((total - 1.0).abs() < tolerance, "{name}: the density integrates to {total}");
        let (mut counts, mut u) = (vec![0u64; rows * columns], Pcg::new(seed).point(0, 0, 0));
        let draws = if name == "triangle" { DRAWS / 8 } else { DRAWS };
        for _ in 0..draws {
            let x = d.sample(u.next_2d());
            let [s, t] = place(x);
            counts[((s * rows as f64) as usize).min(rows - 1) * columns + ((t * columns as f64) as usize).min(columns - 1)] += 1;
            assert!(d.pdf(&x) > 0.0, "{name}: drew {x:?} of density 0");
        }
        let expected: Vec<f64> = masses.iter().map(|m| m * draws as f64 / total).collect();
        results.push(budget.counts(name, &counts, &expected));
    }
    all_pass(results);
}

#[test]
fn planes_come_back() {
    for (name, d, ..) in planes() {
        let grid = [LEAST, 1e-9, 1e-4, 0.1, 0.25, 0.3, 0.5, 0.6, 0.75, 0.9, 1.0 - 1e-4, MOST];
        for u in grid.into_iter().flat_map(|u| grid.map(|v| [u, v])) {
            let x = d.sample(u);
            assert!(d.pdf(&x) > 0.0 && d.pdf(&x).is_finite() && x.iter().all(|x| x.is_finite()), "{name}: {u:?} goes to {x:?}");
            let back = d.invert(&x).unwrap_or_else(|| panic!("{name}: {u:?} goes to {x:?}, which is outside"));
            // rounding of a cosine, at worst, is blown up by the root of the distance from the axis: 1e-8
            let turned = |a: f64, b: f64| (a - b).abs().min(1.0 - (a - b).abs());
            let tolerance = if u[0] < 1e-3 || u[0] > 0.999 { 3e-8 } else { 1e-11 };
            assert!((back[0] - u[0]).abs() < tolerance, "{name}: {u:?} goes to {x:?}, which comes from {back:?}");
            assert!(turned(back[1], u[1]) < tolerance.max(1e-11), "{name}: {u:?} goes to {x:?}, which comes from {back:?}");
        }
        if !["disk", "triangle", "table"].contains(&name) {
            let x = d.sample([0.3, 0.7]);
            assert!((x.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14, "{name}: {x:?} is no direction");
        }
    }
}

/// The mean cosine of Henyey and Greenstein's function is g, by midpoints in u.
#[test]
fn asymmetry_is_the_mean_cosine() {
    for g in [-0.999, -0.3, -1e-9, 0.0, 1e-12, 0.2, 0.85, 0.9999] {
        let d = HenyeyGreenstein::new(g).unwrap();
        // finer towards u = 0 and 1: u = 3s² − 2s³
        let n = 100_000;
        let mean: f64 = (0..n)
            .map(|i| (f64::from(i) + 0.5) / f64::from(n))
            .map(|s| d.sample([s * s * (3.0 - 2.0 * s), 0.1])[2] * 6.0 * s * (1.0 - s))
            .sum();
        assert!((mean / f64::from(n) - g).abs() < 1e-7, "{g}: {}", mean / f64::from(n));
    }
}

#[test]
fn indices_have_their_probabilities() {
    let mut budget = Budget::of("sampling::indices");
    let weights: Vec<f64> = (0..50).map(|i| if i % 5 == 2 { 0.0 } else { f64::from((i * i) % 17) + 0.01 }).collect();
    let (bisected, alias) = (Discrete::new(&weights).unwrap(), Alias::new(&weights).unwrap());
    let total: f64 = weights.iter().sum();
    let mut results = Vec::new();
    for (seed, (name, d)) in
        [("bisection", &bisected as &dyn Distribution<Unit = f64, Point = usize>), ("alias", &alias)].into_iter().enumerate()
    {
        let (mut counts, mut u) = (vec![0u64; 50], Pcg::new(seed as u64).point(0, 0, 0));
        (0..DRAWS).for_each(|_| counts[d.sample(u.next_1d())] += 1);
        for (i, w) in weights.iter().enumerate() {
            assert!((d.pdf(&i) - w / total).abs() < 1e-15);
            assert!(*w > 0.0 || counts[i] == 0, "{name} drew {i}");
        }
        assert!((d.pdf(&50), weights[d.sample(0.0)] > 0.0, weights[d.sample(1.0)] > 0.0) == (0.0, true, true));
        let expected: Vec<f64> = weights.iter().map(|w| w / total * DRAWS as f64).collect();
        results.push(budget.counts(name, &counts, &expected));
    }
    for i in 0..1000 {
        let u = (f64::from(i) + 0.5) / 1000.0;
        let (index, rest) = bisected.split(u);
        assert!((bisected.join(index, rest).unwrap() - u).abs() < 1e-15 && (0.0..1.0).contains(&rest) && index == bisected.sample(u));
    }
    assert_eq!(bisected.join(2, 0.5), None);
    all_pass(results);
}

/// Every column of the alias table: probabilities of thirds, a single index, tiny weights, zeros at both ends, all exactly as asked.
#[test]
fn alias_columns_add_up() {
    let tables: [&[f64]; 6] =
        [&[1.0, 1.0, 1.0], &[5.0], &[1e-300, 1.0, 0.0], &[0.0, 0.0, 2.0, 0.0], &[0.1, 0.2, 0.3, 0.4], &[5e-324, 5e-324]];
    for weights in tables {
        let d = Alias::new(weights).unwrap();
        let n = 2520 * weights.len();
        let mut counts = vec![0; weights.len()];
        (0..n).for_each(|i| counts[d.sample((i as f64 + 0.5) / n as f64)] += 1);
        for (i, count) in counts.iter().enumerate() {
            assert!((f64::from(*count) / n as f64 - d.pdf(&i)).abs() < 1.0 / 1260.0, "{weights:?}: {counts:?}");
            assert!(weights[i] > 0.0 || *count == 0);
        }
    }
}

#[test]
fn bad_tables_are_refused() {
    let bad: [&[f64]; 6] = [&[], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN, 1.0], &[f64::INFINITY, 1.0], &[f64::MAX, f64::MAX]];
    for weights in bad {
        let edges: Vec<f64> = (0..=weights.len()).map(|i| i as f64).collect();
        let knots: Vec<f64> = (0..weights.len()).map(|i| i as f64).collect();
        let refusals = [
            Discrete::new(weights).err(),
            Alias::new(weights).err(),
            PiecewiseConstant::new(&edges, weights).err(),
            PiecewiseConstant::on(0.0..=1.0, weights).err().filter(|_| weights.first() != Some(&f64::MAX)).or(Discrete::new(weights).err()),
            PiecewiseLinear::new(&knots, weights).err().filter(|_| weights.first() != Some(&f64::MAX)).or(Discrete::new(weights).err()),
        ];
        for refusal in refusals {
            assert!(matches!(refusal, Some(Error::Invalid { .. })), "{weights:?}: {refusal:?}");
        }
    }
    assert!(PiecewiseConstant::new(&[0.0, 2.0, 1.0], &[1.0, 1.0]).is_err());
    assert!(PiecewiseConstant::new(&[0.0, f64::NAN, 1.0], &[1.0, 1.0]).is_err());
    assert!(PiecewiseConstant::new(&[0.0, 1.0], &[1.0, 1.0]).is_err());
    assert!(PiecewiseLinear::new(&[0.0], &[1.0]).is_err());
    assert!(PiecewiseLinear::new(&[0.0, 0.0], &[1.0, 1.0]).is_err());
    assert!(PiecewiseConstant2d::on([(0.0..=1.0).into(), (0.0..=1.0).into()], &[vec![1.0, 2.0], vec![1.0]]).is_err());
    assert!(PiecewiseConstant2d::on::<Vec<f64>>([(0.0..=1.0).into(), (0.0..=1.0).into()], &[]).is_err());
    assert!(PiecewiseConstant2d::on([(1.0..=0.0).into(), (0.0..=1.0).into()], &[[1.0]]).is_err());
    for (name, refused) in [
        ("power", Power::new(-1.0).is_err() && Power::new(f64::NAN).is_err()),
        ("exponential", Exponential::new(0.0).is_err() && Exponential::new(f64::INFINITY).is_err()),
        ("cone", UniformCone::new(1.0).is_err() && UniformCone::new(-1.1).is_err() && UniformCone::new(f64::NAN).is_err()),
        ("phase function", HenyeyGreenstein::new(1.0).is_err() && HenyeyGreenstein::new(f64::NAN).is_err()),
        ("triangle", UniformTriangle::new([[0.0; 3], [1.0; 3], [2.0; 3]]).is_err()),
    ] {
        assert!(refused, "{name}");
    }
}
