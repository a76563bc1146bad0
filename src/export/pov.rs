//! POV-Ray: an include file in POV-Ray's own convention (left-handed, y up, foot at the origin), a scene that shows it
//! off, and its settings (`reference/povray.md`).

use std::io::{self, Write};

use serde::Serialize;

use super::decimal::{number, vector};
use super::identifier::{identifier, part_identifier, plain};
use super::pov_body::{write_body, write_mesh};
use super::{TemplateError, Templates};
use crate::math::{Colour, DVec3};
use crate::model::{BARK, Digits, Dome, FADE, Instance, Light, MOSS, Material, Model, Pattern, Projection, Sky, Wave};
use crate::raster::Panorama;

/// With more primitives than this the scene takes the objects inline, since `object { Name }` copies a union.
const MOST_COPIED: usize = 1_000_000;
/// Digits of a mesh that is posed: it is of unit size.
const MESH_DIGITS: u32 = 7;
/// Digits of numbers that are not lengths.
const PLAIN: Digits = Digits(6);
/// Lights that stand for the sky in the studio look: more take longer, fewer show as separate shadows.
const DOME: u32 = 96;

/// Where a model came from, for the header of what is written.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// The command that repeats it.
    pub command: String,
    /// The scene's seed.
    pub seed: u64,
}

/// A model on its way to POV-Ray.
pub struct Pov<'a> {
    model: &'a Model,
    templates: &'a Templates,
    values: Values,
}

/// What the templates may ask for.
#[derive(Serialize)]
struct Values {
    version: &'static str,
    stem: String,
    prefix: String,
    title: String,
    command: String,
    seed: u64,
    width: u32,
    height_pixels: u32,
    height: String,
    inline: bool,
    extent: String,
    objects: Vec<ObjectValues>,
    materials: Vec<MaterialValues>,
    camera: CameraValues,
    lights: Vec<LightValues>,
    /// Towards the light, and its colour: the sky of the studio look.
    dome: Vec<[String; 2]>,
    sky: SkyValues,
    ground: Option<GroundValues>,
}

#[derive(Serialize)]
struct ObjectValues {
    id: String,
    height: String,
    foot: String,
    /// What follows the object where it stands, after the first, which is at its foot.
    places: Vec<String>,
    keyword: &'static str,
    shadow: bool,
    texture: String,
    /// What is declared once and posed, if it is: its mesh.
    one: Option<String>,
    body: String,
}

#[derive(Serialize)]
struct MaterialValues {
    id: String,
    colour: String,
    ambient: String,
    diffuse: String,
    emission: String,
    specular: String,
    roughness: String,
    phong: String,
    phong_size: String,
    pattern: Option<PatternValues>,
}

#[derive(Serialize)]
struct PatternValues {
    function: String,
    colour: String,
    size: String,
    /// The material's colour where it is too thin for the pattern.
    mean: String,
}

#[derive(Serialize)]
struct CameraValues {
    kind: &'static str,
    location: String,
    look_at: String,
    angle: Option<String>,
    width: Option<String>,
}

#[derive(Serialize)]
struct LightValues {
    location: String,
    colour: String,
    /// The colour in the studio look.
    studio: String,
    parallel: bool,
    across: Option<String>,
    /// Distance over which it falls off.
    fade: Option<String>,
    shadow: bool,
}

#[derive(Serialize)]
struct SkyValues {
    horizon: String,
    zenith: Option<String>,
    /// How far its picture is turned, in degrees; without one it is a gradient.
    turn: Option<String>,
}

#[derive(Serialize)]
struct GroundValues {
    height: String,
    colour: String,
    ambient: String,
    diffuse: String,
    reach: String,
    fade: String,
    radius: Option<String>,
}

/// POV-Ray's space from the world's: swapping y and z turns right-handed into left-handed without mirroring the shape.
pub(super) fn to_pov(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, p.y)
}

fn colour(Colour([r, g, b]): Colour) -> String {
    vector(DVec3::new(r, g, b), PLAIN)
}

/// What stands for the body of object `i` in a filled-in template; no scene text can contain it.
fn body_mark(i: usize) -> String {
    format!("\u{1}{i}\u{1}")
}

/// What stands for the mesh of object `i`, declared on its own.
fn mesh_mark(i: usize) -> String {
    format!("\u{1}m{i}\u{1}")
}

