//! Distance fields from a structure, and their isosurfaces (Xu and Mould 2007, section 3.3): what encloses all that is no
//! farther from a limb than its width.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geom::{Bounds, Surface, fill};
use crate::graph::{Graph, LatticeError, Node, Window};
use crate::grow::LatticeSpace;
use crate::math::{Cancelled, DVec2, DVec3, Memory, OutOfMemory, Progress};
use crate::plan::{Goal, PlanError, mean_cost, plan_from};
use crate::raster::rings;
use crate::skeleton::Skeleton;

/// One surface around limbs: in space closed, in the plane the area within.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct IsosurfaceSpec {
    /// What is measured from the limbs; their width is the level.
    pub of: Distance,
    /// Spacing of the grid that distances are measured on, in scene units: by default the lattice's, or half of the least
    /// radius. Costs are measured on the lattice itself.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub spacing: Option<f64>,
    /// In space: how often it is smoothed.
    #[schemars(range(min = 0, max = 100))]
    pub smooth: u32,
}

impl Default for IsosurfaceSpec {
    fn default() -> Self {
        Self { of: Distance::default(), spacing: None, smooth: 2 }
    }
}

/// What a distance field measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Distance {
    /// The distance itself.
    #[default]
    Euclidean,
    /// Path cost, by a second search from the structure, over what a unit of length costs on average: rough.
    Cost,
}

/// More samples than this are refused.
const MOST_SAMPLES: f64 = 3e8;
/// Bytes of a sample of distance, and of one of path cost.
const SAMPLE_BYTES: [f64; 2] = [4.0, 8.0];
/// Bytes that a square of the surface as wide as the spacing takes: a corner, two triangles, normals, while they are copied.
const SQUARE_BYTES: f64 = 250.0;

/// Why there is no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IsosurfaceError {
    /// The grid would be too large.
    #[error("{0:.1e} samples are too many ({MOST_SAMPLES:.0e} at most): use a wider spacing")]
    TooManySamples(f64),
    /// The grid has no window.
    #[error(transparent)]
    Window(LatticeError),
    /// The grid misses everything.
    #[error("nothing is as wide as the spacing, {0}: use a narrower one")]
    Narrow(f64),
    /// Costs need the lattice.
    #[error("path costs are measured on the lattice that the first step grew in: it has scattered nodes")]
    NoLattice,
    /// Costs have the lattice's spacing.
    #[error("path costs are measured on the lattice that the step grew in, with its spacing")]
    OwnSpacing,
    /// The lattice is too large for a second search.
    #[error("{0:.1e} nodes are too many to measure costs on ({MOST_SAMPLES:.0e} at most)")]
    TooManyNodes(f64),
    /// The lattice cannot be made again.
    #[error(transparent)]
    Lattice(LatticeError),
    /// The second search failed.
    #[error(transparent)]
    Plan(PlanError),
    /// No cost is low enough.
    #[error("no node lies within the width of the limbs: make them wider, or the spacing narrower")]
    NoNode,
    /// The grid takes more memory than allowed.
    #[error("its grid needs {0}: use a wider spacing, or raise --max-memory")]
    Memory(#[from] OutOfMemory),
    /// Stopped by its [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl IsosurfaceError {
    /// The key of [`IsosurfaceSpec`] that it is about.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            Self::TooManySamples(_) | Self::Memory(_) | Self::Window(_) | Self::Narrow(_) | Self::OwnSpacing => {
                "spacing"
            }
            _ => "of",
        }
    }
}

/// The surface around `skeletons`, in their space. `space` is that of the first of them, if it is a lattice.
///
/// # Errors
/// [`IsosurfaceError`].
pub fn isosurface(
    spec: &IsosurfaceSpec,
    skeletons: &[&Skeleton],
    space: Option<&LatticeSpace>,
    is_flat: bool,
    seed: u64,
    memory: &Memory,
    progress: &Progress,
) -> Result<Surface, IsosurfaceError> {
    match spec.of {
        Distance::Euclidean => by_distance(spec, skeletons, space, is_flat, memory, progress),
        Distance::Cost => {
            let space = space.ok_or(IsosurfaceError::NoLattice)?;
            if spec.spacing.is_some() {
                return Err(IsosurfaceError::OwnSpacing);
            }
            let nodes = space.window.nodes() as f64;
            if nodes > MOST_SAMPLES {
                return Err(IsosurfaceError::TooManyNodes(nodes));
            }
            let surface = squares(skeletons, space.window.spacing) * SQUARE_BYTES;
            memory.ask(space.bytes_needed().saturating_add((nodes * SAMPLE_BYTES[1] + surface) as u64))?;
            by_cost(space, skeletons, spec, seed, progress)
        }
    }
}

