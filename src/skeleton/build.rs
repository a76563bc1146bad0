//! The skeleton: the union of paths as a forest.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hash};

use rayon::prelude::*;

use crate::math::DVec3;

/// One node of a skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkeletonNode {
    /// Its position, in scene units.
    pub position: DVec3,
    /// The node before it on the path from the generator; `None` at a generator.
    pub parent: Option<u32>,
    /// Least path cost from the generator.
    pub cost: f64,
    /// Total path cost through all earlier steps from which this one grew: the order in which nodes grow.
    pub age: f64,
    /// Radius of the limb, in scene units; 0 until a width is applied.
    pub radius: f64,
    /// The number of its limb ([`Skeleton::number_branches`]).
    pub branch: u32,
    /// The round in which it grew.
    pub level: u16,
    /// The class of the thickest path through it, as an index of [`Skeleton::classes`].
    pub class: u16,
}

impl SkeletonNode {
    /// A node without radius, of limb 0 and level 0; its age is its cost.
    #[must_use]
    pub fn new(position: DVec3, parent: Option<u32>, cost: f64, class: u16) -> Self {
        Self { position, parent, cost, age: cost, radius: 0.0, branch: 0, level: 0, class }
    }
}

/// The end of one path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Path {
    /// The node at the endpoint.
    pub end: u32,
    /// The path's class, as an index of [`Skeleton::classes`].
    pub class: u16,
    /// The generator from which it was planned: the root of its graph.
    pub root: u32,
    /// Its identity, independent of other paths: the key of the random numbers of growth from its end.
    pub name: u64,
    /// The direction of the last branch of the limb that it continues; zero where there is none.
    pub last: DVec3,
}

/// The nodes of a path that no earlier path contains.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limb {
    /// The node of an earlier path at which it starts, and the index of that path; `None` where it starts at a root.
    pub leaves: Option<(u32, u32)>,
    /// Its own nodes, from the first to its end.
    pub nodes: Vec<u32>,
}

/// A forest of nodes; parents precede children.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// All nodes.
    pub nodes: Vec<SkeletonNode>,
    /// The paths whose union it is, in the order of their endpoints.
    pub paths: Vec<Path>,
    /// Names of the classes of paths.
    pub classes: Vec<String>,
}

impl Skeleton {
    /// An empty skeleton.
    #[must_use]
    pub fn new(classes: Vec<String>) -> Self {
        Self { classes, ..Self::default() }
    }

    /// Adds a path, given from its endpoint back to a generator as node, position and cost. Paths that meet share their nodes:
    /// `known` maps graph nodes to skeleton nodes.
    pub fn add_path<K: Copy + Eq + Hash, S: BuildHasher>(
        &mut self,
        known: &mut HashMap<K, u32, S>,
        class: u16,
        path: impl Iterator<Item = (K, DVec3, f64)>,
    ) {
        let mut fresh = Vec::with_capacity(16);
        let mut parent = None;
        for (node, position, cost) in path {
            if let Some(&at) = known.get(&node) {
                parent = Some(at);
                break;
            }
            fresh.push((node, position, cost));
        }
        for (node, position, cost) in fresh.into_iter().rev() {
            let at = self.nodes.len() as u32;
            known.insert(node, at);
            self.nodes.push(SkeletonNode::new(position, parent, cost, class));
            parent = Some(at);
        }
        let name = self.paths.len() as u64;
        self.paths.extend(parent.map(|end| Path { end, class, root: 0, name, ..Path::default() }));
    }

    /// Offsets the ages and limits the radii of every tree by the age and radius that `start` gives for its root.
    pub fn start_from(&mut self, start: impl Fn(&SkeletonNode) -> (f64, f64)) {
        let mut starts: Vec<(f64, f64)> = Vec::with_capacity(self.nodes.len());
        for node in &mut self.nodes {
            let (age, radius) = node.parent.map_or_else(|| start(node), |parent| starts[parent as usize]);
            starts.push((age, radius));
            node.age = age + node.cost;
            node.radius = node.radius.min(radius);
        }
    }

