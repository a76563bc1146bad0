//! The voxel space automaton (Greene 1989): limbs sense light, other growth and surfaces, and grow in rounds, each against what
//! the rounds before made.

use std::any::Any;
use std::sync::Arc;

use rand::RngExt;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::light::LightSense;
use super::neighbourhood::{Near, Neighbourhood};
use crate::geom::{Occupancy, Shape};
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::{Grown, NODE_BYTES, bits};
use crate::grow::limb_starts::{Start, branch_name};
use crate::grow::segments::{Attractor, strayed};
use crate::grow::space::Space;
use crate::grow::spaces::VoxelSpace;
use crate::grow::step::{Context, Generators, Method, Step, Yield};
use crate::math::{DVec3, Stream};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// Rays start so many voxels away from their limb, and meet growth only beyond its foliage: it does not shade itself.
const OFF: f64 = 1.5;
/// Other growth counts up to this many times the least distance from it.
const ROOM: f64 = 4.0;
/// A direction that is bent to a surface keeps at least this share of its step, and grows to no more than the other.
const BENT: [f64; 2] = [0.5, 1.5];
/// Farther back nobody is a relative.
const MOST_KIN: usize = 64;
/// How often a direction is bent, and a point where a limb starts.
const BENDS: usize = 3;
const START_BENDS: usize = 16;

/// Growth by voxels, with its names resolved; angles are in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Automaton {
    /// How far a limb grows in a round, in scene units.
    pub step: f64,
    /// Rounds.
    pub rounds: u32,
    /// Nodes at most.
    pub nodes: u32,
    /// Directions that a limb tries.
    pub tries: u32,
    /// Least and greatest angle of these from its way.
    pub turn: [f64; 2],
    /// Least and greatest age at which limbs branch, and the angle.
    pub branches: Option<([u32; 2], [f64; 2])>,
    /// Least distance from other growth.
    pub apart: f64,
    /// What it counts to be far from that.
    pub room: f64,
    /// What it counts to go straight on.
    pub straight: f64,
    /// What light counts.
    pub light: LightSense,
    /// How far leaves reach around every node.
    pub foliage: f64,
    /// What it clings to.
    pub cling: Option<Cling>,
    /// What it keeps from, and how far.
    pub keep_from: Option<(Shape, f64)>,
    /// The way of limbs that start at points, of length 1.
    pub heading: DVec3,
    /// What it tends to.
    pub toward: Option<Attractor>,
}

/// A surface to cling to.
#[derive(Clone, Debug, PartialEq)]
pub struct Cling {
    /// The shape whose surface it is.
    pub to: Shape,
    /// Least and greatest distance from it.
    pub within: [f64; 2],
}

/// A limb that is alive.
#[derive(Clone)]
struct Tip {
    /// The plant that it belongs to.
    plant: usize,
    start: Start,
    node: u32,
    limb: u32,
    age: u32,
    /// The age of its next branch.
    due: u32,
    /// Does it leave another limb here?
    is_branch: bool,
}

/// What a tip would best do.
#[derive(Clone, Copy)]
struct Choice {
    score: f64,
    at: DVec3,
}

/// A step while it grows.
struct Plant<'a> {
    step: &'a Step,
    own: &'a Automaton,
    stream: Stream,
    skeleton: Skeleton,
}

/// How `step` grows by voxels, if it does.
fn automaton(step: &Step) -> Option<&Automaton> {
    let method: &dyn Any = step.method.as_ref();
    method.downcast_ref()
}

