//! Rounds of subgraphs: every end that still lives gets a graph of its own, and paths from it to new ends (Xu and Mould
//! 2012, section 3.2, Fig. 4).

use std::collections::HashSet;

use rand::RngExt;
use rayon::prelude::*;

use super::influence::{Influence, Share};
use super::light::Canopy;
use super::repeat::{Repeat, Target};
use super::spec::{Index, Orient};
use crate::geom::{Mark, MarkKind};
use crate::graph::{EdgeWeights, Node, Scatter, WeightTable};
use crate::grow::choice::choose;
use crate::grow::construction::Construction;
use crate::grow::endpoints::Placement;
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::{Grown, Part};
use crate::grow::space::Space;
use crate::grow::spaces::{ScatterSpace, SubgraphPlace};
use crate::grow::step::{Context, Generators, Step, Unreached};
use crate::math::{DMat3, DVec3, Memory, Progress, Stream, frame_along, from_height, mix, rotated_toward, rotation};
use crate::plan::routes;
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// More ends than this in a round are refused: each has a graph of its own.
const MOST_ENDS: f64 = 1e6;
/// Bytes that an end takes with the way to it, and with what is made of it.
const END_BYTES: f64 = 4096.0;
/// Ends that a thread takes at a time.
const CHUNK: usize = 16;
/// Different sets of nodes that subgraphs share. Each subgraph has weights and endpoints of its own, and is turned about
/// its axis at random: that no two of a step's thousands have the same nodes would cost ten times their planning.
const SETS: u64 = 64;

/// An end that may sprout.
#[derive(Clone, Copy, Debug)]
struct End {
    /// The node of the skeleton.
    node: u32,
    /// From the root of the subgraph that it belongs to, of length 1.
    way: DVec3,
    /// How many more rounds it may sprout.
    lifespan: u32,
    /// What tells it from all others, for random numbers.
    name: u64,
}

/// A step on its way through its rounds.
pub struct Rounds<'a> {
    step: &'a Step,
    repeat: &'a Repeat,
    space: &'a ScatterSpace,
    seed: u64,
    table: WeightTable,
    /// Nodes around an end, made when they are first wanted; unused where something is forbidden, which differs from end
    /// to end.
    sets: Vec<Option<Scatter>>,
    ends: Vec<End>,
    round: u32,
    level: u16,
    grown: Grown,
}

/// The set of nodes that an end takes.
fn set_of(end: &End) -> usize {
    (mix(end.name) % SETS) as usize
}

/// What one subgraph yields: nodes behind their parents (the end itself is 0), and the ends of its paths.
#[derive(Default)]
struct Sprout {
    nodes: Vec<(DVec3, u32, f64)>,
    ends: Vec<(u32, u16)>,
    graph: [u64; 3],
    dropped: usize,
    marks: Vec<Mark>,
}

/// The ends that a step begins at, each place once.
struct FirstEnds {
    skeleton: Skeleton,
    ends: Vec<End>,
    known: HashSet<[u64; 3]>,
    lifespan: u32,
}

impl FirstEnds {
    fn add(&mut self, position: DVec3, way: DVec3, from: Option<&SkeletonNode>) {
        if !self.known.insert(position.to_array().map(f64::to_bits)) {
            return;
        }
        let node = self.skeleton.nodes.len() as u32;
        let (age, level) = from.map_or((0.0, 0), |from| (from.age, from.level));
        self.skeleton.nodes.push(SkeletonNode { age, level, ..SkeletonNode::new(position, None, 0.0, 0) });
        self.ends.push(End { node, way, lifespan: self.lifespan, name: mix(u64::from(node)) });
    }

    /// Adds those of `step`; the level of its first round.
    fn gather(&mut self, step: &Step, up: DVec3, context: &Context<'_>) -> Result<u16, GrowError> {
        let mut level = 0;
        match &step.source {
            Generators::At(points) => points.iter().for_each(|&p| self.add(p, up, None)),
            Generators::Inside(_) | Generators::Spread(_) => {
                return Err(step.error(Key::From, Problem::NoRoundSource));
            }
            Generators::Steps(steps, part) => {
                for &source in steps {
                    let skeleton = context.grown[source].ok_or_else(|| step.error(Key::From, Problem::NotGrown))?;
                    level = level.max(skeleton.nodes.iter().map(|n| n.level + 1).max().unwrap_or(0));
                    for (end, way) in skeleton.ends(*part == Part::EveryEnd) {
                        let node = &skeleton.nodes[end as usize];
                        self.add(node.position, way.normalize_or(up), Some(node));
                    }
                }
            }
        }
        Ok(level)
    }
}

