//! Diffusion-limited aggregation, the baseline that path planning imitates (Witten and Sander 1981; Xu and Mould 2007, section
//! 2 and Fig. 11): particles walk at random until they touch what has grown, and stay there.

use rand::RngExt;

use super::spec::{DlaSpec, Walk};
use crate::graph::{Graph, Lattice, Node};
use crate::grow::error::GrowError;
use crate::grow::grown::Grown;
use crate::grow::lookup::Lookup;
use crate::grow::site::Site;
use crate::grow::space::Space;
use crate::grow::spaces::OnLattice;
use crate::grow::starts::starts;
use crate::grow::step::{Context, Method, Step};
use crate::grow::trial::try_places;
use crate::math::{Cancelled, DVec3, Progress, Stream, from_height};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// Walkers of the fast walk start over when they are this many times as far away as what has grown.
const LOST: f64 = 20.0;
/// Looked up each time so many particles have come to stay.
const CHECK: u32 = 64;
/// Levels of the pyramid.
const LEVELS: usize = 12;
/// So many in a row that stay beyond the border: the space is full.
const MOST_LOST: u32 = 1000;
/// Steps of a walker, at most: then it is lost.
const MOST_STEPS: u64 = 1 << 36;
/// A walker that could not move so often in a row is stuck.
const MOST_STUCK: u32 = 4096;
/// Steps between looks whether to stop.
const LOOK: u64 = 1 << 20;

/// Which cells hold particles, in cells of the spacing and of twice, four times ... that.
struct Pyramid {
    size: [usize; 3],
    levels: Vec<Vec<u64>>,
}

impl Pyramid {
    fn new(size: [u32; 3]) -> Self {
        let size = size.map(|s| s as usize);
        let levels = (0..LEVELS).map(|level| vec![0; Self::cells(size, level).div_ceil(64)]).collect();
        Self { size, levels }
    }

    fn dims(size: [usize; 3], level: usize) -> [usize; 3] {
        size.map(|s| ((s - 1) >> level) + 1)
    }

    fn cells(size: [usize; 3], level: usize) -> usize {
        Self::dims(size, level).iter().product()
    }

    fn set(&mut self, at: [i64; 3]) {
        for level in 0..LEVELS {
            let [nx, ny, _] = Self::dims(self.size, level);
            let [x, y, z] = at.map(|c| c as usize >> level);
            let i = x + nx * (y + ny * z);
            self.levels[level][i / 64] |= 1 << (i % 64);
        }
    }

