//! Stems grow segment by segment, split, and bear stems of the next level.

use rand::RngExt;

use super::spec::WeberPennSpec;
use super::stem::{Stem, stray};
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::{Grown, MOST_NODES, NODE_BYTES};
use crate::grow::step::{Context, Generators, Method, Step};
use crate::math::{DMat3, DVec3, Stream, mix, name_of, rotation};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

impl Method for WeberPennSpec {
    fn name(&self) -> &'static str {
        "weber_penn"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let Generators::At(points) = &step.source else { return Err(step.error(Key::From, Problem::NotGrown)) };
        let stream = Stream::new(context.seed, &format!("weber_penn/{}", step.name));
        let mut tree = Tree { own: self, step, context, stream, skeleton: Skeleton::new(step.classes.clone()) };
        for (&at, name) in points.iter().zip(0..) {
            tree.plant(at, mix(name))?;
        }
        let skeleton = tree.skeleton;
        step.finish_with(Grown { settled: skeleton.nodes.len() as u64, ..Grown::default() }, skeleton, context)
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        let trees = if let Generators::At(points) = &step.source { points.len() } else { 1 };
        let nodes = (self.expected() * trees as f64).min(MOST_NODES as f64);
        nodes as u64 * NODE_BYTES * u64::from(step.parts())
    }
}

impl WeberPennSpec {
    /// About how many nodes a tree has, where every stem is as long as its level allows.
    fn expected(&self) -> f64 {
        let (mut stems, mut nodes) = (1.0, 0.0);
        for (level, own) in self.levels.iter().enumerate() {
            let splits =
                (1..own.segments).fold(1.0, |stems, _| stems * (1.0 + own.splits)) + f64::from(own.base_splits);
            let born = self.levels.get(level + 1).map_or(0.0, |next| next.branches);
            nodes += stems * (splits * f64::from(own.segments) + born);
            stems *= born;
        }
        nodes
    }
}

/// Trees while they grow.
struct Tree<'a> {
    own: &'a WeberPennSpec,
    step: &'a Step,
    context: &'a Context<'a>,
    stream: Stream,
    skeleton: Skeleton,
}

/// What a stem carries on from segment to segment.
struct Along {
    random: Stream,
    /// Parts of stems and of splits that have not come out yet.
    owed: [f64; 2],
    /// Where the last stem left it.
    turn: f64,
}

