//! Regions: which generator is nearest to each node (Xu and Mould 2007, section 3.4): rocks, cracked ground, cells.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::OnceLock;

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::solid::Regions;
use super::spec::RegionsSpec;
use crate::geom::{Shape, Surface, Voxels, fill};
use crate::graph::{Graph, Lattice, Mask, Node, Window};
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::Grown;
use crate::grow::site::Site;
use crate::grow::spaces::{LatticeSpace, OnLattice};
use crate::grow::starts::starts;
use crate::grow::step::{Context, Method, Step, Yield};
use crate::grow::trial::try_places;
use crate::math::{DVec2, DVec3, Point};
use crate::plan::{Goal, plan, plan_delayed};
use crate::raster::{contours, rings};
use crate::skeleton::Skeleton;

/// No region.
const NONE: u16 = u16::MAX;

/// The nodes of a lattice with the region of each and its cost.
struct Labelled<'a> {
    lattice: Cow<'a, Lattice>,
    shape: &'a Shape,
    nodes: Vec<(u16, u32)>,
    /// Where the generators are, in coordinates.
    seeds: Vec<[u32; 3]>,
}

impl Labelled<'_> {
    fn cell(&self, [x, y, z]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.lattice.window().size;
        x as usize + nx as usize * (y as usize + ny as usize * z as usize)
    }

    /// How far the border of the region of the node at `at` is on the way to the next along an axis: where both ways cost the same,
    /// or on the surface of the space.
    fn crossing(&self, at: [u32; 3], axis: usize, up: bool) -> f64 {
        let window = self.lattice.window();
        let mut other = at;
        other[axis] = other[axis].wrapping_add_signed(if up { 1 } else { -1 });
        let is_within = other[axis] < window.size[axis];
        if is_within && self.nodes[self.cell(other)].0 != NONE {
            let slot = 2 * axis as u32 + u32::from(!up);
            let weight = f64::from(self.lattice.follow(self.lattice.node(at), slot).1);
            let [here, there] = [at, other].map(|at| f64::from(self.nodes[self.cell(at)].1));
            return (there - here + weight) / (2.0 * weight);
        }
        let p = window.position(at);
        let mut q = p;
        q[axis] += if up { window.spacing } else { -window.spacing };
        let (a, b) = (self.shape.distance(p), self.shape.distance(q));
        if a <= 0.0 && b > 0.0 { a / (a - b) } else { 0.5 }
    }

    /// The border of a region whose nodes lie between two corners.
    fn surface(&self, region: u16, [low, high]: [[u32; 3]; 2], spec: &RegionsSpec) -> Surface {
        let window = self.lattice.window();
        let is_in = |at: [u32; 3]| self.nodes[self.cell(at)].0 == region;
        let spacing = window.spacing;
        if self.lattice.is_plane() {
            let size = [high[0] + 1 - low[0], high[1] + 1 - low[1]];
            let at = |x: u32, y: u32| [x + low[0], y + low[1], 0];
            let mut rings = if spec.gap > 0.0 {
                let inside: Vec<bool> = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| is_in(at(x, y)))).collect();
                drawn_in(size, &inside, spec.gap * 0.5 / spacing)
            } else {
                rings(size, |x, y| is_in(at(x, y)), |[x, y], axis, up| self.crossing(at(x, y), axis, up))
            };
            (0..spec.smooth).for_each(|_| rings.iter_mut().for_each(smooth));
            let origin = window.position(low);
            return fill(&rings).map(|p| origin.with_z(0.0) + p * spacing);
        }
        // Only the part of the window that it takes up.
        let size = [0, 1, 2].map(|axis| high[axis] + 1 - low[axis]);
        let at = |at: [u32; 3]| [0, 1, 2].map(|axis| at[axis] + low[axis]);
        let mut surface = Surface::extract(size, |p| is_in(at(p)), |p, axis, up| self.crossing(at(p), axis, up))
            .map(|p| window.position(low) + p * spacing);
        surface.smooth(spec.smooth);
        if spec.gap > 0.0 {
            let normals = surface.normals();
            surface.points.iter_mut().zip(normals).for_each(|(p, n)| *p -= n * (spec.gap * 0.5));
        }
        surface
    }

    /// Those of `kept`, side by side.
    fn regions(&self, kept: &[u16], spec: &RegionsSpec) -> Regions {
        let mut is_kept = vec![false; usize::from(NONE) + 1];
        kept.iter().for_each(|&region| is_kept[usize::from(region)] = true);
        let boxes = self.boxes(self.seeds.len());
        let own = |region: u16| Some((region, boxes[usize::from(region)])).filter(|(_, [low, high])| low[0] <= high[0]);
        let present: Vec<(u16, [[u32; 3]; 2])> = kept.iter().filter_map(|&region| own(region)).collect();
        let surfaces: Vec<Surface> = present.par_iter().map(|&(region, own)| self.surface(region, own, spec)).collect();
        // A gap may leave nothing of a region, or less.
        let is_there =
            |surface: &Surface| !surface.triangles.is_empty() && (self.lattice.is_plane() || surface.volume() > 0.0);
        Regions {
            surfaces: surfaces.into_iter().filter(is_there).collect(),
            window: *self.lattice.window(),
            is_inside: self.nodes.iter().map(|&(region, _)| is_kept[usize::from(region)]).collect(),
            solid: OnceLock::new(),
        }
    }

    /// The box of each region's nodes, in coordinates; that of one without nodes has its low corner above its high one.
    fn boxes(&self, regions: usize) -> Vec<[[u32; 3]; 2]> {
        let size = self.lattice.window().size;
        let mut boxes = vec![[size, [0; 3]]; regions];
        let mut i = 0;
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    if let Some([low, high]) = boxes.get_mut(usize::from(self.nodes[i].0)) {
                        *low = [low[0].min(x), low[1].min(y), low[2].min(z)];
                        *high = [high[0].max(x), high[1].max(y), high[2].max(z)];
                    }
                    i += 1;
                }
            }
        }
        boxes
    }
}

