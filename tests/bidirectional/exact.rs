//! The algebra of bidirectional estimators by exact enumeration (theory §8, 8.10, 8.11): every decision of both walks has a few equally likely outcomes,
//! and the mean of the library's own scores over all of them is a matrix element, to rounding.

use fredholm::detector::{At, Detector, Start, StartPdf};
use fredholm::estimator::Estimator;
use fredholm::kernel::{HasAdjoint, Kernel, Operator, Step, Transition, TransitionPdf};
use fredholm::sampling::{Purpose, Sampler};
use fredholm::source::{Birth, Emit, EmitPdf, Source};
use fredholm::walk::{Beyond, Bidirectional, Connect, Ending, Heuristic, Meet, Met, Strategies, Survival, meet_by_density};
use fredholm::{Equation, Error, Value};

const HEURISTICS: [Heuristic; 5] =
    [Heuristic::Balance, Heuristic::Power(2.0), Heuristic::Power(0.7), Heuristic::Maximum, Heuristic::Average];

// ---------------------------------------------------------------- enumeration

/// Outcomes of a walk's decisions: where it starts, and two numbers a vertex, whether it goes on and where.
#[derive(Clone, Debug)]
struct Decisions {
    start: [f64; 2],
    /// (survival, move) of backward and forward vertices
    vertices: [Vec<(f64, f64)>; 2],
    at: (u64, Purpose),
}

impl Sampler for Decisions {
    fn next_1d(&mut self) -> f64 {
        let (vertex, purpose) = self.at;
        let decided = self.vertices[(vertex % 2) as usize].get(vertex as usize / 2);
        match purpose {
            Purpose::Start => self.start[0],
            Purpose::Event => self.start[1],
            // beyond the vertices that matter walks end where they can; the middle outcome of a move leads where they can
            Purpose::Survival => decided.map_or(0.99, |d| d.0),
            Purpose::Move => decided.map_or(0.5, |d| d.1),
        }
    }
    fn seek(&mut self, vertex: u64, purpose: Purpose) {
        self.at = (vertex, purpose);
    }
}

/// The mean score over all decisions of the first `steps` vertices of both walks.
fn mean(estimator: &impl Estimator<Value = f64>, steps: usize) -> f64 {
    let walks: Vec<Vec<(f64, f64)>> = (0..6usize.pow(steps as u32))
        .map(|i| {
            let digit = |k: usize| i / 6usize.pow(k as u32) % 6;
            (0..steps).map(|k| ((0.5 + (digit(k) % 2) as f64) / 2.0, (0.5 + (digit(k) / 2) as f64) / 3.0)).collect()
        })
        .collect();
    let (mut sum, mut count, mut memory) = (0.0, 0.0, Default::default());
    for (i, j) in (0..9).map(|k| (k % 3, k / 3)) {
        let start = [i, j].map(|k| (0.5 + f64::from(k)) / 3.0);
        for back in &walks {
            let mut part = 0.0;
            let mut u = Decisions { start, vertices: [back.clone(), Vec::new()], at: (0, Purpose::Start) };
            for forth in &walks {
                u.vertices[1].clone_from(forth);
                part += estimator.score(0, &mut u, &mut memory).value;
                count += 1.0;
            }
            sum += part;
        }
    }
    sum / count
}

fn outcome(u: f64) -> usize {
    (u * 3.0) as usize
}

// ---------------------------------------------------------------- a chain of three states

/// K = K_c + a Dirac part from 2 to 1; moves by tables of three equally likely outcomes, whose middle one leads to 0.
#[derive(Clone, Copy, Debug)]
struct Chain {
    k: [[f64; 3]; 3],
    moves: [[usize; 3]; 3],
    /// from, to, κ; no edge if κ = 0
    mirror: (usize, usize, f64),
}

const BACK: [[usize; 3]; 3] = [[1, 0, 2], [2, 0, 2], [0, 0, 1]];
/// the mirror's edge is twice as likely as backward
const FORTH: [[usize; 3]; 3] = [[0, 0, 1], [2, 0, 2], [1, 0, 2]];

