//! Irregular graphs: Poisson-disc nodes in a shape, joined to their neighbours (Xu and Mould 2012, section 3.1).

use std::ops::Range;

use super::joined::Neighbourhood;
use super::poisson::{Cells, poisson};
use super::{CostField, FieldValue, Node, Region, Sectors, WeightTable};
use crate::math::{DVec3, Stream, mix};

/// Side of a cell of the neighbourhood, in spacings: two rings of such cells hold nearly every neighbour.
const CELL: f64 = 1.3;
/// Nodes for each cubic spacing of volume, about, where there is no room for another; and for each square one.
const DENSITY: [f64; 2] = [0.75, 0.8];
/// Bytes that a node takes at the peak of building its graph, cells and edges included.
const NODE_BYTES: u64 = 420;

/// More nodes than this, by their estimate, are refused: there are fewer cells than a u32 can count.
pub(super) const MOST_NODES: f64 = 1e8;

/// How scattered nodes are joined.
#[derive(Clone, Debug, PartialEq)]
pub enum Joining {
    /// Each to the nearest in every sector around it.
    Yao(Sectors),
    /// All that are no farther apart than this, in scene units.
    Radius(f64),
}

/// What a scattered graph is made of, its region apart.
#[derive(Clone, Copy)]
pub struct ScatterPlan<'a> {
    /// Least distance between nodes, in scene units.
    pub spacing: f64,
    /// Does it lie in the plane z = 0?
    pub is_plane: bool,
    /// Which nodes are joined.
    pub joining: &'a Joining,
    /// Places that are nodes, as far as they are not too near to each other.
    pub fixed: &'a [DVec3],
    /// The owner of a place, where nodes of two owners are not to be joined; 0 joins all.
    pub owner: Option<&'a (dyn Fn(DVec3) -> u8 + Sync)>,
}

/// A scattered graph. Its edges are stored, both ways; their weights are made apart ([`Scatter::weigh`]), so that many may
/// share the nodes.
#[derive(Clone, Debug, Default)]
pub struct Scatter {
    positions: Vec<DVec3>,
    owners: Vec<u8>,
    /// Where the edges of each node start.
    starts: Vec<u32>,
    /// Other ends.
    ends: Vec<Node>,
    spacing: f64,
}

/// A weight for each edge of a scattered graph, in the order of [`Scatter::edges`].
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

    /// Those of the edges in `range`.
    #[must_use]
    pub fn of(&self, range: Range<usize>) -> &[u32] {
        &self.weights[range]
    }
}

/// Why nodes cannot be scattered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScatterError {
    /// No node lies in the region.
    #[error("no node fits in the shape: is it empty, or all of it forbidden?")]
    Empty,
    /// Too many for their numbers.
    #[error("about {0:.1e} nodes are too many (1e8 at most): use a wider spacing or a smaller shape")]
    TooMany(f64),
    /// Too many or no clusters.
    #[error("`inside` holds {found} clusters that far apart, where 1 to {most} are possible: change `apart`")]
    Clusters {
        /// How many there would be.
        found: usize,
        /// How many there can be.
        most: usize,
    },
}

/// About how many nodes `spacing` apart the box with these corners holds.
#[must_use]
pub fn scatter_estimate(bounds: [DVec3; 2], spacing: f64, is_plane: bool) -> f64 {
    let extent = ((bounds[1] - bounds[0]) / spacing).max(DVec3::splat(-1.0)) + 1.0;
    if is_plane { extent.x * extent.y * DENSITY[1] } else { extent.x * extent.y * extent.z * DENSITY[0] }
}

/// Bytes that scattering so many nodes takes at its peak.
#[must_use]
pub fn scatter_bytes(nodes: f64) -> u64 {
    (nodes as u64).saturating_mul(NODE_BYTES)
}

impl Scatter {
    /// Scatters nodes in `region`, at random by `stream`, and joins them.
    ///
    /// # Errors
    /// [`ScatterError::Empty`], [`ScatterError::TooMany`].
    pub fn new(plan: &ScatterPlan<'_>, region: &dyn Region, stream: &Stream) -> Result<Self, ScatterError> {
        let bounds = region.bounds();
        let estimate = scatter_estimate(bounds, plan.spacing, plan.is_plane);
        if estimate.is_nan() || estimate > MOST_NODES {
            return Err(ScatterError::TooMany(estimate));
        }
        let cells = Cells::new(bounds, plan.spacing, plan.is_plane);
        let positions = poisson(region, &cells, plan.spacing, plan.fixed, stream);
        if positions.is_empty() {
            return Err(ScatterError::Empty);
        }
        let owners: Vec<u8> = plan.owner.map_or_else(Vec::new, |owner| positions.iter().map(|&p| owner(p)).collect());
        let owned = (!owners.is_empty()).then_some(&owners[..]);
        let (starts, ends) = match plan.joining {
            Joining::Yao(sectors) => {
                let near = Neighbourhood::new(&positions, owned, plan.spacing * CELL).yao(sectors);
                both_ways(positions.len(), |i| {
                    near[i * sectors.count()..(i + 1) * sectors.count()].iter().copied().filter(|&j| j != u32::MAX)
                })
            }
            Joining::Radius(reach) => {
                let near = Neighbourhood::new(&positions, owned, *reach).within(*reach);
                both_ways(positions.len(), |i| near[i].iter().copied())
            }
        };
        Ok(Self { positions, owners, starts, ends, spacing: plan.spacing })
    }

