//! Which nodes are endpoints: few of many, at random.

use super::crowd::Crowd;
use crate::graph::{Node, Scatter};
use crate::math::{DVec3, Stream, mix};

/// `count` nodes that are not `taken` and `fit`, no two nearer than `apart`, in random order; fewer where there are no
/// more. They are taken then. A larger count starts with the smaller one. Where nodes have owners, each owner has as
/// many as the others, and those without have none.
pub(super) fn choose(
    graph: &Scatter,
    taken: &mut [bool],
    count: u32,
    apart: f64,
    fits: impl Fn(DVec3) -> bool,
    stream: &Stream,
) -> Vec<Node> {
    let order: Vec<(u64, Node)> = (0..graph.len() as u32)
        .filter(|&i| !taken[i as usize])
        .map(|i| (mix(stream.key() ^ mix(u64::from(i))), Node(i)))
        .collect();
    let mut crowd = Crowd::new(apart);
    let owners = (0..graph.len() as u32).map(|i| graph.owner(Node(i))).max().unwrap_or(0);
    let quota = |owner: u8| {
        let (owner, owners) = (u32::from(owner), u32::from(owners));
        let share = |owners: std::num::NonZeroU32| count / owners + u32::from(owner <= count % owners);
        std::num::NonZeroU32::new(owners).map_or(count, share)
    };
    let mut given = vec![0_u32; usize::from(owners) + 1];
    in_random_order(order, count as usize, |node| {
        let (p, owner) = (graph.position(node), graph.owner(node));
        let is_open = (owners == 0 || owner > 0) && given[usize::from(owner)] < quota(owner);
        let is_taken = is_open && fits(p) && crowd.has_room(p);
        if is_taken {
            crowd.add(p);
            given[usize::from(owner)] += 1;
            taken[node.0 as usize] = true;
        }
        is_taken
    })
}

/// The first `count` of those that `take` takes, in the order of their random keys; as many as there are.
pub(super) fn in_random_order<T: Copy + Ord>(
    mut order: Vec<(u64, T)>,
    count: usize,
    mut take: impl FnMut(T) -> bool,
) -> Vec<T> {
    let mut chosen = Vec::new();
    let mut sorted = 0;
    while chosen.len() < count && sorted < order.len() {
        // Most choices are few among many: the rest need not be sorted.
        let next = (sorted + (count - chosen.len()).max(32) * 2).min(order.len());
        if next < order.len() {
            order[sorted..].select_nth_unstable(next - sorted);
        }
        order[sorted..next].sort_unstable();
        for &(_, item) in &order[sorted..next] {
            if chosen.len() < count && take(item) {
                chosen.push(item);
            }
        }
        sorted = next;
    }
    chosen
}
