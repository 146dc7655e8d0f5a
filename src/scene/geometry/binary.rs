//! A binary tree over boxes by the surface-area heuristic, the same for any number of threads.

use crate::parallel;
use std::array::from_fn;

/// Slices of space among whose limits the best split is sought.
const BINS: usize = 16;
/// Items that a task looks at.
const CHUNK: usize = 1 << 14;
/// Subtrees that are made at the same time, at least.
const TASKS: usize = 64;

/// Low and high corner in single precision.
pub(super) type Box32 = [[f32; 3]; 2];

const NOTHING: Box32 = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

#[inline]
fn join(a: &Box32, b: &Box32) -> Box32 {
    let min = |x: f32, y: f32| if x < y { x } else { y };
    let max = |x: f32, y: f32| if x > y { x } else { y };
    [from_fn(|i| min(a[0][i], b[0][i])), from_fn(|i| max(a[1][i], b[1][i]))]
}

/// Half the surface.
pub(super) fn area([low, high]: &Box32) -> f32 {
    let [x, y, z]: [f32; 3] = from_fn(|i| high[i] - low[i]);
    x * (y + z) + y * z
}

/// Two children, at `first` and `first + 1`, or one item, number `first` in the tree's order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    pub(super) bounds: Box32,
    pub(super) first: u32,
    pub(super) is_item: bool,
}

/// The branches, the root first and parents before their children, and the items in the order of their numbers.
///
/// Ranges are split where a sum of areas times counts is least, among the limits of slices: minima, maxima and counts, which are the same
/// in whatever order they are taken. Wald (2007), On fast construction of SAH-based bounding volume hierarchies, §3.
#[derive(Debug)]
pub(super) struct Binary {
    pub(super) branches: Vec<Branch>,
    pub(super) order: Vec<u32>,
}

/// A branch whose items are known.
#[derive(Clone, Copy, Debug)]
struct Range {
    branch: usize,
    start: usize,
    end: usize,
}

impl Binary {
    pub(super) fn new(boxes: &[Box32]) -> Self {
        let root = Range { branch: 0, start: 0, end: boxes.len() };
        let order: Vec<u32> = (0..boxes.len() as u32).collect();
        let bounds = gather(&order, |items| items.iter().fold(NOTHING, |all, &i| join(&all, &boxes[i as usize])), join);
        let mut tree = Binary { branches: vec![Branch { bounds, first: 0, is_item: true }], order };
        let (mut work, mut tasks) = (vec![root], Vec::new());
        while let Some(range) = work.pop() {
            if range.end - range.start <= CHUNK.max(boxes.len() / TASKS) {
                tasks.push(range);
            } else {
                work.extend(tree.split(boxes, range));
            }
        }
        for (part, range) in parallel::map(tasks.len(), |k| tree.part(boxes, tasks[k])).iter().zip(&tasks) {
            tree.attach(part, *range);
        }
        tree
    }

    /// The tree below a branch, for itself.
    fn part(&self, boxes: &[Box32], range: Range) -> Binary {
        let mut part = Binary { branches: vec![self.branches[range.branch]], order: self.order[range.start..range.end].to_vec() };
        let mut work = vec![Range { branch: 0, start: 0, end: part.order.len() }];
        while let Some(range) = work.pop() {
            if range.end - range.start == 1 {
                part.branches[range.branch].first = range.start as u32;
            } else {
                work.extend(part.split(boxes, range));
            }
        }
        part
    }

    fn attach(&mut self, part: &Binary, range: Range) {
        self.order[range.start..range.end].copy_from_slice(&part.order);
        // the root of the part is here already
        let shift = self.branches.len() - 1;
        let moved = |b: &Branch| Branch { first: b.first + if b.is_item { range.start } else { shift } as u32, ..*b };
        let mut branches = part.branches.iter().map(moved);
        self.branches[range.branch] = branches.next().expect("a root");
        self.branches.extend(branches);
    }

    /// Gives a branch two children.
    fn split(&mut self, boxes: &[Box32], range: Range) -> [Range; 2] {
        let items = &mut self.order[range.start..range.end];
        let bins = Bins::new(boxes, items);
        let Split { axis, bin, mut bounds } = bins.best();
        let mut middle = partition(items, |i| bins.index(&boxes[i as usize], axis) < bin);
        if middle == 0 || middle == items.len() {
            // all in one place: any halves
            middle = items.len() / 2;
            let around = |items: &[u32]| items.iter().fold(NOTHING, |all, &i| join(&all, &boxes[i as usize]));
            bounds = [around(&items[..middle]), around(&items[middle..])];
        }
        let (first, middle) = (self.branches.len(), range.start + middle);
        self.branches[range.branch] = Branch { first: first as u32, is_item: false, ..self.branches[range.branch] };
        self.branches.extend(bounds.map(|bounds| Branch { bounds, first: 0, is_item: true }));
        [Range { branch: first, start: range.start, end: middle }, Range { branch: first + 1, start: middle, end: range.end }]
    }
}

