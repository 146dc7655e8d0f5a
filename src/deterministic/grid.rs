//! Nodes of a quadrature rule on a domain; rows of the operator on them are in [`rows`](super::rows), interpolants in [`stencil`](super::stencil).

use super::axis::Axis;
use super::basis::Basis;
use super::double_exponential::DoubleExponential;
use super::ends::Ends;
use super::lines::Line;
use super::near::nearer_end;
use crate::domain::{Domain, Node, Point};
use crate::error::Error;

/// Largest dense system that is tried: 8 n² bytes.
const MOST_UNKNOWNS: usize = 16_384;
/// Most nodes of a rule whose matrix is never formed.
const MOST_NODES: usize = 1 << 22;

/// Nodes y_j with weights w_j, ∫ φ dμ ≈ Σ w_j φ(y_j); with panels, rows near the diagonal come from product integration.
#[derive(Clone, Debug)]
pub(crate) struct Grid<X> {
    pub(crate) nodes: Vec<Node<X>>,
    pub(super) panels: Option<Panels>,
    /// of each coordinate, where the rule is a single tensor product
    pub(super) tensor: Option<Vec<Axis>>,
    /// order of the rules around x by which rows are integrated
    pub(super) centred: Option<usize>,
    /// where rows are integrated towards ends of the domain
    pub(super) ends: Ends,
    /// where rows are integrated towards lines
    pub(super) lines: Vec<Line>,
}

/// Panels of the map's coordinate; nodes are ordered state by state, panel by panel.
#[derive(Clone, Debug)]
pub(crate) struct Panels {
    pub(crate) breaks: Vec<f64>,
    pub(crate) basis: Basis,
    /// rule for a piece of a near panel
    pub(super) pieces: Basis,
}

impl Panels {
    pub(crate) fn count(&self) -> usize {
        self.breaks.len() - 1
    }

    /// The panel that holds coordinate t.
    pub(crate) fn at(&self, t: f64) -> usize {
        self.breaks.partition_point(|b| *b <= t).clamp(1, self.count()) - 1
    }

    pub(crate) fn panel(&self, p: usize) -> (f64, f64) {
        (self.breaks[p], self.breaks[p + 1])
    }
}

impl<X: Point> Grid<X> {
    /// The domain's own tensor rule.
    pub(crate) fn plain<D: Domain<Point = X>>(domain: &D, panels: usize, order: usize) -> Result<Self, Error> {
        for (parameter, value) in [("panels", panels), ("order", order)] {
            if value == 0 {
                return Err(Error::invalid(parameter, 0.0, "must be at least 1"));
            }
        }
        let unknowns = ((panels as f64) * order as f64).powi(domain.dimension() as i32) * domain.states() as f64;
        if unknowns > MOST_NODES as f64 || (panels == 1 && order > MOST_UNKNOWNS) {
            return Err(Error::invalid("unknowns", unknowns, "must be at most 4194304, and the order of a rule at most 16384"));
        }
        let axis = |a: usize| if domain.is_periodic(a) { Axis::Trapezoid(order) } else { Axis::Gauss(Box::new(Basis::gauss(order))) };
        let tensor = (panels == 1).then(|| (0..domain.dimension()).map(axis).collect());
        Ok(Grid { nodes: domain.rule(panels, order), panels: None, tensor, centred: None, ends: Ends::default(), lines: Vec::new() })
    }

    /// `order` equidistant nodes of a one-dimensional domain, for functions that continue periodically.
    pub(super) fn equidistant<D: Domain<Point = X>>(domain: &D, order: usize) -> Result<Self, Error> {
        check_size(order as f64 * domain.states() as f64)?;
        let node = |state: usize, k: usize| {
            let placed = domain.place(state, || (k as f64 + 0.5) / order as f64);
            Node { point: placed.point, weight: placed.weight / order as f64 }
        };
        let nodes = (0..domain.states()).flat_map(|s| (0..order).map(move |k| (s, k))).map(|(s, k)| node(s, k)).collect();
        Ok(Grid {
            nodes,
            panels: None,
            tensor: Some(vec![Axis::Trapezoid(order)]),
            centred: None,
            ends: Ends::default(),
            lines: Vec::new(),
        })
    }

    /// Whether all nodes are equidistant.
    pub(super) fn is_equidistant(&self) -> bool {
        matches!(self.tensor.as_deref(), Some([Axis::Trapezoid(_)]))
    }

    /// The domain's tensor rule, with rows by rules around x.
    pub(crate) fn centred<D: Domain<Point = X>>(domain: &D, order: usize) -> Result<Self, Error> {
        let grid = Grid::plain(domain, 1, order)?;
        if domain.around(&grid.nodes[0].point, 1).is_none() {
            let why = "has no rules around a point: take a graded or adaptive one on a line; disks have them";
            return Err(Error::invalid("Nystrom::centred", order as f64, why));
        }
        Ok(Grid { centred: Some(order), ..grid })
    }

    /// Whether rows are integrated around x, whatever K does there.
    pub(crate) fn is_centred(&self) -> bool {
        self.centred.is_some()
    }

