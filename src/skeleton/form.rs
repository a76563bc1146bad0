//! The form of natural limbs: merged where they run side by side, smoothed, with collars at forks and a flare at the root.

use schemars::JsonSchema;
use serde::Deserialize;

use super::plant::{Plant, PlantNode};
use super::{SkeletonNode, Width};
use crate::math::DVec3;

/// The form of natural limbs.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FormSpec {
    /// Standard deviation, in nodes, of the smoothing along limbs; 0 keeps the kinks of the graph.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub smoothness: f64,
    /// Distance below which limbs that run side by side are merged, as a share of the sum of their radii; 0 merges none.
    #[schemars(range(min = 0.0, max = 4.0))]
    pub merge: f64,
    /// The branch collar: how much thicker a limb is at its fork, as a share of its radius.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub collar: f64,
    /// The root flare: the factor of the radius at the foot.
    #[schemars(range(min = 1.0, max = 5.0))]
    pub flare: f64,
}

impl Default for FormSpec {
    fn default() -> Self {
        Self { smoothness: 1.5, merge: 1.35, collar: 0.35, flare: 1.5 }
    }
}

/// The form of natural limbs.
pub type Form = FormSpec;

/// Standard deviation of the smoothing kernel, in radii of the limb, where that exceeds the smoothness.
const THICK: f64 = 1.3;
/// Upper bound of that standard deviation, in nodes.
const MOST_SPREAD: f64 = 5.0;
/// Length of a collar beyond the surface of the parent limb, in radii of the limb.
const COLLAR_REACH: f64 = 3.0;
/// Length of the flare, in radii of the root.
const FLARE_REACH: f64 = 3.5;

impl Plant {
    /// Gives limbs their form; `width` is that of the part where the plant starts.
    pub fn shape(&mut self, form: &Form, width: &Width) {
        if form.merge > 0.0 {
            self.merge(form.merge);
            self.thicken(width);
        }
        self.limit_radii();
        self.part_limbs();
        self.smooth(form.smoothness);
        self.swell(form);
        self.resample();
    }

    /// Limits each radius to the parent's, which merging may have violated.
    fn limit_radii(&mut self) {
        for i in 0..self.nodes.len() {
            if let Some(parent) = self.nodes[i].node.parent {
                let most = self.nodes[parent as usize].node.radius;
                let radius = &mut self.nodes[i].node.radius;
                if *radius > most {
                    *radius = most;
                }
            }
        }
    }

    /// Gives every side limb a first node of its own at the fork with its own radius, so that the frustum to its next node
    /// starts inside the parent limb instead of with the parent's radius.
    fn part_limbs(&mut self) {
        let main = self.main_children();
        let mut nodes: Vec<PlantNode> = Vec::with_capacity(self.nodes.len());
        let mut renamed: Vec<u32> = Vec::with_capacity(self.nodes.len());
        for (i, own) in self.nodes.iter().enumerate() {
            let mut own = *own;
            if let Some(p) = own.node.parent {
                let fork = self.nodes[p as usize].node;
                let mut parent = renamed[p as usize];
                if main[p as usize] != Some(i as u32) {
                    let start =
                        SkeletonNode { position: fork.position, parent: Some(parent), cost: fork.cost, ..own.node };
                    parent = nodes.len() as u32;
                    nodes.push(PlantNode { node: start, part: own.part, reach: own.reach + self.step(i) });
                }
                own.node.parent = Some(parent);
            }
            renamed.push(nodes.len() as u32);
            nodes.push(own);
        }
        self.nodes = nodes;
        for end in &mut self.ends {
            end.path.end = renamed[end.path.end as usize];
            end.path.root = renamed[end.path.root as usize];
        }
    }

    /// Is node `i` the first node of a side limb?
    pub(super) fn is_start(&self, i: usize) -> bool {
        self.nodes[i].node.parent.is_some_and(|p| self.nodes[p as usize].node.position == self.nodes[i].node.position)
    }

