//! Spaces: their names and files are looked up, and their sizes checked.

use std::sync::Arc;

use super::{Clusters, LatticeSpace, LatticeSpec, ScatterSpace, ScatterSpec, VoxelNodesSpec, VoxelSpace};
use crate::geom::{Bounds, Shape, Strokes};
use crate::graph::{CostField, FieldSpec, FieldUse, HeightEnd, Joining, Measure, MeasureSpec, Sectors, TriangularSpec};
use crate::grow::lookup::{Lookup, given_shape, note};
use crate::grow::space::{NodesSpec, Space, SpaceSpec};
use crate::math::{DVec3, Point, Weights};

/// More edges than this are refused.
const MOST_EDGES: f64 = 2e9;
/// More scattered nodes than this are refused.
const MOST_SCATTERED: f64 = 1e8;

/// What all kinds of spaces have.
struct Common {
    shape: Shape,
    forbid: Option<Shape>,
    weights: Weights,
    fields: Vec<CostField>,
    stream: String,
}

/// The space called `name`; what is wrong with it is noted.
pub fn resolve_space(name: &str, spec: &SpaceSpec, lookup: &mut dyn Lookup) -> Option<Space> {
    let shape = lookup.shape("shape", &spec.shape);
    let forbid = given_shape(lookup, "forbid", spec.forbid.as_ref())?;
    let shape = shape?;
    let is_plane = spec.nodes.is_plane();
    if shape.has_outline(is_plane) {
        let message = if is_plane {
            "letters and pictures have no `depth` in the plane"
        } else {
            "letters and pictures need a `depth` in space"
        };
        lookup.wrong("shape", message.to_owned());
        return None;
    }
    let up = if is_plane { 1 } else { 2 };
    let fields: Vec<_> =
        spec.field.iter().map(|(key, of)| field(&format!("field.{key}"), of, shape.bounds(), up, lookup)).collect();
    let fields = fields.into_iter().collect::<Option<_>>()?;
    let stream = spec.stream.clone().unwrap_or_else(|| name.to_owned());
    let common = Common { shape, forbid, weights: spec.weights, fields, stream };
    match spec.nodes {
        NodesSpec::Lattice(nodes) => lattice(nodes, spec, common, lookup).map(Space::Lattice),
        NodesSpec::Voxels(nodes) => voxels(nodes, spec, common, lookup).map(Space::Voxels),
        NodesSpec::Scatter(nodes) => scatter(nodes, spec, common, lookup).map(Space::Scatter),
        NodesSpec::Triangular(nodes) => triangular(nodes, spec, common, lookup).map(Space::Scatter),
    }
}

fn lattice(nodes: LatticeSpec, spec: &SpaceSpec, common: Common, lookup: &mut dyn Lookup) -> Option<LatticeSpace> {
    let LatticeSpec { spacing, neighbours } = nodes;
    if spec.clusters.is_some() {
        lookup.wrong("clusters", "clusters need scattered nodes (`nodes.scatter`)".to_owned());
    }
    let Common { shape, forbid, weights, fields, stream } = common;
    let window = LatticeSpace::window(&shape, spacing, neighbours);
    let window = note(lookup, "nodes.lattice.spacing", window)?;
    Some(LatticeSpace { shape, forbid, window, neighbours, weights, fields, stream })
}

fn voxels(nodes: VoxelNodesSpec, spec: &SpaceSpec, common: Common, lookup: &mut dyn Lookup) -> Option<VoxelSpace> {
    let given = [
        ("weights", spec.weights != Weights::default()),
        ("field", !spec.field.is_empty()),
        ("clusters", spec.clusters.is_some()),
        ("stream", spec.stream.is_some()),
    ];
    for (key, _) in given.iter().filter(|(_, is_given)| *is_given) {
        lookup.wrong(key, format!("voxels have no `{key}`: nothing is planned in them"));
    }
    let side = nodes.side;
    let sampled = |shape: Shape| shape.sampled(side);
    let space = VoxelSpace { shape: sampled(common.shape), forbid: common.forbid.map(sampled), side };
    note(lookup, "nodes.voxels", space.check())?;
    Some(space)
}

