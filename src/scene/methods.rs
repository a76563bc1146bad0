//! How steps grow: which keys go with which method, and what shapes name of other steps.

use super::Scene;
use super::resolve::Resolver;
use crate::files::Folder;
use crate::geom::{MeshParts, Rings, ShapeFiles, ShapeSpec, SketchLines};
use crate::grow::{FromSpec, Method, MethodSpec, Placement, SIDE, Source, Space, SpreadSpec, StepSpec};
use crate::math::{PerRound, unknown};

/// The dielectric breakdown model solves for all nodes again and again: more would take days.
const MOST_DBM: u64 = 4 << 20;
/// Fields that keep eight bytes a node, and walks that keep some: no more nodes than this.
const MOST_DENSE: u64 = 1 << 27;
/// The class of limbs that have no endpoints.
const MAIN: &str = "main";

/// What the shapes of a scene may name: files beside it, and its steps.
pub(super) struct Names<'a> {
    pub folder: &'a Folder,
    pub scene: &'a Scene,
}

impl ShapeFiles for Names<'_> {
    fn letters(&self, text: &str, file: Option<&str>) -> Result<Rings, String> {
        self.folder.letters(text, file)
    }

    fn picture_outlines(&self, file: &str, threshold: f64, bright: bool) -> Result<Rings, String> {
        self.folder.picture_outlines(file, threshold, bright)
    }

    fn sketch_lines(&self, file: &str) -> Result<SketchLines, String> {
        self.folder.sketch_lines(file)
    }

    fn mesh_parts(&self, file: &str) -> Result<MeshParts, String> {
        self.folder.mesh_parts(file)
    }

    fn solid_step(&self, name: &str) -> Result<(usize, ShapeSpec), String> {
        let steps = &self.scene.grow;
        let index = steps.keys().position(|key| key == name).ok_or_else(|| unknown("step", name, steps.keys()))?;
        let step = &steps[name];
        if !matches!(step.by, MethodSpec::Regions(_)) {
            return Err(format!("step `{name}` grows limbs: only steps with `by.regions` are shapes"));
        }
        let of = step.space.as_ref().map_or("", |space| &space.name);
        let space = self.scene.space.get(of);
        let space = space.ok_or_else(|| unknown("space", of, self.scene.space.keys()))?;
        Ok((index, space.shape.clone()))
    }
}