    /// `order` double-exponential nodes of a one-dimensional domain.
    pub(crate) fn double_exponential<D: Domain<Point = X>>(domain: &D, order: usize) -> Result<Self, Error> {
        check_size(order as f64 * domain.states() as f64)?;
        let rule = DoubleExponential::on(domain, order);
        let nodes = (0..domain.states()).flat_map(|state| rule.nodes(domain, state)).collect();
        Ok(Grid {
            nodes,
            panels: None,
            tensor: Some(vec![Axis::DoubleExponential(rule)]),
            centred: None,
            ends: Ends::default(),
            lines: Vec::new(),
        })
    }

    /// The same grid, with rows on the panels at singular ends integrated towards those.
    pub(crate) fn towards(self, ends: Ends) -> Self {
        Grid { ends, ..self }
    }

    /// Singular ends of the domain, as far as rows know.
    pub(crate) fn ends(&self) -> Ends {
        self.ends
    }

    /// The same grid, with rows integrated towards lines as well.
    pub(crate) fn across(self, lines: Vec<Line>) -> Self {
        Grid { lines, ..self }
    }

    /// Coordinates between which f is one piece: ends of panels, or double-exponential nodes.
    pub(crate) fn cuts(&self) -> Vec<f64> {
        match (&self.panels, self.tensor.as_deref()) {
            (Some(panels), _) => panels.breaks.clone(),
            (_, Some([Axis::DoubleExponential(rule)])) => rule.coordinates().collect(),
            _ => Vec::new(),
        }
    }

    /// Whether the values at the nodes are those of functions that may be singular at the ends.
    pub(crate) fn is_double_exponential(&self) -> bool {
        matches!(self.tensor.as_deref(), Some([Axis::DoubleExponential(_)]))
    }

    /// Gauss–Legendre nodes of `order` on every panel of a one-dimensional domain; `breaks` ascend from 0 to 1.
    pub(crate) fn panelled<D: Domain<Point = X>>(domain: &D, breaks: Vec<f64>, order: usize) -> Result<Self, Error> {
        if domain.dimension() != 1 {
            return Err(Error::invalid(
                "dimension",
                domain.dimension() as f64,
                "panels towards the diagonal need a one-dimensional domain",
            ));
        }
        if order == 0 {
            return Err(Error::invalid("order", 0.0, "must be at least 1"));
        }
        check_size((breaks.len() - 1) as f64 * order as f64 * domain.states() as f64)?;
        let basis = Basis::gauss(order);
        let mut nodes = Vec::with_capacity(domain.states() * (breaks.len() - 1) * order);
        for state in 0..domain.states() {
            for ends in breaks.windows(2) {
                add_panel(domain, state, (ends[0], ends[1]), &basis, &mut nodes);
            }
        }
        let pieces = Basis::gauss(order.max(16));
        Ok(Grid {
            nodes,
            panels: Some(Panels { breaks, basis, pieces }),
            tensor: None,
            centred: None,
            ends: Ends::default(),
            lines: Vec::new(),
        })
    }

    pub(crate) fn panels(&self) -> Option<&Panels> {
        self.panels.as_ref()
    }

    /// Whether f − g at x is to be had from values at the nodes alone: so close to an end where K(x, ·) is unbounded that rows cannot be trusted.
    pub(crate) fn is_held_off<D: Domain<Point = X>>(&self, domain: &D, x: &X) -> bool {
        self.panels.is_some() && self.ends.held_off(domain, x) != *x
    }
}

/// Gauss nodes of one panel, found from the nearer end of the domain, with weights for where floating-point numbers put them: towards an end where f and K
/// are singular the last bit of a node shows.
fn add_panel<D: Domain>(domain: &D, state: usize, (a, b): (f64, f64), basis: &Basis, nodes: &mut Vec<Node<D::Point>>) {
    let origin = nearer_end(domain, 0.5 * (a + b));
    let end = domain.place(state, || origin).point;
    let (mut shifts, mut weights) = (vec![0.0; basis.len()], vec![0.0; basis.len()]);
    let first = nodes.len();
    for (n, shift) in basis.rule().iter().zip(&mut shifts) {
        let wanted = (a - origin) + (b - a) * n.point;
        if wanted > 0.5 {
            // towards infinity there is no end to count from
            nodes.push(domain.place(state, || wanted));
            continue;
        }
        let placed = domain.displaced(&end, state, wanted);
        *shift = (domain.separation(&end, &placed.point) - wanted) / (b - a);
        nodes.push(placed);
    }
    basis.shifted_weights(&shifts, &mut weights);
    nodes[first..].iter_mut().zip(&weights).for_each(|(n, w)| n.weight *= w * (b - a));
}

/// Refuses systems that would not fit.
pub(crate) fn check_size(unknowns: f64) -> Result<(), Error> {
    if unknowns > MOST_UNKNOWNS as f64 {
        return Err(Error::invalid(
            "unknowns",
            unknowns,
            "must be at most 16384, a dense system taking 8 n² bytes, unless K has low rank or is one of x − y on uniform nodes",
        ));
    }
    Ok(())
}
