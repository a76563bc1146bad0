//! Construction: `obvhs` clusters the boxes piece by piece, and its binary trees are collapsed to eight children a node.

use obvhs::aabb::Aabb as Box2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use super::binary::Binary;
use super::collapse::{Wide, collapse};
use super::tree::{Aabb, Child, STACK, WIDTH};

/// log2 of the slots of the hash table that detects coincident centres.
const TABLE_BITS: u32 = 16;
/// Coincident boxes from which on clustering, quadratic in their number, is avoided.
const MOST_COINCIDENT: usize = 4096;
/// Boxes clustered at once, which bounds the temporary memory.
const PIECE: usize = 1 << 16;
/// Bytes that clustering takes of each.
const PIECE_BYTES: usize = 96;

/// Bytes that clustering takes while it is under way.
pub(super) fn bytes_of_pieces(count: usize) -> usize {
    count.min(PIECE * rayon::current_num_threads()) * PIECE_BYTES
}

/// Have fewer than [`MOST_COINCIDENT`] boxes the centre of another one, as far as a small hash table detects?
pub(super) fn is_spread<'a>(boxes: impl Iterator<Item = &'a Aabb>) -> bool {
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

/// An empty slot of a block.
pub(super) const EMPTY: u32 = u32::MAX;

/// The tree over `boxes`, and the indices of the boxes of each block, [`EMPTY`] in unused slots. Boxes in the tree are padded
/// by `pad`.
pub(super) fn build(boxes: &[Aabb], pad: f32) -> Wide {
    if boxes.is_empty() {
        return Wide::default();
    }
    let mut top = halve(boxes, (0..boxes.len() as u32).collect(), PIECE);
    let (nodes, order) = (&mut top.nodes, &top.order);
    let leaves: Vec<usize> = (0..nodes.len()).filter(|&i| nodes[i].is_leaf()).collect();
    let indices = |&i: &usize| {
        let first = nodes[i].first_index as usize;
        &order[first..first + nodes[i].prim_count as usize]
    };
    let mut pieces: Vec<Wide> = leaves.par_iter().map(|leaf| piece(boxes, indices(leaf), pad)).collect();
    if pieces.len() == 1 {
        return pieces.remove(0);
    }
    for (piece, leaf) in (0..).zip(leaves) {
        nodes[leaf].first_index = piece;
    }
    let mut blocks = Vec::with_capacity(pieces.iter().map(|piece| piece.blocks.len()).sum());
    let mut deepest = 0;
    let mut whole = collapse(&top, PIECE as u32, by_count, pad, |tree, _, leaf| {
        let piece = std::mem::take(&mut pieces[leaf.first_index as usize]);
        let root = tree.graft(piece.tree, blocks.len() as u32);
        blocks.extend(piece.blocks);
        deepest = deepest.max(piece.waiting);
        Child::Node(root)
    });
    whole.blocks = blocks;
    whole.waiting += deepest;
    debug_assert!(whole.waiting <= STACK);
    whole
}

/// The tree over some of the boxes.
fn piece(boxes: &[Aabb], indices: &[u32], pad: f32) -> Wide {
    let with_blocks = |binary: &Binary, weight: fn(&Bvh2Node, u32) -> f32| {
        let mut blocks = Vec::with_capacity(indices.len() / 4);
        let mut wide = collapse(binary, WIDTH as u32, weight, pad, |_, binary, leaf| {
            blocks.push(gather(binary, leaf));
            Child::Block((blocks.len() - 1) as u32)
        });
        wide.blocks = blocks;
        wide
    };
    if is_spread(indices.iter().map(|&i| &boxes[i as usize])) {
        let wide = with_blocks(&cluster(boxes, indices), |node, _| node.aabb().half_area());
        // The other half of the stack is for the top tree.
        if wide.waiting <= STACK / 2 {
            return wide;
        }
    }
    with_blocks(&halve(boxes, indices.to_vec(), 1), by_count)
}

/// The weight by the number of primitives, which keeps a tree shallow.
fn by_count(_: &Bvh2Node, count: u32) -> f32 {
    count as f32
}

fn to_box2(b: &Aabb) -> Box2 {
    Box2::new(b.min.into(), b.max.into())
}

/// The binary tree by parallel locally-ordered clustering (Meister and Bittner 2018); reinsertion does not pay once it is
/// collapsed (`benches/README.md`).
fn cluster(boxes: &[Aabb], indices: &[u32]) -> Binary {
    let own: Vec<Box2> = indices.iter().map(|&i| to_box2(&boxes[i as usize])).collect();
    let all = (0..own.len() as u32).collect();
    let bvh = PlocBuilder::with_capacity(own.len()).build(PlocSearchDistance::Low, &own, all, SortPrecision::U64, 2);
    let order = bvh.primitive_indices.iter().map(|&i| indices[i as usize]).collect();
    Binary { nodes: bvh.nodes, order }
}

/// The binary tree by median splits of the longest axis, with leaves of at most `most` boxes: balanced for any input.
fn halve(boxes: &[Aabb], mut order: Vec<u32>, most: usize) -> Binary {
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![(0_usize, 0..order.len())];
    while let Some((at, range)) = open.pop() {
        let whole = order[range.clone()].iter().fold(Aabb::EMPTY, |sum, &i| sum.union(&boxes[i as usize]));
        if range.len() <= most {
            nodes[at] = Bvh2Node::new(to_box2(&whole), range.len() as u32, range.start as u32);
            continue;
        }
        let size = [0, 1, 2].map(|i| whole.max[i] - whole.min[i]);
        let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
        let middle = |i: u32| boxes[i as usize].min[axis] + boxes[i as usize].max[axis];
        let half = range.len() / 2;
        order[range.clone()]
            .select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)).then_with(|| a.cmp(&b)));
        let first = nodes.len();
        nodes[at] = Bvh2Node::new(to_box2(&whole), 0, first as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        open.push((first, range.start..range.start + half));
        open.push((first + 1, range.start + half..range.end));
    }
    Binary { nodes, order }
}

