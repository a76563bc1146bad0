//! The collapse of a binary tree to eight children a node with the least expected cost (Ylitie, Karras and Laine 2017,
//! "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", section 3.2).

use obvhs::bvh2::node::Bvh2Node;

use super::binary::Binary;
use super::tree::{Aabb, Child, Tree, WIDTH};

/// The cost of intersecting a block over that of a node.
const BLOCK_COST: f32 = 0.8;

/// An 8-wide tree and the primitives of its blocks.
#[derive(Default)]
pub(super) struct Wide {
    pub tree: Tree,
    pub blocks: Vec<[u32; WIDTH]>,
    /// Upper bound of the stack's size during a traversal.
    pub waiting: usize,
}

/// The cost of representing a subtree as a forest of at most 1, 2, ... 8 nodes.
type Costs = [f32; WIDTH];

/// Collapses a binary tree: a node of at most `most` primitives may become a leaf, made by `leaf`. `weight`, a function of a
/// node and its number of primitives, is proportional to the probability that a ray hits the node.
pub(super) fn collapse(
    binary: &Binary,
    most: u32,
    weight: impl Fn(&Bvh2Node, u32) -> f32,
    pad: f32,
    mut leaf: impl FnMut(&mut Tree, &Binary, &Bvh2Node) -> Child,
) -> Wide {
    let nodes = &binary.nodes;
    let (counts, costs) = costs(nodes, most, weight);
    let mut wide = Wide::default();
    let root = wide.tree.add();
    let mut open = vec![(0_u32, root, 0_usize)];
    while let Some((from, to, waiting)) = open.pop() {
        let (children, len) = children(nodes, &costs, from, counts[from as usize] <= most);
        wide.waiting = wide.waiting.max(waiting + len);
        for (slot, &child) in children[..len].iter().enumerate() {
            let node = &nodes[child as usize];
            let bounds = node.aabb();
            let bounds = Aabb { min: bounds.min.to_array(), max: bounds.max.to_array() };
            let to_child = if counts[child as usize] <= most {
                leaf(&mut wide.tree, binary, node)
            } else {
                let node = wide.tree.add();
                open.push((child, node, waiting + len - 1));
                Child::Node(node)
            };
            wide.tree.set(to, slot, &bounds.pad(pad), to_child);
        }
    }
    wide
}

/// The number of primitives below each node, and the costs.
fn costs(nodes: &[Bvh2Node], most: u32, weight: impl Fn(&Bvh2Node, u32) -> f32) -> (Vec<u32>, Vec<Costs>) {
    let mut seen = Vec::with_capacity(nodes.len());
    let mut open = vec![0_u32];
    while let Some(i) = open.pop() {
        seen.push(i);
        let node = &nodes[i as usize];
        if !node.is_leaf() {
            open.extend([node.first_index, node.first_index + 1]);
        }
    }
    let mut counts = vec![0; nodes.len()];
    let mut costs = vec![[0.0; WIDTH]; nodes.len()];
    for i in seen.into_iter().rev().map(|i| i as usize) {
        let node = &nodes[i];
        let first = node.first_index as usize;
        counts[i] = if node.is_leaf() { node.prim_count } else { counts[first] + counts[first + 1] };
        let weight = weight(node, counts[i]);
        let whole = if counts[i] <= most { weight * BLOCK_COST } else { f32::INFINITY };
        if node.is_leaf() {
            costs[i] = [whole; WIDTH];
            continue;
        }
        let split = |n: usize| shares(n).map(|k| shared(&costs, first, n, k)).fold(f32::INFINITY, f32::min);
        let mut own = [whole.min(split(WIDTH) + weight); WIDTH];
        for n in 2..=WIDTH {
            own[n - 1] = own[n - 2].min(split(n));
        }
        costs[i] = own;
    }
    (counts, costs)
}

/// The possible numbers of the `n` children that the first of two nodes gets.
fn shares(n: usize) -> std::ops::Range<usize> {
    1..n
}

/// The cost of two siblings, of which the first gets `k` of `n` children.
fn shared(costs: &[Costs], first: usize, n: usize, k: usize) -> f32 {
    costs[first][k - 1] + costs[first + 1][n - k - 1]
}

/// The children of a node in the wide tree, and their number.
fn children(nodes: &[Bvh2Node], costs: &[Costs], from: u32, is_leaf: bool) -> ([u32; WIDTH], usize) {
    let mut found = [from; WIDTH];
    if is_leaf {
        return (found, 1);
    }
    let mut len = 0;
    // Nodes with the most children that each may become.
    let mut open = [(0_u32, 0_usize); WIDTH + 1];
    let mut waiting = 0;
    let split = |i: u32, n: usize, open: &mut [(u32, usize); WIDTH + 1], waiting: &mut usize| {
        let first = nodes[i as usize].first_index;
        let cost = |k: &usize| shared(costs, first as usize, n, *k);
        let k = shares(n).min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(1);
        open[*waiting] = (first, k);
        open[*waiting + 1] = (first + 1, n - k);
        *waiting += 2;
    };
    split(from, WIDTH, &mut open, &mut waiting);
    while waiting > 0 {
        waiting -= 1;
        let (i, n) = open[waiting];
        let own = &costs[i as usize];
        // The least number at the same cost.
        match (1..=n).find(|&m| own[m - 1] <= own[n - 1]) {
            None | Some(1) => {
                found[len] = i;
                len += 1;
            }
            Some(m) => split(i, m, &mut open, &mut waiting),
        }
    }
    (found, len)
}

#[cfg(test)]
mod tests {
    use obvhs::aabb::Aabb as Box2;

    use super::*;

    /// A balanced binary tree over `count` unit boxes in a row, a power of two, one a leaf.
    fn row(count: u32) -> Binary {
        let along = |from: u32, to: u32| Box2::new([from as f32, 0.0, 0.0].into(), [to as f32, 1.0, 1.0].into());
        let mut nodes = vec![Bvh2Node::default()];
        let mut open = vec![(0, 0, count)];
        while let Some((at, from, to)) = open.pop() {
            if to - from == 1 {
                nodes[at] = Bvh2Node::new(along(from, to), 1, from);
                continue;
            }
            let first = nodes.len();
            nodes[at] = Bvh2Node::new(along(from, to), 0, first as u32);
            nodes.extend([Bvh2Node::default(); 2]);
            let middle = from.midpoint(to);
            open.extend([(first, from, middle), (first + 1, middle, to)]);
        }
        Binary { nodes, order: (0..count).collect() }
    }

    /// With equal weights for equal counts, 64 boxes in a row become one node of eight full blocks.
    #[test]
    fn blocks_are_filled() {
        let binary = row(64);
        let mut counts = Vec::new();
        let wide = collapse(
            &binary,
            WIDTH as u32,
            |_, count| count as f32,
            0.0,
            |_, binary, leaf| {
                let width = leaf.aabb().max.x - leaf.aabb().min.x;
                counts.push(width as usize);
                assert_eq!(binary.order.len(), 64);
                Child::Block(counts.len() as u32 - 1)
            },
        );
        assert_eq!(counts, [8; 8]);
        assert_eq!(wide.waiting, 8);
    }

    #[test]
    fn costs_fall_with_more_children() {
        let binary = row(32);
        let (counts, costs) = costs(&binary.nodes, 8, |_, count| count as f32);
        assert_eq!(counts[0], 32);
        assert_eq!(counts.iter().filter(|&&count| count == 1).count(), 32);
        for own in costs {
            assert!(own.windows(2).all(|pair| pair[1] <= pair[0]), "{own:?}");
            assert!(own[WIDTH - 1].is_finite());
        }
    }
}