/// How many squares as wide as `spacing` the surface of limbs has.
fn squares(skeletons: &[&Skeleton], spacing: f64) -> f64 {
    skeletons.iter().map(|s| s.area()).sum::<f64>() / (spacing * spacing)
}

/// The surface of all that is no farther from the limbs than their width.
fn by_distance(
    spec: &IsosurfaceSpec,
    skeletons: &[&Skeleton],
    space: Option<&LatticeSpace>,
    is_flat: bool,
    memory: &Memory,
    progress: &Progress,
) -> Result<Surface, IsosurfaceError> {
    let nodes = || skeletons.iter().flat_map(|s| &s.nodes);
    let least = nodes().map(|n| n.radius).fold(f64::INFINITY, f64::min);
    let own = space.map(|space| space.window.spacing);
    let spacing = spec.spacing.or(own).unwrap_or(least * 0.5);
    let bounds = nodes().fold(Bounds::EMPTY, |b, n| b.union(Bounds::of_ball(n.position, n.radius)));
    let dimensions = if is_flat { 2 } else { 3 };
    let samples = (0..dimensions).map(|axis| bounds.size()[axis] / spacing + 5.0).product::<f64>();
    if samples.is_nan() || samples > MOST_SAMPLES {
        return Err(IsosurfaceError::TooManySamples(samples));
    }
    memory.ask((samples * SAMPLE_BYTES[0] + squares(skeletons, spacing) * SQUARE_BYTES) as u64)?;
    let margin = 2.0 * spacing;
    let window = Window::new(bounds.min - margin, bounds.max + margin, spacing, dimensions as u32)
        .map_err(IsosurfaceError::Window)?;
    let field = distances(window, skeletons, progress)?;
    let surface = level(window, is_flat, spec.smooth, progress, |cell| f64::from(field[cell]))?;
    if surface.triangles.is_empty() { Err(IsosurfaceError::Narrow(spacing)) } else { Ok(surface) }
}