/// The primitives below a node with at most a block of them.
fn gather(binary: &Binary, root: &Bvh2Node) -> [u32; WIDTH] {
    let mut block = [EMPTY; WIDTH];
    let mut len = 0;
    let mut open = [*root; WIDTH + 1];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let node = open[waiting];
        if node.is_leaf() {
            for i in 0..node.prim_count {
                block[len] = binary.order[(node.first_index + i) as usize];
                len += 1;
            }
        } else {
            let first = node.first_index as usize;
            open[waiting] = binary.nodes[first];
            open[waiting + 1] = binary.nodes[first + 1];
            waiting += 2;
        }
    }
    block
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::math::Stream;

    fn boxes(count: usize) -> Vec<Aabb> {
        let mut random = Stream::new(1, "boxes");
        (0..count)
            .map(|_| {
                let min: [f32; 3] = std::array::from_fn(|_| random.random_range(-5.0..5.0));
                Aabb { min, max: min.map(|x| x + random.random_range(0.0..0.5)) }
            })
            .collect()
    }

    /// Every box is in one slot of one block, and walks need no more stack than there is.
    fn holds_all(boxes: &[Aabb]) {
        let wide = build(boxes, 0.0);
        let mut slots: Vec<u32> = wide.blocks.iter().flatten().copied().filter(|&slot| slot != EMPTY).collect();
        slots.sort_unstable();
        assert!(slots.into_iter().eq(0..boxes.len() as u32));
        assert!(wide.waiting <= STACK, "{}", wide.waiting);
        assert!(wide.blocks.len() >= boxes.len().div_ceil(WIDTH));
    }

    #[test]
    fn every_box_has_one_slot() {
        for count in [0, 1, 2, WIDTH, WIDTH + 1, 1000, PIECE + 5000] {
            holds_all(&boxes(count));
        }
    }

    #[test]
    fn coincident_boxes_are_noticed_and_held() {
        let same = vec![Aabb { min: [1.0; 3], max: [2.0; 3] }; 2 * MOST_COINCIDENT];
        assert!(!is_spread(same.iter()));
        assert!(is_spread(boxes(20_000).iter()));
        holds_all(&same);
    }

    #[test]
    fn halving_is_balanced() {
        let boxes = boxes(1000);
        let binary = halve(&boxes, (0..1000).collect(), 1);
        let mut deepest = 0;
        let mut open = vec![(0, 1)];
        while let Some((node, depth)) = open.pop() {
            deepest = deepest.max(depth);
            let node = &binary.nodes[node];
            if !node.is_leaf() {
                open.extend([0, 1].map(|i| (node.first_index as usize + i, depth + 1)));
            }
        }
        assert_eq!(deepest, 11);
    }
}
