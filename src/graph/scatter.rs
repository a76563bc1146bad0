//! Irregular graphs: Poisson-disc nodes in a shape, joined to their neighbours (Xu and Mould 2012, section 3.1).

use std::ops::Range;

use rand::RngExt;

use super::poisson::{CellGrid, poisson};
use super::scatter_size::{MOST_NODES, spacing_of_kept};
use super::triangular::{REACH, triangular};
use super::yao::NodeGrid;
use super::{CostField, FieldValue, Node, Region, ScatterError, Sectors, WeightTable, scatter_estimate};
use crate::math::{DVec3, Stream, mix};

/// Side of a grid cell, in spacings: two rings of cells contain nearly every Yao neighbour.
const CELL: f64 = 1.3;
/// The stream of what is kept.
const KEPT: u64 = u64::MAX;
/// Which scattered nodes are joined by edges.
#[derive(Clone, Debug, PartialEq)]
pub enum Joining {
    /// The Yao graph: each node with the nearest in every sector around it.
    Yao {
        /// The sectors.
        sectors: Sectors,
        /// The nearest is joined if it is no farther than this, in spacings: infinite in the paper (2012, section 3.1), where edges
        /// bridge what the volume leaves out.
        longest: f64,
    },
    /// The geometric graph: all pairs within this distance, in scene units.
    Radius(f64),
    /// Nodes of a triangular lattice, each with its six neighbours.
    Triangular,
}

/// The parameters of a scattered graph but for its region.
#[derive(Clone, Copy)]
pub struct ScatterPlan<'a> {
    /// Least distance between nodes, in scene units.
    pub spacing: f64,
    /// The share of the nodes that are kept, at random: below 1 they fill the space as unevenly as so many darts do.
    pub keep: f64,
    /// Does it lie in the plane z = 0?
    pub is_plane: bool,
    /// Which nodes are joined.
    pub joining: &'a Joining,
    /// Positions of nodes to be included, but for those nearer than the spacing to an earlier one.
    pub fixed: &'a [DVec3],
    /// The owner of a position: nodes of two different owners are not joined, unless one is 0.
    pub owner: Option<&'a (dyn Fn(DVec3) -> u8 + Sync)>,
}

/// A scattered graph, as adjacency lists of directed edges. Weights are separate ([`Scatter::weigh`]), so that many sets of
/// weights can share the nodes.
#[derive(Clone, Debug, Default)]
pub struct Scatter {
    positions: Vec<DVec3>,
    owners: Vec<u8>,
    /// The index of each node's first edge.
    starts: Vec<u32>,
    /// The other end of each edge.
    ends: Vec<Node>,
    spacing: f64,
    /// How far apart they are on average.
    apart: f64,
}

/// The weight of each edge of a scattered graph, in the order of [`Scatter::edges`].
#[derive(Clone, Debug, Default)]
pub struct EdgeWeights {
    weights: Vec<u32>,
    fraction: u32,
}

impl EdgeWeights {
    /// The real number that the fixed-point `cost` stands for: `R^alpha` times the length in spacings.
    #[must_use]
    pub fn real(&self, cost: u64) -> f64 {
        cost as f64 / f64::from(1_u32 << self.fraction)
    }

    /// The weights of the edges in `range`.
    #[must_use]
    pub fn of(&self, range: Range<usize>) -> &[u32] {
        &self.weights[range]
    }
}

/// The edges between all nodes no farther apart than `reach`, from both ends.
fn within(positions: &[DVec3], owned: Option<&[u8]>, reach: f64) -> (Vec<u32>, Vec<Node>) {
    let near = NodeGrid::new(positions, owned, reach).within(reach);
    both_ways(positions.len(), |i| near[i].iter().copied())
}

impl Joining {
    /// About how many edges a node has, of a graph of so many nodes `spacing` apart.
    #[must_use]
    pub fn degree(&self, nodes: f64, spacing: f64, is_plane: bool) -> f64 {
        match self {
            Self::Yao { .. } => 12.0,
            Self::Radius(reach) => {
                let wide = reach / spacing;
                let near = if is_plane { 2.6 * wide * wide } else { 3.2 * wide * wide * wide };
                near.min(nodes)
            }
            Self::Triangular => 6.0,
        }
    }
}