impl<'a> Pov<'a> {
    /// `name` gives the files their stem and the declared names their prefix; `size` is the picture's, in pixels.
    #[must_use]
    pub fn new(model: &'a Model, templates: &'a Templates, name: &str, size: [u32; 2], origin: &Origin) -> Self {
        let prefix = identifier(name);
        let bounds = model.bounds();
        let extent = if bounds.is_empty() { 1.0 } else { bounds.size().max_element() };
        let digits = Digits::for_size(extent);
        let point = |p: DVec3| vector(to_pov(p), digits);
        let material_id = |i: usize| format!("{prefix}_{}_Texture", identifier(&model.materials[i].0));
        let mut ids: Vec<String> = Vec::new();
        for object in &model.objects {
            let id =
                if model.objects.len() == 1 { prefix.clone() } else { part_identifier(&prefix, &object.name, &ids) };
            ids.push(id);
        }
        let objects = model.objects.iter().enumerate().map(|(i, object)| ObjectValues {
            id: ids[i].clone(),
            height: number(object.height(), object.digits),
            foot: vector(to_pov(object.instances[0].at), object.digits),
            places: object.instances[1..].iter().map(|place| placed(place, object.digits)).collect(),
            // A union of fewer than two objects warns.
            keyword: if object.balls.len() + object.segments.len() + object.poses.len() < 2 {
                "object"
            } else {
                "union"
            },
            shadow: object.shadow,
            texture: match model.materials[object.material].1.pattern {
                Some(_) => format!("{}_Plain", material_id(object.material)),
                None => material_id(object.material),
            },
            one: (!object.poses.is_empty()).then(|| mesh_mark(i)),
            body: body_mark(i),
        });
        let materials = model.materials.iter().enumerate().map(|(i, (_, m))| MaterialValues {
            id: material_id(i),
            colour: colour(m.colour),
            ambient: number(m.ambient, PLAIN),
            diffuse: number(m.diffuse, PLAIN),
            emission: number(m.emission, PLAIN),
            specular: number(m.specular, PLAIN),
            roughness: number(m.roughness, PLAIN),
            phong: number(m.phong, PLAIN),
            phong_size: number(m.phong_size, PLAIN),
            pattern: m.pattern.as_ref().map(|pattern| pattern_values(m, pattern)),
        });
        let camera = &model.camera;
        let (kind, angle, width) = match camera.projection {
            Projection::Perspective { angle } => {
                ("perspective", Some(number(angle * 180.0 / std::f64::consts::PI, PLAIN)), None)
            }
            Projection::Parallel { width } => ("orthographic", None, Some(number(width, digits))),
        };
        let values = Values {
            version: env!("CARGO_PKG_VERSION"),
            stem: plain(name),
            title: plain(&model.title),
            command: plain(&origin.command),
            seed: origin.seed,
            width: size[0],
            height_pixels: size[1],
            height: number(bounds.max.z.max(0.0), digits),
            inline: model.primitives() > MOST_COPIED && model.objects.iter().all(|o| o.instances.len() == 1),
            extent: number(extent * 100.0, digits),
            objects: objects.collect(),
            materials: materials.collect(),
            camera: CameraValues { kind, location: point(camera.at), look_at: point(camera.look_at), angle, width },
            lights: model.lights.iter().map(|light| light_values(light, extent, &point)).collect(),
            dome: Dome::new(model)
                .lights(DOME)
                .into_iter()
                .map(|(towards, c)| [vector(to_pov(towards), PLAIN), colour(c)])
                .collect(),
            sky: SkyValues {
                horizon: colour(model.sky.at_horizon()),
                zenith: match &model.sky {
                    Sky::Gradient { zenith, .. } => Some(colour(*zenith)),
                    Sky::Picture { .. } => None,
                },
                turn: match &model.sky {
                    Sky::Gradient { .. } => None,
                    // POV-Ray's pictures begin along +x, ours end along -x.
                    Sky::Picture { turn, .. } => Some(number(180.0 - turn, PLAIN)),
                },
            },
            ground: model.ground.map(|ground| GroundValues {
                height: number(ground.height, digits),
                colour: colour(ground.material.colour),
                ambient: number(ground.material.ambient, PLAIN),
                diffuse: number(ground.material.diffuse, PLAIN),
                reach: number(ground.reach, digits),
                fade: number(FADE, PLAIN),
                radius: ground.radius.map(|radius| number(radius, digits)),
            }),
            prefix,
        };
        Self { model, templates, values }
    }

    /// The identifier that is 1 for the exact look, 0 for the studio's.
    #[must_use]
    pub fn exact(&self) -> String {
        format!("{}_Exact", self.values.prefix)
    }

    /// The identifiers declared: the prefix, or one an object.
    pub fn identifiers(&self) -> impl Iterator<Item = &str> {
        self.values.objects.iter().map(|object| object.id.as_str())
    }

