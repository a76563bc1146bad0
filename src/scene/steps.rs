//! Spaces and steps: their names and files are looked up.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::methods::is_first;
use super::resolve::Resolver;
use crate::files::{decode_grey, decode_sketch};
use crate::geom::{Bounds, Shape, Strokes};
use crate::graph::{CostField, FieldSpec, FieldUse, HeightEnd, Joining, Measure, MeasureSpec, Sectors, Weights};
use crate::grow::{
    Clusters, EndpointSpec, Endpoints, FromSpec, LatticeSpace, LatticeSpec, MethodSpec, Near, NearSpec, NodesSpec,
    Part, Placement, ScatterSpace, ScatterSpec, Source as Generators, Space, SpaceSpec, Step, StepSpec, VoxelNodesSpec,
    VoxelSpace,
};
use crate::math::{DVec2, DVec3, PerRound, Point};
use crate::skeleton::Width;

/// More edges than this are refused.
const MOST_EDGES: f64 = 2e9;
/// More scattered nodes than this are refused.
const MOST_SCATTERED: f64 = 1e8;

impl Resolver<'_> {
    pub(super) fn space(&mut self, name: &str, spec: &SpaceSpec) -> Option<Space> {
        let place = format!("space.{name}");
        let shape = self.shape(&format!("{place}.shape"), &spec.shape);
        let forbid = match &spec.forbid {
            Some(forbid) => Some(self.shape(&format!("{place}.forbid"), forbid)?),
            None => None,
        };
        let shape = shape?;
        if shape.has_outline(spec.nodes.is_plane()) {
            let message = if spec.nodes.is_plane() {
                "letters and pictures have no `depth` in the plane"
            } else {
                "letters and pictures need a `depth` in space"
            };
            self.wrong(&format!("{place}.shape"), message.to_owned());
            return None;
        }
        let up = if spec.nodes.is_plane() { 1 } else { 2 };
        let fields: Vec<_> = spec
            .field
            .iter()
            .map(|(key, field)| self.field(&format!("{place}.field.{key}"), field, shape.bounds(), up))
            .collect();
        let fields = fields.into_iter().collect::<Option<_>>()?;
        let (weights, stream) = (spec.weights, spec.stream.clone().unwrap_or_else(|| name.to_owned()));
        match spec.nodes {
            NodesSpec::Lattice(LatticeSpec { spacing, neighbours }) => {
                if spec.clusters.is_some() {
                    let message = "clusters need scattered nodes (`nodes.scatter`)".to_owned();
                    self.wrong(&format!("{place}.clusters"), message);
                }
                let window = LatticeSpace::window(&shape, spacing, neighbours);
                let window = self.note(&format!("{place}.nodes.lattice.spacing"), window)?;
                Some(Space::Lattice(LatticeSpace { shape, forbid, window, neighbours, weights, fields, stream }))
            }
            NodesSpec::Voxels(VoxelNodesSpec { side }) => {
                let given = [
                    ("weights", spec.weights != Weights::default()),
                    ("field", !spec.field.is_empty()),
                    ("clusters", spec.clusters.is_some()),
                    ("stream", spec.stream.is_some()),
                ];
                for (key, _) in given.iter().filter(|(_, is_given)| *is_given) {
                    self.wrong(
                        &format!("{place}.{key}"),
                        format!("voxels have no `{key}`: nothing is planned in them"),
                    );
                }
                let sampled = |shape: Shape| shape.sampled(side);
                let space = VoxelSpace { shape: sampled(shape), forbid: forbid.map(sampled), side };
                self.note(&format!("{place}.nodes.voxels"), space.check())?;
                Some(Space::Voxels(space))
            }
            NodesSpec::Scatter(ScatterSpec { spacing, sectors, radius, plane }) => {
                let joining = match (sectors, radius) {
                    (Some(_), Some(_)) => Err("nodes are joined either by `sectors` or within a `radius`".to_owned()),
                    (_, Some(radius)) => Ok(Joining::Radius(radius)),
                    (sectors, None) => Sectors::new(sectors.unwrap_or(if plane { 6 } else { 8 }), plane)
                        .map(Joining::Yao)
                        .map_err(String::from),
                };
                let joining = self.note(&format!("{place}.nodes.scatter"), joining)?;
                let clusters = match &spec.clusters {
                    Some(clusters) => Some(Clusters {
                        inside: self.shape(&format!("{place}.clusters.inside"), &clusters.inside)?,
                        apart: clusters.apart,
                        radius: clusters.radius,
                        foot: clusters.foot.0,
                        neck: clusters.neck,
                    }),
                    None => None,
                };
                let space = ScatterSpace {
                    shape,
                    forbid,
                    spacing,
                    is_plane: plane,
                    joining,
                    clusters,
                    weights,
                    fields,
                    stream,
                };
                let estimate = space.estimate();
                if estimate.is_nan() || estimate > MOST_SCATTERED {
                    let message = format!(
                        "about {estimate:.1e} nodes are too many ({MOST_SCATTERED:.0e} at most): use a wider spacing or a smaller shape"
                    );
                    self.wrong(&format!("{place}.nodes.scatter.spacing"), message);
                    return None;
                }
                let edges = space.edges_estimate();
                if edges > MOST_EDGES {
                    let message = format!(
                        "about {edges:.1e} edges are too many ({MOST_EDGES:.0e} at most): use a smaller radius"
                    );
                    self.wrong(&format!("{place}.nodes.scatter.radius"), message);
                    return None;
                }
                let size = space.shape.bounds().size();
                if !plane && size.min_element() <= 0.0 && !space.shape.bounds().is_empty() {
                    let message = "a shape in space needs a thickness; for a flat scene set `plane = true`".to_owned();
                    self.wrong(&format!("{place}.shape"), message);
                    return None;
                }
                Some(Space::Scatter(space))
            }
        }
    }

    fn field(&mut self, place: &str, spec: &FieldSpec, frame: Bounds, up: usize) -> Option<CostField> {
        let upright = if up == 1 { DVec3::Y } else { DVec3::Z };
        let of = |key: &str| format!("{place}.of.{key}");
        let measure = match &spec.of {
            MeasureSpec::Axis { along, through } => {
                let along = along.map_or(upright, |p| p.0);
                let unit = along.try_normalize().ok_or("an axis needs a direction, not the zero vector");
                Measure::Axis { through: through.map_or(DVec3::ZERO, |p| p.0), along: self.note(&of("axis"), unit)? }
            }
            MeasureSpec::Point(Point(p)) => Measure::Point(*p),
            MeasureSpec::Height { cheap } => {
                let (low, high) = (frame.min[up], frame.max[up]);
                if low == high {
                    self.wrong(&of("height"), "the space has no height".to_owned());
                    return None;
                }
                let (cheap, dear) = if *cheap == HeightEnd::Low { (low, high) } else { (high, low) };
                Measure::Height { up, cheap, dear }
            }
            MeasureSpec::Shape(shape) => Measure::Shape(self.shape(&of("shape"), shape)?),
            MeasureSpec::Map { file } => {
                let picture = self
                    .folder
                    .read(file)
                    .and_then(|bytes| decode_grey(&bytes).map_err(|error| format!("cannot read `{file}`: {error}")));
                Measure::Map { picture: Arc::new(self.note(&of("map.file"), picture)?), frame, up }
            }
            MeasureSpec::Sketch { file } => {
                let lines = self.sketch(&of("sketch.file"), file, frame, up)?.0;
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

    /// The strokes and the points of an SVG file, its page stretched over `frame`: (across, up, 0).
    fn sketch(&mut self, place: &str, file: &str, frame: Bounds, up: usize) -> Option<(Vec<Vec<DVec3>>, Vec<DVec3>)> {
        let page = self
            .folder
            .read(file)
            .and_then(|bytes| decode_sketch(&bytes).map_err(|error| format!("cannot read `{file}`: {error}")));
        let page = self.note(place, page)?;
        let size = frame.size();
        let stretch = |p: DVec2| DVec3::new(frame.min.x + p.x * size.x, frame.min[up] + p.y * size[up], 0.0);
        let lines = page.lines.iter().map(|(line, _)| line.iter().map(|&p| stretch(p)).collect()).collect();
        Some((lines, page.points().map(stretch).collect()))
    }

    /// Steps that wait for each other are an error.
    pub(super) fn circles(&mut self, steps: &[Option<Step>]) {
        let mut has_grown = vec![false; steps.len()];
        for _ in 0..steps.len() {
            for (i, step) in steps.iter().enumerate() {
                has_grown[i] |= step.as_ref().is_none_or(|step| step.after().all(|before| has_grown[before]));
            }
        }
        let names: Vec<String> = self.scene.grow.keys().cloned().collect();
        if let Some(stuck) = has_grown.iter().position(|grown| !grown) {
            let message = "this step waits for itself: it grows from, or near, a step that waits for it".to_owned();
            self.wrong(&format!("grow.{}", names[stuck]), message);
        }
    }

    fn near(
        &mut self,
        place: &str,
        spec: &EndpointSpec,
        near: &NearSpec,
        stream: String,
        inside: Shape,
    ) -> Option<Near> {
        let step = self.find(&format!("{place}.near.step"), "step", &near.step, self.scene.grow.keys())?;
        Some(Near {
            count: spec.count.as_ref()?.once()? as u32,
            step,
            reach: near.reach,
            toward: near.toward,
            lower: near.lower,
            shorten: near.shorten,
            inside,
            apart: spec.apart,
            stream,
        })
    }

    pub(super) fn step(
        &mut self,
        name: &str,
        spec: &StepSpec,
        spaces: &BTreeMap<&String, Option<Space>>,
        pixel: Option<f64>,
    ) -> Option<Step> {
        let place = format!("grow.{name}");
        let is_free = matches!(spec.by, MethodSpec::Segments(_));
        let space = match &spec.space {
            Some(name) => {
                self.find(&format!("{place}.space"), "space", name, self.scene.space.keys());
                if is_free {
                    let message = "growth by segments needs no space: it stays `inside` a shape".to_owned();
                    self.wrong(&format!("{place}.space"), message);
                }
                spaces.get(&name.name).cloned().flatten()
            }
            None => {
                if !is_free {
                    self.wrong(&format!("{place}.space"), "this way of growing needs a `space`".to_owned());
                }
                None
            }
        };
        let mut classes: Vec<String> = spec.to.values().map(|set| set.class.clone()).collect();
        classes.sort();
        classes.dedup();
        let source = match &spec.from {
            FromSpec::At(points) => Some(Generators::At(points.iter().map(|p| p.0).collect())),
            FromSpec::Inside(shape) => self.shape(&format!("{place}.from.inside"), shape).map(Generators::Inside),
            FromSpec::Spread(spread) => self.spread(&place, name, spread, spec),
            FromSpec::All(step) => self
                .find(&format!("{place}.from.all"), "step", step, self.scene.grow.keys())
                .map(|step| Generators::Steps(vec![step], Part::All)),
            FromSpec::Ends(step) => self
                .find(&format!("{place}.from.ends"), "step", step, self.scene.grow.keys())
                .map(|step| Generators::Steps(vec![step], Part::Ends)),
            FromSpec::EveryEnd(steps) => {
                let found: Vec<_> = (0..)
                    .zip(steps)
                    .map(|(i, step): (usize, _)| {
                        self.find(&format!("{place}.from.every_end.{i}"), "step", step, self.scene.grow.keys())
                    })
                    .collect();
                found.into_iter().collect::<Option<_>>().map(|steps| Generators::Steps(steps, Part::EveryEnd))
            }
        };
        if spec.along > 0.0 && (is_first(&spec.from) || spec.repeat.is_some()) {
            let message =
                "`along` is about the step that this one grows from: it needs `from.all` or `from.ends`, and no `repeat`".to_owned();
            self.wrong(&format!("{place}.along"), message);
        }
        let method = self.method(&place, spec, space.as_ref(), &mut classes);
        let refine = match &spec.refine {
            Some(refine) => {
                let Some(lattice) = space.as_ref()?.lattice() else {
                    let message = "paths are refined on lattices: scattered nodes take a smaller spacing".to_owned();
                    self.wrong(&format!("{place}.refine"), message);
                    return None;
                };
                let refine = refine.resolve(lattice.window.spacing, pixel);
                Some(self.note(&format!("{place}.refine"), refine)?)
            }
            None => None,
        };
        // Regions have none.
        let width = spec.width.clone().unwrap_or(Width::Constant(0.0));
        let widths = width.check(&classes);
        self.note(&format!("{place}.width"), widths);
        let repeat = match &spec.repeat {
            Some(repeat) => Some(self.repeat(&place, repeat, spec, space.as_ref())?),
            None => None,
        };
        self.plant_width(&place, spec);
        let rounds = spec.repeat.as_ref().map(super::repeat::indices);
        let sets: Vec<_> = spec
            .to
            .iter()
            .map(|(key, set)| {
                let to = format!("{place}.to.{key}");
                let placement = self.placement(&to, &format!("{name}/{key}"), set, space.as_ref(), rounds);
                let class = classes.binary_search(&set.class).unwrap_or(0) as u16;
                placement.map(|placement| Endpoints { name: key.clone(), class, placement })
            })
            .collect();
        let step = Step {
            name: name.to_owned(),
            space: if is_free { None } else { Some(space?) },
            space_name: spec.space.as_ref().map_or_else(String::new, |space| space.name.clone()),
            source: source?,
            endpoints: sets.into_iter().collect::<Option<_>>()?,
            classes,
            method: method?,
            along: spec.along,
            refine,
            repeat,
            width,
            strands: spec.strands,
            symmetry: spec.symmetry,
            form: spec.form,
            smooth: spec.smooth,
            unreached: spec.unreached,
        };
        if step.repeat.is_some() && !step.solids().is_empty() {
            let message = "a repeated step cannot depend on what another step grew as a solid".to_owned();
            self.wrong(&format!("{place}.repeat"), message);
        }
        Some(step)
    }

    /// `rounds` are those of a repeated step.
    fn placement(
        &mut self,
        place: &str,
        own: &str,
        spec: &EndpointSpec,
        space: Option<&Space>,
        rounds: Option<u32>,
    ) -> Option<Placement> {
        if spec.count.is_none() {
            let given = [
                ("near", spec.near.is_some()),
                ("inside", spec.inside.is_some()),
                ("shell", spec.shell.is_some()),
                ("apart", spec.apart > 0.0),
            ];
            for (key, _) in given.iter().filter(|(_, is_given)| *is_given) {
                let message = format!("`{key}` says where endpoints are placed at random: it needs `count`");
                self.wrong(&format!("{place}.{key}"), message);
            }
        }
        if rounds.is_some() && (spec.count.is_none() || spec.near.is_some()) {
            let message =
                "a repeated step places its endpoints at random around each end: it needs `count`, and no `near`";
            self.wrong(place, message.to_owned());
            return None;
        }
        match (&spec.count, &spec.at, &spec.sketch, &spec.through, &spec.grammar) {
            (Some(count), None, None, None, None) => {
                self.count(&format!("{place}.count"), count, rounds)?;
                let stream = spec.stream.clone().unwrap_or_else(|| own.to_owned());
                let inside = match &spec.inside {
                    Some(inside) => Some(self.shape(&format!("{place}.inside"), inside)?),
                    None => None,
                };
                if let Some(near) = &spec.near {
                    if spec.shell.is_some() {
                        self.wrong(&format!("{place}.shell"), "`near` and `shell` do not go together".to_owned());
                    }
                    let inside = inside.or_else(|| space.map(|space| space.shape().clone()))?;
                    return self.near(place, spec, near, stream, inside).map(Placement::Near);
                }
                let (count, apart, shell) = (count.clone(), spec.apart, spec.shell);
                Some(Placement::Random { count, inside, apart, shell, stream })
            }
            (None, Some(points), None, None, None) => {
                if points.is_empty() {
                    self.wrong(&format!("{place}.at"), "list at least one endpoint".to_owned());
                }
                Some(Placement::At(points.iter().map(|p| p.0).collect()))
            }
            (None, None, None, Some(lists), None) => {
                if lists.is_empty() || lists.iter().any(Vec::is_empty) {
                    self.wrong(&format!("{place}.through"), "list at least one point for each path".to_owned());
                }
                if space?.lattice().is_some() {
                    let message = "`through` needs scattered nodes (`nodes.scatter`)".to_owned();
                    self.wrong(&format!("{place}.through"), message);
                }
                Some(Placement::Through(lists.iter().map(|list| list.iter().map(|p| p.0).collect()).collect()))
            }
            (None, None, None, None, Some(grammar)) => {
                let ends = grammar.endpoints(space?.up() == 1);
                self.note(&format!("{place}.grammar"), ends).map(Placement::At)
            }
            (None, None, Some(file), None, None) => {
                let space = space?;
                let frame = space.shape().bounds();
                let (_, points) = self.sketch(&format!("{place}.sketch"), file, frame, space.up())?;
                let raise = |p: DVec3| if space.up() == 1 { p } else { DVec3::new(p.x, frame.centre().y, p.y) };
                Some(Placement::At(points.into_iter().map(raise).collect()))
            }
            _ => {
                let message = "endpoints need exactly one of `count` (at random), `at` (a list), `through` (lists), `sketch` (an SVG file) and `grammar` (an L-system)";
                self.wrong(place, message.to_owned());
                None
            }
        }
    }

    /// Counts are whole, and there is at least one in some round.
    fn count(&mut self, place: &str, count: &PerRound, rounds: Option<u32>) -> Option<()> {
        let least = if rounds.is_some() { 0.0 } else { 1.0 };
        let all = rounds.unwrap_or(1);
        let is_whole = (0..all).all(|round| count.at(round) == libm::floor(count.at(round)) || count.once().is_none());
        if rounds.is_none() && count.once().is_none() {
            self.wrong(place, "a number for each round needs `repeat`".to_owned());
        } else if !count.is_within(all, least, 1e6) || !is_whole {
            let found: Vec<String> = (0..all.min(8)).map(|round| count.at(round).to_string()).collect();
            self.wrong(place, format!("expected whole numbers from {least} to 1000000, found {}", found.join(", ")));
        } else if (0..all).all(|round| count.at(round) < 1.0) {
            self.wrong(place, "no round has an endpoint: nothing would grow".to_owned());
        } else {
            return Some(());
        }
        None
    }
}