impl Scatter {
    /// A Poisson-disc sample of `region` with random numbers from `stream`, and its edges.
    ///
    /// # Errors
    /// [`ScatterError::Empty`], [`ScatterError::TooMany`].
    pub fn new(plan: &ScatterPlan<'_>, region: &dyn Region, stream: &Stream) -> Result<Self, ScatterError> {
        let bounds = region.bounds();
        let estimate = scatter_estimate(bounds, plan.spacing, plan.is_plane);
        if estimate.is_nan() || estimate > MOST_NODES {
            return Err(ScatterError::TooMany(estimate));
        }
        let positions = if *plan.joining == Joining::Triangular {
            triangular(region, plan.spacing, plan.fixed)
        } else {
            let cells = CellGrid::new(bounds, plan.spacing, plan.is_plane);
            let mut nodes = poisson(region, &cells, plan.spacing, plan.fixed, stream);
            if plan.keep < 1.0 {
                let mut kept = stream.nth(KEPT);
                let mut fixed = plan.fixed.len();
                nodes.retain(|_| {
                    let is_fixed = fixed > 0;
                    fixed = fixed.saturating_sub(1);
                    is_fixed || kept.random::<f64>() < plan.keep
                });
            }
            nodes
        };
        if positions.is_empty() {
            return Err(ScatterError::Empty);
        }
        let apart = spacing_of_kept(plan.spacing, plan.keep, plan.is_plane);
        let owners: Vec<u8> = plan.owner.map_or_else(Vec::new, |owner| positions.iter().map(|&p| owner(p)).collect());
        let owned = (!owners.is_empty()).then_some(&owners[..]);
        let (starts, ends) = match plan.joining {
            Joining::Yao { sectors, longest } => {
                let near = NodeGrid::new(&positions, owned, apart * CELL).yao(sectors, longest * plan.spacing);
                both_ways(positions.len(), |i| {
                    near[i * sectors.count()..(i + 1) * sectors.count()].iter().copied().filter(|&j| j != u32::MAX)
                })
            }
            Joining::Radius(reach) => within(&positions, owned, *reach),
            Joining::Triangular => within(&positions, owned, plan.spacing * REACH),
        };
        Ok(Self { positions, owners, starts, ends, spacing: plan.spacing, apart })
    }

    /// Weights of its edges: `R^alpha` by `table` times the length in spacings, R from `stream`, with `fields` evaluated at
    /// the positions transformed by `put`.
    #[must_use]
    pub fn weigh(
        &self,
        table: &WeightTable,
        fields: &[CostField],
        put: impl Fn(DVec3) -> DVec3,
        stream: &Stream,
    ) -> EdgeWeights {
        let fraction = table.fraction();
        let one = f64::from(1_u32 << fraction);
        let values: Vec<FieldValue> = if fields.is_empty() {
            Vec::new()
        } else {
            self.positions.iter().map(|&p| CostField::combine(fields, put(p))).collect()
        };
        let per_spacing = 1.0 / self.spacing;
        let mut weights = Vec::with_capacity(self.ends.len());
        for i in 0..self.positions.len() as u32 {
            let a = self.positions[i as usize];
            for &Node(j) in &self.ends[self.edges(Node(i))] {
                let length = a.distance(self.positions[j as usize]) * per_spacing;
                let name = u64::from(i.min(j)) | u64::from(i.max(j)) << 32;
                let mut weight = f64::from(table.entry(0, mix(stream.key() ^ mix(name))));
                if let (Some(a), Some(b)) = (values.get(i as usize), values.get(j as usize)) {
                    weight = weight * (a.factor + b.factor) * 0.5 + (a.sum + b.sum) * 0.5 * one;
                }
                weights.push((weight * length + 0.5).clamp(1.0, 4e9) as u32);
            }
        }
        EdgeWeights { weights, fraction }
    }

