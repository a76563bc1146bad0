//! Path refinement: finer lattices around coarse paths, planned again (Xu and Mould 2007, section 3.1 and Fig. 4).

use std::collections::HashMap;

use rayon::prelude::*;

use super::refine_spec::Refine;
use crate::geom::{Mark, MarkKind};
use crate::graph::{Graph, Mask, Node, Window};
use crate::grow::construction::graph_marks;
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::spaces::LatticeSpace;
use crate::grow::step::{Context, Step};
use crate::math::{DVec3, Progress};
use crate::plan::{Goal, plan};
use crate::skeleton::{Path, Skeleton};

/// A round that plans among more nodes than this is refused: it would take a minute and more.
const MOST_REFINED: u64 = 1 << 27;
/// A path is refined in pieces of so many coarse nodes, so that the graphs are small and temporary.
const PIECE: usize = 32;
/// Nodes of the finer lattice from the root's side, with the cost from the first.
type Way = Vec<([i32; 3], f64)>;

/// One piece of a path in the finer lattice, and marks of that.
struct Piece {
    way: Way,
    marks: Vec<Mark>,
}

/// Refines every path of `skeleton`, which was planned in `space`, as often as `step` says; of `marks` those of the graph become
/// those of the finest. Roots, forks and ends stay
/// where they are; between them each path is planned again.
pub(in crate::grow) fn refined(
    step: &Step,
    skeleton: Skeleton,
    marks: &mut Vec<Mark>,
    space: &LatticeSpace,
    context: &Context<'_>,
) -> Result<Skeleton, GrowError> {
    match &step.refine {
        Some(refine) => rounds(step, refine, skeleton, marks, space, context),
        None => Ok(skeleton),
    }
}

fn rounds(
    step: &Step,
    refine: &Refine,
    mut skeleton: Skeleton,
    marks: &mut Vec<Mark>,
    space: &LatticeSpace,
    context: &Context<'_>,
) -> Result<Skeleton, GrowError> {
    let Context { seed, progress, show, .. } = *context;
    let mut spacing = space.window.spacing;
    for round in 1..=refine.times {
        progress.report("refine", f64::from(round - 1) / f64::from(refine.times))?;
        let finer = spacing / f64::from(refine.ratio);
        let show = if round == refine.times { show } else { &[] };
        let work = Round { step, refine, space, seed, spacing: finer, round, show, progress };
        // Costs stay comparable: each round has `ratio` times as many edges.
        let (finer_skeleton, drawn) = work.apply(&skeleton, finer / space.window.spacing)?;
        skeleton = finer_skeleton;
        if round == refine.times {
            // The graph that the paths lie in is the last one.
            marks.retain(|mark| !mark.kind.is_of_graph());
            marks.extend(drawn);
        }
        spacing = finer;
    }
    Ok(skeleton)
}

struct Round<'a> {
    step: &'a Step,
    refine: &'a Refine,
    space: &'a LatticeSpace,
    seed: u64,
    spacing: f64,
    round: u32,
    show: &'a [MarkKind],
    progress: &'a Progress,
}

