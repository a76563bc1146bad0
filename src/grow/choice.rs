//! Which nodes of a scattered graph are endpoints.

use super::endpoints::Crowd;
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
    let mut order: Vec<(u64, u32)> = (0..graph.len() as u32)
        .filter(|&i| !taken[i as usize])
        .map(|i| (mix(stream.key() ^ mix(u64::from(i))), i))
        .collect();
    // Most choices are few among many: the rest need not be sorted.
    let mut sorted = 0;
    let mut crowd = Crowd::new(apart);
    let owners = (0..graph.len() as u32).map(|i| graph.owner(Node(i))).max().unwrap_or(0);
    let quota = |owner: u8| {
        let (owner, owners) = (u32::from(owner), u32::from(owners));
        let share = |owners: std::num::NonZeroU32| count / owners + u32::from(owner <= count % owners);
        std::num::NonZeroU32::new(owners).map_or(count, share)
    };
    let mut given = vec![0_u32; usize::from(owners) + 1];
    let mut chosen = Vec::new();
    while chosen.len() < count as usize && sorted < order.len() {
        let next = (sorted.max(16) * 4).min(order.len());
        if next < order.len() {
            order[sorted..].select_nth_unstable(next - sorted);
        }
        order[sorted..next].sort_unstable();
        for &(_, i) in &order[sorted..next] {
            let p = graph.position(Node(i));
            let owner = graph.owner(Node(i));
            let is_open = (owners == 0 || owner > 0) && given[usize::from(owner)] < quota(owner);
            if chosen.len() < count as usize && is_open && fits(p) && crowd.has_room(p) {
                crowd.add(p);
                given[usize::from(owner)] += 1;
                taken[i as usize] = true;
                chosen.push(Node(i));
            }
        }
        sorted = next;
    }
    chosen
}
