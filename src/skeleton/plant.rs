//! Plants: the skeletons of several steps, one grown from another, as one forest. Widths that depend on whole paths from tips to
//! roots are computed here.

use std::collections::HashMap;

use super::{ByLength, Path, Pipe, Skeleton, SkeletonNode, Width};
use crate::math::{DVec3, power};

/// Default unit of widths by length, as a share of the longest path.
const UNIT: f64 = 1e-3;

/// What one step contributes to a plant.
#[derive(Clone, Debug)]
pub struct PlantPart<'a> {
    /// What it grew.
    pub skeleton: &'a Skeleton,
    /// Its width.
    pub width: &'a Width,
    /// The level of its first round.
    pub first_level: u16,
}

/// A forest made of parts. Parents precede children.
#[derive(Clone, Debug)]
pub struct Plant {
    pub(super) nodes: Vec<PlantNode>,
    /// The ends of all paths.
    pub(super) ends: Vec<PlantEnd>,
    pub(super) parts: usize,
}

/// A node of a plant.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlantNode {
    pub node: SkeletonNode,
    /// The part that it belongs to.
    pub part: u32,
    /// Length of the longest path from here to a tip.
    pub reach: f64,
}

/// The end of a path of a plant.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlantEnd {
    pub part: u32,
    /// The path, with nodes of the plant.
    pub path: Path,
    /// The exponent of widths traced from here.
    z: f64,
}

impl Plant {
    /// Bytes of a node while the plant takes its form: here, and in a copy that has it.
    pub const NODE_BYTES: u64 = 2 * size_of::<PlantNode>() as u64;

    /// Bytes of a node while parts become a plant and that one skeleton: in both.
    pub const WHOLE_BYTES: u64 = (size_of::<PlantNode>() + size_of::<SkeletonNode>()) as u64;

    /// Bytes of the plant, and of the skeletons that it is split into.
    #[must_use]
    pub fn bytes_to_split(&self) -> usize {
        self.nodes.capacity() * size_of::<PlantNode>()
            + self.nodes.len() * size_of::<SkeletonNode>()
            + self.ends.len() * (size_of::<PlantEnd>() + size_of::<Path>())
    }