impl Round<'_> {
    /// The pieces of a chain of coarse nodes, planned again.
    fn pieces(&self, chain: &[u32], coarse: &Skeleton, scale: f64) -> Result<Vec<Piece>, GrowError> {
        let pieces = cut(chain).map(|piece| {
            let first = coarse.nodes[piece[0] as usize].cost;
            let nodes = piece.iter().map(|&i| &coarse.nodes[i as usize]);
            let points = nodes.map(|n| (n.position, (n.cost - first) / scale));
            self.piece(&points.collect::<Vec<_>>())
        });
        pieces.collect()
    }

    /// The finer skeleton, and marks of the lattices that it lies in.
    fn apply(&self, coarse: &Skeleton, scale: f64) -> Result<(Skeleton, Vec<Mark>), GrowError> {
        let chains = chains(coarse);
        self.check_size(&chains, coarse)?;
        let refined: Result<Vec<Vec<Piece>>, GrowError> =
            chains.par_iter().map(|chain| self.pieces(chain, coarse, scale)).collect();

        let mut fine = Skeleton::new(coarse.classes.clone());
        let mut known: HashMap<[i32; 3], u32> = HashMap::new();
        let mut renamed = vec![u32::MAX; coarse.nodes.len()];
        let mut marks = Vec::new();
        for (i, node) in coarse.nodes.iter().enumerate().filter(|(_, node)| node.parent.is_none()) {
            renamed[i] = fine.nodes.len() as u32;
            known.entry(self.at(node.position)).or_insert(renamed[i]);
            fine.nodes.push(*node);
        }
        for (chain, pieces) in chains.iter().zip(refined?) {
            let (start, end) = (chain[0], chain[chain.len() - 1]);
            let last = coarse.nodes[end as usize];
            let from = renamed[start as usize];
            let mut cost = fine.nodes[from as usize].cost;
            let mut way: Vec<([i32; 3], DVec3, f64)> = Vec::new();
            for piece in pieces {
                let base = cost;
                marks.extend(piece.marks);
                for (at, along) in piece.way.into_iter().skip(1) {
                    cost = base + along * scale;
                    way.push((at, DVec3::from_array(at.map(|c| f64::from(c) * self.spacing)), cost));
                }
            }
            if let Some(end) = way.last_mut() {
                end.1 = last.position;
            }
            // Paths that meet share what follows, so that there are no loops.
            let paths = fine.paths.len();
            way.insert(0, (self.at(coarse.nodes[start as usize].position), DVec3::ZERO, 0.0));
            known.insert(way[0].0, from);
            way.reverse();
            stop_at_crossing(&mut way, &known, &fine);
            fine.add_path(&mut known, last.class, way.into_iter());
            renamed[end as usize] = fine.paths.last().map_or(from, |path| path.end);
            fine.paths.truncate(paths);
        }
        fine.paths = coarse
            .paths
            .iter()
            .map(|path| Path { end: renamed[path.end as usize], root: renamed[path.root as usize], ..*path })
            .collect();
        Ok((fine, marks))
    }

    fn wrong(&self, problem: Problem) -> GrowError {
        self.step.error(Key::Weights, problem)
    }

    fn at(&self, p: DVec3) -> [i32; 3] {
        p.to_array().map(|x| libm::round(x / self.spacing) as i32)
    }

    /// How far sublattices reach around a node, in nodes of theirs.
    fn reach(&self) -> [i32; 3] {
        let is_plane = self.space.neighbours.dimensions() == 2;
        let reach = (self.refine.reach * self.refine.ratio) as i32;
        [reach, reach, if is_plane { 0 } else { reach }]
    }

    /// The box of the sublattices around `nodes`.
    fn window(&self, nodes: &[[i32; 3]]) -> Window {
        let reach = self.reach();
        let span = |axis: usize| {
            let low = nodes.iter().map(|n| n[axis]).min().unwrap_or(0) - reach[axis];
            let high = nodes.iter().map(|n| n[axis]).max().unwrap_or(0) + reach[axis];
            (low, (high - low + 1) as u32)
        };
        let spans = [0, 1, 2].map(span);
        Window { spacing: self.spacing, origin: spans.map(|s| s.0), size: spans.map(|s| s.1) }
    }

    /// Refuses rounds whose boxes have too many nodes in all: each has about `ratio` times those of the one before, since pieces
    /// are of so many nodes.
    fn check_size(&self, chains: &[Vec<u32>], coarse: &Skeleton) -> Result<(), GrowError> {
        let nodes_of = |piece: &[u32]| {
            let nodes: Vec<[i32; 3]> = piece.iter().map(|&i| self.at(coarse.nodes[i as usize].position)).collect();
            self.window(&nodes).nodes()
        };
        let mut count: u64 = chains.iter().flat_map(|chain| cut(chain)).map(nodes_of).sum();
        for _ in self.round..self.refine.times {
            count = count.saturating_mul(self.refine.ratio.into());
        }
        if count > MOST_REFINED {
            let problem = Problem::TooRefined { round: self.refine.times, count, most: MOST_REFINED };
            return Err(self.step.error(Key::Refine, problem));
        }
        Ok(())
    }

    /// The least-cost way from the first of `points` to the last within sublattices around all of them; beside each is
    /// its cost on the coarse way.
    fn piece(&self, points: &[(DVec3, f64)]) -> Result<Piece, GrowError> {
        let nodes: Vec<[i32; 3]> = points.iter().map(|&(p, _)| self.at(p)).collect();
        let (window, reach) = (self.window(&nodes), self.reach());
        let within = |n: [i32; 3]| [0, 1, 2].map(|i| (n[i] - window.origin[i]) as u32);
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);

        let [width, height, _] = window.size.map(|s| s as usize);
        let mut words = vec![u64::MAX; (window.nodes() as usize).div_ceil(64)];
        let mut open = |n: [i32; 3]| {
            let [x, y, z] = within(n).map(|c| c as usize);
            let cell = x + width * (y + height * z);
            words[cell / 64] &= !(1 << (cell % 64));
        };
        for n in &nodes {
            for z in n[2] - reach[2]..=n[2] + reach[2] {
                for y in n[1] - reach[1]..=n[1] + reach[1] {
                    for x in n[0] - reach[0]..=n[0] + reach[0] {
                        if self.space.is_open(window.position(within([x, y, z]))) {
                            open([x, y, z]);
                        }
                    }
                }
            }
        }
        // What was given stays, even where rounding puts it outside.
        [first, last].into_iter().for_each(&mut open);

        let stream = format!("{}/{}", self.space.stream, self.round);
        let mask = Mask::from_words(words, window.nodes() as usize);
        let lattice = self
            .space
            .lattice_in(window, &stream, self.seed, Some(mask))
            .map_err(|e| self.wrong(Problem::Lattice(e)))?;
        let marks = graph_marks(&lattice, self.show).map_err(|problem| self.step.error(Key::Nodes, problem))?;
        let [from, to] = [first, last].map(|n| lattice.node(within(n)));
        let plan =
            plan(&lattice, &[from], Goal::Nodes(&[to]), self.progress).map_err(|error| self.step.plan_error(error))?;
        let range = lattice.weight_range();
        let Some(mut left) = plan.cost(to) else {
            // Obstacles cut the corridor at this scale: the coarse way stays, straight from node to node.
            let way = nodes.into_iter().zip(points).map(|(n, (_, cost))| (n, *cost)).collect();
            return Ok(Piece { way, marks });
        };
        let mut way: Way = plan
            .path(to)
            .map(|node: Node| {
                let here = (self.at(lattice.position(node)), range.real(left));
                left -= plan.predecessor(node).map_or(0, |(_, weight)| u64::from(weight));
                here
            })
            .collect();
        way.reverse();
        Ok(Piece { way, marks })
    }
}