    /// Weights for its edges: `R^alpha` by `table` times the length in spacings, R from `stream`, with `fields` at the places
    /// where `put` puts the nodes.
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

    /// How many nodes there are; they are called from 0 on.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Has it no nodes?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Where `node` is, in scene units.
    #[must_use]
    pub fn position(&self, node: Node) -> DVec3 {
        self.positions[node.0 as usize]
    }

    /// Where all nodes are.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The owner of `node`; 0 where there are none.
    #[must_use]
    pub fn owner(&self, node: Node) -> u8 {
        self.owners.get(node.0 as usize).copied().unwrap_or(0)
    }

    /// How many edges there are, each counted once.
    #[must_use]
    pub fn count_edges(&self) -> u64 {
        self.ends.len() as u64 / 2
    }

    /// Which edges are those of `node`.
    #[must_use]
    pub fn edges(&self, node: Node) -> Range<usize> {
        self.starts[node.0 as usize] as usize..self.starts[node.0 as usize + 1] as usize
    }

    /// The other ends of the edges in `range`.
    #[must_use]
    pub fn ends(&self, range: Range<usize>) -> &[Node] {
        &self.ends[range]
    }

    /// The nodes nearest to `points`; of several the first.
    #[must_use]
    pub fn nearest(&self, points: &[DVec3]) -> Vec<Node> {
        let near = Neighbourhood::new(&self.positions, None, self.spacing * CELL);
        points.iter().filter_map(|&p| near.nearest_to(p).map(Node)).collect()
    }
}

/// The edges of `count` nodes both ways, once each, from those that `near` lists in at least one direction: where each
/// node's start, and their other ends.
fn both_ways<I: Iterator<Item = u32>>(count: usize, near: impl Fn(usize) -> I) -> (Vec<u32>, Vec<Node>) {
    let is_back = |i: usize, j: u32| near(j as usize).any(|k| k as usize == i);
    // An edge that both ends list is told by the lower one.
    let listed = |i: usize| {
        let is_told = move |j: &u32| (i as u32) < *j || !is_back(i, *j);
        near(i).filter(is_told)
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
        let plan = ScatterPlan { spacing, is_plane, joining, fixed: &fixed, owner: None };
        Scatter::new(&plan, &Ball(1.0), &Stream::new(seed, "scatter")).unwrap()
    }

    /// No two nodes nearer than the spacing, and no room for another: held to a hundred thousand random places, which
    /// know nothing of cells.
    #[test]
    fn nodes_are_apart_and_leave_no_room() {
        for (is_plane, spacing) in [(false, 0.13), (true, 0.03), (false, 0.9), (true, 2.5)] {
            for seed in 0..3 {
                let graph = scatter(spacing, is_plane, &Joining::Yao(Sectors::new(6, is_plane).unwrap()), seed);
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
        let make = || scatter(0.04, false, &Joining::Yao(Sectors::Orthants), 5);
        let (one, two) = (pool(1).install(make), pool(2).install(make));
        assert_eq!(one.positions, two.positions);
        assert_eq!(one.ends, two.ends);
        // Cells of several blocks, and about six edges a node (2012, section 4).
        assert!(one.len() > 30_000, "{}", one.len());
        let each = one.count_edges() as f64 / one.len() as f64;
        assert!((5.0..7.0).contains(&each), "{each}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        /// Edges are those that brute force finds, whatever the shape: clumps far apart, owners, ties.
        #[test]
        fn yao_edges_equal_brute_force(
            points in prop::collection::vec(prop::array::uniform3(-9..9_i32), 2..400), far in prop::bool::ANY,
            which in 0..5_usize, owned in prop::bool::ANY
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
            let found = Neighbourhood::new(&nodes, Some(&owners), 1.7).yao(&sectors);
            for i in 0..nodes.len() {
                for sector in 0..sectors.count() {
                    let expected = (0..nodes.len())
                        .filter(|&j| joins(i, j) && sectors.of(nodes[j] - nodes[i]) == sector)
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