    /// [`Skeleton::start_from`] where the limb number of each node is the index of a path, by that path's root.
    pub fn start_limbs_from(&mut self, start: impl Fn(&SkeletonNode) -> (f64, f64) + Sync) {
        let nodes = &self.nodes;
        let starts: Vec<(f64, f64)> = self.paths.par_iter().map(|path| start(&nodes[path.root as usize])).collect();
        self.nodes.par_iter_mut().for_each(|node| {
            let (age, radius) = starts[node.branch as usize];
            node.age = age + node.cost;
            node.radius = node.radius.min(radius);
        });
    }

    /// The skeleton at the age `age`: later nodes are omitted, and the last segment of each limb is cut at that age.
    #[must_use]
    pub fn until(&self, age: f64) -> Self {
        let mut grown = Self { classes: self.classes.clone(), ..Self::default() };
        let mut renamed: Vec<Option<u32>> = vec![None; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            let parent = match node.parent {
                Some(p) => renamed[p as usize].filter(|_| self.nodes[p as usize].age < age),
                None if node.age <= age => None,
                None => continue,
            };
            if node.parent.is_some() && parent.is_none() {
                continue;
            }
            let mut node = SkeletonNode { parent, ..*node };
            if let Some(from) = parent.map(|p| grown.nodes[p as usize]).filter(|_| node.age > age) {
                let share = (age - from.age) / (node.age - from.age);
                node.position = from.position + (node.position - from.position) * share;
                node.cost = from.cost + (node.cost - from.cost) * share;
                node.radius = from.radius + (node.radius - from.radius) * share;
                node.age = age;
            }
            renamed[i] = Some(grown.nodes.len() as u32);
            grown.nodes.push(node);
        }
        grown.paths = self
            .paths
            .iter()
            .filter_map(|path| {
                let [end, root] = [path.end, path.root].map(|node| renamed[node as usize]);
                Some(Path { end: end?, root: root?, ..*path })
            })
            .collect();
        grown
    }

    /// Sets the root of every path to the root of its tree.
    pub fn root_paths(&mut self) {
        let mut roots: Vec<u32> = Vec::with_capacity(self.nodes.len());
        for (i, node) in (0..).zip(&self.nodes) {
            roots.push(node.parent.map_or(i, |parent| roots[parent as usize]));
        }
        for path in &mut self.paths {
            path.root = roots[path.end as usize];
        }
    }