    /// Writes `NAME.inc`.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidData`] around a [`TemplateError`], or what `out` says.
    pub fn write_inc(&self, mut out: impl Write) -> io::Result<()> {
        let text = self.fill("scene.inc")?;
        // Bodies stand in the text as marks between control characters.
        for (i, part) in text.split('\u{1}').enumerate() {
            if i % 2 == 0 {
                out.write_all(part.as_bytes())?;
            } else if let Some(i) = part.strip_prefix('m') {
                if let Some(object) = i.parse().ok().and_then(|i: usize| self.model.objects.get(i)) {
                    write_mesh(&object.mesh, Digits(MESH_DIGITS), &mut out)?;
                }
            } else if let Some(object) = part.parse().ok().and_then(|i: usize| self.model.objects.get(i)) {
                let (_, material) = &self.model.materials[object.material];
                let texture = &self.values.materials[object.material].id;
                let one = format!("{}_One", self.values.objects[part.parse::<usize>().unwrap_or(0)].id);
                write_body(object, material.pattern.as_ref(), texture, &one, &mut out)?;
            }
        }
        Ok(())
    }

    /// The text of `NAME.pov`, without the line that tells whether it was edited.
    ///
    /// # Errors
    /// As [`Pov::write_inc`].
    pub fn scene(&self) -> io::Result<String> {
        self.fill("scene.pov")
    }

    /// The text of `NAME.ini`.
    ///
    /// # Errors
    /// As [`Pov::write_inc`].
    pub fn settings(&self) -> io::Result<String> {
        self.fill("scene.ini")
    }

    /// The picture of the sky, with its strength, that belongs beside the scene as `NAME-sky.exr`.
    #[must_use]
    pub fn sky(&self) -> Option<(&Panorama, f64)> {
        match &self.model.sky {
            Sky::Picture { picture, strength, .. } => Some((picture, *strength)),
            Sky::Gradient { .. } => None,
        }
    }

    fn fill(&self, name: &str) -> io::Result<String> {
        self.templates
            .fill(name, &self.values)
            .map_err(|error: TemplateError| io::Error::new(io::ErrorKind::InvalidData, error))
    }
}

fn light_values(light: &Light, extent: f64, point: &dyn Fn(DVec3) -> String) -> LightValues {
    match *light {
        Light::Sun { towards, colour: c, size, shadow } => {
            let distance = extent * 100.0;
            let wide = 2.0 * distance * libm::tan(size * 0.5);
            LightValues {
                location: point(towards * distance),
                colour: colour(c),
                studio: colour(light.studio()),
                parallel: true,
                across: (size > 0.0 && shadow).then(|| number(wide, PLAIN)),
                fade: None,
                shadow,
            }
        }
        Light::Point { at, colour: c, shadow, fade } => LightValues {
            location: point(at),
            colour: colour(c),
            studio: colour(light.studio()),
            parallel: false,
            across: None,
            fade: fade.map(|fade| number(fade, PLAIN)),
            shadow,
        },
    }
}

/// An object's further place, as what follows its name.
fn placed(place: &Instance, digits: Digits) -> String {
    let mut text = String::new();
    if place.scale != 1.0 {
        text.push_str(&format!("scale {} ", number(place.scale, PLAIN)));
    }
    if place.turn != 0.0 {
        // Left-handed: the other way around.
        text.push_str(&format!("rotate {}*y ", number(-place.turn, PLAIN)));
    }
    format!("{text}translate {}", vector(to_pov(place.at), digits))
}

/// A pattern as POV-Ray's own functions.
fn pattern_values(material: &Material, pattern: &Pattern) -> PatternValues {
    let dot = |[a, b, c]: [f64; 3]| format!("{a}*x+{b}*y+{c}*z");
    let wave = |w: &Wave| format!("sin({}+{}+{}*sin({}))", dot(w.along), w.phase, w.bend, dot(w.by));
    let sum = |waves: &[Wave]| waves.iter().map(wave).collect::<Vec<_>>().join("+");
    let function = match pattern {
        Pattern::Bark { .. } => format!("max(0,1-abs({})*{})", sum(&BARK), Pattern::FISSURE),
        Pattern::Moss { .. } => format!(
            "min(1,max(0,({})*{}+x/max(0.000001,sqrt(x*x+z*z))*{}-{}))",
            sum(&MOSS),
            Pattern::PATCH[0],
            Pattern::PATCH[1],
            Pattern::PATCH[2]
        ),
    };
    PatternValues {
        function: function.replace("+-", "-"),
        colour: colour(pattern.colour()),
        size: number(pattern.size(), PLAIN),
        mean: colour(material.mean_colour()),
    }
}
