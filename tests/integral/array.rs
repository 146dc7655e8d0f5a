//! Array-RQMC: right whatever the scoring, ending, detector and sequence; its intervals cover; its variance falls faster than 1/n.

use crate::common::{Budget, all_pass};
use crate::erased::{Equation, kernel_fn, source_fn};
use crate::{rates, stated};
use fredholm::detector::{At, Bins, Functional, Points};
use fredholm::deterministic::Nystrom;
use fredholm::domain::{Cuboid, Domain, Grouped, Interval};
use fredholm::kernel::{HasDomain, Operator, Step, Transition};
use fredholm::sampling::{Layout, Sampler, Sobol};
use fredholm::statistics::Sweep;
use fredholm::walk::{ArrayRqmc, Roulette, Sort};
use fredholm::{Error, Estimate, Method, Walk};

const N: u64 = 1 << 13;

fn sobol(seed: u64) -> Sobol {
    Sobol::new(seed)
}

/// One number for roulette and `d` for the step: all a walk from a point needs.
fn lean(seed: u64, d: u16) -> Sobol {
    Sobol::new(seed).layout(Layout::of_dimension(d).start(0).event(0))
}

/// What happens at the faces of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Faces {
    Leaky,
    Mirrors,
}

/// Free flights in [0, L]^D with weight c, each coordinate by Laplace's distribution.
#[derive(Clone, Copy, Debug)]
struct Flights<const D: usize> {
    region: Cuboid<D>,
    c: f64,
    faces: Faces,
}

impl<const D: usize> Flights<D> {
    fn new(length: f64, c: f64, faces: Faces) -> Self {
        Flights { region: Cuboid::from(std::array::from_fn(|_| 0.0..=length)), c, faces }
    }

    fn equation(self) -> fredholm::Equation<impl fredholm::source::Source<Point = [f64; D], Value = f64>, Self> {
        Equation::new(source_fn(self.region, |_: &[f64; D]| 1.0), self)
    }
}

fn laplace(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).ln() } else { -(2.0 - 2.0 * u).ln() }
}

impl<const D: usize> Operator for Flights<D> {
    type Point = [f64; D];
    type Weight = f64;
}
impl<const D: usize> HasDomain for Flights<D> {
    type Domain = Cuboid<D>;
    fn domain(&self) -> &Cuboid<D> {
        &self.region
    }
}
impl<const D: usize> Transition for Flights<D> {
    fn step<S: Sampler>(&self, x: &[f64; D], u: &mut S) -> Option<Step<[f64; D], f64>> {
        let mut y = x.map(|x| x + laplace(u.next_1d()));
        if self.faces == Faces::Mirrors {
            let length = self.region.sides()[0].length();
            let fold = |y: f64| {
                let t = 2.0 * (y / (2.0 * length)).rem_euclid(1.0);
                (length * if t > 1.0 { 2.0 - t } else { t }).clamp(0.0, length)
            };
            y = y.map(fold);
        }
        self.region.contains(&y).then(|| Step::new(y, self.c))
    }
}