    /// Is the cell of this level, or one around it, taken?
    fn is_near(&self, at: [i64; 3], level: usize) -> bool {
        let [nx, ny, nz] = Self::dims(self.size, level).map(|n| n as i64);
        let [x, y, z] = at.map(|c| c >> level);
        let depth = i64::from(self.size[2] > 1);
        for z in (z - depth).max(0)..=(z + depth).min(nz - 1) {
            for y in (y - 1).max(0)..=(y + 1).min(ny - 1) {
                for x in (x - 1).max(0)..=(x + 1).min(nx - 1) {
                    let i = (x + nx * (y + ny * z)) as usize;
                    if self.levels[level][i / 64] >> (i % 64) & 1 == 1 {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// How many cells in every direction are free for sure.
    fn free(&self, at: [i64; 3]) -> f64 {
        (0..LEVELS).take_while(|&level| !self.is_near(at, level)).last().map_or(0.0, |level| (1_u64 << level) as f64)
    }
}

/// What has grown: particles in steps of the lattice, from its first node.
struct Cluster {
    places: Vec<DVec3>,
    parents: Vec<Option<u32>>,
    pyramid: Pyramid,
    /// For each cell the last particle in it, and for each particle the one before in its cell.
    heads: Vec<u32>,
    before: Vec<u32>,
    size: [u32; 3],
    middle: DVec3,
    radius: f64,
    is_flat: bool,
}

impl Cluster {
    fn cell(&self, p: DVec3) -> [i64; 3] {
        p.to_array().map(|c| libm::floor(c + 0.5) as i64)
    }

    fn index(&self, at: [i64; 3]) -> Option<usize> {
        let is_there = (0..3).all(|axis| (0..i64::from(self.size[axis])).contains(&at[axis]));
        let [x, y, z] = at.map(|c| c as usize);
        is_there.then(|| x + self.size[0] as usize * (y + self.size[1] as usize * z))
    }

    /// Adds a particle; `false` where it is beyond the window.
    fn add(&mut self, p: DVec3, parent: Option<u32>) -> bool {
        let at = self.cell(p);
        let Some(cell) = self.index(at) else { return false };
        let name = self.places.len() as u32;
        self.before.push(std::mem::replace(&mut self.heads[cell], name));
        self.pyramid.set(at);
        self.places.push(p);
        self.parents.push(parent);
        self.radius = self.radius.max((p - self.middle).length());
        true
    }

    fn particle(&self, at: [i64; 3]) -> Option<u32> {
        self.index(at).map(|cell| self.heads[cell]).filter(|&name| name != u32::MAX)
    }

    /// A direction at random, of length 1.
    fn direction(&self, random: &mut Stream) -> DVec3 {
        let turn = std::f64::consts::TAU * random.random::<f64>();
        let z: f64 = if self.is_flat { 0.0 } else { random.random_range(-1.0..1.0) };
        from_height(z, turn)
    }

    /// The first particle that a disc touches on its way from `p` along `way`, of length 1, and how far it goes.
    fn touched(&self, p: DVec3, way: DVec3, length: f64) -> Option<(u32, f64)> {
        let at = self.cell(p);
        let depth = if self.is_flat { 0 } else { 3 };
        let mut first: Option<(u32, f64)> = None;
        for z in -depth..=depth {
            for y in -3..=3 {
                for x in -3..=3 {
                    let mut name =
                        self.index([at[0] + x, at[1] + y, at[2] + z]).map_or(u32::MAX, |cell| self.heads[cell]);
                    while name != u32::MAX {
                        // Where the distance is 1: two radii.
                        let d = self.places[name as usize] - p;
                        let along = d.dot(way);
                        let root = along * along - d.length_squared() + 1.0;
                        if root >= 0.0 && along > 0.0 {
                            let t = (along - libm::sqrt(root)).max(0.0);
                            if t <= length && first.is_none_or(|(other, best)| (t, name) < (best, other)) {
                                first = Some((name, t));
                            }
                        }
                        name = self.before[name as usize];
                    }
                }
            }
        }
        first
    }
}

impl Method for DlaSpec {
    fn name(&self) -> &'static str {
        "dla"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let space = step.lattice()?;
        let mut site = OnLattice::new(step, space, context)?;
        let generators: Vec<Node> = starts(step, &mut site, context)?.into_iter().map(|(node, _)| node).collect();
        let random = Stream::new(context.seed, &format!("dla/{}", step.name));
        let skeleton = self.aggregate(&site.lattice, &generators, step.classes.clone(), random, context.progress)?;
        let settled = skeleton.nodes.len() as u64;
        let [nodes, edges] = site.size();
        step.finish_with(Grown { nodes, edges, settled, ..Grown::default() }, skeleton, context)
    }

    fn check_places(&self, step: &Step, context: &Context<'_>) -> Result<(), GrowError> {
        try_places(step, &mut OnLattice::new(step, step.lattice()?, context)?, context)
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        step.lattice().map_or(0, |space| space.bytes_beside(space.window.nodes() * 5))
    }
}

impl DlaSpec {
    /// This, with what is wrong about its space noted.
    pub(in crate::grow) fn resolve(&self, space: Option<&Space>, lookup: &mut dyn Lookup) -> Self {
        let lattice = space.and_then(Space::lattice);
        if lattice.is_some_and(|space| !space.shape.is_box() || space.forbid.is_some()) {
            let message =
                "aggregation needs the room of a box with nothing forbidden: its walkers come from outside".to_owned();
            lookup.wrong("space", message);
        }
        *self
    }

    /// Grows around `generators`; the skeleton, in which every tip ends a path.
    fn aggregate(
        &self,
        lattice: &Lattice,
        generators: &[Node],
        classes: Vec<String>,
        mut random: Stream,
        progress: &Progress,
    ) -> Result<Skeleton, Cancelled> {
        let window = lattice.window();
        let size = window.size;
        let cells = lattice.cells();
        let mut cluster = Cluster {
            places: Vec::new(),
            parents: Vec::new(),
            pyramid: Pyramid::new(size),
            heads: vec![u32::MAX; cells],
            before: Vec::new(),
            size,
            middle: DVec3::ZERO,
            radius: 0.0,
            is_flat: lattice.is_plane(),
        };
        let seeds: Vec<DVec3> =
            generators.iter().map(|&g| DVec3::from_array(lattice.coordinates(g).map(f64::from))).collect();
        cluster.middle = seeds.iter().copied().sum::<DVec3>() / seeds.len() as f64;
        seeds.iter().for_each(|&p| {
            cluster.add(p, None);
        });
        let most = seeds.len() + self.particles as usize;
        let (mut made, mut lost) = (0_u32, 0_u32);
        while cluster.places.len() < most {
            let landed = if self.lattice {
                self.walk_lattice(lattice, &cluster, &mut random, progress)?
            } else {
                self.walk_free(&cluster, &mut random, progress)?
            };
            // What found no place, or would stay beyond the border, is lost.
            if landed.is_some_and(|(p, parent)| cluster.add(p, Some(parent))) {
                lost = 0;
            } else {
                lost += 1;
                if lost == MOST_LOST {
                    break;
                }
            }
            made += 1;
            if made.is_multiple_of(CHECK) {
                progress.report("grow", f64::from(made) / f64::from(self.particles))?;
            }
        }
        Ok(skeleton(&cluster, classes, |p| window.position([0; 3]) + p * window.spacing))
    }

    /// Where a walker starts: on the border of the window, or on a circle (a sphere) just around what has grown.
    fn start(&self, cluster: &Cluster, random: &mut Stream) -> DVec3 {
        if self.walk == Walk::Fast {
            return cluster.middle + cluster.direction(random) * (cluster.radius + 3.0);
        }
        let dimensions = if cluster.is_flat { 2 } else { 3 };
        let sides = [0, 1, 2].map(|axis| f64::from(cluster.size[axis] - 1));
        let mut p = DVec3::ZERO;
        (0..dimensions).for_each(|axis| p[axis] = random.random::<f64>() * sides[axis]);
        // Sides by their size.
        let face =
            |axis: usize| (0..dimensions).filter(|&other| other != axis).map(|other| sides[other]).product::<f64>();
        let mut left = random.random::<f64>() * (0..dimensions).map(face).sum::<f64>();
        let mut axis = 0;
        while axis + 1 < dimensions && left >= face(axis) {
            left -= face(axis);
            axis += 1;
        }
        p[axis] = if random.random::<bool>() { 0.0 } else { sides[axis] };
        p
    }

    /// A walk along the lattice until it is next to what has grown: the place, and the particle beside it.
    fn walk_lattice(
        &self,
        lattice: &Lattice,
        cluster: &Cluster,
        random: &mut Stream,
        progress: &Progress,
    ) -> Result<Option<(DVec3, u32)>, Cancelled> {
        let steps = lattice.steps();
        let far = LOST * (cluster.radius + 3.0);
        let is_open = |at: [i64; 3]| cluster.index(at).is_none() || lattice.is_open(lattice.node(at.map(|c| c as u32)));
        let mut at = cluster.cell(self.start(cluster, random));
        let mut stuck = 0;
        for step in 0..MOST_STEPS {
            if step % LOOK == 0 {
                progress.check()?;
            }
            if cluster.pyramid.is_near(clamped(at, cluster.size), 0) && cluster.particle(at).is_none() {
                let mut beside = steps.iter().map(|step| [0, 1, 2].map(|axis| at[axis] + i64::from(step[axis])));
                if let Some(parent) = beside.find_map(|other| cluster.particle(other))
                    && is_open(at)
                {
                    return Ok(Some((DVec3::from_array(at.map(|c| c as f64)), parent)));
                }
            }
            if self.walk == Walk::Fast {
                let p = DVec3::from_array(at.map(|c| c as f64));
                let off = (p - cluster.middle).length();
                let beyond = off - cluster.radius;
                let free = if beyond > 4.0 {
                    beyond - 2.0
                } else {
                    cluster.index(at).map_or(0.0, |_| cluster.pyramid.free(at) - 1.0)
                };
                if off > far || cluster.particle(at).is_some() {
                    at = cluster.cell(self.start(cluster, random));
                    continue;
                }
                if free >= 3.0 {
                    at = cluster.cell(p + cluster.direction(random) * free);
                    continue;
                }
            }
            let step = steps[random.random_range(0..steps.len())];
            let next = [0, 1, 2].map(|axis| at[axis] + i64::from(step[axis]));
            let is_inside = self.walk == Walk::Fast || cluster.index(next).is_some();
            stuck += 1;
            if is_inside && is_open(next) && cluster.particle(next).is_none() {
                at = next;
                stuck = 0;
            }
            if stuck == MOST_STUCK {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// A walk of a disc (a ball) of diameter 1 until it touches what has grown.
    fn walk_free(
        &self,
        cluster: &Cluster,
        random: &mut Stream,
        progress: &Progress,
    ) -> Result<Option<(DVec3, u32)>, Cancelled> {
        let far = LOST * (cluster.radius + 3.0);
        let mut p = self.start(cluster, random);
        for step in 0..MOST_STEPS {
            if step % LOOK == 0 {
                progress.check()?;
            }
            let off = (p - cluster.middle).length();
            let at = cluster.cell(p);
            let free = match self.walk {
                Walk::Textbook => 1.0,
                Walk::Fast if off - cluster.radius > 4.0 => off - cluster.radius - 1.0,
                // A cell that is not taken may have a particle half a cell within the next.
                Walk::Fast => cluster.index(at).map_or(1.0, |_| (cluster.pyramid.free(at) - 1.5).max(1.0)),
            };
            let way = cluster.direction(random);
            // Two cells free in every direction are more than a step and a touch.
            if free <= 1.0
                && cluster.pyramid.is_near(clamped(at, cluster.size), 1)
                && let Some((parent, length)) = cluster.touched(p, way, free)
            {
                return Ok(Some((p + way * length, parent)));
            }
            let next = p + way * free;
            let is_lost = match self.walk {
                Walk::Fast => (next - cluster.middle).length() > far,
                // The border reflects.
                Walk::Textbook => cluster.index(cluster.cell(next)).is_none(),
            };
            p = match self.walk {
                Walk::Fast if is_lost => self.start(cluster, random),
                Walk::Textbook if is_lost => p,
                _ => next,
            };
        }
        Ok(None)
    }
}

fn clamped(at: [i64; 3], size: [u32; 3]) -> [i64; 3] {
    [0, 1, 2].map(|axis| at[axis].clamp(0, i64::from(size[axis]) - 1))
}

/// What has grown as a skeleton: costs count the particles from the generator.
fn skeleton(cluster: &Cluster, classes: Vec<String>, place: impl Fn(DVec3) -> DVec3) -> Skeleton {
    let mut skeleton = Skeleton::new(classes);
    let mut is_tip = vec![true; cluster.places.len()];
    for (&p, &parent) in cluster.places.iter().zip(&cluster.parents) {
        let cost = parent.map_or(0.0, |parent| {
            is_tip[parent as usize] = false;
            skeleton.nodes[parent as usize].cost + 1.0
        });
        skeleton.nodes.push(SkeletonNode::new(place(p), parent, cost, 0));
    }
    let tips = (0..cluster.places.len() as u32).filter(|&i| is_tip[i as usize]);
    skeleton.paths = tips.map(|end| Path { end, name: u64::from(end), ..Path::default() }).collect();
    skeleton
}