/// Signed distance from the round cones of `skeletons` at the nodes of `window`, where it is small; far outside elsewhere.
fn distances(window: Window, skeletons: &[&Skeleton], progress: &Progress) -> Result<Vec<f32>, Cancelled> {
    let [nx, ny, _] = window.size.map(|s| s as usize);
    let low = window.position([0; 3]);
    let near = 1.5 * window.spacing;
    let mut pieces: Vec<(DVec3, f64, DVec3, f64)> = Vec::new();
    for skeleton in skeletons {
        for node in &skeleton.nodes {
            let from = node.parent.map_or(node, |parent| &skeleton.nodes[parent as usize]);
            pieces.push((from.position, from.radius, node.position, node.radius));
        }
    }
    let mut field = vec![f32::MAX; nx * ny * window.size[2] as usize];
    // Layers side by side; in the plane rows.
    let (slab, axis) = if window.size[2] > 1 { (nx * ny, 2) } else { (nx, 1) };
    let reach = |&(a, ra, b, rb): &(DVec3, f64, DVec3, f64)| {
        let r = ra.max(rb) + near;
        let place = |p: DVec3| (p - low) / window.spacing;
        (place(a.min(b) - r), place(a.max(b) + r))
    };
    let mut by_layer: Vec<Vec<u32>> = vec![Vec::new(); field.len() / slab];
    for (i, piece) in (0..).zip(&pieces) {
        let (from, to) = reach(piece);
        let range = |x: f64| x.clamp(0.0, by_layer.len() as f64 - 1.0) as usize;
        let (first, last) = (range(libm::ceil(from[axis])), range(to[axis]));
        by_layer[first..=last].iter_mut().for_each(|layer| layer.push(i));
    }
    field.par_chunks_mut(slab).zip(by_layer).enumerate().try_for_each(|(layer, (values, inside))| {
        progress.check()?;
        for i in inside {
            let piece = &pieces[i as usize];
            let &(a, ra, b, rb) = piece;
            let (from, to) = reach(piece);
            let along = b - a;
            let squared = along.length_squared();
            let range = |axis: usize, n: usize| {
                let clamp = |x: f64| x.clamp(0.0, n as f64 - 1.0) as usize;
                clamp(libm::ceil(from[axis]))..=clamp(to[axis])
            };
            let rows = if axis == 2 { range(1, ny) } else { layer..=layer };
            for y in rows {
                for x in range(0, nx) {
                    let z = if axis == 2 { layer } else { 0 };
                    let p = low + DVec3::new(x as f64, y as f64, z as f64) * window.spacing;
                    let t = if squared > 0.0 { ((p - a).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
                    let d = ((p - a - along * t).length() - (ra + (rb - ra) * t)) as f32;
                    let value = &mut values[x + if axis == 2 { nx * y } else { 0 }];
                    *value = if d < *value { d } else { *value };
                }
            }
        }
        Ok(())
    })?;
    Ok(field)
}

/// The surface of all that costs no more than its width from the limbs: half a unit of the last place above, so that no node
/// is on it.
fn by_cost(
    space: &LatticeSpace,
    skeletons: &[&Skeleton],
    spec: &IsosurfaceSpec,
    seed: u64,
    progress: &Progress,
) -> Result<Surface, IsosurfaceError> {
    let lattice = space.lattice(seed).map_err(IsosurfaceError::Lattice)?;
    let range = lattice.weight_range();
    let mean = mean_cost(space.neighbours, space.weights).map_err(IsosurfaceError::Lattice)?;
    // Costs of a length, in fixed point.
    let scale = mean / space.window.spacing * f64::from(1_u32 << range.fraction);
    let widest = skeletons.iter().flat_map(|s| &s.nodes).map(|n| n.radius).fold(0.0, f64::max);
    let mut later: Vec<(Node, u64)> = skeletons
        .iter()
        .flat_map(|s| &s.nodes)
        .filter_map(|n| Some((lattice.nearest(n.position)?, ((widest - n.radius) * scale) as u64)))
        .collect();
    // What starts first is what counts.
    later.sort_unstable_by_key(|&(node, cost)| (node, cost));
    later.dedup_by_key(|&mut (node, _)| node);
    let most = (widest * scale) as u64;
    // A step beyond, so that values on both sides of the surface are known.
    let beyond = most + u64::from(range.most);
    let plan = plan_from(&lattice, &later, Goal::Within(beyond), progress).map_err(|error| match error {
        PlanError::Cancelled(cancelled) => IsosurfaceError::Cancelled(cancelled),
        PlanError::TooWide { .. } => IsosurfaceError::Plan(error),
    })?;
    let starts: std::collections::HashMap<Node, u64> = later.iter().copied().collect();
    let costs = plan.carry(lattice.nodes(), u64::MAX, |node| starts[&node], |cost, weight| cost + u64::from(weight));
    let threshold = most as f64 + 0.5;
    let value = |cell: usize| if costs[cell] == u64::MAX { f64::MAX } else { costs[cell] as f64 - threshold };
    let surface = level(space.window, lattice.is_plane(), spec.smooth, progress, value)?;
    if surface.triangles.is_empty() { Err(IsosurfaceError::NoNode) } else { Ok(surface) }
}

/// The surface where `value`, of a cell of `window`, is 0: what is below is inside.
fn level(
    window: Window,
    is_flat: bool,
    smooth: u32,
    progress: &Progress,
    value: impl Fn(usize) -> f64,
) -> Result<Surface, Cancelled> {
    let [nx, ny, _] = window.size.map(|s| s as usize);
    let cell = |[x, y, z]: [u32; 3]| x as usize + nx * (y as usize + ny * z as usize);
    let crossing = |at: [u32; 3], axis: usize, up: bool| {
        let mut other = at;
        other[axis] = other[axis].wrapping_add_signed(if up { 1 } else { -1 });
        if other[axis] >= window.size[axis] {
            return 0.5;
        }
        let (a, b) = (value(cell(at)), value(cell(other)));
        a / (a - b)
    };
    let low = window.position([0; 3]);
    if is_flat {
        let size = [window.size[0], window.size[1]];
        let rings = rings(size, |x, y| value(cell([x, y, 0])) < 0.0, |[x, y], axis, up| crossing([x, y, 0], axis, up));
        let place = |p: &DVec2| low.truncate() + *p * window.spacing;
        let placed: Vec<Vec<DVec2>> = rings.iter().map(|ring| ring.iter().map(place).collect()).collect();
        return Ok(fill(&placed));
    }
    // Where nothing is inside any more the extraction ends at once.
    let is_inside = |at: [u32; 3]| value(cell(at)) < 0.0 && progress.check().is_ok();
    let mut surface = Surface::extract(window.size, is_inside, crossing).map(|p| low + p * window.spacing);
    progress.check()?;
    for _ in 0..smooth {
        progress.check()?;
        surface.smooth(1);
    }
    Ok(surface)
}