/// The rings around all that is at least `by` steps within what is `inside` on a grid of `size` samples.
fn drawn_in([width, height]: [u32; 2], inside: &[bool], by: f64) -> Vec<Vec<DVec2>> {
    // With a sample outside on each side.
    let size = [width + 2, height + 2];
    let framed: Vec<bool> = (0..size[1])
        .flat_map(|y| {
            (0..size[0]).map(move |x| {
                let is_there = (1..=width).contains(&x) && (1..=height).contains(&y);
                is_there && inside[((y - 1) * width + x - 1) as usize]
            })
        })
        .collect();
    let distances = Voxels::new([size[0], size[1], 1], 1.0, DVec3::ZERO, &framed);
    let value = |x: u32, y: u32| distances.distance(DVec3::new(x.into(), y.into(), 0.0)) + by;
    let lines = contours(size, value);
    lines.into_iter().map(|line| line[1..].iter().map(|p| *p - 1.0).collect()).collect()
}

/// Each point of a ring halfway to the middle of its neighbours.
fn smooth(ring: &mut Vec<DVec2>) {
    let n = ring.len();
    *ring = (0..n).map(|i| ring[i] * 0.5 + (ring[(i + 1) % n] + ring[(i + n - 1) % n]) * 0.25).collect();
}

impl Method for RegionsSpec {
    fn name(&self) -> &'static str {
        "regions"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let space = step.lattice()?;
        let mut site = OnLattice::new(step, space, context)?;
        let starts = starts(step, &mut site, context)?;
        let generators: Vec<Node> = starts.iter().map(|&(node, _)| node).collect();
        let (regions, settled) = grow_regions(self, step, space, &site.lattice, &generators, context)?;
        let [nodes, edges] = site.size();
        let grown = Grown { nodes, edges, settled, regions: Some(regions), ..Grown::default() };
        step.finish_with(grown, Skeleton::new(step.classes.clone()), context)
    }

    fn check_places(&self, step: &Step, context: &Context<'_>) -> Result<(), GrowError> {
        try_places(step, &mut OnLattice::new(step, step.lattice()?, context)?, context)
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        let Ok(space) = step.lattice() else { return 0 };
        // A region and a cost, carried along paths, and what is kept; and those of lattices twice as fine.
        space.bytes_with_paths(0, 12_u64 << (space.neighbours.dimensions() * self.refine))
    }

    fn yields(&self) -> Yield {
        Yield::Solids
    }
}

