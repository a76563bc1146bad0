//! POV-Ray: an include file in POV-Ray's own convention (left-handed, y up, foot at the origin), a scene that shows it
//! off, and its settings (`reference/povray.md`).

use std::io::{self, Write};

use super::pov_body::{write_body, write_ends, write_mesh};
use super::pov_values::{PovValues, stage_values, values};
use super::{Origin, TemplateError, Templates};
use crate::model::{Body, Digits, Model, Sky};
use crate::raster::Panorama;

/// Digits of a mesh that is posed: it is of unit size.
const MESH_DIGITS: u32 = 7;

/// A model on its way to POV-Ray.
pub struct Pov<'a> {
    model: &'a Model,
    templates: &'a Templates,
    values: PovValues,
    /// Of what stands about it.
    stage: Option<PovValues>,
}

impl<'a> Pov<'a> {
    /// `name` gives the files their stem and the declared names their prefix; `size` is the picture's, in pixels.
    #[must_use]
    pub fn new(model: &'a Model, templates: &'a Templates, name: &str, size: [u32; 2], origin: &Origin) -> Self {
        let values = values(model, name, size, origin);
        Self { model, templates, stage: stage_values(model, &values), values }
    }

    /// The identifier that is 1 for the exact look, 0 for the studio's.
    #[must_use]
    pub fn exact(&self) -> String {
        format!("{}_Exact", self.values.prefix)
    }

    /// The identifier of how much the natural look spends: 0, 1 or 2.
    #[must_use]
    pub fn quality(&self) -> String {
        format!("{}_Quality", self.values.prefix)
    }

    /// The identifiers declared: the prefix, or one an object.
    pub fn identifiers(&self) -> impl Iterator<Item = &str> {
        self.values.objects.iter().map(|object| object.id.as_str())
    }

    /// Writes `NAME.inc`.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidData`] around a [`TemplateError`], or what `out` says.
    pub fn write_inc(&self, out: impl Write) -> io::Result<()> {
        self.write_objects(&self.values, out)
    }

    /// Is there something that stands about it, a file of its own?
    #[must_use]
    pub fn has_stage(&self) -> bool {
        self.stage.is_some()
    }

    /// Writes `NAME-stage.inc`, if there is something that stands about it.
    ///
    /// # Errors
    /// As [`Pov::write_inc`].
    pub fn write_stage(&self, out: impl Write) -> io::Result<()> {
        self.stage.as_ref().map_or(Ok(()), |values| self.write_objects(values, out))
    }

    fn write_objects(&self, values: &PovValues, mut out: impl Write) -> io::Result<()> {
        let text = self.fill("scene.inc", values)?;
        // Bodies stand in the text as marks between control characters.
        for (i, part) in text.split('\u{1}').enumerate() {
            if i % 2 == 0 {
                out.write_all(part.as_bytes())?;
            } else if let Some(i) = part.strip_prefix('m') {
                let object = i.parse().ok().and_then(|i: usize| self.model.objects.get(i));
                if let Some(Body::Posed(mesh, _)) = object.map(|object| &object.body) {
                    write_mesh(mesh, Digits(MESH_DIGITS), &mut out)?;
                }
            } else if let Some(i) = part.strip_prefix('t') {
                let object = i.parse().ok().and_then(|i: usize| self.model.objects.get(i));
                if let Some((limbs, digits)) = object.and_then(|object| Some((object.body.limbs()?, object.digits))) {
                    write_ends(limbs, digits, &mut out)?;
                }
            } else if let Some(of) =
                part.parse().ok().and_then(|i: usize| values.objects.iter().find(|of| of.number == i))
            {
                let object = &self.model.objects[of.number];
                let (_, material) = &self.model.materials[object.material];
                let texture = values.materials.iter().find(|of| of.number == object.material);
                let texture = texture.map_or("", |of| of.id.as_str());
                let posed = of.posed.as_deref().unwrap_or_default();
                write_body(object, material, texture, posed, &mut out)?;
            }
        }
        Ok(())
    }

    /// The text of `NAME.pov`, without the line that tells whether it was edited.
    ///
    /// # Errors
    /// As [`Pov::write_inc`].
    pub fn scene(&self) -> io::Result<String> {
        self.fill("scene.pov", &self.values)
    }

    /// The text of `NAME.ini`.
    ///
    /// # Errors
    /// As [`Pov::write_inc`].
    pub fn settings(&self) -> io::Result<String> {
        self.fill("scene.ini", &self.values)
    }

    /// The picture of the sky, with its strength, that belongs beside the scene as `NAME-sky.exr`.
    #[must_use]
    pub fn sky(&self) -> Option<(&Panorama, f64)> {
        match &self.model.sky {
            Sky::Picture { picture, strength, .. } => Some((picture, *strength * self.model.camera.gain)),
            Sky::Gradient { .. } => None,
        }
    }

    fn fill(&self, name: &str, values: &PovValues) -> io::Result<String> {
        self.templates
            .fill(name, values)
            .map_err(|error: TemplateError| io::Error::new(io::ErrorKind::InvalidData, error))
    }
}
