//! RenderMan RIB: a scene, and an archive of its objects, in what Pixie and Aqsis both take (`reference/rib.md`).

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use super::rib_body::write_object;
use super::rib_options::RibOptions;
use super::rib_sheets::sheet_bytes_needed;
use super::rib_stage::in_front;
use super::rib_surface::is_leaf;
use super::rib_values::{RibValues, has_casters, values};
use super::{Origin, TemplateError, Templates};
use crate::model::{Body, Light, Limbs, Model, Object, Pattern};

/// An archive of a scene's objects, where they stand in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RibPart {
    /// `NAME.archive.rib`: what the scene is of.
    Archive,
    /// `NAME.casters.rib`: what of it casts shadows.
    Casters,
    /// `NAME.stage.rib`: what stands about it.
    Stage,
}

/// A model on its way to RIB.
pub struct Rib<'a> {
    model: &'a Model,
    templates: &'a Templates,
    options: RibOptions,
    /// Pixels across the picture.
    width: u32,
    values: RibValues,
}

impl<'a> Rib<'a> {
    /// `name` gives the files their stem; `size` is the picture's, in pixels.
    #[must_use]
    pub fn new(
        model: &'a Model,
        templates: &'a Templates,
        name: &str,
        size: [u32; 2],
        origin: &Origin,
        options: RibOptions,
    ) -> Self {
        Self { model, templates, options, width: size[0], values: values(model, name, size, origin, options) }
    }

    /// Bytes that its texts take for a picture of `size` pixels, besides what is streamed.
    #[must_use]
    pub fn bytes_needed(model: &Model, size: [u32; 2], options: RibOptions) -> u64 {
        let limbs = model.objects.iter().filter_map(|object| object.body.limbs());
        let fewer = limbs.filter(|_| options.detail > 0.0).map(Limbs::bytes_within).max();
        // Scenery is cut off before the camera, one object after the other.
        let scenery = model.objects.iter().filter(|object| object.is_scenery);
        let cut = scenery.map(|object| object.body.bytes() as u64 + size_of_val(&object.instances[..]) as u64).max();
        sheet_bytes_needed(model, size) + fewer.max(cut).unwrap_or(0)
    }

    /// The text of `NAME.rib`, without the line that tells whether it was edited.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidData`] around a [`TemplateError`].
    pub fn scene(&self) -> io::Result<String> {
        self.templates.fill("scene.rib", &self.values).map_err(invalid)
    }

    /// The files that [`Self::shaders`] may name.
    pub fn shader_files() -> impl Iterator<Item = String> {
        ["thorns", "fadepoint", "leaf"].into_iter().chain(Pattern::NAMES).map(|name| format!("{name}.sl"))
    }

    /// The shaders that the scene uses and no renderer has, by file name: they must be compiled.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidData`] around a [`TemplateError`].
    pub fn shaders(&self) -> io::Result<Vec<(String, String)>> {
        let objects = || self.model.objects.iter();
        let limbs = || objects().filter_map(|object| object.body.limbs());
        let mut names = BTreeMap::new();
        if self.options.displace && limbs().any(|limbs| limbs.thorns.is_some()) {
            names.insert("thorns", None);
        }
        if self.model.lights.iter().any(|light| matches!(light, Light::Point { .. })) {
            names.insert("fadepoint", None);
        }
        if objects().any(|object| is_leaf(object, &self.model.materials[object.material].1)) {
            names.insert("leaf", None);
        }
        let laid = objects().filter(|object| object.body.limbs().is_some());
        let patterns = laid.filter_map(|object| self.model.materials[object.material].1.pattern);
        for pattern in patterns {
            names.insert(pattern.figure().name(), Some(pattern.figure().share().to_string()));
        }
        let text = |name: &str, share: Option<String>| match share {
            None => Ok(self.templates.text(&format!("{name}.sl")).to_owned()),
            Some(share) => self.templates.fill("pattern.sl", BTreeMap::from([("name", name), ("share", &share)])),
        };
        let texts = names.into_iter().map(|(name, share)| Ok((format!("{name}.sl"), text(name, share)?)));
        texts.collect::<Result<_, TemplateError>>().map_err(invalid)
    }

    /// Do its shadow maps need an archive of their own, `NAME.casters.rib`, since some objects cast no shadow?
    #[must_use]
    pub fn has_casters(&self) -> bool {
        has_casters(self.model, self.options)
    }

    /// Does anything stand about its objects, in an archive of its own, `NAME.stage.rib`?
    #[must_use]
    pub fn has_stage(&self) -> bool {
        self.model.has_scenery()
    }

    /// Writes one of its archives.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_part(&self, part: RibPart, mut out: impl Write) -> io::Result<()> {
        writeln!(out, "##RenderMan RIB-Structure 1.1 Entity\nversion 3.03")?;
        let is_wanted = |object: &Object| match part {
            RibPart::Archive => !object.is_scenery,
            RibPart::Casters => !object.is_scenery && object.shadow,
            RibPart::Stage => object.is_scenery,
        };
        let is_thorns = |object: &Object| object.body.limbs().is_some_and(|limbs| limbs.is_thorns);
        let shown = |object: &&Object| is_wanted(object) && !(self.options.displace && is_thorns(object));
        // A scene reads several archives: no number is used again.
        for (handle, object) in (1..).zip(&self.model.objects).filter(|(_, object)| shown(object)) {
            let (_, material) = &self.model.materials[object.material];
            let shown = self.detailed(object);
            if !shown.instances.is_empty() {
                write_object(&shown, material, handle, self.options, &mut out)?;
            }
        }
        Ok(())
    }

    /// `object`, without what the picture is too coarse to show or what is behind the camera.
    fn detailed<'o>(&self, object: &'o Object) -> Cow<'o, Object> {
        match &object.body {
            _ if object.is_scenery => Cow::Owned(in_front(object, &self.model.camera, self.values.near)),
            Body::Limbs(limbs) if self.options.detail > 0.0 => {
                let error = self.options.detail * object.pixel(&self.model.camera, self.width);
                let (name, instances) = (object.name.clone(), object.instances.clone());
                Cow::Owned(Object { name, instances, body: Body::Limbs(limbs.within(error)), ..*object })
            }
            _ => Cow::Borrowed(object),
        }
    }
}

fn invalid(error: TemplateError) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error)
}