impl Method for Automaton {
    fn name(&self) -> &'static str {
        "voxels"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let mut all = self.grow_together(&[step], &[], context)?;
        all.pop().ok_or_else(|| step.error(Key::Space, Problem::NoSpace))
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        match &step.space {
            // What grows asks as it grows.
            Some(Space::Voxels(space)) => space.bytes_needed(),
            _ => 0,
        }
    }

    fn yields(&self) -> Yield {
        Yield::Limbs
    }

    fn shapes(&self) -> Vec<&Shape> {
        let cling = self.cling.iter().map(|cling| &cling.to);
        cling.chain(self.keep_from.iter().map(|(shape, _)| shape)).collect()
    }

    fn with_shapes(&self, change: &dyn Fn(&Shape) -> Shape) -> Option<Arc<dyn Method>> {
        let mut own = self.clone();
        own.cling.iter_mut().for_each(|cling| cling.to = change(&cling.to));
        own.keep_from.iter_mut().for_each(|(shape, _)| *shape = change(shape));
        Some(Arc::new(own))
    }

    fn is_shared(&self) -> bool {
        true
    }

    fn grow_together(
        &self,
        steps: &[&Step],
        before: &[(&Step, &Skeleton)],
        context: &Context<'_>,
    ) -> Result<Vec<Grown>, GrowError> {
        let Some(first) = steps.first() else { return Ok(Vec::new()) };
        let Some(Space::Voxels(space)) = &first.space else {
            return Err(first.error(Key::Space, Problem::WrongSpace("voxels")));
        };
        let (skeletons, voxels) = grow_garden(steps, space, before, context)?;
        let finish = |(step, skeleton): (&&Step, Skeleton)| {
            let settled = skeleton.nodes.len() as u64;
            step.finish_with(Grown { nodes: voxels, settled, ..Grown::default() }, skeleton, context)
        };
        steps.iter().zip(skeletons).map(finish).collect()
    }
}

impl Automaton {
    /// The normal of the surface that it clings to, at `p`.
    fn normal(&self, to: &Shape, p: DVec3) -> DVec3 {
        let off = self.step * 1e-3;
        DVec3::from_array(DVec3::AXES.map(|axis| to.distance(p + axis * off) - to.distance(p - axis * off)))
            .normalize_or_zero()
    }

    /// `p`, bent to the surface that growth clings to, if there is one, by so many tries.
    fn bent(&self, mut p: DVec3, tries: usize) -> Option<DVec3> {
        let Some(Cling { to, within: [least, most] }) = &self.cling else { return Some(p) };
        for _ in 0..tries {
            let d = to.distance(p);
            if (*least..=*most).contains(&d) {
                return Some(p);
            }
            p += self.normal(to, p) * ((least + most) * 0.5 - d);
        }
        None
    }

    /// Where a step from `from` along `way` leads.
    fn lead(&self, from: DVec3, way: DVec3) -> Option<DVec3> {
        let at = self.bent(from + way * self.step, BENDS)?;
        let length = (at - from).length() / self.step;
        (self.cling.is_none() || (BENT[0]..=BENT[1]).contains(&length)).then_some(at)
    }

    /// The best that `tip` can do against what has grown; none where no direction is open.
    fn choose(&self, tip: &Tip, garden: &Garden<'_>, near: &Near<'_>, mut random: Stream) -> Option<Choice> {
        let Garden { space, voxels, .. } = garden;
        let solids = garden.solids.as_ref();
        let Start { at: from, way, .. } = tip.start;
        let angles = self.branches.filter(|_| tip.is_branch).map_or(self.turn, |(_, angles)| angles);
        let off = voxels.side() * OFF;
        let is_open = |p: DVec3| {
            space.shape.contains(p)
                && !space.forbid.as_ref().is_some_and(|forbid| forbid.contains(p))
                && self.keep_from.as_ref().is_none_or(|(shape, by)| shape.distance(p) >= *by)
        };
        let is_free = |at: DVec3| {
            // Nothing thicker than a voxel is stepped over.
            let pieces = libm::ceil((at - from).length() / voxels.side()).max(2.0) as u32;
            (1..=pieces).all(|i| is_open(from + (at - from) * (f64::from(i) / f64::from(pieces))))
                && !near.is_in_the_way(from, at, self.apart)
        };
        // What each counts without room and light, and with all of both.
        let mut tried: Vec<(f64, f64, DVec3, DVec3)> = Vec::with_capacity(self.tries as usize);
        for _ in 0..self.tries {
            let aim = strayed(way, angles, &mut random);
            let Some(at) = self.lead(from, aim) else { continue };
            let went = (at - from).normalize_or(aim);
            let mut score = self.straight * went.dot(way);
            if let Some(Attractor { at: goal, strength }) = self.toward {
                score += strength * went.dot((goal - at).normalize_or_zero());
            }
            tried.push((score + self.room.max(0.0) + self.light.score(went, |_| true), score, at, went));
        }
        // What is costly is not asked of what could not be the best even with all room and light.
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Option<Choice> = None;
        for (most, mut score, at, went) in tried {
            if best.is_some_and(|best| most <= best.score) {
                break;
            }
            if !is_free(at) {
                continue;
            }
            if self.room > 0.0 {
                // Relatives are not in the way, but they take room: so branches part.
                let nearest = near.distance(at, ROOM * self.apart);
                score += self.room * (nearest / (ROOM * self.apart).max(f64::MIN_POSITIVE));
            }
            let is_lit = |ray: DVec3| {
                !solids.is_some_and(|solids| solids.is_blocked(at, ray, off))
                    && !voxels.is_blocked(at, ray, off + self.foliage)
            };
            score += self.light.score(went, is_lit);
            if best.is_none_or(|best| score > best.score) {
                best = Some(Choice { score, at });
            }
        }
        best
    }