fn scatter(nodes: ScatterSpec, spec: &SpaceSpec, common: Common, lookup: &mut dyn Lookup) -> Option<ScatterSpace> {
    let ScatterSpec { spacing, sectors, longest, radius, plane, keep } = nodes;
    let joining = match (sectors, longest, radius) {
        (Some(_), _, Some(_)) => Err("nodes are joined either by `sectors` or within a `radius`".to_owned()),
        (_, Some(_), Some(_)) => {
            Err("nodes are joined within a `radius`: it leaves no `longest` of a Yao graph".to_owned())
        }
        (_, _, Some(radius)) => Ok(Joining::Radius(radius)),
        (sectors, longest, None) => {
            let sectors = Sectors::new(sectors.unwrap_or(if plane { 6 } else { 8 }), plane);
            let longest = longest.unwrap_or(f64::INFINITY);
            sectors.map(|sectors| Joining::Yao { sectors, longest }).map_err(|error| error.to_string())
        }
    };
    let joining = note(lookup, "nodes.scatter", joining)?;
    let clusters = match &spec.clusters {
        Some(clusters) => Some(Clusters {
            inside: lookup.shape("clusters.inside", &clusters.inside)?,
            apart: clusters.apart,
            radius: clusters.radius,
            foot: clusters.foot.0,
            neck: clusters.neck,
        }),
        None => None,
    };
    let Common { shape, forbid, weights, fields, stream } = common;
    let space =
        ScatterSpace { shape, forbid, spacing, keep, is_plane: plane, joining, clusters, weights, fields, stream };
    check_scatter("nodes.scatter", &space, lookup)?;
    Some(space)
}

fn triangular(
    nodes: TriangularSpec,
    spec: &SpaceSpec,
    common: Common,
    lookup: &mut dyn Lookup,
) -> Option<ScatterSpace> {
    if spec.clusters.is_some() {
        lookup.wrong("clusters", "clusters need scattered nodes (`nodes.scatter`)".to_owned());
    }
    let Common { shape, forbid, weights, fields, stream } = common;
    let (spacing, joining) = (nodes.spacing, Joining::Triangular);
    let space = ScatterSpace {
        shape,
        forbid,
        spacing,
        keep: 1.0,
        is_plane: true,
        joining,
        clusters: None,
        weights,
        fields,
        stream,
    };
    check_scatter("nodes.triangular", &space, lookup)?;
    Some(space)
}

fn check_scatter(nodes: &str, space: &ScatterSpace, lookup: &mut dyn Lookup) -> Option<()> {
    let estimate = space.estimate();
    if estimate.is_nan() || estimate > MOST_SCATTERED {
        let message = format!(
            "about {estimate:.1e} nodes are too many ({MOST_SCATTERED:.0e} at most): use a wider spacing or a smaller shape"
        );
        lookup.wrong(&format!("{nodes}.spacing"), message);
        return None;
    }
    let edges = space.edges_estimate();
    if edges > MOST_EDGES {
        let message = format!("about {edges:.1e} edges are too many ({MOST_EDGES:.0e} at most): use a smaller radius");
        lookup.wrong(&format!("{nodes}.radius"), message);
        return None;
    }
    let bounds = space.shape.bounds();
    if !space.is_plane && bounds.size().min_element() <= 0.0 && !bounds.is_empty() {
        let message = "a shape in space needs a thickness; for a flat scene set `plane = true`".to_owned();
        lookup.wrong("shape", message);
        return None;
    }
    Some(())
}

fn field(key: &str, spec: &FieldSpec, frame: Bounds, up: usize, lookup: &mut dyn Lookup) -> Option<CostField> {
    let upright = if up == 1 { DVec3::Y } else { DVec3::Z };
    let of = |own: &str| format!("{key}.of.{own}");
    let measure = match &spec.of {
        MeasureSpec::Axis { along, through } => {
            let along = along.map_or(upright, |p| p.0);
            let unit = along.try_normalize().ok_or("an axis needs a direction, not the zero vector");
            Measure::Axis { through: through.map_or(DVec3::ZERO, |p| p.0), along: note(lookup, &of("axis"), unit)? }
        }
        MeasureSpec::Point(Point(p)) => Measure::Point(*p),
        MeasureSpec::Height { cheap } => {
            let (low, high) = (frame.min[up], frame.max[up]);
            if low == high {
                lookup.wrong(&of("height"), "the space has no height".to_owned());
                return None;
            }
            let (cheap, costly) = if *cheap == HeightEnd::Low { (low, high) } else { (high, low) };
            Measure::Height { up, cheap, costly }
        }
        MeasureSpec::Shape(shape) => Measure::Shape(lookup.shape(&of("shape"), shape)?),
        MeasureSpec::Map { file } => Measure::Map { picture: lookup.grey(&of("map.file"), file)?, frame, up },
        MeasureSpec::Sketch { file } => {
            let lines = lookup.sketch(&of("sketch.file"), file, frame, up)?.0;
            Measure::Sketch { strokes: Arc::new(Strokes::new(lines)), up }
        }
    };
    Some(CostField {
        measure,
        per: spec.per,
        power: spec.power,
        scale: spec.scale,
        inverse: spec.inverse,
        multiply: spec.by == FieldUse::Multiply,
    })
}