/// f = 1 + xy-kernel and e^{−|x−y|}: closed forms; every scoring, ending, detector, and both orders.
#[test]
fn arrays_are_unbiased() {
    let mut budget = Budget::of("integral::array");
    let mut results = Vec::new();
    let rank_one = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let slab = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (-(x - y).abs()).exp());
    let mut check = |name: &str, e: Estimate, truth: f64, margin: f64| results.push(budget.mean(name, stated(&e), truth, margin * truth));
    {
        let (name, eq, truth) = ("rank one", rank_one.at(0.5), 1.15);
        let methods: [(&str, &dyn Method<_, _, _, Solution = Estimate>); 7] = [
            ("collision, PCG", &ArrayRqmc::new(Walk::collision().samples_per_cell(N))),
            ("collision", &ArrayRqmc::new(Walk::collision().samples_per_cell(N).sequence(sobol(1)))),
            (
                "collision, by weight",
                &ArrayRqmc::new(Walk::collision().samples_per_cell(N).sequence(sobol(2))).sorted_by(Sort::StateAndWeight),
            ),
            ("next event", &ArrayRqmc::new(Walk::next_event().samples_per_cell(N).sequence(sobol(3)))),
            ("MIS", &ArrayRqmc::new(Walk::mis().samples_per_cell(N).sequence(sobol(4)))),
            ("absorption", &ArrayRqmc::new(Walk::absorption().roulette(Roulette::constant(0.5)).samples_per_cell(N).sequence(sobol(5)))),
            ("fixed depth", &ArrayRqmc::new(Walk::fixed_depth(20).samples_per_cell(N).sequence(sobol(6)))),
        ];
        methods.into_iter().for_each(|(what, m)| check(&format!("{name}, {what}"), eq.solve(m).unwrap(), truth, 0.3));
    }
    let exact = |x: f64| 1.5 + 0.5 * x * (1.0 - x);
    let array = ArrayRqmc::new(Walk::subcritical().samples_per_cell(N).sequence(sobol(7)));
    let tabulated = slab.clone().tabulated(64).unwrap();
    let grid = tabulated.on(&[0.0, 0.5, 1.0]).solve(&array).unwrap();
    grid.into_iter().zip([0.0, 0.5, 1.0]).for_each(|(e, x)| check("grid", e, exact(x), 0.1));
    let bins = tabulated.seen_by(&Bins::new(0.0..=1.0, 2)).solve(&array).unwrap();
    bins.into_iter().for_each(|e| check("bins", e, 1.5 + 1.0 / 12.0, 0.1));
    let functional = Functional::new(Interval::from(0.0..=1.0), |x| 2.0 * x);
    check("functional", tabulated.seen_by(&functional).solve(&array).unwrap(), 1.5 + 1.0 / 12.0, 0.2);
    // two dimensions, and three: a product kernel with f = 1 + x₀x₁/… by rank one
    let plane = Equation::on_domain(Cuboid::<2>::unit(), |_| 1.0, |x, y| x[0] * x[1] * y[0] * y[1]);
    // ∫y₀y₁ f = a/(1 − b), a = 1/4, b = 1/9
    let truth = 1.0 + 0.25 * 0.25 / (1.0 - 1.0 / 9.0);
    for sort in [Sort::State, Sort::StateAndWeight] {
        let m = ArrayRqmc::new(Walk::collision().samples_per_cell(N).sequence(sobol(8))).sorted_by(sort);
        check("plane", plane.at([0.5, 0.5]).solve(&m).unwrap(), truth, 0.2);
    }
    let space = Equation::on_domain(Cuboid::<3>::unit(), |_| 1.0, |x, y| x[0] * x[1] * y[0] * y[2]);
    let m = ArrayRqmc::new(Walk::collision().samples_per_cell(N).sequence(sobol(9)));
    check("space", space.at([1.0, 1.0, 0.5]).solve(&m).unwrap(), 1.0 + 0.25 / (1.0 - 1.0 / 12.0), 0.2);
    // groups: f_i = 1 + ∫ Σ_j ¼ f_j = 2
    let groups = Grouped::new(Interval::from(0.0..=1.0), 2);
    let kernel = kernel_fn(groups, |_, _| 0.25);
    let proposed = fredholm::kernel::Proposed::new(kernel, fredholm::kernel::Uniform::on(groups));
    let eq = Equation::new(source_fn(groups, |_| 1.0), proposed);
    check("groups", eq.at((0.5, 1)).solve(&m).unwrap(), 2.0, 0.2);
    let flights = Flights::<1>::new(10.0, 0.95, Faces::Leaky).equation();
    let nystrom = Equation::on_interval(0.0..=10.0, |_| 1.0, |x: f64, y: f64| 0.475 * (-(x - y).abs()).exp());
    let truth = nystrom.solve(&Nystrom::graded(64, 8)).unwrap().eval(5.0);
    let walk = Walk::collision().roulette(Roulette::throughput(0.01)).samples_per_cell(N);
    check("flights", flights.at([5.0]).solve(&ArrayRqmc::new(walk.sequence(lean(1, 1)))).unwrap(), truth, 0.05);
    check("flights, PCG", flights.at([5.0]).solve(&ArrayRqmc::new(walk)).unwrap(), truth, 0.2);
    let square = Flights::<2>::new(4.0, 0.9, Faces::Leaky).equation();
    let plain = square.at([1.0, 2.0]).solve(&walk.samples_per_cell(1 << 20)).unwrap();
    let array = square.at([1.0, 2.0]).solve(&ArrayRqmc::new(walk.sequence(lean(2, 2)))).unwrap();
    let error = plain.std_error.unwrap().hypot(array.std_error.unwrap());
    results.push(budget.mean("flights in the plane", (array.value, error, 15.0), plain.value, 0.1 * plain.value));
    all_pass(results);
}