    /// The age of the next branch after `age`.
    fn due(&self, age: u32, random: &mut Stream) -> u32 {
        self.branches.map_or(u32::MAX, |([least, most], _)| age + random.random_range(least..=most))
    }

    /// How far relatives are not in each other's way, in nodes.
    fn kin(&self) -> usize {
        (libm::ceil(self.apart / self.step * 2.0) as usize + 2).min(MOST_KIN)
    }
}

/// A piece of a limb takes up voxels, with its leaves.
fn take_up(voxels: &mut Occupancy, from: DVec3, to: DVec3, foliage: f64) {
    voxels.insert_line(from, to);
    if foliage > 0.0 {
        voxels.insert_ball(to, foliage);
    }
}

/// A space with all that grows in it.
struct Garden<'a> {
    space: &'a VoxelSpace,
    plants: Vec<Plant<'a>>,
    voxels: Occupancy,
    /// What is forbidden alone, where there is foliage that light goes through.
    solids: Option<Occupancy>,
    others: Neighbourhood,
    tips: Vec<Tip>,
    /// The greatest least distance that anything here keeps.
    apart: f64,
}

/// Grows `steps` together in `space`, which are all by voxels, among what `before` grew there: each one's skeleton, and the
/// number of voxels that something is in.
fn grow_garden(
    steps: &[&Step],
    space: &VoxelSpace,
    before: &[(&Step, &Skeleton)],
    context: &Context<'_>,
) -> Result<(Vec<Skeleton>, u64), GrowError> {
    let mut plants: Vec<Plant<'_>> = Vec::with_capacity(steps.len());
    for step in steps {
        let Some(own) = automaton(step) else { continue };
        let stream = Stream::new(context.seed, &format!("voxels/{}", step.name));
        plants.push(Plant { step, own, stream, skeleton: Skeleton::new(step.classes.clone()) });
    }
    // How far is asked for, and the longest piece that could reach to there.
    let most = |of: &dyn Fn(&Automaton) -> f64| plants.iter().map(|p| of(p.own)).fold(0.0, f64::max);
    let before_apart = before.iter().filter_map(|(step, _)| automaton(step)).map(|own| own.apart).fold(0.0, f64::max);
    let apart = most(&|own| own.apart).max(before_apart);
    let asked = apart * ROOM + most(&|own| own.step) * BENT[1];
    let steps = plants.iter().map(|p| p.own.step * BENT[1]);
    let pieces = before.iter().flat_map(|(_, s)| s.segments()).map(|(a, b)| a.position.distance(b.position));
    let longest = steps.chain(pieces).fold(0.0, f64::max);
    let voxels = space.voxels();
    let solids = (space.forbid.is_some() && most(&|own| own.foliage) > 0.0).then(|| voxels.clone());
    let others = Neighbourhood::new(asked + longest);
    let mut garden = Garden { space, plants, voxels, solids, others, tips: Vec::new(), apart };
    garden.sow(before, context)?;
    let rounds = garden.plants.iter().map(|plant| plant.own.rounds).max().unwrap_or(0);
    for round in 0..rounds {
        context.memory.ask(garden.bytes_ahead())?;
        let choices = garden.choose(round);
        garden.grow(&choices, round);
        if round == 0
            && let Some(plant) = garden.plants.iter().find(|plant| plant.is_stuck())
        {
            return Err(plant.wrong(Problem::Stuck));
        }
        if garden.tips.is_empty() {
            break;
        }
        context.progress.report("grow", f64::from(round + 1) / f64::from(rounds))?;
    }
    Ok((garden.plants.into_iter().map(Plant::finish).collect(), garden.voxels.count()))
}