impl Tree<'_> {
    /// Grows a tree at a point.
    fn plant(&mut self, at: DVec3, name: u64) -> Result<(), GrowError> {
        let mut random = self.stream.nth(name);
        let own = self.own;
        let scale = (own.scale + stray(own.scale_v, &mut random)).max(0.0);
        let length = scale * own.levels[0].length_max(&mut random);
        let node = self.skeleton.nodes.len() as u32;
        self.skeleton.nodes.push(SkeletonNode::new(at, None, 0.0, 0));
        let frame = DMat3::IDENTITY;
        let trunk = Stem { level: 0, node, segment: 0, frame, length, vigour: 1.0, back: 0.0, share: 1.0, name };
        self.grow(trunk)
    }

    /// Grows a stem with all that it bears.
    fn grow(&mut self, stem: Stem) -> Result<(), GrowError> {
        let mut waiting = vec![stem];
        while let Some(stem) = waiting.pop() {
            self.context.progress.check()?;
            self.grow_on(stem, &mut waiting)?;
        }
        Ok(())
    }

    /// Grows what is left of a stem; what splits off and what it bears waits.
    fn grow_on(&mut self, mut stem: Stem, waiting: &mut Vec<Stem>) -> Result<(), GrowError> {
        let (own, level) = (self.own, &self.own.levels[stem.level]);
        let mut random = self.stream.nth(name_of(stem.name, 1 + u64::from(stem.segment)));
        let owed = [random.random::<f64>() - 0.5, random.random::<f64>() - 0.5];
        let turn = std::f64::consts::TAU * random.random::<f64>();
        let mut along = Along { random, owed, turn };
        while stem.segment < level.segments {
            if stem.segment > 0 {
                let bend = level.bend(stem.segment, &mut along.random);
                stem.bend(bend - stem.back);
            }
            if stem.level >= 2 {
                stem.lift(own.attraction_up, level.segments);
            }
            self.add_segment(&mut stem, &mut along, waiting)?;
            stem.segment += 1;
            if stem.segment < level.segments {
                self.split(&mut stem, &mut along, waiting);
            }
        }
        let name = self.skeleton.paths.len() as u64;
        self.skeleton.paths.push(Path { end: stem.node, name, ..Path::default() });
        Ok(())
    }

    /// Adds a segment, with a node for each stem that leaves it.
    fn add_segment(&mut self, stem: &mut Stem, along: &mut Along, waiting: &mut Vec<Stem>) -> Result<(), GrowError> {
        let own = self.own;
        let segments = f64::from(own.levels[stem.level].segments);
        let each = stem.length / segments;
        let (way, from) = (stem.frame.z_axis, f64::from(stem.segment) / segments);
        let start = self.skeleton.nodes[stem.node as usize].position;
        // The part of the segment that bears stems.
        let bare = own.bare(stem.level);
        let first = ((bare - from) * segments).clamp(0.0, 1.0);
        let born = own.count(stem) * stem.share * (1.0 - first) / (segments * (1.0 - bare)) + along.owed[0];
        let count = libm::round(born).max(0.0);
        along.owed[0] = born - count;
        for i in 0..count as u32 {
            let share = first + (1.0 - first) * (f64::from(i) + 0.5) / count;
            self.add(stem, start + way * (each * share))?;
            let born = self.bear(stem, stem.length * from + each * share, along);
            waiting.extend(born);
        }
        self.add(stem, start + way * each)
    }

    /// Adds a node to `stem`.
    fn add(&mut self, stem: &mut Stem, at: DVec3) -> Result<(), GrowError> {
        let count = self.skeleton.nodes.len() as u64;
        if count >= MOST_NODES {
            return Err(self.step.error(Key::Method, Problem::TooManyNodes { count, most: MOST_NODES }));
        }
        let parent = self.skeleton.nodes[stem.node as usize];
        let cost = parent.cost + parent.position.distance(at);
        let node = SkeletonNode { level: stem.level as u16, ..SkeletonNode::new(at, Some(stem.node), cost, 0) };
        stem.node = count as u32;
        self.skeleton.nodes.push(node);
        Ok(())
    }

    /// A stem of the next level that leaves the last node of `stem`, at `offset` along it (sections 4.2 and 4.3); `None` where it
    /// would have no length.
    fn bear(&self, stem: &Stem, offset: f64, along: &mut Along) -> Option<Stem> {
        let next = &self.own.levels[stem.level + 1];
        let random = &mut along.random;
        let rotate = next.rotate.radians();
        let strayed = stray(next.rotate_v.radians(), random);
        along.turn = if rotate >= 0.0 {
            along.turn + rotate + strayed
        } else {
            // From side to side.
            along.turn + std::f64::consts::PI
        };
        let about = if rotate >= 0.0 { along.turn } else { along.turn + rotate + strayed };
        let down = self.own.down(stem, offset, random);
        let (length, vigour) = self.own.child_length(stem, offset, random);
        let frame = stem.frame * rotation(DVec3::Z, about) * rotation(DVec3::X, down);
        let name = name_of(stem.name, u64::from(stem.node) << 1 | 1);
        let child = Stem {
            level: stem.level + 1,
            node: stem.node,
            segment: 0,
            frame,
            length,
            vigour,
            back: 0.0,
            share: 1.0,
            name,
        };
        (length > 0.0).then_some(child)
    }

    /// Splits a stem at the end of a segment (section 4.2): all that come of it part, and bend back over what is left.
    fn split(&self, stem: &mut Stem, along: &mut Along, waiting: &mut Vec<Stem>) {
        let level = &self.own.levels[stem.level];
        let is_base = stem.level == 0 && stem.segment == 1 && level.base_splits > 0;
        let wanted = if is_base { f64::from(level.base_splits) } else { level.splits + along.owed[1] };
        let count = libm::round(wanted).max(0.0);
        if !is_base {
            along.owed[1] = wanted - count;
        }
        if count == 0.0 {
            return;
        }
        stem.share /= count + 1.0;
        let left = f64::from(level.segments - stem.segment);
        let whole = *stem;
        for i in 0..=count as u32 {
            let random = &mut along.random;
            let mut part = whole;
            let declination = part.declination();
            let angle = level.split_angle.radians() + stray(level.split_angle_v.radians(), random);
            let angle = (angle - declination).max(0.0);
            // About the upright: around it in equal parts at the base, else apart to either side.
            let spread = if is_base {
                std::f64::consts::TAU * f64::from(i) / (count + 1.0)
            } else {
                let u: f64 = random.random();
                let tilt = (declination.to_degrees() + 30.0 - 90.0).abs();
                let apart = (20.0 + 0.75 * (30.0 + tilt) * u * u).to_radians();
                if i == 0 { 0.0 } else { libm::copysign(apart, f64::from(i % 2) - 0.5) * f64::from(i.div_ceil(2)) }
            };
            part.bend(angle);
            part.spread(spread);
            part.back = angle / left;
            if i == 0 {
                *stem = part;
            } else {
                waiting
                    .push(Stem { name: name_of(whole.name, u64::from(whole.node) << 1 | u64::from(i) << 33), ..part });
            }
        }
    }
}