/// The variance of a replicate of n chains against that of n walks: the gain at 2¹² and the slope of the error.
#[test]
fn the_variance_falls_faster_than_by_n() {
    const R: u64 = 64;
    let mut budget = Budget::of("integral::array slopes");
    let walk = |n: u64| Walk::collision().roulette(Roulette::throughput(0.01)).samples_per_cell(n);
    let sizes: Vec<u64> = (6..=12).map(|k| 1 << k).collect();
    let line = Flights::<1>::new(10.0, 0.95, Faces::Leaky).equation();
    let box_of = |faces| {
        let region = Flights::<2>::new(4.0, 0.8, faces);
        Equation::new(source_fn(region.region, |x: &[f64; 2]| (-x[0]).exp() * (1.0 + x[1])), region)
    };
    let truth = line.at([5.0]).solve(&ArrayRqmc::new(walk(1 << 18).sequence(lean(99, 1)))).unwrap().value;
    let sweep =
        Sweep::run(truth, &sizes, R, |n, s| line.at([5.0]).solve(&ArrayRqmc::new(walk(n).sequence(lean(s, 1).replicates(1))))).unwrap();
    let mut results = vec![budget.at_most("slope", rates::slope(&sweep, R), -0.65, 0.3)];
    // ln(variance of walks/variance of arrays); that of the arrays has R repetitions, ln s² the error √(2/R)
    let mut gain = |what: &str, arrays: f64, plain: Estimate, least: f64| {
        let loss = (arrays * 4096.0 / plain.variance().unwrap()).ln();
        results.push(budget.at_most(what, (loss, (2.0 / R as f64).sqrt(), 1e6), -f64::ln(least), 1.6));
    };
    gain("line", sweep.studies().last().unwrap().1.mse().value, line.at([5.0]).solve(&walk(1 << 14)).unwrap(), 40.0);
    // losses at the faces are jumps of the score: the gain is less, and still there
    for (faces, least) in [(Faces::Leaky, 8.0), (Faces::Mirrors, 60.0)] {
        let plane = box_of(faces);
        let m = ArrayRqmc::new(walk(4096 * R).sequence(lean(5, 2).replicates(R as u32)));
        let e = plane.at([1.0, 2.0]).solve(&m).unwrap();
        let replicate = e.std_error.unwrap().powi(2) * R as f64;
        gain(&format!("{faces:?}"), replicate, plane.at([1.0, 2.0]).solve(&walk(1 << 14)).unwrap(), least);
    }
    all_pass(results);
}

/// Student's interval from the replicates, 10 of 64 chains.
#[test]
fn replicates_of_arrays_cover_what_they_promise() {
    let mut budget = Budget::of("integral::array coverage");
    let slab = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (-(x - y).abs()).exp());
    let exact = |x: f64| 1.5 + 0.5 * x * (1.0 - x);
    for x in [0.2, 0.5] {
        let cells = Points(vec![x; 6000]);
        let method =
            ArrayRqmc::new(Walk::collision().roulette(Roulette::constant(0.6)).samples_per_cell(640).sequence(lean(3, 1).replicates(10)));
        let estimates = slab.seen_by(&cells).solve(&method).unwrap();
        let hits = estimates.iter().filter(|e| (e.value - exact(x)).abs() <= e.half_width(0.95).unwrap()).count();
        budget.frequency(&format!("x = {x}"), hits as u64, 6000, 0.93, 0.97).unwrap();
    }
}

