//! Names and files of a scene, looked up; what is wrong is noted with its place.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::document::Scene;
use super::mistake::Mistake;
use super::tree::Entry;
use crate::files::{Folder, decode_grey, decode_sketch};
use crate::geom::{Bounds, MeshParts, Rings, Shape, ShapeError, ShapeFiles, ShapeSpec, SketchLines};
use crate::grow::{Expected, Lookup, MethodSpec, Sketched, Step, StepSpec};
use crate::math::{DVec2, DVec3, Ref, unknown};
use crate::raster::Grey;

/// What the shapes of a scene may name: files beside it, and its steps.
struct Names<'a> {
    folder: &'a Folder,
    scene: &'a Scene,
}

impl ShapeFiles for Names<'_> {
    fn letters(&self, text: &str, file: Option<&str>) -> Result<Rings, ShapeError> {
        self.folder.letters(text, file)
    }

    fn picture_outlines(&self, file: &str, threshold: f64, bright: bool) -> Result<Rings, ShapeError> {
        self.folder.picture_outlines(file, threshold, bright)
    }

    fn sketch_lines(&self, file: &str) -> Result<SketchLines, ShapeError> {
        self.folder.sketch_lines(file)
    }

    fn mesh_parts(&self, file: &str) -> Result<MeshParts, ShapeError> {
        self.folder.mesh_parts(file)
    }

    fn solid_step(&self, name: &str) -> Result<(usize, ShapeSpec), ShapeError> {
        let steps = &self.scene.grow;
        let index = steps.keys().position(|key| key == name);
        let index = index.ok_or_else(|| ShapeError::Unknown(unknown("step", name, steps.keys())))?;
        let step = &steps[name];
        if !matches!(step.by, MethodSpec::Regions(_)) {
            return Err(ShapeError::Limbs(name.to_owned()));
        }
        let of = step.space.as_ref().map_or("", |space| &space.name);
        let space = self.scene.space.get(of);
        let space = space.ok_or_else(|| ShapeError::Unknown(unknown("space", of, self.scene.space.keys())))?;
        Ok((index, space.shape.clone()))
    }
}

/// A scene while it is resolved.
pub(super) struct Resolver<'a> {
    pub scene: &'a Scene,
    pub folder: &'a Folder,
    /// Size of a pixel, where there is a view.
    pub pixel: Option<f64>,
    /// What steps are expected to grow.
    pub expected: BTreeMap<String, Expected>,
    pub tree: &'a Entry,
    pub mistakes: &'a mut Vec<Mistake>,
}

impl<'a> Resolver<'a> {
    pub fn wrong(&mut self, place: &str, message: String) {
        self.mistakes.push(Mistake { span: self.tree.find_span(place), place: place.to_owned(), message });
    }

    /// The value, or its error noted at `place`.
    pub fn note<T>(&mut self, place: &str, result: Result<T, impl ToString>) -> Option<T> {
        result.map_err(|error| self.wrong(place, error.to_string())).ok()
    }

    /// The index of `name` among `known`.
    pub fn find<'b, T>(
        &mut self,
        place: &str,
        kind: &str,
        name: &Ref<T>,
        known: impl Iterator<Item = &'b String> + Clone,
    ) -> Option<usize> {
        let found = known.clone().position(|k| *k == name.name);
        if found.is_none() {
            self.wrong(place, unknown(kind, &name.name, known));
        }
        found
    }

    pub fn shape(&mut self, place: &str, spec: &ShapeSpec) -> Option<Shape> {
        let names = Names { folder: self.folder, scene: self.scene };
        let shape = spec.resolve(&self.scene.shape, &names);
        self.note(place, shape)
    }

    /// Is the scene flat?
    pub fn is_flat(&self) -> bool {
        self.scene.space.values().next().is_some_and(|spec| spec.nodes.is_plane())
    }

    /// The decoded contents of `file`, or its error noted at `place`.
    pub fn read<T, E: ToString>(
        &mut self,
        place: &str,
        file: &str,
        decode: impl FnOnce(&[u8]) -> Result<T, E>,
    ) -> Option<T> {
        let wrong = |error: E| format!("cannot read `{file}`: {}", error.to_string());
        let read = self.folder.read(file).map_err(|error| error.to_string());
        self.note(place, read.and_then(|bytes| decode(&bytes).map_err(wrong)))
    }

    /// Looks up what stands below `prefix`.
    pub fn below<'r>(&'r mut self, prefix: &'r str) -> Below<'r, 'a> {
        Below { resolver: self, prefix }
    }
}

/// Lookups of a step or a space, whose keys lie below a prefix.
pub(super) struct Below<'r, 'a> {
    resolver: &'r mut Resolver<'a>,
    prefix: &'r str,
}

impl Below<'_, '_> {
    fn at(&self, key: &str) -> String {
        format!("{}.{key}", self.prefix)
    }
}

impl Lookup for Below<'_, '_> {
    fn wrong(&mut self, key: &str, message: String) {
        let place = self.at(key);
        self.resolver.wrong(&place, message);
    }

    fn shape(&mut self, key: &str, spec: &ShapeSpec) -> Option<Shape> {
        let place = self.at(key);
        self.resolver.shape(&place, spec)
    }

    fn grey(&mut self, key: &str, file: &str) -> Option<Arc<Grey>> {
        let place = self.at(key);
        self.resolver.read(&place, file, decode_grey).map(Arc::new)
    }

    fn sketch(&mut self, key: &str, file: &str, frame: Bounds, up: usize) -> Option<Sketched> {
        let place = self.at(key);
        let page = self.resolver.read(&place, file, decode_sketch)?;
        let size = frame.size();
        let stretch = |p: DVec2| DVec3::new(frame.min.x + p.x * size.x, frame.min[up] + p.y * size[up], 0.0);
        let lines = page.lines.iter().map(|(line, _)| line.iter().map(|&p| stretch(p)).collect()).collect();
        Some((lines, page.points().map(stretch).collect()))
    }

    fn step(&mut self, key: &str, name: &Ref<Step>) -> Option<usize> {
        let place = self.at(key);
        self.resolver.find(&place, "step", name, self.resolver.scene.grow.keys())
    }

    fn steps(&self) -> &BTreeMap<String, StepSpec> {
        &self.resolver.scene.grow
    }

    fn expected(&self, step: &str) -> Expected {
        self.resolver.expected.get(step).copied().unwrap_or_default()
    }

    fn is_flat(&self) -> bool {
        self.resolver.is_flat()
    }

    fn pixel(&self) -> Option<f64> {
        self.resolver.pixel
    }
}