/// Labels every node with its nearest generator and takes the borders of the regions that are kept; how many nodes were
/// settled.
fn grow_regions(
    spec: &RegionsSpec,
    step: &Step,
    space: &LatticeSpace,
    lattice: &Lattice,
    generators: &[Node],
    context: &Context<'_>,
) -> Result<(Regions, u64), GrowError> {
    if generators.len() >= usize::from(NONE) {
        return Err(step.error(Key::From, Problem::TooManyRegions { count: generators.len(), most: NONE - 1 }));
    }
    let found = plan(lattice, generators, Goal::Everything, context.progress);
    let found = found.map_err(|error| step.plan_error(error))?;
    let settled = found.settled() as u64;
    let numbers: HashMap<Node, u16> = generators.iter().copied().zip(0..).collect();
    let nodes = found.carry(
        lattice.nodes(),
        (NONE, 0),
        |generator| (numbers[&generator], 0),
        |(region, cost): (u16, u32), weight| (region, cost.saturating_add(weight)),
    );
    let seeds = generators.iter().map(|&node| lattice.coordinates(node)).collect();
    let mut labelled = Labelled { lattice: Cow::Borrowed(lattice), shape: &space.shape, nodes, seeds };
    let mut kept: Vec<u16> = (0..generators.len() as u16).collect();
    if !spec.keep.is_empty() {
        kept.clear();
        for (i, Point(p)) in spec.keep.iter().enumerate() {
            let region = lattice.nearest_within(*p).map_or(NONE, |node| labelled.nodes[lattice.cell(node)].0);
            if region == NONE {
                return Err(step.error(Key::MethodKey("keep", Some(i)), Problem::NoRegion(*p)));
            }
            if !kept.contains(&region) {
                kept.push(region);
            }
        }
    }
    for level in 0..spec.refine {
        context.progress.report("refine", f64::from(level) / f64::from(spec.refine))?;
        labelled = finer(step, &labelled, space, level, context)?;
    }
    Ok((labelled.regions(&kept, spec), settled))
}

