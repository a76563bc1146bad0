//! How a scene is seen: the view, materials, sky and lights are looked up.

use std::sync::Arc;

use super::resolver::Resolver;
use crate::assemble::{Backdrop, Recipe};
use crate::files::{decode_grey, decode_panorama, decode_plate, resize_grey, resize_plate};
use crate::math::{Colour, Degrees};
use crate::model::{Daylight, Light, LightSpec, Material, Sky, SkySpec, ViewFrame, ViewSpec};

impl Resolver<'_> {
    /// The view, and the size of the picture.
    pub fn view(&mut self, spec: Option<&ViewSpec>, size: Option<[u32; 2]>) -> Option<(Option<Backdrop>, [u32; 2])> {
        let Some(spec) = spec else { return Some((None, size.unwrap_or([640, 480]))) };
        let mut plate = None;
        if let Some(file) = &spec.plate {
            plate = Some(Arc::new(self.read("view.plate", file, decode_plate)?));
        }
        let mut matte = None;
        if let Some(file) = &spec.matte {
            matte = Some(Arc::new(self.read("view.matte", file, decode_grey)?));
        }
        let own = plate.as_ref().map(|plate| plate.frame());
        let size = size.or(own).unwrap_or([640, 480]);
        if let Some(matte) = &matte
            && matte.size() != own.unwrap_or(size)
        {
            let ([w, h], [width, height]) = (matte.size(), own.unwrap_or(size));
            let message = format!("the matte has {w} by {h} pixels, what it belongs to {width} by {height}");
            self.wrong("view.matte", message);
            return None;
        }
        // A photograph takes the picture's size.
        if own.is_some_and(|own| own != size) {
            if let Some(plate) = &mut plate {
                let smaller = resize_plate(plate, size);
                *plate = Arc::new(self.note("size", smaller)?);
            }
            matte = matte.map(|matte| Arc::new(resize_grey(&matte, size)));
        }
        Some((Some(Backdrop { frame: ViewFrame::new(spec, size), plate, matte }), size))
    }

    pub fn materials(&self, is_flat: bool) -> Vec<(String, Material)> {
        let mut materials = self.scene.material.clone();
        if is_flat {
            // What shines is white on black.
            let ink = if self.scene.view.is_some() { 1.0 } else { 0.0 };
            materials.entry("ink".to_owned()).or_insert(Material::ink(Colour([ink; 3])));
        } else {
            materials.entry("bark".to_owned()).or_insert(Recipe::bark());
        }
        materials.into_iter().collect()
    }

    /// The day that the sky is of, if it is.
    pub fn daylight(&mut self) -> Option<Daylight> {
        let spec = self.scene.sky.as_ref()?.daylight.as_ref()?;
        self.note("sky.daylight", Daylight::new(spec))
    }

    pub fn sky(&mut self, spec: &SkySpec, daylight: Option<&Daylight>) -> Option<Sky> {
        let gradient = spec.horizon.is_some() || spec.zenith.is_some();
        let picture_alone = [("turn", spec.turn.0 != 0.0), ("strength", spec.strength.is_some())];
        for (key, _) in picture_alone.iter().filter(|(_, given)| *given && spec.file.is_none()) {
            self.wrong(&format!("sky.{key}"), format!("`{key}` is for a picture of the sky, `file`"));
        }
        match (spec.colour, gradient, &spec.file, spec.daylight) {
            (Some(colour), false, None, None) => Some(Sky::plain(colour)),
            (None, true, None, None) => {
                let (Some(horizon), Some(zenith)) = (spec.horizon, spec.zenith) else {
                    self.wrong("sky", "a gradient needs both `horizon` and `zenith`".to_owned());
                    return None;
                };
                Some(Sky::Gradient { horizon, zenith })
            }
            (None, false, Some(file), None) => {
                let picture = self.read("sky.file", file, decode_panorama)?.into();
                Some(Sky::Picture { picture, turn: spec.turn.0, strength: spec.strength.unwrap_or(1.0), light: 1.0 })
            }
            (None, false, None, Some(_)) => daylight.map(Daylight::sky),
            _ => {
                let message = "a sky has exactly one of `colour`, `horizon` with `zenith`, `file` and `daylight`";
                self.wrong("sky", message.to_owned());
                None
            }
        }
    }

    pub fn lights(&mut self, is_flat: bool, daylight: Option<&Daylight>) -> Vec<Light> {
        if self.scene.light.is_empty() && !is_flat {
            return daylight.map_or_else(Recipe::two_suns, |daylight| vec![daylight.sun(), daylight.fill()]);
        }
        let mut lights = Vec::new();
        for (name, spec) in &self.scene.light {
            lights.extend(match *spec {
                LightSpec::Sun { from, colour, size, shadow } => {
                    let towards = from.0.try_normalize().ok_or("a sun needs a direction, not the zero vector");
                    self.note(&format!("light.{name}.sun.from"), towards).map(|towards| Light::Sun {
                        towards,
                        colour,
                        size: Degrees(size).radians(),
                        shadow,
                    })
                }
                LightSpec::Point { at, colour, shadow, fade } => Some(Light::Point { at: at.0, colour, shadow, fade }),
            });
        }
        lights
    }
}