impl Garden<'_> {
    /// Bytes that it takes when every tip has grown once more, and branched.
    fn bytes_ahead(&self) -> u64 {
        let nodes: usize = self.plants.iter().map(|plant| plant.skeleton.nodes.len()).sum();
        let voxels = self.voxels.bytes() * (1 + usize::from(self.solids.is_some()));
        voxels as u64 + (nodes + 2 * self.tips.len()) as u64 * NODE_BYTES
    }

    /// Puts in what grew before, and the tips that all plants start with.
    fn sow(&mut self, before: &[(&Step, &Skeleton)], context: &Context<'_>) -> Result<(), GrowError> {
        let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        for (step, skeleton) in before {
            let (foliage, apart) = automaton(step).map_or((0.0, 0.0), |own| (own.foliage, own.apart));
            let mut numbers: Vec<u32> = Vec::with_capacity(skeleton.nodes.len());
            for node in &skeleton.nodes {
                let from = node.parent.map_or(node.position, |p| skeleton.nodes[p as usize].position);
                take_up(&mut self.voxels, from, node.position, foliage);
                let parent = node.parent.map(|p| numbers[p as usize]);
                let number = self.others.add(from, node.position, parent, u32::MAX, apart);
                numbers.push(number);
                known.entry(bits(node.position)).or_insert(number);
            }
        }
        for (index, plant) in self.plants.iter_mut().enumerate() {
            self.tips.extend(plant.sow(index, self.space, &known, &mut self.others, context)?);
        }
        Ok(())
    }

    /// What each tip would best do against what the rounds before made.
    fn choose(&self, round: u32) -> Vec<Option<Choice>> {
        let choose = |tip: &Tip| {
            let Plant { own, stream, .. } = &self.plants[tip.plant];
            if round >= own.rounds {
                return None;
            }
            let reach = (own.apart * ROOM).max(self.apart) + own.step * BENT[1];
            let near = self.others.near(0, tip.start.at, reach, tip.node, own.kin());
            let random = stream.nth(tip.start.name).nth(u64::from(round));
            own.choose(tip, self, &near, random)
        };
        self.tips.par_iter().with_min_len(8).map(choose).collect()
    }

    /// Lets all grow that can, the best first, of equals the one that began first; tips that had no choice are gone.
    fn grow(&mut self, choices: &[Option<Choice>], round: u32) {
        let mut order: Vec<(usize, Choice)> =
            choices.iter().enumerate().filter_map(|(i, choice)| Some((i, (*choice)?))).collect();
        order.sort_by(|(i, a), (j, b)| b.score.total_cmp(&a.score).then(i.cmp(j)));
        let fresh = self.others.len();
        let mut is_alive = vec![false; self.tips.len()];
        let mut begun: Vec<(usize, Tip)> = Vec::new();
        for (i, Choice { at, .. }) in order {
            let tip = &mut self.tips[i];
            let plant = &mut self.plants[tip.plant];
            let own = plant.own;
            is_alive[i] = plant.skeleton.nodes.len() < own.nodes as usize;
            if !is_alive[i] {
                continue;
            }
            let from = tip.start.at;
            let near = self.others.near(fresh, from, self.apart + own.step * BENT[1], tip.node, own.kin());
            // Another was first: it tries again next round.
            if near.is_in_the_way(from, at, own.apart) {
                continue;
            }
            take_up(&mut self.voxels, from, at, own.foliage);
            begun.extend(plant.extend(tip, at, round, &mut self.others).map(|branch| (i, branch)));
        }
        let mut is_alive = is_alive.into_iter();
        self.tips.retain(|_| is_alive.next().unwrap_or(false));
        // In the order of the limbs that they leave.
        begun.sort_by_key(|(i, _)| *i);
        for (_, mut branch) in begun {
            let plant = &mut self.plants[branch.plant];
            let root = plant.skeleton.paths[branch.limb as usize].root;
            branch.limb = plant.begin(branch.start.name, root);
            self.tips.push(branch);
        }
    }
}