impl Chain {
    fn new(mirror: f64) -> Self {
        let mut k = [[0.2, 0.5, 0.3], [0.4, 0.0, 0.7], [0.1, 0.6, 0.0]];
        if mirror != 0.0 {
            k[2][1] = 0.0;
        }
        Chain { k, moves: BACK, mirror: (2, 1, mirror) }
    }

    fn is_mirror(&self, x: usize, y: usize) -> bool {
        self.mirror.2 != 0.0 && (x, y) == (self.mirror.0, self.mirror.1)
    }

    fn probability(&self, x: usize, y: usize) -> f64 {
        self.moves[x].iter().filter(|m| **m == y).count() as f64 / 3.0
    }

    /// K of both kinds.
    fn total(&self, x: usize, y: usize) -> f64 {
        if self.is_mirror(x, y) { self.mirror.2 } else { self.k[x][y] }
    }
}

impl Operator for Chain {
    type Point = usize;
    type Weight = f64;
}
impl Kernel for Chain {
    fn eval(&self, x: &usize, y: &usize) -> f64 {
        self.k[*x][*y]
    }
}
impl Transition for Chain {
    fn step<S: Sampler>(&self, x: &usize, u: &mut S) -> Option<Step<usize, f64>> {
        let y = self.moves[*x][outcome(u.next_1d())];
        let weight = self.total(*x, y) / self.probability(*x, y);
        Some(if self.is_mirror(*x, y) { Step::singular(y, weight) } else { Step::regular(y, weight) })
    }
}
impl TransitionPdf for Chain {
    fn pdf(&self, x: &usize, y: &usize) -> f64 {
        if self.is_mirror(*x, *y) { 0.0 } else { self.probability(*x, *y) }
    }
}
impl HasAdjoint for Chain {
    type Adjoint = Chain;
    fn adjoint(&self) -> Result<Chain, Error> {
        let k = std::array::from_fn(|i| std::array::from_fn(|j| self.k[j][i]));
        Ok(Chain { k, moves: FORTH, mirror: (self.mirror.1, self.mirror.0, self.mirror.2) })
    }
}

#[derive(Clone, Copy, Debug)]
struct Ends;

const G: [f64; 3] = [0.5, 0.0, 1.5];
const H: [f64; 3] = [1.0, 0.0, 0.2];
/// starts and births by outcome
const STARTS: [usize; 3] = [0, 1, 2];
const BIRTHS: [usize; 3] = [2, 0, 1];

fn share(table: [usize; 3], x: usize) -> f64 {
    table.iter().filter(|y| **y == x).count() as f64 / 3.0
}

impl Source for Ends {
    type Point = usize;
    type Value = f64;
    fn eval(&self, x: &usize) -> f64 {
        G[*x]
    }
}
impl Emit for Ends {
    type State = usize;
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<usize, f64> {
        let point = BIRTHS[outcome(u.next_1d())];
        Birth { point, weight: G[point] / share(BIRTHS, point) }
    }
}
impl EmitPdf for Ends {
    fn emit_pdf(&self, z: &usize) -> f64 {
        share(BIRTHS, *z)
    }
}
impl Detector for Ends {
    type Point = usize;
    type Answer<T> = T;
    fn cells(&self) -> usize {
        1
    }
    fn start<S: Sampler>(&self, _: usize, u: &mut S) -> Start<usize> {
        let point = STARTS[outcome(u.next_1d())];
        Start { point, weight: H[point] / share(STARTS, point) }
    }
    fn answer<T>(&self, mut cells: Vec<T>) -> T {
        cells.swap_remove(0)
    }
}
impl StartPdf for Ends {
    fn start_pdf(&self, _: usize, x: &usize) -> f64 {
        share(STARTS, *x)
    }
    fn importance(&self, _: usize, x: &usize) -> f64 {
        H[*x]
    }
}

