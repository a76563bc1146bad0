//! The search against Dijkstra's algorithm with a binary heap, and the properties on which later stages rely.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use proptest::prelude::*;

use super::search::{Later, plan_on};
use super::*;
use crate::geom::Neighbours;
use crate::graph::{FieldValue, Graph, Lattice, Mask, Node, Window};
use crate::math::{DVec3, Progress, Stream, Weights};

fn joined(count: u32) -> Neighbours {
    Neighbours::try_from(count).unwrap()
}

type Field = ([bool; 3], fn(DVec3) -> FieldValue);

fn lattice(neighbours: Neighbours, size: [u32; 3], seed: u64, alpha: f64, field: bool, holes: bool) -> Lattice {
    let window = Window {
        spacing: 1.0,
        origin: [-3, 5, -7],
        size: if neighbours.is_plane() { [size[0], size[1], 1] } else { size },
    };
    let field: Option<Field> =
        field.then_some(([true, false, true], |p| FieldValue { sum: p.x.abs() * 0.7, factor: 0.5 + p.z.abs() * 0.1 }));
    let mask = holes.then(|| {
        let words =
            (0..window.nodes().div_ceil(64)).map(|w| crate::math::mix(seed ^ w) & crate::math::mix(seed ^ !w) & !1);
        Mask::from_words(words.collect(), window.nodes() as usize)
    });
    Lattice::new(window, neighbours, &Stream::new(seed, "test"), Weights { max: 10.0, alpha }, field, mask).unwrap()
}

/// Dijkstra's algorithm (1959) with a binary heap; it shares only the graph with the search.
fn dijkstra<G: Graph>(graph: &G, generators: &[Node]) -> HashMap<Node, u64> {
    let mut heap: BinaryHeap<_> = generators.iter().map(|&g| Reverse((0_u64, g))).collect();
    let mut costs = HashMap::new();
    while let Some(Reverse((cost, node))) = heap.pop() {
        if costs.contains_key(&node) {
            continue;
        }
        costs.insert(node, cost);
        graph.edges(node, |edge| {
            if !costs.contains_key(&edge.node) {
                heap.push(Reverse((cost + u64::from(edge.weight), edge.node)));
            }
        });
    }
    costs
}