impl Plant<'_> {
    /// An error about where it starts.
    fn wrong(&self, problem: Problem) -> GrowError {
        self.step.error(Key::From, problem)
    }

    /// Has nothing grown from the points that it starts at?
    fn is_stuck(&self) -> bool {
        matches!(self.step.source, Generators::At(_)) && self.skeleton.nodes.iter().all(|node| node.parent.is_none())
    }

    /// The tips that it starts with; `known` has what grew before, by place.
    fn sow(
        &mut self,
        index: usize,
        space: &VoxelSpace,
        known: &FxHashMap<[u64; 3], u32>,
        others: &mut Neighbourhood,
        context: &Context<'_>,
    ) -> Result<Vec<Tip>, GrowError> {
        let mut tips = Vec::new();
        for mut start in self.step.starts_of_limbs(self.own.heading, context)? {
            if matches!(self.step.source, Generators::At(_)) {
                let bent = self.own.bent(start.at, START_BENDS);
                start.at = bent.ok_or_else(|| self.wrong(Problem::NothingToClingTo(start.at)))?;
            }
            let is_open =
                space.shape.contains(start.at) && !space.forbid.as_ref().is_some_and(|f| f.contains(start.at));
            if !is_open {
                return Err(self.wrong(Problem::StartsForbidden(start.at)));
            }
            let limb = self.begin(start.name, self.skeleton.nodes.len() as u32);
            let root = SkeletonNode { branch: limb, ..SkeletonNode::new(start.at, None, 0.0, 0) };
            // What it grows from is no stranger.
            let before = known.get(&bits(start.at)).copied();
            let node = self.push(root, before, others);
            let due = self.own.due(0, &mut self.stream.nth(start.name).nth(u64::MAX));
            tips.push(Tip { plant: index, start, node, limb, age: 0, due, is_branch: false });
        }
        Ok(tips)
    }

    /// Begins a limb of the tree with this root; its number.
    fn begin(&mut self, name: u64, root: u32) -> u32 {
        self.skeleton.paths.push(Path { end: root, root, name, ..Path::default() });
        self.skeleton.paths.len() as u32 - 1
    }

    /// Adds a node that grew from the one with the number `before`; its own number among all.
    fn push(&mut self, node: SkeletonNode, before: Option<u32>, others: &mut Neighbourhood) -> u32 {
        let from = node.parent.map_or(node.position, |parent| self.skeleton.nodes[parent as usize].position);
        let number = others.add(from, node.position, before, self.skeleton.nodes.len() as u32, self.own.apart);
        self.skeleton.nodes.push(node);
        number
    }

    /// Lets `tip` grow to `at`; the branch that leaves it there, if one is due.
    fn extend(&mut self, tip: &mut Tip, at: DVec3, round: u32, others: &mut Neighbourhood) -> Option<Tip> {
        let parent = others.own(tip.node);
        let before = self.skeleton.nodes[parent as usize];
        let way = at - before.position;
        let made = SkeletonNode::new(at, Some(parent), before.cost + way.length(), 0);
        tip.node = self.push(SkeletonNode { branch: tip.limb, ..made }, Some(tip.node), others);
        tip.start = Start { at, way: way.normalize_or(tip.start.way), ..tip.start };
        tip.age += 1;
        tip.is_branch = false;
        if tip.age < tip.due {
            return None;
        }
        let name = branch_name(tip.start.name, tip.age, 0);
        tip.due = self.own.due(tip.age, &mut self.stream.nth(tip.start.name).nth(u64::MAX - 1 - u64::from(round)));
        let due = self.own.due(0, &mut self.stream.nth(name).nth(u64::MAX));
        Some(Tip { start: Start { name, ..tip.start }, age: 0, due, is_branch: true, ..tip.clone() })
    }

    /// What it grew: limbs that never did have no path.
    fn finish(self) -> Skeleton {
        let Skeleton { nodes, paths, classes } = self.skeleton;
        let mut end = vec![None; paths.len()];
        nodes.iter().zip(0..).for_each(|(node, i): (_, u32)| end[node.branch as usize] = Some(i));
        let mut renamed = vec![0; paths.len()];
        let mut kept = Vec::with_capacity(paths.len());
        for (i, (path, end)) in paths.into_iter().zip(end).enumerate() {
            renamed[i] = kept.len() as u32;
            kept.extend(end.map(|end| Path { end, ..path }));
        }
        let nodes = nodes.into_iter().map(|n| SkeletonNode { branch: renamed[n.branch as usize], ..n }).collect();
        Skeleton { nodes, paths: kept, classes }
    }
}