impl<'a> Rounds<'a> {
    /// Begins a step at the ends of what the steps before have grown; `None` where it is not repeated.
    ///
    /// # Errors
    /// [`GrowError::Step`] where there are no ends.
    pub fn begin(step: &'a Step, context: &Context<'_>) -> Result<Option<Self>, GrowError> {
        let Some(repeat) = &step.repeat else { return Ok(None) };
        let Some(Space::Scatter(space)) = &step.space else {
            return Err(step.error(Key::Space, Problem::NotRepeated));
        };
        let table = space.table().map_err(|error| step.error(Key::Weights, Problem::Weights(error)))?;
        let mut first = FirstEnds {
            skeleton: Skeleton::new(step.classes.clone()),
            ends: Vec::new(),
            known: HashSet::new(),
            lifespan: repeat.lifespan.first,
        };
        let level = first.gather(step, space.up_vector(), context)?;
        if first.ends.is_empty() {
            return Err(step.error(Key::From, Problem::NoEnds));
        }
        let grown = Grown { name: step.name.clone(), skeleton: first.skeleton, first_level: level, ..Grown::default() };
        let sets = vec![None; SETS as usize];
        let seed = context.seed;
        Ok(Some(Self { step, repeat, space, seed, table, sets, ends: first.ends, round: 0, level, grown }))
    }

    /// What has grown so far.
    #[must_use]
    pub fn skeleton(&self) -> &Skeleton {
        &self.grown.skeleton
    }

