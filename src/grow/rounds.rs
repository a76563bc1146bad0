//! Rounds of subgraphs: every end that still lives gets a graph of its own, and paths from it to new ends (Xu and Mould
//! 2012, section 3.2, Fig. 4).

use std::collections::HashMap;

use rand::RngExt;
use rayon::prelude::*;

use super::choice::choose;
use super::construction::scattered_marks;
use super::influence::Share;
use super::scatter_space::Place;
use super::{
    Canopy, GrowError, Grown, Index, Influence, LifespanSpec, Loss, Mark, MarkKind, Orient, Part, Placement,
    ScatterSpace, Source, Step, Unreached,
};
use crate::geom::Shape;
use crate::graph::{Node, Scatter, WeightTable};
use crate::math::{DMat3, DVec3, PerRound, Progress, Stream, frame_along, mix, rotation, turned_toward};
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

/// How a step is repeated, with its names resolved.
#[derive(Clone, Debug)]
pub struct Repeat {
    /// How many rounds at most.
    pub times: u32,
    /// Size of the space around an end over that of the space as it is written.
    pub size: PerRound,
    /// What counts the rounds.
    pub by: Index,
    /// Where the z of that space points.
    pub orient: Orient,
    /// Turns of that direction.
    pub turns: Vec<Turn>,
    /// How many more rounds an end may sprout.
    pub lifespan: LifespanSpec,
    /// What favours some ends over others.
    pub influences: Vec<Influence>,
}

/// A turn of a direction.
#[derive(Clone, Debug)]
pub struct Turn {
    /// Where to.
    pub target: Target,
    /// By how much, in degrees.
    pub by: PerRound,
}

/// Where a direction is turned to.
#[derive(Clone, Debug)]
pub enum Target {
    /// This direction, of length 1.
    Along(DVec3),
    /// Away from this shape, where it is no farther than this.
    From(Shape, f64),
}

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

impl<'a> Rounds<'a> {
    /// Begins at the ends of what the steps before have grown, by index.
    ///
    /// # Errors
    /// [`GrowError::Scene`] where there are no ends.
    pub fn new(
        step: &'a Step,
        repeat: &'a Repeat,
        space: &'a ScatterSpace,
        seed: u64,
        grown: &[Option<&Skeleton>],
    ) -> Result<Self, GrowError> {
        let wrong =
            |key: &str, message: String| GrowError::Scene { place: format!("grow.{}.{key}", step.name), message };
        let table = space.table().map_err(|error| GrowError::Scene {
            place: format!("space.{}.weights", step.space_name),
            message: error.to_string(),
        })?;
        let mut skeleton = Skeleton::new(step.classes.clone());
        let mut ends = Vec::new();
        let mut known = HashMap::new();
        let mut level = 0;
        let mut begin = |position: DVec3, way: DVec3, from: Option<&SkeletonNode>| {
            let bits = position.to_array().map(f64::to_bits);
            if known.insert(bits, ()).is_some() {
                return;
            }
            let node = skeleton.nodes.len() as u32;
            let (age, level) = from.map_or((0.0, 0), |from| (from.age, from.level));
            skeleton.nodes.push(SkeletonNode { age, level, ..SkeletonNode::new(position, None, 0.0, 0) });
            let lifespan = repeat.lifespan.first;
            ends.push(End { node, way, lifespan, name: mix(u64::from(node)) });
        };
        let up = if space.is_plane { DVec3::Y } else { DVec3::Z };
        match &step.source {
            Source::At(points) => points.iter().for_each(|&p| begin(p, up, None)),
            Source::Inside(_) | Source::Spread(_) => {
                return Err(wrong("from", "a repeated step starts from points or the ends of steps".to_owned()));
            }
            Source::Steps(steps, part) => {
                for &source in steps {
                    let skeleton = grown[source].ok_or_else(|| wrong("from", "the step has not grown".to_owned()))?;
                    level = level.max(skeleton.nodes.iter().map(|n| n.level + 1).max().unwrap_or(0));
                    for (end, way) in skeleton.ends(*part == Part::EveryEnd) {
                        let node = &skeleton.nodes[end as usize];
                        begin(node.position, way.normalize_or(up), Some(node));
                    }
                }
            }
        }
        if ends.is_empty() {
            return Err(wrong("from", "there is no end to grow from: the step before has no paths".to_owned()));
        }
        let grown = Grown {
            name: step.name.clone(),
            skeleton,
            foot: None,
            first_level: level,
            nodes: 0,
            edges: 0,
            settled: 0,
            dropped: 0,
            marks: Vec::new(),
            regions: None,
        };
        let sets = vec![None; SETS as usize];
        Ok(Self { step, repeat, space, seed, table, sets, ends, round: 0, level, grown })
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
    /// [`GrowError::Scene`] where the step's width has no number for a class.
    pub fn finish(self, grown: &[Option<&Skeleton>]) -> Result<Grown, GrowError> {
        let skeleton = self.step.finish(self.grown.skeleton, grown)?;
        Ok(Grown { skeleton, ..self.grown })
    }

    /// The influences that need a [`Canopy`], as how thick limbs are for them.
    pub fn clumps(&self) -> impl Iterator<Item = f64> + '_ {
        self.repeat.influences.iter().filter_map(Influence::clump)
    }

