//! From boxes to a tree: a binary tree, eight of its boxes to a node.

use super::binary::{Binary, Box32, area};
use super::leaves::Leaf;
use super::tree::{LANES, Node, Place, Tree};
use crate::parallel;

/// Items in a leaf.
pub(super) const IN_LEAF: usize = 4;
/// Cost of trying a leaf, in visits of a node.
const LEAF_COST: f32 = 2.0;

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
    fn single(&self, [low, high]: Bounds) -> Box32 {
        let at = |x: f64, i: usize| (self.scale * (x - self.centre[i])) as f32;
        let low: [f32; 3] = std::array::from_fn(|i| at(low[i], i).next_down());
        let high: [f32; 3] = std::array::from_fn(|i| at(high[i], i).next_up());
        [low, high]
    }
}

/// A tree over boxes, its leaves, and the indices of the boxes in their order.
pub(super) fn build(bounds: &[Bounds]) -> (Tree, Vec<Leaf>, Vec<u32>) {
    let place = Place::of(around(bounds.iter().copied()));
    let boxes: Vec<Box32> = parallel::map_short(bounds.len(), |i| place.single(bounds[i]));
    let binary = Binary::new(&boxes);
    Collapse::new(&binary).run(place)
}

/// What a subtree of the binary tree costs if up to i + 1 children of a wide node stand for it: the areas of the boxes, in visits.
#[derive(Clone, Copy, Debug)]
struct Plan {
    cost: [f32; LANES],
    /// how many of them stand for the first half; 0 if one fewer is as good
    split: [u8; LANES],
    count: u32,
}

/// The wide tree of least surface-area cost that can be made of a binary one.
/// Ylitie, Karras & Laine (2017), Efficient incoherent ray traversal on GPUs through compressed wide BVHs, §3.1.
struct Collapse<'a> {
    binary: &'a Binary,
    plans: Vec<Plan>,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Binary) -> Self {
        let nothing = Plan { cost: [0.0; LANES], split: [0; LANES], count: 0 };
        let mut collapse = Collapse { binary, plans: vec![nothing; binary.branches.len()] };
        // children come after their parents
        for i in (0..binary.branches.len()).rev() {
            collapse.plans[i] = collapse.plan(i);
        }
        collapse
    }

    fn plan(&self, i: usize) -> Plan {
        let node = &self.binary.branches[i];
        let area = area(&node.bounds);
        if node.is_item {
            return Plan { cost: [LEAF_COST * area; LANES], split: [0; LANES], count: 1 };
        }
        let [a, b] = [0, 1].map(|k| &self.plans[node.first as usize + k]);
        let mut plan = Plan { cost: [0.0; LANES], split: [0; LANES], count: a.count + b.count };
        for lanes in 1..LANES {
            let ways = (0..lanes).map(|k| (a.cost[k] + b.cost[lanes - 1 - k], k as u8 + 1));
            (plan.cost[lanes], plan.split[lanes]) = ways.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        }
        // one child: a leaf, or a node with all its lanes
        plan.cost[0] = if plan.count as usize <= IN_LEAF { LEAF_COST * area } else { area + plan.cost[LANES - 1] };
        // boxes without area cost nothing: what must be opened stays open
        let fewest = if plan.count as usize <= IN_LEAF { 1 } else { 2 };
        for lanes in fewest..LANES {
            if plan.cost[lanes] >= plan.cost[lanes - 1] {
                (plan.cost[lanes], plan.split[lanes]) = (plan.cost[lanes - 1], 0);
            }
        }
        plan
    }

    fn run(&self, place: Place) -> (Tree, Vec<Leaf>, Vec<u32>) {
        let (mut nodes, mut leaves, mut order) = (vec![Node::EMPTY], Vec::new(), Vec::new());
        let mut work = vec![(0, 0)];
        while let Some((i, wide)) = work.pop() {
            let children = self.children(i);
            let boxes: Vec<_> = children.iter().map(|&c| self.binary.branches[c].bounds).collect();
            let mut node = Node::around(&boxes);
            for (lane, &child) in children.iter().enumerate() {
                node.child[lane] = if self.plans[child].count as usize <= IN_LEAF {
                    let first = order.len();
                    self.items(child, &mut order);
                    leaves.push(Leaf::new(first, order.len() - first));
                    Node::leaf(leaves[leaves.len() - 1])
                } else {
                    nodes.push(Node::EMPTY);
                    work.push((child, nodes.len() - 1));
                    nodes.len() as u32 - 1
                };
            }
            nodes[wide] = node;
        }
        (Tree { nodes, place }, leaves, order)
    }

    /// The nodes that stand for one, at most eight.
    fn children(&self, node: usize) -> Vec<usize> {
        let (mut children, mut work) = (Vec::with_capacity(LANES), vec![(node, LANES - 1)]);
        while let Some((i, mut lanes)) = work.pop() {
            while lanes > 0 && self.plans[i].split[lanes] == 0 {
                lanes -= 1;
            }
            let split = usize::from(self.plans[i].split[lanes]);
            if lanes == 0 {
                children.push(i);
            } else {
                let first = self.binary.branches[i].first as usize;
                work.extend([(first + 1, lanes - split), (first, split - 1)]);
            }
        }
        children
    }

    fn items(&self, node: usize, items: &mut Vec<u32>) {
        let mut work = vec![node];
        while let Some(i) = work.pop() {
            let (node, first) = (&self.binary.branches[i], self.binary.branches[i].first as usize);
            if node.is_item {
                items.push(self.binary.order[first]);
            } else {
                work.extend([first, first + 1]);
            }
        }
    }
}