/// Chains of an independent sequence are independent: their variance is that of plain walks.
#[test]
fn an_array_of_independent_chains_is_no_better_than_walks() {
    let mut budget = Budget::of("integral::array plain");
    let slab = Equation::on_interval(0.0..=1.0, |_| 1.0, |x: f64, y: f64| 0.5 * (-(x - y).abs()).exp());
    let one = slab.at(0.5).solve(&Walk::collision().samples_per_cell(1 << 18)).unwrap().variance().unwrap();
    let study = fredholm::statistics::Study::run(1.625, 3000, |s| {
        slab.at(0.5).solve(&ArrayRqmc::new(Walk::collision().seed(s).samples_per_cell(16 * 32)))
    });
    let v = study.unwrap().variance();
    budget.mean("variance", (v.value * 16.0 * 32.0, v.std_error * 16.0 * 32.0, 1e6), one, 0.3 * one).unwrap();
}

#[test]
fn threads_change_nothing() {
    let line = Flights::<1>::new(10.0, 0.95, Faces::Leaky).equation();
    let m = ArrayRqmc::new(Walk::collision().roulette(Roulette::throughput(0.01)).samples_per_cell(5000).sequence(lean(1, 1)));
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let e = pool.install(|| line.at([5.0]).solve(&m)).unwrap();
        [e.value.to_bits(), e.std_error.unwrap().to_bits(), e.steps]
    };
    let one = run(1);
    assert!([2, 3, 8].iter().all(|t| run(*t) == one));
}

#[test]
fn what_cannot_be_walked_is_refused() {
    let eq = Equation::on_interval(0.0..=1.0, |_| 1.0, |x, y| 0.5 * x * y);
    let solve = |walk: Walk| eq.at(0.5).solve(&ArrayRqmc::new(walk));
    let name = |e: Result<Estimate, Error>| match e {
        Err(Error::Invalid { parameter, .. }) => parameter,
        other => panic!("{other:?}"),
    };
    assert_eq!(name(solve(Walk::collision().samples_per_cell(0))), "samples_per_cell");
    assert_eq!(name(solve(Walk::collision().samples_per_cell(1 << 40))), "chains a replicate");
    // every step of every chain would read the same points
    let textbook = Walk::collision().sequence(Sobol::new(0).unscrambled());
    assert_eq!(name(eq.at(0.5).solve(&ArrayRqmc::new(textbook))), "replicates");
    assert_eq!(name(solve(Walk::collision().roulette(Roulette::constant(2.0)))), "roulette survival probability");
    let none = Walk::collision().sequence(Sobol::new(0).replicates(0));
    assert_eq!(name(eq.at(0.5).solve(&ArrayRqmc::new(none))), "replicates");
    // one replicate: no error is invented
    let one = Walk::collision().sequence(Sobol::new(0).replicates(1));
    assert_eq!(eq.at(0.5).solve(&ArrayRqmc::new(one)).unwrap().std_error, None);
    assert!(matches!(eq.at(0.5).solve(&ArrayRqmc::new(Walk::collision().ending(fredholm::walk::OwnAbsorption))), Err(Error::NeverEnds)));
    let long = eq.at(0.5).solve(&ArrayRqmc::new(Walk::collision().roulette(Roulette::constant(0.999)).max_steps(20)));
    assert!(matches!(long, Err(Error::WalkTooLong { steps: 20, .. })), "{long:?}");
    // the place of a value that is no number
    let poles = Equation::on_interval(0.0..=1.0, |x| if x > 0.9 { f64::NAN } else { 1.0 }, |x, y| 0.5 * x * y);
    let m = ArrayRqmc::new(Walk::collision().sequence(sobol(1)).samples_per_cell(1000));
    let Err(Error::NonFiniteSource { at, .. }) = poles.at(0.5).solve(&m) else { panic!() };
    assert!(at.starts_with("0.9"), "{at}");
    let Err(Error::NonFiniteSource { at, .. }) = poles.seen_by(&At(0.95)).solve(&ArrayRqmc::new(Walk::collision())) else { panic!() };
    assert_eq!(at, "0.95");
}