    /// Grows one round within `max_memory` bytes. `canopies` has a canopy for each of [`Rounds::clumps`], of what grew before
    /// this round.
    ///
    /// # Errors
    /// [`GrowError`].
    pub fn advance(
        &mut self,
        canopies: &[Canopy],
        show: &[MarkKind],
        max_memory: u64,
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
        let most = f64::min(MOST_ENDS, max_memory as f64 / END_BYTES);
        if self.grown.skeleton.paths.len() as f64 + counted > most {
            let message = format!(
                "round {} would have {counted} ends, more than the {most:.0} that there is memory for: use fewer rounds, lower counts or shorter lifespans",
                self.round + 1
            );
            return Err(GrowError::Scene { place: format!("grow.{}.repeat.times", self.step.name), message });
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
            let message = format!(
                "round {} could place none of its {counted} endpoints: make `inside` or `shell` larger, `apart` or the spacing smaller",
                self.round + 1
            );
            return Err(GrowError::Scene { place: format!("grow.{}.to", self.step.name), message });
        }
        progress.report("grow", f64::from(self.round + 1) / f64::from(self.repeat.times))?;
        let level = self.level + self.round as u16;
        for ((end, share), sprout) in ends.iter().zip(&shares).zip(sprouts) {
            self.join(end, share, sprout, level, &stream);
        }
        self.round += 1;
        Ok(())
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
            .map_err(|error| self.wrong_space(error.to_string()))?;
        wanted.into_iter().zip(made).for_each(|(set, graph)| self.sets[set] = Some(graph));
        Ok(())
    }

    fn wrong_space(&self, message: String) -> GrowError {
        GrowError::Scene { place: format!("space.{}.nodes", self.step.space_name), message }
    }

