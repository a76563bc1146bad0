//! Spaces and steps: their names and files are looked up.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::resolve::Resolver;
use crate::files::{decode_grey, decode_sketch};
use crate::geom::{Bounds, Shape, Strokes};
use crate::graph::{CostField, FieldSpec, FieldUse, HeightEnd, Measure, MeasureSpec};
use crate::grow::{
    EndpointSpec, Endpoints, FromSpec, LatticeSpec, Method, MethodSpec, Near, NearSpec, NodesSpec, Part, Placement,
    SIDE, Source as Generators, Space, SpaceSpec, Step, StepSpec,
};
use crate::math::{DVec2, DVec3, Point};

/// The dielectric breakdown model solves for all nodes again and again: more would take days.
const MOST_DBM: u64 = 4 << 20;

impl Resolver<'_> {
    pub(super) fn space(&mut self, name: &str, spec: &SpaceSpec) -> Option<Space> {
        let place = format!("space.{name}");
        let shape = self.shape(&format!("{place}.shape"), &spec.shape);
        let forbid = match &spec.forbid {
            Some(forbid) => Some(self.shape(&format!("{place}.forbid"), forbid)?),
            None => None,
        };
        let NodesSpec::Lattice(LatticeSpec { spacing, neighbours }) = spec.nodes;
        let shape = shape?;
        let window =
            self.note(&format!("{place}.nodes.lattice.spacing"), Space::window(&shape, spacing, neighbours))?;
        let up = if neighbours.dimensions() == 2 { 1 } else { 2 };
        let fields: Vec<_> = spec
            .field
            .iter()
            .map(|(key, field)| self.field(&format!("{place}.field.{key}"), field, shape.bounds(), up))
            .collect();
        Some(Space {
            shape,
            forbid,
            window,
            neighbours,
            weights: spec.weights,
            fields: fields.into_iter().collect::<Option<_>>()?,
            stream: spec.stream.clone().unwrap_or_else(|| name.to_owned()),
        })
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
            count: spec.count?,
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
        self.find(&format!("{place}.space"), "space", &spec.space, self.scene.space.keys());
        let space = spaces.get(&spec.space.name).cloned().flatten();
        let mut classes: Vec<String> = spec.to.values().map(|set| set.class.clone()).collect();
        classes.sort();
        classes.dedup();
        if spec.to.is_empty() {
            self.wrong(&format!("{place}.to"), "a step needs at least one set of endpoints, `to.NAME`".to_owned());
        }
        let source = match &spec.from {
            FromSpec::At(points) => Some(Generators::At(points.iter().map(|p| p.0).collect())),
            FromSpec::Inside(shape) => self.shape(&format!("{place}.from.inside"), shape).map(Generators::Inside),
            FromSpec::All(step) => self
                .find(&format!("{place}.from.all"), "step", step, self.scene.grow.keys())
                .map(|step| Generators::Step(step, Part::All)),
            FromSpec::Ends(step) => self
                .find(&format!("{place}.from.ends"), "step", step, self.scene.grow.keys())
                .map(|step| Generators::Step(step, Part::Ends)),
        };
        if spec.along > 0.0 && !matches!(spec.from, FromSpec::All(_) | FromSpec::Ends(_)) {
            let message =
                "`along` is about the step that this one grows from: it needs `from.all` or `from.ends`".to_owned();
            self.wrong(&format!("{place}.along"), message);
        }
        let method = match spec.by {
            MethodSpec::Paths => Method::Paths,
            MethodSpec::Dbm(dbm) => {
                if space.as_ref().is_some_and(|space| space.window.nodes() > MOST_DBM) {
                    let message =
                        format!("the dielectric breakdown model takes {MOST_DBM} nodes at most: use a wider spacing");
                    self.wrong(&format!("{place}.space"), message);
                }
                classes.push(SIDE.to_owned());
                classes.sort();
                classes.dedup();
                Method::Dbm(dbm)
            }
        };
        let refine = match &spec.refine {
            Some(refine) => {
                let refine = refine.resolve(space.as_ref()?.window.spacing, pixel);
                Some(self.note(&format!("{place}.refine"), refine)?)
            }
            None => None,
        };
        let widths = spec.width.check(&classes);
        self.note(&format!("{place}.width"), widths);
        let sets: Vec<_> = spec
            .to
            .iter()
            .map(|(key, set)| {
                let placement =
                    self.placement(&format!("{place}.to.{key}"), &format!("{name}/{key}"), set, space.as_ref());
                let class = classes.binary_search(&set.class).unwrap_or(0) as u16;
                placement.map(|placement| Endpoints { name: key.clone(), class, placement })
            })
            .collect();
        Some(Step {
            name: name.to_owned(),
            space: space?,
            space_name: spec.space.name.clone(),
            source: source?,
            endpoints: sets.into_iter().collect::<Option<_>>()?,
            classes,
            method,
            along: spec.along,
            refine,
            width: spec.width.clone(),
            smooth: spec.smooth,
            unreached: spec.unreached,
        })
    }

    fn placement(&mut self, place: &str, own: &str, spec: &EndpointSpec, space: Option<&Space>) -> Option<Placement> {
        if spec.count.is_none() {
            let given = [("near", spec.near.is_some()), ("inside", spec.inside.is_some()), ("apart", spec.apart > 0.0)];
            for (key, _) in given.iter().filter(|(_, is_given)| *is_given) {
                let message = format!("`{key}` says where endpoints are placed at random: it needs `count`");
                self.wrong(&format!("{place}.{key}"), message);
            }
        }
        match (&spec.count, &spec.at, &spec.sketch) {
            (Some(count), None, None) => {
                let inside = match &spec.inside {
                    Some(inside) => self.shape(&format!("{place}.inside"), inside)?,
                    None => space?.shape.clone(),
                };
                let stream = spec.stream.clone().unwrap_or_else(|| own.to_owned());
                if let Some(near) = &spec.near {
                    return self.near(place, spec, near, stream, inside).map(Placement::Near);
                }
                Some(Placement::Random { count: *count, inside, apart: spec.apart, stream })
            }
            (None, Some(points), None) => {
                if points.is_empty() {
                    self.wrong(&format!("{place}.at"), "list at least one endpoint".to_owned());
                }
                Some(Placement::At(points.iter().map(|p| p.0).collect()))
            }
            (None, None, Some(file)) => {
                let space = space?;
                let frame = space.shape.bounds();
                let (_, points) = self.sketch(&format!("{place}.sketch"), file, frame, space.up())?;
                let raise = |p: DVec3| if space.up() == 1 { p } else { DVec3::new(p.x, frame.centre().y, p.y) };
                Some(Placement::At(points.into_iter().map(raise).collect()))
            }
            _ => {
                let message =
                    "endpoints need exactly one of `count` (at random), `at` (a list) and `sketch` (an SVG file)";
                self.wrong(place, message.to_owned());
                None
            }
        }
    }
}