impl<V: Value> Meet<usize, V> for Ends {
    fn meet<S: Sampler>(&self, z: &usize, load: V, _: &mut S, found: impl FnMut(Met<usize, V>)) {
        meet_by_density(self, z, load, found);
    }
}

/// P by place: 1/2, or 1 at one place, another for either direction.
#[derive(Clone, Copy, Debug)]
struct Certain(usize);

impl Certain {
    fn at(self, place: usize) -> f64 {
        if place == self.0 { 1.0 } else { 0.5 }
    }
}

impl Ending<Chain> for Certain {
    fn survival(&self, _: &Chain, x: &usize, _: u64, _: f64) -> Survival {
        Survival::with_probability(self.at(*x))
    }
    fn survival_at(&self, _: &Chain, x: &usize) -> Option<f64> {
        Some(self.at(*x))
    }
}

/// ⟨h, Tᵐ g⟩ by matrices.
fn element<const N: usize>(h: [f64; N], k: impl Fn(usize, usize) -> f64, g: [f64; N], m: usize) -> f64 {
    let apply = |v: [f64; N]| std::array::from_fn(|i| (0..N).map(|j| k(i, j) * v[j]).sum());
    let term = (0..m).fold(g, |v, _| apply(v));
    (0..N).map(|i| h[i] * term[i]).sum()
}

#[test]
fn weighted_strategies_add_up_to_the_matrix_element() {
    for mirror in [0.0, 0.8] {
        let chain = Chain::new(mirror);
        let eq = Equation::new(Ends, chain);
        let query = eq.seen_by(&Ends);
        for heuristic in HEURISTICS {
            for m in 0..=2 {
                let walks = Bidirectional::new().endings(Certain(1), Certain(2)).heuristic(heuristic).strategies(Strategies::Order(m));
                let (found, truth) =
                    (mean(&query.bidirectional(&walks).unwrap(), m as usize), element(H, |i, j| chain.total(i, j), G, m as usize));
                assert!((found - truth).abs() < 1e-12, "mirror {mirror}, {heuristic:?}, order {m}: {found} against {truth}");
            }
        }
    }
}

/// Controls have the mean 0, whatever a pilot makes of them.
#[test]
fn optimal_weights_add_up_to_the_matrix_element() {
    for mirror in [0.0, 0.8] {
        let chain = Chain::new(mirror);
        let eq = Equation::new(Ends, chain);
        for m in 0..=2 {
            let truth = element(H, |i, j| chain.total(i, j), G, m as usize);
            for heuristic in [Heuristic::Balance, Heuristic::Maximum] {
                let walks = Bidirectional::new().endings(Certain(1), Certain(2)).heuristic(heuristic).strategies(Strategies::Order(m));
                let query = eq.seen_by(&Ends);
                let found = mean(&query.bidirectional(&walks.optimal(1 << 14)).unwrap(), m as usize);
                assert!((found - truth).abs() < 1e-12, "mirror {mirror}, {heuristic:?}, order {m}: {found} against {truth}");
            }
        }
        let walks = Bidirectional::new().endings(Certain(1), Certain(2)).strategies(Strategies::Order(2)).optimal(1 << 14);
        let (found, truth) =
            (mean(&eq.at(0usize).bidirectional(&walks).unwrap(), 2), element([1.0, 0.0, 0.0], |i, j| chain.total(i, j), G, 2));
        assert!((found - truth).abs() < 1e-12, "mirror {mirror}, at a point: {found} against {truth}");
    }
}

/// Three edges: one weight each suffices, the enumeration is long.
#[test]
fn weighted_strategies_of_three_edges() {
    let chain = Chain::new(0.8);
    let eq = Equation::new(Ends, chain);
    let query = eq.at(0usize);
    for heuristic in [Heuristic::Balance, Heuristic::Maximum] {
        let walks = Bidirectional::new().endings(Certain(1), Certain(2)).heuristic(heuristic).strategies(Strategies::Order(3));
        let found = mean(&query.bidirectional(&walks).unwrap(), 3);
        let truth = element([1.0, 0.0, 0.0], |i, j| chain.total(i, j), G, 3);
        assert!((found - truth).abs() < 1e-12, "{heuristic:?}: {found} against {truth}");
    }
}