    /// Is nothing left to grow?
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.round == self.repeat.times || self.ends.is_empty()
    }

    /// What has grown.
    ///
    /// # Errors
    /// [`GrowError::Step`] where the step's width has no number for a class.
    pub fn finish(self, grown: &[Option<&Skeleton>]) -> Result<Grown, GrowError> {
        let skeleton = self.step.finish(self.grown.skeleton, grown)?;
        Ok(Grown { skeleton, ..self.grown })
    }

    /// The influences that need a [`Canopy`], as how thick limbs are for them.
    pub fn clumps(&self) -> impl Iterator<Item = f64> + '_ {
        self.repeat.influences.iter().filter_map(Influence::clump)
    }

    /// Grows one round within `memory`. `canopies` has a canopy for each of [`Rounds::clumps`], of what grew before
    /// this round.
    ///
    /// # Errors
    /// [`GrowError`].
    pub fn advance(
        &mut self,
        canopies: &[Canopy],
        show: &[MarkKind],
        memory: &Memory,
        progress: &Progress,
    ) -> Result<(), GrowError> {
        let stream = Stream::new(self.seed, &format!("rounds/{}/{}", self.step.name, self.round));
        let ends = std::mem::take(&mut self.ends);
        let places: Vec<(DVec3, DVec3)> =
            ends.iter().map(|end| (self.grown.skeleton.nodes[end.node as usize].position, end.way)).collect();
        let mut shares = vec![Share::default(); ends.len()];
        let mut canopies = canopies.iter();
        for (i, influence) in (0..).zip(&self.repeat.influences) {
            let canopy = influence.clump().and_then(|_| canopies.next());
            let dealt = influence.deal(&places, canopy, stream.nth(i));
            shares.iter_mut().zip(dealt).for_each(|(share, dealt)| *share = share.with(dealt));
        }
        let counted: f64 = ends
            .iter()
            .zip(&shares)
            .map(|(end, share)| self.counts(end, share).iter().map(|&count| f64::from(count)).sum::<f64>())
            .sum();
        let most = f64::min(MOST_ENDS, memory.left() as f64 / END_BYTES);
        if self.grown.skeleton.paths.len() as f64 + counted > most {
            let problem = Problem::TooManyEnds { round: self.round + 1, ends: counted, most };
            return Err(self.step.error(Key::Rounds, problem));
        }
        if self.space.is_alike() {
            self.make_sets(&ends)?;
        }
        // Equal pieces in order: the result does not depend on who grew them.
        let work: Vec<(&End, &Share)> = ends.iter().zip(&shares).collect();
        let sprouts: Vec<Sprout> = work
            .par_chunks(CHUNK)
            .map(|chunk| {
                progress.check()?;
                chunk.iter().map(|(end, share)| self.sprout(end, share, &stream, show)).collect::<Result<Vec<_>, _>>()
            })
            .collect::<Result<Vec<Vec<Sprout>>, GrowError>>()?
            .into_iter()
            .flatten()
            .collect();
        if counted > 0.0 && sprouts.iter().all(|sprout| sprout.ends.is_empty()) {
            return Err(self.step.error(Key::To, Problem::EmptyRound { round: self.round + 1, count: counted }));
        }
        progress.report("grow", f64::from(self.round + 1) / f64::from(self.repeat.times))?;
        self.ask_to_join(&sprouts, memory)?;
        let level = self.level + self.round as u16;
        for ((end, share), sprout) in ends.iter().zip(&shares).zip(sprouts) {
            self.join(end, share, sprout, level, &stream);
        }
        self.round += 1;
        Ok(())
    }

    /// Asks for what `sprouts` take beside the skeleton's nodes that they become, and beside the sets of nodes.
    fn ask_to_join(&self, sprouts: &[Sprout], memory: &Memory) -> Result<(), GrowError> {
        let joined = size_of::<SkeletonNode>() + size_of::<(DVec3, u32, f64)>();
        let nodes = sprouts.iter().map(|sprout| sprout.nodes.len() * joined).sum::<usize>();
        let sets = self.sets.iter().flatten().map(Scatter::bytes).sum::<usize>();
        Ok(memory.ask((nodes + size_of_val(sprouts) + sets) as u64)?)
    }

    /// Makes the sets of nodes that `ends` take.
    fn make_sets(&mut self, ends: &[End]) -> Result<(), GrowError> {
        let mut wanted: Vec<usize> = ends.iter().map(set_of).filter(|&set| self.sets[set].is_none()).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let stream = Stream::new(self.seed, &format!("space/{}", self.space.stream));
        let made: Vec<Scatter> = wanted
            .par_iter()
            .map(|&set| self.space.scatter_around(None, &stream.nth(set as u64)))
            .collect::<Result<_, _>>()
            .map_err(|error| self.wrong_nodes(Problem::Scatter(error)))?;
        wanted.into_iter().zip(made).for_each(|(set, graph)| self.sets[set] = Some(graph));
        Ok(())
    }

    fn wrong_nodes(&self, problem: Problem) -> GrowError {
        self.step.error(Key::Nodes, problem)
    }

    /// The number by which an end counts its rounds.
    fn index(&self, end: &End) -> u32 {
        match self.repeat.by {
            Index::Round => self.round,
            Index::Lifespan => self.repeat.lifespan.first - end.lifespan,
        }
    }

    /// How many endpoints of each set an end gets.
    fn counts(&self, end: &End, share: &Share) -> Vec<u32> {
        let index = self.index(end);
        let sets = self.step.endpoints.iter().map(|set| match &set.placement {
            _ if share.dies => 0,
            Placement::Random(random) => share.count.unwrap_or(random.count.at(index) as u32),
            Placement::At(_) | Placement::Near(_) | Placement::Through(_) => 0,
        });
        sets.collect()
    }

    /// Where the space around an end is; `own` is the end's stream.
    fn place(&self, end: &End, share: &Share, own: &Stream) -> SubgraphPlace {
        let at = self.grown.skeleton.nodes[end.node as usize].position;
        let index = self.index(end);
        let mut way = match self.repeat.orient {
            Orient::Outward => end.way,
            Orient::Up => self.space.up_vector(),
            Orient::Down => -self.space.up_vector(),
            Orient::Along(along) => along.0.normalize_or(DVec3::Z),
            Orient::Random => {
                let mut random = Stream::new(self.seed, &format!("ways/{}", self.step.name)).nth(end.name);
                let z: f64 = if self.space.is_plane { 0.0 } else { random.random_range(-1.0..1.0) };
                let turn = std::f64::consts::TAU * random.random::<f64>();
                from_height(z, turn)
            }
        };
        for turn in &self.repeat.turns {
            let target = match &turn.target {
                Target::Along(target) => Some(*target),
                Target::From(shape, within) => {
                    // The distance grows fastest straight away from the shape.
                    let d = |p: DVec3| shape.distance(p);
                    let step = self.space.spacing * 1e-3;
                    let rise = DVec3::AXES.map(|axis| d(at + axis * step) - d(at - axis * step));
                    (d(at) <= *within).then(|| DVec3::from_array(rise).try_normalize()).flatten()
                }
            };
            if let Some(target) = target {
                way = rotated_toward(way, target, turn.by.at(index) * (std::f64::consts::PI / 180.0));
            }
        }
        let size = self.repeat.size.at(index) * share.size.unwrap_or(1.0);
        let turn = if self.space.is_plane {
            // The space's y is along the way.
            DMat3::from_cols(DVec3::new(way.y, -way.x, 0.0), way, DVec3::Z)
        } else {
            let roll: f64 = own.nth(0).random();
            frame_along(way) * rotation(DVec3::Z, std::f64::consts::TAU * roll)
        };
        SubgraphPlace { at, turn, size }
    }

    /// Grows the subgraph of one end.
    fn sprout(&self, end: &End, share: &Share, stream: &Stream, show: &[MarkKind]) -> Result<Sprout, GrowError> {
        let counts = self.counts(end, share);
        let mut sprout = Sprout::default();
        if counts.iter().all(|&count| count == 0) {
            return Ok(sprout);
        }
        let own = stream.nth(end.name);
        let place = self.place(end, share, &own);
        let alone;
        let graph = match &self.sets[set_of(end)] {
            Some(graph) => graph,
            None => {
                alone = self
                    .space
                    .scatter_around(Some(&place), &own)
                    .map_err(|error| self.wrong_nodes(Problem::Scatter(error)))?;
                &alone
            }
        };
        let mut wanted: Vec<(Node, u16)> = Vec::new();
        let mut taken = vec![false; graph.len()];
        taken[0] = true;
        for (i, (set, count)) in self.step.endpoints.iter().zip(counts).enumerate() {
            let Placement::Random(random) = &set.placement else { continue };
            let inside = random.inside.as_ref().unwrap_or(&self.space.shape);
            let fits = |p: DVec3| random.holds(inside, p);
            let chosen = choose(graph, &mut taken, count, random.apart, fits, &own.nth(1 + i as u64));
            wanted.extend(chosen.into_iter().map(|node| (node, set.class)));
        }
        if wanted.is_empty() {
            return Ok(sprout);
        }
        let nodes: Vec<Node> = wanted.iter().map(|&(node, _)| node).collect();
        let weights = graph.weigh(&self.table, &self.space.fields, |p| place.put(p), &own);
        let found = routes(graph, &weights, &[(Node(0), 0)], &nodes, &Progress::default())?;
        let mut known: Vec<u32> = vec![u32::MAX; graph.len()];
        known[0] = 0;
        let spacing = self.space.spacing * place.size;
        let mut fresh = Vec::new();
        for &(node, class) in &wanted {
            if found.cost(node).is_none() {
                sprout.dropped += 1;
                if self.step.unreached == Unreached::Error {
                    let at = place.put(graph.position(node));
                    return Err(self.step.error(Key::To, Problem::Unreached(at)));
                }
                continue;
            }
            fresh.clear();
            let mut parent = 0;
            for (at, cost) in found.path(node) {
                if known[at.0 as usize] != u32::MAX {
                    parent = known[at.0 as usize];
                    break;
                }
                fresh.push((at, cost));
            }
            for &(at, cost) in fresh.iter().rev() {
                sprout.nodes.push((place.put(graph.position(at)), parent, weights.real(cost) * spacing));
                parent = sprout.nodes.len() as u32;
                known[at.0 as usize] = parent;
            }
            sprout.ends.push((parent, class));
        }
        sprout.graph = [graph.len() as u64, graph.count_edges(), found.settled() as u64];
        if !show.is_empty() {
            sprout.marks = self.marks(graph, &weights, &nodes, &place, show)?;
        }
        Ok(sprout)
    }

    /// Marks of the graph around an end.
    fn marks(
        &self,
        graph: &Scatter,
        weights: &EdgeWeights,
        ends: &[Node],
        place: &SubgraphPlace,
        show: &[MarkKind],
    ) -> Result<Vec<Mark>, GrowError> {
        let construction = Construction {
            graph: &(graph, weights),
            shapes: vec![&self.space.shape],
            ends: ends.iter().map(|&node| graph.position(node)).collect(),
            is_plane: self.space.is_plane,
            contours: &|| None,
            sectors: Vec::new(),
        };
        let marks = construction.marks(show).map_err(|problem| self.wrong_nodes(problem))?;
        let put =
            marks.into_iter().map(|mark| Mark { line: mark.line.into_iter().map(|p| place.put(p)).collect(), ..mark });
        Ok(put.collect())
    }

    /// Adds what an end sprouted to the skeleton.
    fn join(&mut self, end: &End, share: &Share, sprout: Sprout, level: u16, stream: &Stream) {
        let grown = &mut self.grown;
        let skeleton = &mut grown.skeleton;
        let first = skeleton.nodes.len() as u32;
        let root = skeleton.nodes[end.node as usize];
        let named = |i: u32| if i == 0 { end.node } else { first + i - 1 };
        for (position, parent, cost) in sprout.nodes {
            let cost = root.cost + cost;
            let parent = Some(named(parent));
            skeleton.nodes.push(SkeletonNode { position, parent, cost, age: cost, level, class: 0, ..root });
        }
        let mut random = stream.nth(mix(end.name));
        for (i, (node, class)) in (1_u64..).zip(sprout.ends) {
            let node = named(node);
            let name = mix(end.name ^ mix(i));
            skeleton.paths.push(Path { end: node, class, root: end.node, name, ..Path::default() });
            let loss = share.loss.unwrap_or_else(|| self.repeat.lifespan.lose(end.lifespan, &mut random));
            let lifespan = end.lifespan.saturating_sub(loss);
            let way = (skeleton.nodes[node as usize].position - root.position).normalize_or(end.way);
            if lifespan > 0 {
                self.ends.push(End { node, way, lifespan, name });
            }
        }
        grown.nodes += sprout.graph[0];
        grown.edges += sprout.graph[1];
        grown.settled += sprout.graph[2];
        grown.dropped += sprout.dropped;
        grown.marks.extend(sprout.marks);
    }
}
