//! RenderMan RIB: a scene, and an archive of its objects, in what Pixie and Aqsis both take (`reference/rib.md`).

use std::io::{self, Write};

use super::decimal::plain_number as number;
use super::rib_body::write_object;
use super::rib_options::RibOptions;
use super::rib_text::{PLAIN, colour};
use super::rib_values::{RibValues, has_casters, values};
use super::{Origin, TemplateError, Templates};
use crate::math::Colour;
use crate::model::{Material, Model, Object};

/// A model on its way to RIB.
pub struct Rib<'a> {
    model: &'a Model,
    templates: &'a Templates,
    options: RibOptions,
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
        Self { model, templates, options, values: values(model, name, size, origin, options) }
    }

    /// The materials whose patterns it shows as their mean colour alone: RenderMan has no standard shader for them.
    pub fn plain_patterns(&self) -> impl Iterator<Item = &str> {
        self.model.materials.iter().filter(|(_, material)| material.pattern.is_some()).map(|(name, _)| name.as_str())
    }

    /// The text of `NAME.rib`, without the line that tells whether it was edited.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidData`] around a [`TemplateError`].
    pub fn scene(&self) -> io::Result<String> {
        self.templates
            .fill("scene.rib", &self.values)
            .map_err(|error: TemplateError| io::Error::new(io::ErrorKind::InvalidData, error))
    }

    /// The displacement shader `thorns.sl`, where the scene uses it.
    #[must_use]
    pub fn shader(&self) -> Option<&str> {
        let limbs = self.model.objects.iter().filter_map(|object| object.body.limbs());
        let is_used = self.options.displace && limbs.into_iter().any(|limbs| limbs.thorns.is_some());
        is_used.then(|| self.templates.text("thorns.sl"))
    }

    /// Do its shadow maps need an archive of their own, `NAME.casters.rib`, since some objects cast no shadow?
    #[must_use]
    pub fn has_casters(&self) -> bool {
        has_casters(self.model, self.options)
    }

    /// Writes `NAME.archive.rib`: every object, where it stands in the world.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_archive(&self, out: impl Write) -> io::Result<()> {
        self.write_objects(|_| true, out)
    }

    /// Writes `NAME.casters.rib`: the objects that cast shadows.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_casters(&self, out: impl Write) -> io::Result<()> {
        self.write_objects(|object| object.shadow, out)
    }

    fn write_objects(&self, is_wanted: impl Fn(&Object) -> bool, mut out: impl Write) -> io::Result<()> {
        writeln!(out, "##RenderMan RIB-Structure 1.1 Entity\nversion 3.03")?;
        let is_thorns = |object: &Object| object.body.limbs().is_some_and(|limbs| limbs.is_thorns);
        let shown = |object: &&Object| is_wanted(object) && !(self.options.displace && is_thorns(object));
        for (handle, object) in (1..).zip(self.model.objects.iter().filter(shown)) {
            let (_, material) = &self.model.materials[object.material];
            write_object(object, &surface(material), handle, self.options, &mut out)?;
        }
        Ok(())
    }
}

/// The surface of a material: a colour and a standard shader.
fn surface(m: &Material) -> String {
    // The ambient light is 1: light of its own adds to it.
    let [ka, kd] = [m.ambient + m.emission, m.diffuse].map(|x| number(x, PLAIN));
    let Colour(c) = m.mean_colour();
    if m.diffuse == 0.0 && m.ambient == 0.0 {
        return format!("Color [{}]\nSurface \"constant\"", colour(Colour(c.map(|c| c * m.emission))));
    }
    let shine = m.specular.max(m.phong);
    let shader = if shine > 0.0 {
        let rough = if m.specular > 0.0 { m.roughness } else { 1.0 / m.phong_size };
        let [ks, rough] = [shine, rough].map(|x| number(x, PLAIN));
        format!(
            "Surface \"plastic\" \"float Ka\" [{ka}] \"float Kd\" [{kd}] \"float Ks\" [{ks}] \"float roughness\" [{rough}]"
        )
    } else {
        format!("Surface \"matte\" \"float Ka\" [{ka}] \"float Kd\" [{kd}]")
    };
    format!("Color [{}]\n{shader}", colour(Colour(c)))
}