/// Each strategy alone finds the whole element, where it can find every path: without Dirac parts, all can.
#[test]
fn every_strategy_alone_finds_the_matrix_element() {
    let chain = Chain { moves: [[1, 0, 2]; 3], ..Chain::new(0.0) };
    let eq = Equation::new(Ends, chain);
    let query = eq.seen_by(&Ends);
    for m in 0..=2u64 {
        // forward walks never go from 0 to 2: K₂₀ ≠ 0 is found backward only
        let truth = element(H, |i, j| chain.total(i, j), G, m as usize);
        for s in 0..=1 {
            let walks = Bidirectional::new().endings(Certain(1), Certain(2)).strategies(Strategies::One { s, t: m + 1 - s });
            let found = mean(&query.bidirectional(&walks).unwrap(), m as usize);
            assert!((found - truth).abs() < 1e-12, "m = {m}, s = {s}: {found} against {truth}");
        }
    }
}

/// P by place.
#[derive(Clone, Copy, Debug)]
struct Places([f64; 3]);

impl Ending<Chain> for Places {
    fn survival(&self, _: &Chain, x: &usize, _: u64, _: f64) -> Survival {
        Survival::with_probability(self.0[*x])
    }
    fn survival_at(&self, _: &Chain, x: &usize) -> Option<f64> {
        Some(self.0[*x])
    }
}

/// Decisions that make a walk visit `path` and end there; `None` if it cannot.
fn decisions(chain: &Chain, path: &[usize]) -> Option<Vec<(f64, f64)>> {
    let step = |w: &[usize]| Some((0.01, (0.5 + chain.moves[w[0]].iter().position(|y| *y == w[1])? as f64) / 3.0));
    path.windows(2).map(step).collect()
}

/// Σ_s w_s = 1 along every path that scores, over the strategies that can find it: the weight is what an order's score is of the strategy's alone.
#[test]
fn weights_add_up_to_one_along_every_path() {
    for (mirror, m) in [(0.0, 1), (0.0, 3), (0.8, 2), (0.8, 3)] {
        let chain = Chain::new(mirror);
        let adjoint = chain.adjoint().unwrap();
        let eq = Equation::new(Ends, chain);
        let query = eq.seen_by(&Ends);
        let ends = (Places([0.5, 0.75, 0.6]), Places([0.7, 0.4, 0.9]));
        for heuristic in HEURISTICS {
            let walks = Bidirectional::new().endings(ends.0, ends.1).heuristic(heuristic);
            let all = query.bidirectional(&walks.strategies(Strategies::Order(m))).unwrap();
            let mut seen = 0;
            for path in (0..3usize.pow(m as u32 + 1)).map(|i| (0..=m as u32).map(|k| i / 3usize.pow(k) % 3).collect::<Vec<_>>()) {
                let (mut sum, mut found) = (0.0, 0);
                for s in 0..=m + 1 {
                    let (eye, light) = path.split_at((m + 1 - s) as usize);
                    let light: Vec<usize> = light.iter().rev().copied().collect();
                    let (Some(back), Some(forth)) = (decisions(&chain, eye), decisions(&adjoint, &light)) else { continue };
                    let place = |table: [usize; 3], x: Option<&usize>| x.and_then(|x| table.iter().position(|y| y == x));
                    // for a walk of no vertices, one that starts and ends at 1, where g = h = 0: nothing joined with it scores
                    let (Some(start), Some(birth)) = (place(STARTS, eye.first().or(Some(&1))), place(BIRTHS, light.first().or(Some(&1))))
                    else {
                        continue;
                    };
                    let start = [start, birth].map(|k| (0.5 + k as f64) / 3.0);
                    let u = || Decisions { start, vertices: [back.clone(), forth.clone()], at: (0, Purpose::Start) };
                    let one = query.bidirectional(&walks.strategies(Strategies::One { s, t: m + 1 - s })).unwrap();
                    let alone = one.score(0, &mut u(), &mut Default::default()).value;
                    if alone != 0.0 {
                        let both = all.score(0, &mut u(), &mut Default::default()).value;
                        sum += both / alone;
                        found += 1;
                    }
                }
                assert!(found == 0 || (sum - 1.0).abs() < 1e-12, "mirror {mirror}, {heuristic:?}, {path:?}: Σw = {sum} of {found}");
                seen += found;
            }
            assert!(seen >= 8, "{seen}");
        }
    }
}