impl Resolver<'_> {
    /// How the step at `place` grows; keys that do not go with it are noted. `classes` gets those of its own.
    pub(super) fn method(
        &mut self,
        place: &str,
        spec: &StepSpec,
        space: Option<&Space>,
        classes: &mut Vec<String>,
    ) -> Option<Method> {
        let lattice = space.and_then(Space::lattice);
        let nodes = lattice.map_or(0, |space| space.window.nodes());
        let is_paths = spec.by == MethodSpec::Paths;
        let is_free = matches!(spec.by, MethodSpec::Segments(_) | MethodSpec::Voxels(_));
        match (&spec.by, space) {
            (_, None) | (MethodSpec::Voxels(_), Some(Space::Voxels(_))) => {}
            (MethodSpec::Voxels(_), Some(_)) => {
                self.wrong(&format!("{place}.space"), "growth by voxels needs a space with `nodes.voxels`".to_owned());
            }
            (_, Some(Space::Voxels(_))) => {
                let message = "in voxels there is nothing but growth `by.voxels`".to_owned();
                self.wrong(&format!("{place}.space"), message);
            }
            (_, Some(_)) if !is_paths && lattice.is_none() => {
                let message = "only paths are planned among scattered nodes: this needs a lattice".to_owned();
                self.wrong(&format!("{place}.by"), message);
            }
            _ => {}
        }
        if spec.toward.is_some() && !is_free {
            let message = "an attractor is for growth by segments and by voxels".to_owned();
            self.wrong(&format!("{place}.toward"), message);
        }
        let mut without = |key: &str, is_given: bool, what: &str| {
            if is_given {
                self.wrong(&format!("{place}.{key}"), format!("{what} no `{key}`"));
            }
        };
        let what = match &spec.by {
            MethodSpec::Paths => "",
            MethodSpec::Fractal(_) => "fractal placement has",
            MethodSpec::Regions(_) => "regions have",
            MethodSpec::Dbm(_) | MethodSpec::Dla(_) => "an aggregate has",
            MethodSpec::Segments(_) => "growth by segments has",
            MethodSpec::Voxels(_) => "growth by voxels has",
        };
        if !is_paths {
            without("repeat", spec.repeat.is_some(), what);
            without("along", spec.along > 0.0, what);
        }
        let has_ends = matches!(spec.by, MethodSpec::Paths | MethodSpec::Fractal(_) | MethodSpec::Dbm(_));
        if !has_ends {
            without("to", !spec.to.is_empty(), what);
            without("refine", spec.refine.is_some(), what);
        }
        let is_solid = matches!(spec.by, MethodSpec::Regions(_));
        if is_solid {
            without("width", spec.width.is_some(), what);
            without("smooth", spec.smooth > 0.0, "regions have a `smooth` of their own, and");
            without("strands", spec.strands.is_some(), what);
            without("symmetry", spec.symmetry.is_some(), what);
            without("form", spec.form.is_some(), what);
        }
        if has_ends && spec.to.is_empty() {
            self.wrong(&format!("{place}.to"), "a step needs at least one set of endpoints, `to.NAME`".to_owned());
        }
        if !is_solid && spec.width.is_none() {
            self.wrong(&format!("{place}.width"), "limbs need a `width`".to_owned());
        }
        let limit = match &spec.by {
            MethodSpec::Dbm(_) => MOST_DBM,
            MethodSpec::Fractal(_) | MethodSpec::Regions(_) | MethodSpec::Dla(_) => MOST_DENSE,
            MethodSpec::Paths | MethodSpec::Segments(_) | MethodSpec::Voxels(_) => u64::MAX,
        };
        if nodes > limit {
            let message = format!("this way of growing takes {limit} nodes at most, not {nodes}: use a wider spacing");
            self.wrong(&format!("{place}.space"), message);
        }
        if is_free {
            classes.push(MAIN.to_owned());
        }
        Some(match &spec.by {
            MethodSpec::Paths => Method::Paths,
            MethodSpec::Segments(segments) => Method::Segments(self.segments(place, spec, segments)?),
            MethodSpec::Voxels(voxels) => Method::Voxels(self.voxels(place, spec, voxels, space)?),
            MethodSpec::Fractal(fractal) => {
                for (key, set) in &spec.to {
                    if set.count.is_none() || set.near.is_some() || set.shell.is_some() {
                        let message =
                            "fractal placement places endpoints itself: it needs `count`, and no `near` or `shell`";
                        self.wrong(&format!("{place}.to.{key}"), message.to_owned());
                    }
                }
                Method::Fractal(*fractal)
            }
            MethodSpec::Regions(regions) => Method::Regions(regions.clone()),
            MethodSpec::Dla(dla) => {
                classes.push(SIDE.to_owned());
                if lattice.is_some_and(|space| !space.shape.is_box() || space.forbid.is_some()) {
                    let message =
                        "aggregation needs the room of a box with nothing forbidden: its walkers come from outside"
                            .to_owned();
                    self.wrong(&format!("{place}.space"), message);
                }
                Method::Dla(*dla)
            }
            MethodSpec::Dbm(dbm) => {
                classes.push(SIDE.to_owned());
                classes.sort();
                classes.dedup();
                Method::Dbm(*dbm)
            }
        })
    }

    /// Generators at random.
    pub(super) fn spread(&mut self, place: &str, step: &str, spec: &SpreadSpec, spec_of: &StepSpec) -> Option<Source> {
        let inside = match &spec.inside {
            Some(inside) => Some(self.shape(&format!("{place}.from.spread.inside"), inside)?),
            None => None,
        };
        let is_lattice = spec_of
            .space
            .as_ref()
            .and_then(|space| self.scene.space.get(&space.name))
            .is_none_or(|space| space.nodes.is_lattice());
        if !is_lattice {
            let message = "random generators need a lattice: list them with `from.at`".to_owned();
            self.wrong(&format!("{place}.from.spread"), message);
        }
        Some(Source::Spread(Placement::Random {
            count: PerRound::All(f64::from(spec.count)),
            inside,
            shell: None,
            apart: spec.apart,
            stream: format!("{step}/from"),
        }))
    }
}

/// Does `from` name no step?
pub(super) fn is_first(from: &FromSpec) -> bool {
    matches!(from, FromSpec::At(_) | FromSpec::Inside(_) | FromSpec::Spread(_))
}