/// The regions on a lattice twice as fine, planned again around their borders; elsewhere they stay.
fn finer<'a>(
    step: &Step,
    coarse: &Labelled<'_>,
    space: &'a LatticeSpace,
    level: u32,
    context: &Context<'_>,
) -> Result<Labelled<'a>, GrowError> {
    let wide = coarse.lattice.window();
    let size = wide.size.map(|s| s * 2 - 1);
    let bits: u32 = size.iter().map(|&s| 32 - (s - 1).leading_zeros()).sum();
    if bits > 32 || size.iter().map(|&s| u64::from(s)).product::<u64>() > MOST_FINE {
        return Err(step.error(Key::MethodKey("refine", None), Problem::TooFine(size)));
    }
    let window = Window { spacing: wide.spacing * 0.5, origin: wide.origin.map(|c| c * 2), size };
    // Coarse nodes next to another region, or to nothing; and those next to these.
    let is_border = around(wide.size, |cell, other| coarse.nodes[cell].0 != coarse.nodes[other].0, true);
    let is_near = around(wide.size, |_, other| is_border[other], false);
    let corners =
        |at: [u32; 3]| (0..8_u32).map(move |corner| [0, 1, 2].map(|axis| (at[axis] + (corner >> axis & 1)) / 2));
    let at = |cell: u64| {
        let [x, y, _] = size.map(u64::from);
        [cell % x, cell / x % y, cell / (x * y)].map(|c| c as u32)
    };
    let cells = size.iter().map(|&s| u64::from(s)).product::<u64>();
    let is_open = |cell: u64| {
        let at = at(cell);
        corners(at).any(|c| is_near[coarse.cell(c)]) && space.is_open(window.position(at))
    };
    let words = (0..cells.div_ceil(64))
        .into_par_iter()
        .map(|word| {
            let blocked = |bit: u64| word * 64 + bit < cells && !is_open(word * 64 + bit);
            (0..64).fold(0, |bits, bit| bits | u64::from(blocked(bit)) << bit)
        })
        .collect();
    let mask = Mask::from_words(words, cells as usize);
    let stream = format!("{}/refine/{level}", space.stream);
    let lattice = space.lattice_in(window, &stream, context.seed, Some(mask));
    let lattice = lattice.map_err(|error| step.error(Key::Weights, Problem::Lattice(error)))?;
    // A region too thin for a sure node keeps its generator.
    let seeds: FxHashSet<usize> = coarse.seeds.iter().map(|&at| coarse.cell(at)).collect();
    // Sure coarse nodes start it, with what they cost: a coarse step is two fine ones.
    let fractions = [coarse.lattice.weight_range().fraction, lattice.weight_range().fraction];
    let doubled = |cost: u32| (u64::from(cost) << (1 + fractions[1])) >> fractions[0];
    let sure = |node: Node| {
        let at = lattice.coordinates(node);
        let cell = coarse.cell(at.map(|c| c / 2));
        let is_sure = !is_border[cell] || seeds.contains(&cell);
        (at.iter().all(|c| c % 2 == 0) && is_sure && coarse.nodes[cell].0 != NONE).then_some(cell)
    };
    let later: Vec<(Node, u64)> =
        lattice.nodes().filter_map(|node| Some((node, doubled(coarse.nodes[sure(node)?].1)))).collect();
    let found = plan_delayed(&lattice, &[], &later, Goal::Everything, context.progress)
        .map_err(|error| step.plan_error(error))?;
    let mut nodes = found.carry(
        lattice.nodes(),
        (NONE, 0),
        |node| sure(node).map_or((NONE, 0), |cell| (coarse.nodes[cell].0, doubled(coarse.nodes[cell].1) as u32)),
        |(region, cost): (u16, u32), weight| (region, cost.saturating_add(weight)),
    );
    drop(found);
    nodes.par_iter_mut().enumerate().for_each(|(cell, node)| {
        let at = at(cell as u64);
        if !corners(at).any(|c| is_near[coarse.cell(c)]) {
            let (region, cost) = coarse.nodes[coarse.cell(at.map(|c| c / 2))];
            *node = (region, doubled(cost) as u32);
        }
    });
    let seeds = coarse.seeds.iter().map(|at| at.map(|c| c * 2)).collect();
    Ok(Labelled { lattice: Cow::Owned(lattice), shape: &space.shape, nodes, seeds })
}

/// More nodes than this of a refined lattice are refused.
const MOST_FINE: u64 = 1 << 28;

/// For each cell of a window: does `test` hold with any of the cells around it? `beyond` is what holds at its border.
fn around(size: [u32; 3], test: impl Fn(usize, usize) -> bool + Sync, beyond: bool) -> Vec<bool> {
    let [nx, ny, nz] = size.map(i64::from);
    let is_flat = nz == 1;
    (0..nx * ny * nz)
        .into_par_iter()
        .map(|cell| {
            let (x, y, z) = (cell % nx, cell / nx % ny, cell / (nx * ny));
            let edge = x == 0 || y == 0 || x + 1 == nx || y + 1 == ny || (!is_flat && (z == 0 || z + 1 == nz));
            if edge && beyond {
                return true;
            }
            (-1..=1).any(|dz| {
                (-1..=1).any(|dy| {
                    (-1..=1).any(|dx| {
                        let (x, y, z) = (x + dx, y + dy, z + dz);
                        let is_there = (0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z);
                        is_there && test(cell as usize, (x + nx * (y + ny * z)) as usize)
                    })
                })
            })
        })
        .collect()
}