// ---------------------------------------------------------------- states of both directions apart

/// A scene in miniature: three places, scattering B(p; to, from) that knows where light goes and where it comes from, emission L(p, to).
///
/// Eye states are (place, where to), light states (place, where from): f(p, to) = L(p, to) + Σ_q B(p; to, q) f(q, p). A light vertex does not know its own
/// scattering before it is joined.
#[derive(Clone, Copy, Debug)]
struct Scene;
#[derive(Clone, Copy, Debug)]
struct Light;

type Eye = (usize, usize);
type Beam = (usize, Option<usize>);

fn scattering(p: usize, to: usize, from: usize) -> f64 {
    if p == to || p == from { 0.0 } else { 0.3 + 0.1 * p as f64 + 0.2 * to as f64 * (1.0 + from as f64) }
}
fn emission(p: usize, to: usize) -> f64 {
    if p == 1 { 0.0 } else { 0.4 + 0.5 * (p * to) as f64 + 0.1 * to as f64 }
}
/// Where an eye path goes from p, having come from `to`.
fn looks(p: usize, to: usize) -> [usize; 3] {
    [(p + 1) % 3, 0, if to == 2 { (p + 1) % 3 } else { (p + 2) % 3 }]
}
/// Where light goes from p, having come from `from`.
fn shines(p: usize, from: Option<usize>) -> [usize; 3] {
    [(p + 2) % 3, 0, if from == Some(1) { (p + 2) % 3 } else { (p + 1) % 3 }]
}