    fn up(&self) -> DVec3 {
        if self.space.is_plane { DVec3::Y } else { DVec3::Z }
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
            Placement::Random { count, .. } => share.count.unwrap_or(count.at(index) as u32),
            Placement::At(_) | Placement::Near(_) | Placement::Through(_) => 0,
        });
        sets.collect()
    }

    /// Where the space around an end is; `own` is the end's stream.
    fn place(&self, end: &End, share: &Share, own: &Stream) -> Place {
        let at = self.grown.skeleton.nodes[end.node as usize].position;
        let index = self.index(end);
        let mut way = match self.repeat.orient {
            Orient::Outward => end.way,
            Orient::Up => self.up(),
            Orient::Down => -self.up(),
            Orient::Along(along) => along.0.normalize_or(DVec3::Z),
            Orient::Random => {
                let mut random = Stream::new(self.seed, &format!("ways/{}", self.step.name)).nth(end.name);
                let z: f64 = if self.space.is_plane { 0.0 } else { random.random_range(-1.0..1.0) };
                let turn = std::f64::consts::TAU * random.random::<f64>();
                let across = libm::sqrt(1.0 - z * z);
                DVec3::new(across * libm::cos(turn), across * libm::sin(turn), z)
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
                way = turned_toward(way, target, turn.by.at(index) * (std::f64::consts::PI / 180.0));
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
        Place { at, turn, size }
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
                    .map_err(|error| self.wrong_space(error.to_string()))?;
                &alone
            }
        };
        let mut wanted: Vec<(Node, u16)> = Vec::new();
        let mut taken = vec![false; graph.len()];
        taken[0] = true;
        for (i, (set, count)) in self.step.endpoints.iter().zip(counts).enumerate() {
            let Placement::Random { inside, apart, shell, .. } = &set.placement else { continue };
            let inside = inside.as_ref().unwrap_or(&self.space.shape);
            let fits = |p: DVec3| inside.contains(p) && shell.is_none_or(|d| inside.depth(p) <= d);
            let chosen = choose(graph, &mut taken, count, *apart, fits, &own.nth(1 + i as u64));
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
                    return Err(GrowError::Scene {
                        place: format!("grow.{}.to", self.step.name),
                        message: format!(
                            "no path reaches the endpoint at {}: join more nodes, or set `unreached = \"drop\"`",
                            place.put(graph.position(node))
                        ),
                    });
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
        sprout.marks = scattered_marks(graph, &[&self.space.shape], &nodes, show)
            .map_err(|message| self.wrong_space(message))?
            .into_iter()
            .map(|mark| Mark { line: mark.line.into_iter().map(|p| place.put(p)).collect(), ..mark })
            .collect();
        Ok(sprout)
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

impl LifespanSpec {
    /// How much shorter the lifespan of a new end is, where that of the one it sprouted from is `lifespan`.
    fn lose(&self, lifespan: u32, random: &mut Stream) -> u32 {
        let u: f64 = random.random();
        match &self.loss {
            Loss::Constant(loss) => *loss,
            Loss::Random(end) if u < *end => lifespan,
            Loss::Random(_) => (libm::ceil(random.random::<f64>() * f64::from(lifespan)) as u32).max(1),
            Loss::Chances(chances) => {
                let mut sum = 0.0;
                let drawn = chances.iter().find(|[chance, _]| {
                    sum += chance;
                    u < sum
                });
                drawn.or(chances.last()).map_or(1, |[_, loss]| *loss as u32).max(1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 30 % end, and the others lose a part that is even over 1 to their lifespan (2012, section 3.3.3).
    #[test]
    fn lifespans_are_lost_as_the_paper_has_it() {
        let spec = LifespanSpec { first: 5, loss: Loss::Random(0.3) };
        let mut random = Stream::new(1, "loss");
        let mut counts = [0_u32; 6];
        let n = 20_000;
        for _ in 0..n {
            counts[spec.lose(5, &mut random) as usize] += 1;
        }
        // A loss of 5 ends it too: 0.3, and a fifth of 0.7.
        let expected = [0.0, 0.14, 0.14, 0.14, 0.14, 0.44].map(|share| share * f64::from(n));
        let chi2: f64 = (1..6)
            .map(|i| (f64::from(counts[i]) - expected[i]) * (f64::from(counts[i]) - expected[i]) / expected[i])
            .sum();
        assert!(counts[0] == 0 && chi2 < 18.5, "{counts:?}: chi-squared {chi2} over 4 degrees of freedom");
        let spec = LifespanSpec { first: 5, loss: Loss::Chances(vec![[0.25, 1.0], [0.75, 3.0]]) };
        let threes = (0..n).filter(|_| spec.lose(5, &mut random) == 3).count() as f64 / f64::from(n);
        assert!((threes - 0.75).abs() < 0.02);
    }
}