/// `f` of all items, or what `join` makes of `f` of parts of them; it must not matter how they are put together.
fn gather<T: Send>(items: &[u32], f: impl Fn(&[u32]) -> T + Send + Sync, join: impl Fn(&T, &T) -> T) -> T {
    if items.len() <= CHUNK {
        return f(items);
    }
    let parts = parallel::map(items.len().div_ceil(CHUNK), |k| f(&items[k * CHUNK..items.len().min((k + 1) * CHUNK)]));
    parts.into_iter().reduce(|a, b| join(&a, &b)).expect("more than one part")
}

/// Moves the items that go left before the others, says how many.
fn partition(items: &mut [u32], left: impl Fn(u32) -> bool) -> usize {
    let (mut i, mut j) = (0, items.len());
    while i < j {
        if left(items[i]) {
            i += 1;
        } else {
            j -= 1;
            items.swap(i, j);
        }
    }
    i
}

/// What is in the slices of space, across each axis, in which the centres of items are.
struct Bins {
    low: [f32; 3],
    /// slices in a unit of length
    scale: [f32; 3],
    bins: [[Bin; BINS]; 3],
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Box32,
    count: u32,
}

impl Bin {
    const EMPTY: Bin = Bin { bounds: NOTHING, count: 0 };

    fn join(&self, other: &Bin) -> Bin {
        Bin { bounds: join(&self.bounds, &other.bounds), count: self.count + other.count }
    }

    fn cost(&self) -> f32 {
        area(&self.bounds) * self.count as f32
    }
}

/// What comes before bin `bin` across an axis goes left.
struct Split {
    axis: usize,
    bin: usize,
    bounds: [Box32; 2],
}

impl Bins {
    fn new(boxes: &[Box32], items: &[u32]) -> Self {
        let centre = |i: u32| from_fn(|axis| centre(&boxes[i as usize], axis));
        let [low, high] = gather(items, |items| items.iter().fold(NOTHING, |all, &i| join(&all, &[centre(i); 2])), join);
        let scale = from_fn(|axis| Some(BINS as f32 / (high[axis] - low[axis])).filter(|s| s.is_finite()).unwrap_or(0.0));
        let empty = Bins { low, scale, bins: [[Bin::EMPTY; BINS]; 3] };
        let fill = |items: &[u32]| {
            let mut bins = empty.bins;
            for &i in items {
                let bounds = boxes[i as usize];
                for (axis, bins) in bins.iter_mut().enumerate() {
                    let bin = &mut bins[empty.index(&bounds, axis)];
                    *bin = bin.join(&Bin { bounds, count: 1 });
                }
            }
            bins
        };
        let bins = gather(items, fill, |a, b| from_fn(|axis| from_fn(|k| a[axis][k].join(&b[axis][k]))));
        Bins { bins, ..empty }
    }

    #[inline]
    fn index(&self, bounds: &Box32, axis: usize) -> usize {
        (((centre(bounds, axis) - self.low[axis]) * self.scale[axis]) as usize).min(BINS - 1)
    }

    /// The split of least cost; at bin 0 if all is in one place.
    fn best(&self) -> Split {
        let (mut least, mut best) = (f32::INFINITY, Split { axis: 0, bin: 0, bounds: [NOTHING; 2] });
        for (axis, bins) in self.bins.iter().enumerate() {
            let mut right = *bins;
            for k in (0..BINS - 1).rev() {
                right[k] = right[k].join(&right[k + 1]);
            }
            let mut left = Bin::EMPTY;
            for (bin, (before, right)) in (1..).zip(bins.iter().zip(&right[1..])) {
                left = left.join(before);
                let cost = left.cost() + right.cost();
                if left.count > 0 && right.count > 0 && cost < least {
                    (least, best) = (cost, Split { axis, bin, bounds: [left.bounds, right.bounds] });
                }
            }
        }
        best
    }
}

/// Twice the centre of a box.
#[inline]
fn centre([low, high]: &Box32, axis: usize) -> f32 {
    low[axis] + high[axis]
}
