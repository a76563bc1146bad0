//! Building trees: `obvhs` clusters the boxes, and its binary tree is collapsed to eight children a node.

use obvhs::aabb::Aabb as Box2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::tree::{Aabb, Child, STACK, Tree, WIDTH};

/// Slots of the table in which boxes about the same middle are noticed, as a power of 2.
const TABLE_BITS: u32 = 16;
/// More boxes than this about middles that others have make clustering slow: it goes quadratic on coincident boxes.
const MOST_COINCIDENT: usize = 4096;

/// Fewer boxes than [`MOST_COINCIDENT`] have another one's middle, as far as a small table can tell.
pub(super) fn is_spread(boxes: &[Aabb]) -> bool {
    let mut table = vec![0_u32; 1 << TABLE_BITS];
    let mut seen = 0;
    for b in boxes {
        let hash = (0..3).fold(0x811c_9dc5_u32, |hash, i| {
            let middle = (b.min[i] + b.max[i]).to_bits();
            (hash.rotate_left(5) ^ middle).wrapping_mul(0x9e37_79b1)
        });
        let slot = &mut table[(hash >> (32 - TABLE_BITS)) as usize];
        seen += usize::from(*slot == hash);
        *slot = hash;
    }
    seen < MOST_COINCIDENT
}

/// The tree over `boxes`, and the boxes of each block: the eight slots of a block hold indices of boxes, or
/// [`EMPTY`]. Boxes in the tree are grown by `pad`.
pub(super) fn build(boxes: &[Aabb], pad: f32) -> (Tree, Vec<[u32; WIDTH]>) {
    if boxes.is_empty() {
        return (Tree::default(), Vec::new());
    }
    if is_spread(boxes) {
        let (nodes, order) = cluster(boxes);
        let made = collapse(&nodes, &order, pad);
        if made.2 <= STACK {
            return (made.0, made.1);
        }
    }
    let (nodes, order) = halve(boxes);
    let (tree, blocks, _) = collapse(&nodes, &order, pad);
    (tree, blocks)
}

/// A slot of a block without a primitive.
pub(super) const EMPTY: u32 = u32::MAX;

/// The binary tree by locally-ordered clustering (reinsertion pays nothing once it is collapsed: `benches/README.md`), and the order of its primitives.
fn cluster(boxes: &[Aabb]) -> (Vec<Bvh2Node>, Vec<u32>) {
    let boxes: Vec<Box2> = boxes.iter().map(|b| Box2::new(b.min.into(), b.max.into())).collect();
    let indices = (0..boxes.len() as u32).collect();
    let bvh =
        PlocBuilder::with_capacity(boxes.len()).build(PlocSearchDistance::Low, &boxes, indices, SortPrecision::U64, 2);
    drop(boxes);
    (bvh.nodes, bvh.primitive_indices)
}

/// The binary tree by halving the longest side at the median: balanced whatever the boxes are.
fn halve(boxes: &[Aabb]) -> (Vec<Bvh2Node>, Vec<u32>) {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![(0_usize, 0..boxes.len())];
    while let Some((at, range)) = open.pop() {
        let bounds = range.clone().fold(Box2::empty(), |sum, i| {
            let b = &boxes[order[i] as usize];
            sum.union(&Box2::new(b.min.into(), b.max.into()))
        });
        if range.len() == 1 {
            nodes[at] = Bvh2Node::new(bounds, 1, range.start as u32);
            continue;
        }
        let size = bounds.max - bounds.min;
        let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
        let middle = |i: u32| boxes[i as usize].min[axis] + boxes[i as usize].max[axis];
        let half = range.len() / 2;
        order[range.clone()]
            .select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)).then_with(|| a.cmp(&b)));
        let first = nodes.len();
        nodes[at] = Bvh2Node::new(bounds, 0, first as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        open.push((first, range.start..range.start + half));
        open.push((first + 1, range.start + half..range.end));
    }
    (nodes, order)
}

/// Eight children a node: the largest inner child gives way to its own two as long as there is room. Returns the
/// tree, the blocks, and how many children can wait during a traversal.
fn collapse(nodes: &[Bvh2Node], order: &[u32], pad: f32) -> (Tree, Vec<[u32; WIDTH]>, usize) {
    let counts = count(nodes);
    let mut tree = Tree::default();
    let mut blocks = Vec::with_capacity(order.len() / 4);
    let mut most_waiting = 0;
    let root = tree.add();
    let mut open = vec![(0_u32, root, 0_usize)];
    let is_small = |i: u32| counts[i as usize] <= WIDTH as u32;
    while let Some((from, to, waiting)) = open.pop() {
        let mut children = [from; WIDTH];
        let mut len = 1;
        while len < WIDTH {
            // While anything is larger than a block, that is opened first.
            let area = |i: &usize| nodes[children[*i] as usize].aabb().half_area();
            let large = (0..len).filter(|&i| !is_small(children[i])).max_by(|a, b| area(a).total_cmp(&area(b)));
            let Some(largest) = large else { break };
            let first = nodes[children[largest] as usize].first_index;
            children[largest] = first;
            children[len] = first + 1;
            len += 1;
        }
        most_waiting = most_waiting.max(waiting + len);
        for (slot, &child) in children[..len].iter().enumerate() {
            let bounds = nodes[child as usize].aabb();
            let bounds = Aabb { min: bounds.min.to_array(), max: bounds.max.to_array() };
            let to_child = if is_small(child) {
                blocks.push(gather(nodes, order, child));
                Child::Block((blocks.len() - 1) as u32)
            } else {
                let node = tree.add();
                open.push((child, node, waiting + len - 1));
                Child::Node(node)
            };
            tree.set(to, slot, &bounds.pad(pad), to_child);
        }
    }
    (tree, blocks, most_waiting)
}

/// How many primitives are below each node.
fn count(nodes: &[Bvh2Node]) -> Vec<u32> {
    let mut counts = vec![0; nodes.len()];
    let mut open = vec![0_u32];
    let mut seen = Vec::with_capacity(nodes.len());
    while let Some(i) = open.pop() {
        seen.push(i);
        let node = &nodes[i as usize];
        if node.is_leaf() {
            counts[i as usize] = node.prim_count;
        } else {
            open.extend([node.first_index, node.first_index + 1]);
        }
    }
    for &i in seen.iter().rev() {
        let node = &nodes[i as usize];
        if !node.is_leaf() {
            let first = node.first_index as usize;
            counts[i as usize] = counts[first] + counts[first + 1];
        }
    }
    counts
}

/// The primitives below a node that holds a block's worth.
fn gather(nodes: &[Bvh2Node], order: &[u32], root: u32) -> [u32; WIDTH] {
    let mut block = [EMPTY; WIDTH];
    let mut len = 0;
    let mut open = [root; WIDTH + 1];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let node = &nodes[open[waiting] as usize];
        if node.is_leaf() {
            for i in 0..node.prim_count {
                block[len] = order[(node.first_index + i) as usize];
                len += 1;
            }
        } else {
            open[waiting] = node.first_index;
            open[waiting + 1] = node.first_index + 1;
            waiting += 2;
        }
    }
    block
}
