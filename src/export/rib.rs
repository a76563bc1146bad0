//! RenderMan RIB: a scene, and an archive of its objects, in what Pixie and Aqsis both take (`reference/rib.md`).

use std::io::{self, Write};

use serde::Serialize;

use super::decimal::plain_number as number;
use super::identifier::plain;
use super::rib_body::{MATRIX, write_object};
use super::rib_sheets::{Sheet, sheets};
use super::{Origin, TemplateError, Templates};
use crate::geom::Bounds;
use crate::math::{Colour, DVec3};
use crate::model::{Camera, Digits, Light, Material, Model, Object, Projection};

/// Digits of numbers that are not lengths.
pub(super) const PLAIN: Digits = Digits(6);
/// Pixels along a side of a shadow map.
const MAP: u32 = 2048;

/// How a RIB scene has its shadows: renderers differ in that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RibShadows {
    /// None: what every renderer takes.
    #[default]
    None,
    /// Traced by the light `raydistant`, which Pixie has.
    Rays,
    /// Maps that the scene makes first, read by the light `shadowdistant`, which Aqsis has.
    Maps,
}

/// What a RIB scene is like.
#[derive(Clone, Copy, Debug, Default)]
pub struct RibOptions {
    /// Shadows.
    pub shadows: RibShadows,
    /// Leave thorns to the displacement shader `thorns`, which must be compiled; otherwise they are cones.
    pub displace: bool,
}

/// A model on its way to RIB.
pub struct Rib<'a> {
    model: &'a Model,
    templates: &'a Templates,
    options: RibOptions,
    values: Values,
}

/// What the template may ask for.
#[derive(Serialize)]
struct Values {
    version: &'static str,
    stem: String,
    title: String,
    command: String,
    seed: u64,
    width: u32,
    height: u32,
    camera: CameraValues,
    lights: Vec<LightValues>,
    maps: Vec<MapValues>,
    /// Sky and ground.
    sheets: Vec<Sheet>,
    /// Are shadows traced?
    rays: bool,
    /// What the maps show: the end of the name of an archive.
    casters: &'static str,
}

#[derive(Serialize)]
struct CameraValues {
    fov: Option<String>,
    window: String,
    clipping: String,
    matrix: String,
}

#[derive(Serialize)]
struct LightValues {
    shader: &'static str,
    intensity: String,
    colour: String,
    from: String,
    to: Option<String>,
    map: Option<String>,
}

#[derive(Serialize)]
struct MapValues {
    light: String,
    size: u32,
    stem: String,
    window: String,
    clipping: String,
    matrix: String,
}

pub(super) fn triple(p: DVec3, digits: Digits) -> String {
    p.to_array().map(|c| number(c, digits)).join(" ")
}

pub(super) fn colour(Colour(c): Colour) -> String {
    triple(DVec3::from_array(c), PLAIN)
}