    /// Joins the parts: a root of a later part that coincides with a node of an earlier one is that node.
    #[must_use]
    pub fn new(parts: &[PlantPart<'_>]) -> Self {
        let count = |of: fn(&Skeleton) -> usize| parts.iter().map(|part| of(part.skeleton)).sum();
        let mut plant = Self {
            nodes: Vec::with_capacity(count(|skeleton| skeleton.nodes.len())),
            ends: Vec::with_capacity(count(|skeleton| skeleton.paths.len())),
            parts: parts.len(),
        };
        let mut known: HashMap<[u64; 3], u32> = HashMap::new();
        for (index, part) in (0..).zip(parts) {
            let mut renamed: Vec<u32> = Vec::with_capacity(part.skeleton.nodes.len());
            let mut fresh = Vec::new();
            for node in &part.skeleton.nodes {
                let key = node.position.to_array().map(f64::to_bits);
                if let (None, Some(&at)) = (node.parent, known.get(&key)) {
                    renamed.push(at);
                    continue;
                }
                let at = plant.nodes.len() as u32;
                let parent = node.parent.map(|p| renamed[p as usize]);
                plant.nodes.push(PlantNode { node: SkeletonNode { parent, ..*node }, part: index, reach: 0.0 });
                renamed.push(at);
                // None grows from the last, which has most nodes.
                if index as usize + 1 < parts.len() {
                    fresh.push((key, at));
                }
            }
            for (key, at) in fresh {
                known.entry(key).or_insert(at);
            }
            for path in &part.skeleton.paths {
                let end = renamed[path.end as usize];
                let level = part.skeleton.nodes[path.end as usize].level;
                let z = match part.width {
                    Width::Length(ByLength { z, .. }) => z.at(u32::from(level.saturating_sub(part.first_level))),
                    Width::Pipe(_) | Width::Taper(_) | Width::Constant(_) => 1.0,
                };
                let path = Path { end, root: renamed[path.root as usize], ..*path };
                plant.ends.push(PlantEnd { part: index, path, z });
            }
        }
        plant
    }

    /// All of it as one skeleton, without classes.
    #[must_use]
    pub fn whole(self) -> Skeleton {
        Skeleton {
            nodes: self.nodes.into_iter().map(|own| own.node).collect(),
            paths: self.ends.into_iter().map(|end| Path { class: 0, ..end.path }).collect(),
            classes: Vec::new(),
        }
    }

    /// Length of the segment that ends at node `i`.
    pub(super) fn step(&self, i: usize) -> f64 {
        let node = &self.nodes[i].node;
        node.parent.map_or(0.0, |p| (node.position - self.nodes[p as usize].node.position).length())
    }

    /// Sets the radius of every node; `width` is that of the part where the plant starts.
    pub fn thicken(&mut self, width: &Width) {
        let lengths: Vec<f64> = (0..self.nodes.len()).map(|i| self.step(i)).collect();
        match width {
            Width::Length(length) => self.by_length(length, &lengths),
            Width::Pipe(pipe) => self.by_pipe(pipe, &lengths),
            Width::Taper(_) | Width::Constant(_) => {}
        }
    }

    /// The length of the longest path from each node to one of `ends`, if there is one.
    fn longest_paths(&self, ends: impl Iterator<Item = u32>, lengths: &[f64]) -> Vec<Option<f64>> {
        let mut longest: Vec<Option<f64>> = vec![None; self.nodes.len()];
        ends.for_each(|end| longest[end as usize] = Some(0.0));
        for i in (0..self.nodes.len()).rev() {
            if let (Some(length), Some(parent)) = (longest[i], self.nodes[i].node.parent) {
                let longer = length + lengths[i];
                let slot = &mut longest[parent as usize];
                *slot = Some(slot.map_or(longer, |old| if longer > old { longer } else { old }));
            }
        }
        longest
    }

    /// `s^z` (Xu and Mould 2012, section 3.2), the maximum over all traces, scaled to `root`; z is that of the level where the
    /// trace starts.
    fn by_length(&mut self, spec: &ByLength, lengths: &[f64]) {
        let root = spec.root.unwrap_or(1.0);
        let all = self.longest_paths(self.ends.iter().map(|end| end.path.end), lengths);
        let longest = all.iter().flatten().fold(f64::MIN_POSITIVE, |a, &b| f64::max(a, b));
        let unit = spec.unit.unwrap_or(longest * UNIT);
        for (node, length) in self.nodes.iter_mut().zip(&all) {
            node.reach = length.unwrap_or(0.0);
            node.node.radius = 0.0;
        }
        // One pass for each exponent.
        let mut exponents: Vec<f64> = self.ends.iter().map(|end| end.z).collect();
        exponents.sort_by(f64::total_cmp);
        exponents.dedup();
        for z in exponents {
            let ends = self.ends.iter().filter(|end| end.z == z).map(|end| end.path.end);
            let traces = self.longest_paths(ends, lengths);
            for (node, length) in self.nodes.iter_mut().zip(traces) {
                let Some(s) = length else { continue };
                let radius = power(s / unit, z);
                if radius > node.node.radius {
                    node.node.radius = radius;
                }
            }
        }
        let widest = self.nodes.iter().map(|n| n.node.radius).fold(f64::MIN_POSITIVE, f64::max);
        for node in &mut self.nodes {
            node.node.radius = f64::max(node.node.radius * (root / widest), spec.tip.unwrap_or(0.0));
        }
    }

    /// The pipe model: the cross-section of a limb is the sum of those of its children (Shinozaki et al. 1964), scaled to `root`.
    fn by_pipe(&mut self, spec: &Pipe, lengths: &[f64]) {
        let all = self.longest_paths(self.ends.iter().map(|end| end.path.end), lengths);
        let mut area = vec![0.0; self.nodes.len()];
        for i in (0..self.nodes.len()).rev() {
            if area[i] == 0.0 {
                area[i] = 1.0;
            }
            if let Some(parent) = self.nodes[i].node.parent {
                area[parent as usize] += area[i];
            }
        }
        let whole = area.iter().copied().fold(1.0, f64::max);
        let tip = spec.tip.unwrap_or(0.0);
        let root = spec.root.unwrap_or(1.0);
        for ((node, area), length) in self.nodes.iter_mut().zip(area).zip(all) {
            node.reach = length.unwrap_or(0.0);
            node.node.radius = f64::max(root * power(area / whole, 1.0 / spec.power.unwrap_or(2.0)), tip);
        }
    }

    /// The child that continues the limb of each node: the thickest, then the one with the longest path to a tip, then the first.
    pub(super) fn main_children(&self) -> Vec<Option<u32>> {
        let mut main: Vec<Option<u32>> = vec![None; self.nodes.len()];
        let key = |i: u32| {
            let node = &self.nodes[i as usize];
            (node.node.radius, node.reach + self.step(i as usize))
        };
        for i in 0..self.nodes.len() as u32 {
            let Some(parent) = self.nodes[i as usize].node.parent else { continue };
            let main = &mut main[parent as usize];
            if main.is_none_or(|old| key(i) > key(old)) {
                *main = Some(i);
            }
        }
        main
    }

    /// Restores the order in which parents precede children: depth first, the main child first.
    pub(super) fn reorder(&mut self) {
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); self.nodes.len()];
        let mut order: Vec<u32> = Vec::with_capacity(self.nodes.len());
        let mut stack: Vec<u32> = Vec::new();
        for (i, node) in (0_u32..).zip(&self.nodes) {
            match node.node.parent {
                Some(parent) => children[parent as usize].push(i),
                None => stack.push(i),
            }
        }
        stack.reverse();
        while let Some(i) = stack.pop() {
            order.push(i);
            stack.extend(children[i as usize].iter().rev());
        }
        self.keep(&order);
    }

    /// Keeps only the nodes in `order`, renumbered by it; parents and ends must be among them.
    pub(super) fn keep(&mut self, order: &[u32]) {
        let mut renamed = vec![u32::MAX; self.nodes.len()];
        order.iter().zip(0..).for_each(|(&old, new)| renamed[old as usize] = new);
        self.nodes = order.iter().map(|&old| self.nodes[old as usize]).collect();
        for node in &mut self.nodes {
            node.node.parent = node.node.parent.map(|p| renamed[p as usize]);
        }
        for end in &mut self.ends {
            end.path.end = renamed[end.path.end as usize];
            end.path.root = renamed[end.path.root as usize];
        }
    }

    /// The inverse of [`Plant::new`]: where a tree of a later part leaves an earlier one, it starts with a copy of that node.
    #[must_use]
    pub fn split(self) -> Vec<Skeleton> {
        let mut skeletons: Vec<Skeleton> = vec![Skeleton::default(); self.parts];
        let mut counts = vec![0; self.parts];
        for own in &self.nodes {
            let is_copied = own.node.parent.is_some_and(|p| self.nodes[p as usize].part != own.part);
            counts[own.part as usize] += 1 + usize::from(is_copied);
        }
        skeletons.iter_mut().zip(counts).for_each(|(skeleton, count)| skeleton.nodes.reserve_exact(count));
        let mut renamed: Vec<u32> = Vec::with_capacity(self.nodes.len());
        // The copy of an earlier part's node in a later one.
        let mut copies: HashMap<(u32, u32), u32> = HashMap::new();
        let mut copy = |skeletons: &mut Vec<Skeleton>, part: u32, at: u32, nodes: &[PlantNode]| {
            *copies.entry((part, at)).or_insert_with(|| {
                let list = &mut skeletons[part as usize].nodes;
                list.push(SkeletonNode { parent: None, ..nodes[at as usize].node });
                list.len() as u32 - 1
            })
        };
        for PlantNode { node, part, .. } in &self.nodes {
            let parent = node.parent.and_then(|p| {
                let other = &self.nodes[p as usize];
                if other.part == *part {
                    return Some(renamed[p as usize]);
                }
                // A side limb that starts at the fork needs no copy of it.
                (other.node.position != node.position).then(|| copy(&mut skeletons, *part, p, &self.nodes))
            });
            let list = &mut skeletons[*part as usize].nodes;
            renamed.push(list.len() as u32);
            list.push(SkeletonNode { parent, ..*node });
        }
        for PlantEnd { part, path, .. } in &self.ends {
            let is_own = |node: u32| self.nodes[node as usize].part == *part;
            // A path without nodes of its own ends at its root.
            let end = if is_own(path.end) {
                renamed[path.end as usize]
            } else {
                copy(&mut skeletons, *part, path.end, &self.nodes)
            };
            let own = &mut skeletons[*part as usize];
            let root = if is_own(path.root) {
                renamed[path.root as usize]
            } else {
                let up = |&i: &u32| own.nodes[i as usize].parent;
                std::iter::successors(Some(end), up).last().unwrap_or(end)
            };
            own.paths.push(Path { end, root, ..*path });
        }
        skeletons
    }
}

