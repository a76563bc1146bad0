//! Least-cost paths on a graph of one's own: a ring of towns with a costly shortcut. `cargo run --example own_graph`.

#![allow(clippy::print_stdout, reason = "what it prints is its result")]

use std::error::Error;

use lichtenberg::graph::{Edge, Graph, Node, WeightRange};
use lichtenberg::math::Progress;
use lichtenberg::plan::{Goal, plan};

/// Towns in a ring: slot 0 leads to the next one, slot 1 back; slot 2 is a ferry across.
struct Ring {
    towns: u32,
    road: u32,
    ferry: u32,
}

impl Graph for Ring {
    fn slot_bits(&self) -> u32 {
        2
    }
    fn cells(&self) -> usize {
        self.towns as usize
    }
    fn cell(&self, node: Node) -> usize {
        node.0 as usize
    }
    fn edges(&self, node: Node, mut visit: impl FnMut(Edge)) {
        for (slot, back) in [(0, 1), (1, 0), (2, 2)] {
            let (to, weight) = self.follow(node, slot);
            visit(Edge { node: to, cell: self.cell(to), back, weight });
        }
    }
    fn ahead(&self, _cell: usize, _visit: impl FnMut(usize)) {}
    fn follow(&self, node: Node, slot: u32) -> (Node, u32) {
        let by = [1, self.towns - 1, self.towns / 2][slot as usize];
        (Node((node.0 + by) % self.towns), if slot == 2 { self.ferry } else { self.road })
    }
    fn is_wide(&self) -> bool {
        false
    }
    fn slab(&self, _node: Node) -> u32 {
        0
    }
    fn is_inner(&self, _node: Node) -> bool {
        true
    }
    fn weight_range(&self) -> WeightRange {
        WeightRange { least: self.road.min(self.ferry), most: self.road.max(self.ferry), fraction: 0 }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let ring = Ring { towns: 100, road: 10, ferry: 150 };
    let plan = plan(&ring, &[Node(0)], Goal::Everything, &Progress::default())?;
    let way: Vec<u32> = plan.path(Node(40)).map(|node| node.0).collect();
    println!("{} towns, cost {}", way.len(), plan.cost(Node(40)).ok_or("no way")?);
    Ok(())
}