/// The pieces of a chain; each begins with the last node of the one before.
fn cut(chain: &[u32]) -> impl Iterator<Item = &[u32]> {
    (0..chain.len() - 1).step_by(PIECE).map(|start| &chain[start..=(start + PIECE).min(chain.len() - 1)])
}

/// Ends a way, told from its end, where it first crosses a diagonal edge that is there already: it joins that.
fn stop_at_crossing(way: &mut Vec<([i32; 3], DVec3, f64)>, known: &HashMap<[i32; 3], u32>, there: &Skeleton) {
    for i in 1..way.len() {
        let (from, to) = (way[i - 1].0, way[i].0);
        if known.contains_key(&from) {
            return;
        }
        // In the plane edges cross only as the two diagonals of a square.
        if from[0] == to[0] || from[1] == to[1] || from[2] != to[2] {
            continue;
        }
        let corners = [[from[0], to[1], from[2]], [to[0], from[1], from[2]]];
        let [Some(&a), Some(&b)] = corners.map(|corner| known.get(&corner)) else { continue };
        let parent = |i: u32| there.nodes[i as usize].parent;
        if parent(a) == Some(b) || parent(b) == Some(a) {
            way[i].0 = corners[0];
            way.truncate(i + 1);
            return;
        }
    }
}

/// The unbranched stretches of a forest, each from a root or a fork to the next fork or end, in the order of their
/// ends: those nearer the root come first.
fn chains(skeleton: &Skeleton) -> Vec<Vec<u32>> {
    let mut is_end: Vec<bool> = skeleton.child_counts().iter().map(|&count| count != 1).collect();
    for path in &skeleton.paths {
        is_end[path.end as usize] = true;
    }
    for (i, node) in skeleton.nodes.iter().enumerate() {
        is_end[i] |= node.parent.is_none();
    }
    let mut chains = Vec::new();
    for end in (0..skeleton.nodes.len() as u32).filter(|&i| is_end[i as usize]) {
        let Some(mut at) = skeleton.nodes[end as usize].parent else { continue };
        let mut chain = vec![end, at];
        while let Some(parent) = skeleton.nodes[at as usize].parent.filter(|_| !is_end[at as usize]) {
            chain.push(parent);
            at = parent;
        }
        chain.reverse();
        chains.push(chain);
    }
    chains
}