fn check(neighbours: Neighbours, size: [u32; 3], seed: u64, alpha: f64, field: bool, holes: bool) {
    let lattice = lattice(neighbours, size, seed, alpha, field, holes);
    let nodes: Vec<Node> = lattice.nodes().collect();
    let generators = [nodes[0], nodes[nodes.len() / 2]];
    let all = plan(&lattice, &generators, Goal::Everything, &Progress::default()).unwrap();
    let expected = dijkstra(&lattice, &generators);
    let costs = all.costs(nodes.iter().copied());
    let labels = all.labels(nodes.iter().copied());
    for &node in &nodes {
        assert_eq!(all.cost(node), expected.get(&node).copied());
        assert_eq!(costs[lattice.cell(node)], expected.get(&node).copied());
        let end = all.is_reached(node).then(|| all.path(node).last()).flatten();
        assert_eq!(labels[lattice.cell(node)], end);
        assert!(end.is_none_or(|end| generators.contains(&end)));
    }
    assert_eq!(all.settled(), expected.len());

    // The parallel search gives the same cells.
    let shared = plan_on(&lattice, &generators, Later::NONE, Goal::Everything, 2, &Progress::default()).unwrap();
    assert_eq!(shared.settled(), all.settled());
    for &node in &nodes {
        assert_eq!(shared.predecessor(node), all.predecessor(node));
    }

    // An early end changes no path.
    let wanted = [nodes[nodes.len() / 3], nodes[nodes.len() - 1]];
    let early = plan(&lattice, &generators, Goal::Nodes(&wanted), &Progress::default()).unwrap();
    for node in wanted {
        assert!(early.path(node).eq(all.path(node)));
    }
    assert!(early.settled() <= all.settled());

    // Both directions of an edge have the same weight, and the reverse edge leads back.
    for &node in nodes.iter().take(40) {
        lattice.edges(node, |edge| {
            assert_eq!(lattice.follow(edge.node, edge.back), (node, edge.weight));
            let range = lattice.weight_range();
            assert!((range.least..=range.most).contains(&edge.weight));
        });
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn costs_are_least(
        x in 1..14_u32, y in 1..14_u32, z in 1..14_u32, seed: u64, alpha in 0.0..4.0, field: bool, holes: bool
    ) {
        let size = [x, y, z];
        for count in [4, 8, 6, 18, 26] {
            check(joined(count), size, seed, alpha, field, holes);
        }
    }
}

/// Costs past what a cell holds wrap around: 2^27 for 26 neighbours, 32768 units with 12 fractional bits.
#[test]
fn costs_may_exceed_a_cell() {
    let window = Window { spacing: 1.0, origin: [0; 3], size: [3000, 2, 2] };
    let costly: Option<Field> = Some(([true, false, false], |_| FieldValue { sum: 60.0, factor: 1.0 }));
    let lattice =
        Lattice::new(window, joined(26), &Stream::new(1, "long"), Weights { max: 10.0, alpha: 1.0 }, costly, None)
            .unwrap();
    let (root, end) = (lattice.node([0, 0, 0]), lattice.node([2999, 1, 1]));
    let expected = dijkstra(&lattice, &[root]);
    assert!(expected[&end] > 1 << 29, "the test wants a wrap: {}", expected[&end]);
    for goal in [Goal::Everything, Goal::Nodes(&[end, lattice.node([1, 1, 0])])] {
        let plan = plan(&lattice, &[root], goal, &Progress::default()).unwrap();
        assert_eq!(plan.cost(end), Some(expected[&end]));
    }
}

/// Weights from one end of a line to the other, 1 to a million: nearly all buckets are empty, over more than one turn of costs.
#[test]
fn costs_may_lie_far_apart() {
    let window = Window { spacing: 1.0, origin: [0; 3], size: [600, 2, 1] };
    let steep: Option<Field> = Some(([true, false, false], |p| FieldValue { sum: p.x * p.x / 4.0, factor: 1.0 }));
    let lattice =
        Lattice::new(window, joined(4), &Stream::new(1, "steep"), Weights { max: 10.0, alpha: 1.0 }, steep, None)
            .unwrap();
    let (root, end) = (lattice.node([0, 0, 0]), lattice.node([599, 1, 0]));
    let expected = dijkstra(&lattice, &[root]);
    let most = expected.values().copied().max().unwrap();
    assert!(most >> (32 - lattice.slot_bits()) >= 2, "the test wants wraps: {most}");
    let later = [(lattice.node([1, 0, 0]), 1 << 20)];
    for goal in [Goal::Everything, Goal::Nodes(&[end, lattice.node([1, 1, 0])]), Goal::Within(most)] {
        let plain = plan(&lattice, &[root], goal, &Progress::default()).unwrap();
        assert_eq!(plain.cost(end), Some(expected[&end]));
        let delayed = plan_from(&lattice, &[&later[..], &[(root, 0)]].concat(), goal, &Progress::default()).unwrap();
        assert_eq!(delayed.cost(end), Some(expected[&end]));
    }
    // At more than half a wrap from it the first node would seem unsettled, were it still in the list.
    let halfway = 1 << (31 - lattice.slot_bits());
    let middle = (0..600).map(|x| lattice.node([x, 0, 0])).find(|node| expected[node] > halfway).unwrap();
    let wanted = [lattice.node([1, 1, 0]), middle];
    let early = plan(&lattice, &[root], Goal::Nodes(&wanted), &Progress::default()).unwrap();
    // A bucket is no wider than the least weight.
    let last = expected[&middle] + u64::from(lattice.weight_range().least);
    assert!(early.settled() <= expected.values().filter(|cost| **cost <= last).count());
    let half = plan(&lattice, &[root], Goal::Within(most / 2), &Progress::default()).unwrap();
    let known = |&(node, &cost): &(&Node, &u64)| cost <= most / 2 && half.cost(*node) != Some(cost);
    assert_eq!(expected.iter().find(known), None);
}

/// Windows onto one infinite lattice agree where they overlap.
#[test]
fn a_resize_keeps_weights() {
    let weights = Weights { max: 10.0, alpha: 2.0 };
    let make = |origin, size| -> Lattice {
        let window = Window { spacing: 0.5, origin, size };
        Lattice::new(window, joined(18), &Stream::new(7, "resize"), weights, None::<Field>, None).unwrap()
    };
    let (small, large) = (make([0; 3], [4; 3]), make([-5, -9, -2], [40, 30, 20]));
    for node in small.nodes() {
        let twin = large.nearest(small.position(node)).unwrap();
        let mut edges = Vec::new();
        small.edges(node, |edge| edges.push((small.position(edge.node).to_array().map(f64::to_bits), edge.weight)));
        let mut found = 0;
        large.edges(twin, |edge| {
            let key = (large.position(edge.node).to_array().map(f64::to_bits), edge.weight);
            found += usize::from(edges.contains(&key));
        });
        assert_eq!(found, edges.len());
    }
}

/// Weights of neighbouring edges are independent: chi-squared over pairs of quartiles.
#[test]
fn weights_are_independent() {
    let window = Window { spacing: 1.0, origin: [-100, -100, 0], size: [256, 256, 1] };
    let lattice =
        Lattice::new(window, joined(4), &Stream::new(3, "chi"), Weights { max: 5.0, alpha: 1.0 }, None::<Field>, None)
            .unwrap();
    let quartile = |weight: u32| ((weight - 4096) / 4096).min(3) as usize;
    for step in [[1, 0], [0, 1], [1, 1], [2, 1]] {
        let mut bins = [[0_u32; 4]; 4];
        let mut count = 0;
        for y in 1..250 {
            for x in 1..250 {
                let weights = [[x, y, 0], [x + step[0], y + step[1], 0]].map(|at| {
                    // The slot of the positive step along x.
                    lattice.follow(lattice.node(at), 0).1
                });
                bins[quartile(weights[0])][quartile(weights[1])] += 1;
                count += 1;
            }
        }
        let expected = f64::from(count) / 16.0;
        let chi2: f64 =
            bins.iter().flatten().map(|&b| (f64::from(b) - expected) * (f64::from(b) - expected) / expected).sum();
        assert!(chi2 < 45.0, "{step:?}: chi-squared {chi2} over 15 degrees of freedom");
    }
}

#[test]
fn too_wide_a_range_is_refused() {
    let window = Window { spacing: 1.0, origin: [0; 3], size: [9, 9, 1] };
    let lattice = |alpha| -> Result<Lattice, _> {
        Lattice::new(window, joined(4), &Stream::new(1, "wide"), Weights { max: 10.0, alpha }, None::<Field>, None)
    };
    assert!(lattice(1000.0).is_err());
    let steep = lattice(5.7).unwrap();
    assert!(plan(&steep, &[steep.node([0; 3])], Goal::Everything, &Progress::default()).is_ok());
}

/// `Plan::extend` gives the result of a search from all generators, and `Goal::Within` settles every node within its cost.
#[test]
fn searches_go_on_and_stop() {
    for (seed, holes, alpha) in [(1, false, 1.0), (2, true, 3.0), (3, true, 1.0)] {
        let lattice = lattice(Neighbours::EIGHT, [120, 90, 1], seed, alpha, false, holes);
        let nodes: Vec<Node> = lattice.nodes().collect();
        let mut generators = vec![nodes[nodes.len() / 3]];
        let mut grown = plan(&lattice, &generators, Goal::Everything, &Progress::default()).unwrap();
        for round in 0..3 {
            generators.extend(nodes.iter().skip(round * 7 + 5).step_by(977));
            grown.extend(&generators, &Progress::default()).unwrap();
            let whole = plan(&lattice, &generators, Goal::Everything, &Progress::default()).unwrap();
            for &node in &nodes {
                assert_eq!((grown.cost(node), grown.predecessor(node)), (whole.cost(node), whole.predecessor(node)));
            }
        }
        let most = 12 << lattice.weight_range().fraction;
        let near = plan(&lattice, &generators, Goal::Within(most), &Progress::default()).unwrap();
        assert!(near.settled() < grown.costs(nodes.iter().copied()).iter().flatten().count());
        for &node in nodes.iter().filter(|&&node| grown.cost(node).is_some_and(|cost| cost <= most)) {
            assert_eq!((near.cost(node), near.predecessor(node)), (grown.cost(node), grown.predecessor(node)));
        }
    }
}

/// A start that costs more than its least-cost path is no generator.
#[test]
fn costly_starts_give_way() {
    let lattice = lattice(Neighbours::EIGHT, [60, 50, 1], 4, 1.0, false, false);
    let nodes: Vec<Node> = lattice.nodes().collect();
    let starts: Vec<(Node, u64)> =
        nodes.iter().step_by(97).enumerate().map(|(i, &n)| (n, (i as u64 % 5) << 19)).collect();
    let found = plan_from(&lattice, &starts, Goal::Everything, &Progress::default()).unwrap();
    let own: HashMap<Node, u64> = starts.iter().copied().collect();
    let costs =
        found.carry(nodes.iter().copied(), u64::MAX, |node| own[&node], |cost, weight| cost + u64::from(weight));
    // From each start alone, the least of all.
    let mut expected: HashMap<Node, u64> = HashMap::new();
    for &(start, cost) in &starts {
        let costs = dijkstra(&lattice, &[start]);
        for &node in &nodes {
            let best = expected.entry(node).or_insert(u64::MAX);
            *best = (*best).min(cost + costs[&node]);
        }
    }
    assert!(nodes.iter().all(|&node| costs[lattice.cell(node)] == expected[&node]));
    assert!(starts.iter().any(|&(node, cost)| costs[lattice.cell(node)] < cost));
}