    /// The distinct ends of paths, with the vector to each from the root of its graph: every one, or those only from which no
    /// other path was planned.
    pub fn ends(&self, every: bool) -> impl Iterator<Item = (u32, DVec3)> + '_ {
        self.end_paths(every).map(|path| {
            let Path { end, root, .. } = self.paths[path];
            (end, self.nodes[end as usize].position - self.nodes[root as usize].position)
        })
    }

    /// The indices of the paths of [`Skeleton::ends`].
    pub fn end_paths(&self, every: bool) -> impl Iterator<Item = usize> + '_ {
        let mut is_kept = vec![true; self.nodes.len()];
        if !every {
            self.paths.iter().filter(|path| path.root != path.end).for_each(|path| is_kept[path.root as usize] = false);
        }
        (0..self.paths.len()).filter(move |&path| std::mem::replace(&mut is_kept[self.paths[path].end as usize], false))
    }

    /// The direction of the segment that ends at this node; `None` at a root.
    #[must_use]
    pub fn direction_into(&self, node: u32) -> Option<DVec3> {
        let SkeletonNode { position, parent, .. } = self.nodes[node as usize];
        (position - self.nodes[parent? as usize].position).try_normalize()
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<SkeletonNode>() + self.paths.len() * size_of::<Path>()
    }

    /// The area of its surface, each segment as a cone cut off at its nodes.
    #[must_use]
    pub fn area(&self) -> f64 {
        let segments = self.nodes.iter().filter_map(|node| Some((&self.nodes[node.parent? as usize], node)));
        segments.map(|(a, b)| std::f64::consts::PI * (a.radius + b.radius) * a.position.distance(b.position)).sum()
    }

    /// The limb that each path adds to the earlier ones.
    #[must_use]
    pub fn limbs(&self) -> Vec<Limb> {
        let mut owner: Vec<Option<u32>> = vec![None; self.nodes.len()];
        let limb = |(path, name): (&Path, u32)| {
            let mut limb = Limb::default();
            let mut next = Some(path.end);
            while let Some(at) = next {
                if let Some(other) = owner[at as usize] {
                    limb.leaves = Some((at, other));
                    break;
                }
                owner[at as usize] = Some(name);
                limb.nodes.push(at);
                next = self.nodes[at as usize].parent;
            }
            limb.nodes.reverse();
            limb
        };
        self.paths.iter().zip(0..).map(limb).collect()
    }

    /// The segments, as parent and node.
    pub fn segments(&self) -> impl Iterator<Item = (&SkeletonNode, &SkeletonNode)> {
        self.nodes.iter().filter_map(|node| node.parent.map(|p| (&self.nodes[p as usize], node)))
    }

    /// The child that continues the limb of each node: the thickest, then the one whose paths cost most, then the first.
    #[must_use]
    pub fn main_children(&self) -> Vec<Option<u32>> {
        let mut far: Vec<f64> = self.nodes.iter().map(|n| n.cost).collect();
        let mut main: Vec<Option<u32>> = vec![None; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().rev() {
            if let Some(parent) = node.parent {
                far[parent as usize] = far[parent as usize].max(far[i]);
            }
        }
        for (i, node) in self.nodes.iter().enumerate() {
            let Some(parent) = node.parent else { continue };
            let main = &mut main[parent as usize];
            let is_better = main.is_none_or(|old| {
                let key = |n: u32| (self.nodes[n as usize].radius, far[n as usize]);
                key(i as u32) > key(old)
            });
            if is_better {
                *main = Some(i as u32);
            }
        }
        main
    }

    /// Numbers the limbs from 0 in the order of their first nodes: at a fork the main child continues the limb, every other
    /// child starts a new one.
    pub fn number_branches(&mut self) {
        let main = self.main_children();
        let mut next = 0;
        for i in 0..self.nodes.len() {
            self.nodes[i].branch = match self.nodes[i].parent {
                Some(p) if main[p as usize] == Some(i as u32) => self.nodes[p as usize].branch,
                _ => {
                    next += 1;
                    next - 1
                }
            };
        }
    }

    /// The number of children of each node.
    #[must_use]
    pub fn child_counts(&self) -> Vec<u32> {
        let mut counts = vec![0; self.nodes.len()];
        for parent in self.nodes.iter().filter_map(|n| n.parent) {
            counts[parent as usize] += 1;
        }
        counts
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::graph::Node;

    /// A skeleton from lists of (x, y) that start at their endpoint; equal points are one node.
    pub fn skeleton(paths: &[&[(i32, i32)]]) -> Skeleton {
        let mut skeleton = Skeleton::new(vec!["main".to_owned()]);
        let mut known = HashMap::new();
        for path in paths {
            let length = path.len();
            let nodes = path.iter().enumerate().map(|(i, &(x, y))| {
                let node = Node((y * 1000 + x) as u32);
                (node, DVec3::new(f64::from(x), f64::from(y), 0.0), (length - 1 - i) as f64)
            });
            skeleton.add_path(&mut known, 0, nodes);
        }
        skeleton
    }

    #[test]
    fn paths_that_meet_share_their_nodes() {
        let mut s = skeleton(&[&[(0, 3), (0, 2), (0, 1), (0, 0)], &[(2, 2), (1, 2), (0, 1), (0, 0)]]);
        assert_eq!(s.nodes.len(), 6);
        assert_eq!(s.paths.iter().map(|p| p.end).collect::<Vec<_>>(), [3, 5]);
        assert!(s.nodes.iter().enumerate().all(|(i, n)| n.parent.is_none_or(|p| (p as usize) < i)));
        s.number_branches();
        assert_eq!(s.nodes.iter().map(|n| n.branch).collect::<Vec<_>>(), [0, 0, 0, 0, 1, 1]);
    }
}
