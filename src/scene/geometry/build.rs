//! From boxes to a tree: a binary tree by `obvhs`, eight of its boxes to a node.

use super::tree::{LANES, Node, Place, Tree};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Items in a leaf.
pub(super) const IN_LEAF: usize = 4;

/// Low and high corner.
pub(super) type Bounds = [[f64; 3]; 2];

/// The smallest box around others.
pub(super) fn around(bounds: impl IntoIterator<Item = Bounds>) -> Bounds {
    let nothing = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    bounds
        .into_iter()
        .fold(nothing, |[low, high], [l, h]| [std::array::from_fn(|i| low[i].min(l[i])), std::array::from_fn(|i| high[i].max(h[i]))])
}

impl Place {
    fn of([low, high]: Bounds) -> Self {
        let centre = std::array::from_fn(|i| 0.5 * low[i] + 0.5 * high[i]);
        let half = (0..3).fold(0.0, |m: f64, i| m.max(high[i] - centre[i]).max(centre[i] - low[i]));
        // 2⁻ᵉ with 2ᵉ above half: exact, and within the normal numbers for every size that is allowed
        let scale = if half > 0.0 { (-half.log2().floor() - 1.0).exp2() } else { 1.0 };
        Place { centre, scale }
    }

    /// In single precision, rounded outward.
    fn single(&self, [low, high]: Bounds) -> Aabb {
        let at = |x: f64, i: usize| (self.scale * (x - self.centre[i])) as f32;
        let low: [f32; 3] = std::array::from_fn(|i| at(low[i], i).next_down());
        let high: [f32; 3] = std::array::from_fn(|i| at(high[i], i).next_up());
        Aabb { min: low.into(), max: high.into() }
    }
}

/// A tree over boxes, and for each leaf the indices of at most [`IN_LEAF`] boxes in it.
pub(super) fn build(bounds: &[Bounds]) -> (Tree, Vec<Vec<u32>>) {
    let place = Place::of(around(bounds.iter().copied()));
    let boxes: Vec<Aabb> = bounds.iter().map(|&b| place.single(b)).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(PlocSearchDistance::Medium, &boxes, indices, SortPrecision::U64, 3);
    ReinsertionOptimizer::default().run(&mut binary, 0.05, None);
    Collapse::new(&binary).run(place)
}

struct Collapse<'a> {
    binary: &'a Bvh2,
    /// boxes below each node
    count: Vec<u32>,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Bvh2) -> Self {
        let mut count = vec![0; binary.nodes.len()];
        let mut work = vec![(0_usize, false)];
        while let Some((i, ready)) = work.pop() {
            let (node, first) = (&binary.nodes[i], binary.nodes[i].first_index as usize);
            if node.is_leaf() {
                count[i] = node.prim_count;
            } else if ready {
                count[i] = count[first] + count[first + 1];
            } else {
                work.extend([(i, true), (first, false), (first + 1, false)]);
            }
        }
        Collapse { binary, count }
    }

    fn run(&self, place: Place) -> (Tree, Vec<Vec<u32>>) {
        let (mut nodes, mut leaves) = (vec![Node::EMPTY], Vec::new());
        let mut work = vec![(0, 0)];
        while let Some((i, wide)) = work.pop() {
            let mut node = Node::EMPTY;
            for (lane, &child) in self.children(i).iter().enumerate() {
                let bounds = self.binary.nodes[child].aabb();
                for axis in 0..3 {
                    node.bounds[axis][0][lane] = bounds.min[axis];
                    node.bounds[axis][1][lane] = bounds.max[axis];
                }
                node.child[lane] = if self.count[child] as usize <= IN_LEAF {
                    leaves.push(self.items(child));
                    Node::leaf(leaves.len() as u32 - 1)
                } else {
                    nodes.push(Node::EMPTY);
                    work.push((child, nodes.len() - 1));
                    nodes.len() as u32 - 1
                };
            }
            nodes[wide] = node;
        }
        (Tree { nodes, place }, leaves)
    }

    /// At most eight nodes that stand for one: the largest is opened until there are enough.
    fn children(&self, node: usize) -> Vec<usize> {
        let mut children = vec![node];
        while children.len() < LANES {
            let open =
                |&(_, &c): &(usize, &usize)| !self.binary.nodes[c].is_leaf() && (self.count[c] as usize > IN_LEAF || children.len() == 1);
            let area = |c: usize| self.binary.nodes[c].aabb().half_area();
            let Some((k, &c)) = children.iter().enumerate().filter(open).max_by(|a, b| area(*a.1).total_cmp(&area(*b.1))) else { break };
            let first = self.binary.nodes[c].first_index as usize;
            children[k] = first;
            children.push(first + 1);
        }
        children
    }

    fn items(&self, node: usize) -> Vec<u32> {
        let (mut items, mut work) = (Vec::with_capacity(IN_LEAF), vec![node]);
        while let Some(i) = work.pop() {
            let (node, first) = (&self.binary.nodes[i], self.binary.nodes[i].first_index as usize);
            if node.is_leaf() {
                items.extend_from_slice(&self.binary.primitive_indices[first..first + node.prim_count as usize]);
            } else {
                work.extend([first, first + 1]);
            }
        }
        items
    }
}