impl Operator for Scene {
    type Point = Eye;
    type Weight = f64;
}
impl Transition for Scene {
    fn step<S: Sampler>(&self, x: &Eye, u: &mut S) -> Option<Step<Eye, f64>> {
        let q = looks(x.0, x.1)[outcome(u.next_1d())];
        Some(Step::regular((q, x.0), scattering(x.0, x.1, q) / share(looks(x.0, x.1), q)))
    }
}
impl TransitionPdf for Scene {
    fn pdf(&self, x: &Eye, y: &Eye) -> f64 {
        share(looks(x.0, x.1), y.0)
    }
}
impl HasAdjoint for Scene {
    type Adjoint = Light;
    fn adjoint(&self) -> Result<Light, Error> {
        Ok(Light)
    }
}
/// That it can be evaluated too does not get in the way of its own way to be joined.
impl Kernel for Scene {
    fn eval(&self, x: &Eye, y: &Eye) -> f64 {
        if y.1 == x.0 { scattering(x.0, x.1, y.0) } else { 0.0 }
    }
}
impl Operator for Light {
    type Point = Beam;
    type Weight = f64;
}
impl Light {
    fn leaves(z: &Beam, to: usize) -> f64 {
        z.1.map_or_else(|| emission(z.0, to), |from| scattering(z.0, to, from))
    }
}
impl Transition for Light {
    fn step<S: Sampler>(&self, z: &Beam, u: &mut S) -> Option<Step<Beam, f64>> {
        let p = shines(z.0, z.1)[outcome(u.next_1d())];
        Some(Step::regular((p, Some(z.0)), Light::leaves(z, p) / share(shines(z.0, z.1), p)))
    }
}
impl TransitionPdf for Light {
    fn pdf(&self, z: &Beam, y: &Beam) -> f64 {
        share(shines(z.0, z.1), y.0)
    }
}
impl Connect<Light> for Scene {
    const LOOKS_BEYOND: bool = true;
    fn join(&self, x: &Eye, z: &Beam) -> f64 {
        scattering(x.0, x.1, z.0) * Light::leaves(z, x.0)
    }
    fn forward(&self, x: &Eye, from: Beyond<'_, Eye, Beam>) -> Beam {
        match from {
            Beyond::Own(next) => (x.0, Some(next.0)),
            Beyond::Other(z) => (x.0, Some(z.0)),
            Beyond::Start => (x.0, None),
        }
    }
    fn backward(&self, z: &Beam, from: Beyond<'_, Beam, Eye>) -> Eye {
        match from {
            Beyond::Own(next) => (z.0, next.0),
            Beyond::Other(x) => (z.0, x.0),
            Beyond::Start => (z.0, z.0),
        }
    }
}
impl Source for Light {
    type Point = Eye;
    type Value = f64;
    fn eval(&self, x: &Eye) -> f64 {
        emission(x.0, x.1)
    }
}
impl Emit for Light {
    type State = Beam;
    fn emit<S: Sampler>(&self, u: &mut S) -> Birth<Beam, f64> {
        let place = BIRTHS[outcome(u.next_1d())];
        Birth { point: (place, None), weight: 1.0 / share(BIRTHS, place) }
    }
}
impl EmitPdf for Light {
    fn emit_pdf(&self, z: &Beam) -> f64 {
        share(BIRTHS, z.0)
    }
}
/// P depends on everything that a state knows.
impl Ending<Scene> for Certain {
    fn survival(&self, _: &Scene, x: &Eye, _: u64, _: f64) -> Survival {
        Survival::with_probability(if x.1 == 1 { self.at(x.0) } else { 0.5 })
    }
    fn survival_at(&self, _: &Scene, x: &Eye) -> Option<f64> {
        Some(if x.1 == 1 { self.at(x.0) } else { 0.5 })
    }
}
impl Ending<Light> for Certain {
    fn survival(&self, _: &Light, z: &Beam, _: u64, _: f64) -> Survival {
        Survival::with_probability(if z.1 == Some(0) { self.at(z.0) } else { 0.5 })
    }
    fn survival_at(&self, _: &Light, z: &Beam) -> Option<f64> {
        Some(if z.1 == Some(0) { self.at(z.0) } else { 0.5 })
    }
}

#[test]
fn states_of_both_directions_may_differ() {
    let eq = Equation::new(Light, Scene);
    let start: Eye = (0, 2);
    let detector = At(start);
    let query = eq.seen_by(&detector);
    let place = |i: usize| (i / 3, i % 3);
    let k = |i: usize, j: usize| if place(j).1 == place(i).0 { scattering(place(i).0, place(i).1, place(j).0) } else { 0.0 };
    let g: [f64; 9] = std::array::from_fn(|i| emission(place(i).0, place(i).1));
    let h: [f64; 9] = std::array::from_fn(|i| f64::from(u8::from(place(i) == start)));
    for heuristic in HEURISTICS {
        for m in 0..=2 {
            let walks = Bidirectional::new().endings(Certain(1), Certain(2)).heuristic(heuristic).strategies(Strategies::Order(m));
            let (found, truth) = (mean(&query.bidirectional(&walks).unwrap(), m as usize), element(h, k, g, m as usize));
            assert!((found - truth).abs() < 1e-12, "{heuristic:?}, order {m}: {found} against {truth}");
        }
    }
    let walks = Bidirectional::new().endings(Certain(1), Certain(2)).strategies(Strategies::Order(3));
    let (found, truth) = (mean(&query.bidirectional(&walks).unwrap(), 3), element(h, k, g, 3));
    assert!((found - truth).abs() < 1e-12, "order 3: {found} against {truth}");
}