    /// The number of nodes, which are numbered from 0.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.owners[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.ends[..])
    }

    /// Has it no nodes?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The position of `node`, in scene units.
    #[must_use]
    pub fn position(&self, node: Node) -> DVec3 {
        self.positions[node.0 as usize]
    }

    /// The positions of all nodes.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The owner of `node`; 0 without owners.
    #[must_use]
    pub fn owner(&self, node: Node) -> u8 {
        self.owners.get(node.0 as usize).copied().unwrap_or(0)
    }

    /// The number of undirected edges.
    #[must_use]
    pub fn count_edges(&self) -> u64 {
        self.ends.len() as u64 / 2
    }

    /// The indices of the edges of `node`.
    #[must_use]
    pub fn edges(&self, node: Node) -> Range<usize> {
        self.starts[node.0 as usize] as usize..self.starts[node.0 as usize + 1] as usize
    }

    /// The other ends of the edges in `range`.
    #[must_use]
    pub fn ends(&self, range: Range<usize>) -> &[Node] {
        &self.ends[range]
    }

    /// The node nearest to each of `points`; of equally near ones the first.
    #[must_use]
    pub fn nearest(&self, points: &[DVec3]) -> Vec<Node> {
        let near = NodeGrid::new(&self.positions, None, self.apart * CELL);
        points.iter().filter_map(|&p| near.nearest_to(p).map(Node)).collect()
    }
}