/// The unit vector from `a` to `b`, or zero.
pub(super) fn direction(a: DVec3, b: DVec3) -> DVec3 {
    (b - a).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::*;
    use crate::math::PerRound;

    /// A trunk of 4 with an arm, and two limbs from the trunk's top.
    fn parts() -> (Skeleton, Skeleton) {
        let mut trunk =
            skeleton(&[&[(0, 4), (0, 3), (0, 2), (0, 1), (0, 0)], &[(2, 2), (1, 2), (0, 2), (0, 1), (0, 0)]]);
        let mut limbs = skeleton(&[&[(1, 7), (1, 6), (0, 5), (0, 4)], &[(-1, 5), (0, 4)]]);
        trunk.root_paths();
        limbs.root_paths();
        limbs.nodes.iter_mut().for_each(|n| n.level = 1);
        (trunk, limbs)
    }

    /// Against a trace back from each endpoint, as in the paper.
    #[test]
    fn widths_follow_every_trace() {
        let (trunk, limbs) = parts();
        let width = |root, z| Width::Length(ByLength { root, tip: None, unit: None, z: PerRound::All(z) });
        let (wide, fine) = (width(Some(0.5), 0.6), width(None, 0.3));
        let given = [
            PlantPart { skeleton: &trunk, width: &wide, first_level: 0 },
            PlantPart { skeleton: &limbs, width: &fine, first_level: 1 },
        ];
        let mut plant = Plant::new(&given);
        plant.thicken(&wide);
        let longest = 4.0 + 1.0 + 2.0_f64.sqrt() + 1.0;
        let mut expected = vec![0.0_f64; plant.nodes.len()];
        let mut most = 0.0_f64;
        for end in &plant.ends {
            let z = if end.part == 0 { 0.6 } else { 0.3 };
            let (mut s, mut at) = (0.0, Some(end.path.end));
            while let Some(i) = at {
                expected[i as usize] = expected[i as usize].max(power(s / longest * 1e3, z));
                most = most.max(s);
                s += plant.step(i as usize);
                at = plant.nodes[i as usize].node.parent;
            }
        }
        assert!((most - longest).abs() < 1e-12, "{most} {longest}");
        for (node, s) in plant.nodes.iter().zip(&expected) {
            assert!((node.node.radius - 0.5 * s / expected[0]).abs() < 1e-12);
            let parent = node.node.parent.map_or(f64::INFINITY, |p| plant.nodes[p as usize].node.radius);
            assert!(node.node.radius <= parent, "width grows towards the tip");
        }
        assert_eq!(plant.nodes[0].node.radius, 0.5);
        let back = plant.split();
        assert_eq!((back[0].nodes.len(), back[0].paths.len()), (trunk.nodes.len(), 2));
        assert_eq!((back[1].nodes.len(), back[1].paths.len()), (limbs.nodes.len(), 2));
        assert_eq!(back[1].nodes[0].position, limbs.nodes[0].position);
    }

    #[test]
    fn a_pipe_keeps_its_area() {
        let (trunk, limbs) = parts();
        let width = Width::Pipe(Pipe { root: Some(0.4), tip: None, power: None });
        let given = [
            PlantPart { skeleton: &trunk, width: &width, first_level: 0 },
            PlantPart { skeleton: &limbs, width: &width, first_level: 1 },
        ];
        let mut plant = Plant::new(&given);
        plant.thicken(&width);
        for i in 0..plant.nodes.len() as u32 {
            let children: f64 =
                plant.nodes.iter().filter(|n| n.node.parent == Some(i)).map(|n| n.node.radius * n.node.radius).sum();
            let own = plant.nodes[i as usize].node.radius;
            assert!(children == 0.0 || (own * own - children).abs() < 1e-12);
        }
        assert!((plant.nodes[0].node.radius - 0.4).abs() < 1e-12);
    }
}