    /// The next node of its limb for each node.
    pub(super) fn next_along(&self) -> Vec<Option<u32>> {
        let mut next = vec![None; self.nodes.len()];
        for i in 0..self.nodes.len() {
            if let Some(p) = self.nodes[i].node.parent
                && !self.is_start(i)
            {
                next[p as usize] = Some(i as u32);
            }
        }
        next
    }

    /// Smooths positions along limbs with a standard deviation of `nodes` nodes, or more in proportion to the radius: a limb
    /// does not wind within its own thickness. First nodes of side limbs stay on their fork. The kernel is `[1 2 1] / 4`, with
    /// a variance of half a step.
    fn smooth(&mut self, nodes: f64) {
        if nodes <= 0.0 {
            return;
        }
        let starts: Vec<bool> = (0..self.nodes.len()).map(|i| self.is_start(i)).collect();
        let next = self.next_along();
        let passes: Vec<u32> = (0..self.nodes.len())
            .map(|i| {
                let thick = self.nodes[i].node.radius * THICK / self.step(i).max(f64::MIN_POSITIVE);
                let spread = nodes.max(thick.min(MOST_SPREAD));
                libm::round(2.0 * spread * spread) as u32
            })
            .collect();
        let mut before: Vec<DVec3> = self.nodes.iter().map(|n| n.node.position).collect();
        for pass in 0..passes.iter().copied().max().unwrap_or(0) {
            for i in 0..self.nodes.len() {
                let Some(p) = self.nodes[i].node.parent else { continue };
                if starts[i] {
                    self.nodes[i].node.position = self.nodes[p as usize].node.position;
                } else if let Some(n) = next[i].filter(|_| pass < passes[i]) {
                    self.nodes[i].node.position = (before[p as usize] + before[i] * 2.0 + before[n as usize]) * 0.25;
                }
            }
            before.iter_mut().zip(&self.nodes).for_each(|(to, node)| *to = node.node.position);
        }
    }

    /// Adds collars and the flare of the root; radii still never increase towards the tip.
    fn swell(&mut self, form: &Form) {
        // For each node: the length along its limb, the radius at the limb's start, and the parent limb's radius there.
        let mut along: Vec<(f64, f64, f64)> = Vec::with_capacity(self.nodes.len());
        let fall = |x: f64| if x < 1.0 { (1.0 - x) * (1.0 - x) } else { 0.0 };
        // Its slope is 0 at the foot, so that the ball there does not bulge.
        let bell = |x: f64| fall(x * x);
        for i in 0..self.nodes.len() {
            let node = self.nodes[i].node;
            let here = match node.parent {
                None => (0.0, node.radius, 0.0),
                Some(p) if self.is_start(i) => {
                    let other = self.nodes[p as usize].node.radius;
                    (0.0, node.radius, other)
                }
                Some(p) => {
                    let (length, start, other) = along[p as usize];
                    (length + self.step(i), start, other)
                }
            };
            along.push(here);
        }
        // Which nodes are on a limb that starts at a root.
        let mut roots: Vec<bool> = Vec::with_capacity(self.nodes.len());
        for i in 0..self.nodes.len() {
            let is_root = self.nodes[i].node.parent.is_none_or(|p| roots[p as usize] && !self.is_start(i));
            roots.push(is_root);
        }
        for i in 0..self.nodes.len() {
            let (length, start, other) = along[i];
            let extra = if roots[i] {
                start * (form.flare - 1.0) * bell(length / (FLARE_REACH * start).max(f64::MIN_POSITIVE))
            } else {
                start * form.collar * fall(length / (other + COLLAR_REACH * start).max(f64::MIN_POSITIVE))
            };
            let parent = self.nodes[i].node.parent.map_or(f64::INFINITY, |p| self.nodes[p as usize].node.radius);
            let radius = self.nodes[i].node.radius + extra;
            self.nodes[i].node.radius = if radius < parent { radius } else { parent };
        }
    }
}