/// The symmetric closure of the directed edges `near` of `count` nodes, as adjacency lists: the index of each node's first
/// edge, and the other ends.
fn both_ways<I: Iterator<Item = u32>>(count: usize, near: impl Fn(usize) -> I) -> (Vec<u32>, Vec<Node>) {
    let is_back = |i: usize, j: u32| near(j as usize).any(|k| k as usize == i);
    // An edge that both ends list counts for the lower one.
    let listed = |i: usize| {
        let is_first = move |j: &u32| (i as u32) < *j || !is_back(i, *j);
        near(i).filter(is_first)
    };
    let mut starts = vec![0_u32; count + 1];
    for i in 0..count {
        for j in listed(i) {
            starts[i + 1] += 1;
            starts[j as usize + 1] += 1;
        }
    }
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut others = vec![Node(0); starts[count] as usize];
    let mut next = starts.clone();
    let mut put = |i: usize, j: u32| {
        others[next[i] as usize] = Node(j);
        next[i] += 1;
    };
    for i in 0..count {
        for j in listed(i) {
            put(i, j);
            put(j as usize, i as u32);
        }
    }
    (starts, others)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::RngExt;

    use super::*;

    /// A ball with a slit, off the origin.
    pub struct Ball(f64);

    impl Region for Ball {
        fn margin(&self, p: DVec3) -> f64 {
            let p = p - DVec3::new(0.3, -0.2, 0.1);
            (p.length() - self.0).max(0.1 - p.y.abs().max(p.x + 0.5))
        }

        fn bounds(&self) -> [DVec3; 2] {
            let middle = DVec3::new(0.3, -0.2, 0.1);
            [middle - self.0, middle + self.0]
        }
    }

    fn scatter(spacing: f64, is_plane: bool, joining: &Joining, seed: u64) -> Scatter {
        let fixed = [DVec3::new(0.3, 0.4, 0.0), DVec3::new(0.3, 0.4 + spacing * 0.5, 0.0)];
        let plan = ScatterPlan { spacing, keep: 1.0, is_plane, joining, fixed: &fixed, owner: None };
        Scatter::new(&plan, &Ball(1.0), &Stream::new(seed, "scatter")).unwrap()
    }

    fn yao(sectors: Sectors) -> Joining {
        Joining::Yao { sectors, longest: f64::INFINITY }
    }

    /// The sample is a maximal Poisson-disc sample: against random probes, which are independent of cells.
    #[test]
    fn nodes_are_apart_and_leave_no_room() {
        for (is_plane, spacing) in [(false, 0.13), (true, 0.03), (false, 0.9), (true, 2.5)] {
            for seed in 0..3 {
                let graph = scatter(spacing, is_plane, &yao(Sectors::new(6, is_plane).unwrap()), seed);
                let nodes = graph.positions();
                assert!((nodes[0].y - 0.4).abs() < 1e-12 && nodes.iter().all(|p| Ball(1.0).margin(*p) <= 0.0));
                for (i, p) in nodes.iter().enumerate() {
                    assert!(nodes[..i].iter().all(|q| q.distance(*p) >= spacing));
                }
                let mut random = Stream::new(seed, "probe");
                let mut probes = 0;
                while probes < 30_000 {
                    let p = DVec3::new(random.random(), random.random(), random.random()) * 2.0 - 1.0;
                    let p = p + DVec3::new(0.3, -0.2, 0.1);
                    let p = if is_plane { p.with_z(0.0) } else { p };
                    if Ball(1.0).margin(p) <= 0.0 {
                        probes += 1;
                        assert!(nodes.iter().any(|q| q.distance(p) < spacing), "there is room at {p}");
                    }
                }
            }
        }
    }

    #[test]
    fn threads_make_no_difference() {
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let make = || scatter(0.06, false, &yao(Sectors::Orthants), 5);
        let (one, two) = (pool(1).install(make), pool(2).install(make));
        assert_eq!(one.positions, two.positions);
        assert_eq!(one.ends, two.ends);
        // Cells of several blocks, and about six edges a node (2012, section 4).
        assert!(one.len() > 8_000, "{}", one.len());
        let each = one.count_edges() as f64 / one.len() as f64;
        assert!((5.0..7.0).contains(&each), "{each}");
    }

    proptest! {
        /// Against brute force, with distant clusters, owners and ties.
        #[test]
        fn yao_edges_equal_brute_force(
            points in prop::collection::vec(prop::array::uniform3(-9..9_i32), 2..400), far in prop::bool::ANY,
            which in 0..5_usize, owned in prop::bool::ANY, longest in prop::sample::select(vec![f64::INFINITY, 3.0])
        ) {
            let (sectors, is_plane) = [(3, true), (6, true), (6, false), (8, false), (24, false)][which];
            let sectors = Sectors::new(sectors, is_plane).unwrap();
            let mut nodes: Vec<DVec3> = points.iter().map(|p| {
                let clump = if far && p[0] > 3 { 40.0 } else { 0.0 };
                let p = DVec3::from_array(p.map(f64::from)) + clump;
                if is_plane { p.with_z(0.0) } else { p }
            }).collect();
            nodes.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
            nodes.dedup();
            let owners: Vec<u8> = (0..nodes.len()).map(|i| if owned { (i % 3) as u8 } else { 0 }).collect();
            let joins = |i: usize, j: usize| i != j && (owners[i] == owners[j] || owners[i] * owners[j] == 0);
            let found = NodeGrid::new(&nodes, Some(&owners), 1.7).yao(&sectors, longest);
            for i in 0..nodes.len() {
                for sector in 0..sectors.count() {
                    let expected = (0..nodes.len())
                        .filter(|&j| joins(i, j) && sectors.of(nodes[j] - nodes[i]) == sector)
                        .filter(|&j| nodes[j].distance(nodes[i]) <= longest)
                        .min_by(|&a, &b| {
                            nodes[a].distance_squared(nodes[i]).total_cmp(&nodes[b].distance_squared(nodes[i]))
                        });
                    let found = found[i * sectors.count() + sector];
                    prop_assert_eq!((found != u32::MAX).then_some(found as usize), expected);
                }
            }
        }
    }

    #[test]
    fn within_a_radius_all_are_joined() {
        let graph = scatter(0.2, false, &Joining::Radius(0.36), 1);
        let reach = 0.36;
        let nodes = graph.positions();
        for i in 0..graph.len() as u32 {
            let mut joined: Vec<u32> = graph.ends(graph.edges(Node(i))).iter().map(|j| j.0).collect();
            joined.sort_unstable();
            let expected: Vec<u32> = (0..graph.len() as u32)
                .filter(|&j| i != j && nodes[i as usize].distance(nodes[j as usize]) <= reach)
                .collect();
            assert_eq!(joined, expected);
        }
    }
}