/// The matrix from the world to a camera at `at` with these unit vectors to the right, up and forwards: row vectors, the
/// translation last.
fn to_camera(at: DVec3, [r, u, f]: [DVec3; 3], digits: Digits) -> String {
    let row = |axis: usize| format!("{} 0", triple(DVec3::new(r[axis], u[axis], f[axis]), MATRIX));
    let last = triple(-DVec3::new(r.dot(at), u.dot(at), f.dot(at)), digits);
    format!("{} {} {} {last} 1", row(0), row(1), row(2))
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
        let bounds = model.bounds();
        let extent = if bounds.is_empty() { 1.0 } else { bounds.size().max_element() };
        let digits = Digits::for_size(extent);
        let camera = &model.camera;
        let frame = camera.frame();
        let sheets = sheets(model, size, digits);
        // Everything in front of the camera, sky and ground included, with room to spare.
        let far = bounds.corners().map(|p| (p - camera.at).dot(frame[2])).into_iter().fold(extent, f64::max);
        let far = sheets.iter().map(|sheet| sheet.far).fold(far, f64::max) * 1.01;
        let (fov, window) = match camera.projection {
            Projection::Perspective { angle } => {
                let shorter = libm::tan(angle * 0.5) * f64::min(1.0, 1.0 / camera.aspect);
                let fov = 2.0 * libm::atan(shorter) * 180.0 / std::f64::consts::PI;
                (Some(number(fov, PLAIN)), String::new())
            }
            Projection::Parallel { width } => {
                let [across, up] = [width * 0.5, width * 0.5 / camera.aspect].map(|x| number(x, digits));
                (None, format!("-{across} {across} -{up} {up}"))
            }
        };
        let stem = plain(name);
        let mut maps = Vec::new();
        let lights = model.lights.iter().enumerate().map(|(i, light)| match *light {
            Light::Sun { towards, colour: c, shadow, .. } => {
                let map = (shadow && options.shadows == RibShadows::Maps && !bounds.is_empty())
                    .then(|| map_values(&stem, i, towards, bounds, digits));
                let named = map.as_ref().map(|map| format!("{}.shad", map.stem));
                maps.extend(map);
                LightValues {
                    shader: match options.shadows {
                        RibShadows::Rays if shadow => "raydistant",
                        RibShadows::Maps if shadow => "shadowdistant",
                        _ => "distantlight",
                    },
                    intensity: "1".to_owned(),
                    colour: colour(c),
                    from: triple(towards, PLAIN),
                    to: Some("0 0 0".to_owned()),
                    map: named,
                }
            }
            Light::Point { at, colour: c, fade, .. } => {
                // Theirs fall off with the square of the distance from 1 on: right far away; without a falloff, right in the
                // middle of the scene.
                let reach = fade.map_or((at - bounds.centre()).length(), |fade| fade * libm::sqrt(2.0));
                LightValues {
                    shader: "pointlight",
                    intensity: number(reach * reach, PLAIN),
                    colour: colour(c),
                    from: triple(at, digits),
                    to: None,
                    map: None,
                }
            }
        });
        let lights = lights.collect();
        let casters = has_casters(model, options);
        let values = Values {
            version: env!("CARGO_PKG_VERSION"),
            title: plain(&model.title),
            command: plain(&origin.command),
            seed: origin.seed,
            width: size[0],
            height: size[1],
            camera: CameraValues {
                fov,
                window,
                clipping: format!("{} {}", number(extent * 1e-3, digits), number(far, digits)),
                matrix: to_camera(camera.at, frame, digits),
            },
            lights,
            maps,
            sheets,
            rays: options.shadows == RibShadows::Rays,
            casters: if casters { "casters" } else { "archive" },
            stem,
        };
        Self { model, templates, options, values }
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
        let is_used = self.options.displace && self.model.objects.iter().any(|object| object.thorns.is_some());
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
        let shown = |object: &&Object| is_wanted(object) && !(self.options.displace && object.is_thorns);
        for (handle, object) in (1..).zip(self.model.objects.iter().filter(shown)) {
            let (_, material) = &self.model.materials[object.material];
            write_object(object, &surface(material), handle, self.options, &mut out)?;
        }
        Ok(())
    }
}

fn has_casters(model: &Model, options: RibOptions) -> bool {
    options.shadows == RibShadows::Maps && model.objects.iter().any(|object| !object.shadow)
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

/// A shadow map: the scene as a sun sees it.
fn map_values(stem: &str, i: usize, towards: DVec3, bounds: Bounds, digits: Digits) -> MapValues {
    let centre = bounds.centre();
    let radius = bounds.size().length() * 0.5 * 1.02;
    let eye = centre + towards * (radius * 2.0);
    let upright = if towards.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z };
    let right = (-towards).cross(upright).normalize();
    let half = number(radius, digits);
    MapValues {
        light: format!("light {}", i + 1),
        size: MAP,
        stem: format!("{stem}-light{}", i + 1),
        window: format!("-{half} {half} -{half} {half}"),
        clipping: format!("{} {}", number(radius * 0.9, digits), number(radius * 3.1, digits)),
        matrix: to_camera(eye, [right, right.cross(-towards), -towards], digits),
    }
}

/// Where a fraction of the picture, from the top left, looks: a direction of length 1 and where it starts.
pub(super) fn ray(camera: &Camera, x: f64, y: f64) -> (DVec3, DVec3) {
    let [right, up, forwards] = camera.frame();
    let (across, upwards) = (x - 0.5, (0.5 - y) / camera.aspect);
    match camera.projection {
        Projection::Perspective { angle } => {
            let wide = 2.0 * libm::tan(angle * 0.5);
            (camera.at, (forwards + right * (across * wide) + up * (upwards * wide)).normalize())
        }
        Projection::Parallel { width } => (camera.at + right * (across * width) + up * (upwards * width), forwards),
    }
}
