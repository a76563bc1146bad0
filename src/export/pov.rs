//! POV-Ray: an include file in POV-Ray's own convention (left-handed, y up, foot at the origin), a scene that shows it
//! off, and its settings (`reference/povray.md`).

use std::io::{self, Write};

use serde::Serialize;

use super::decimal::{number, push_number, push_vector, vector};
use super::identifier::{identifier, plain};
use super::{TemplateError, Templates};
use crate::geom::frustum;
use crate::math::{Colour, DVec3};
use crate::model::{Digits, Light, Model, Object, Projection};

/// With more primitives than this the scene takes the objects inline, since `object { Name }` copies a union.
const MOST_COPIED: usize = 1_000_000;
/// Digits of numbers that are not lengths.
const PLAIN: Digits = Digits(6);
/// The text buffered before it is written.
const BUFFER: usize = 1 << 16;

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
    objects: Vec<ObjectValues>,
    materials: Vec<MaterialValues>,
    camera: CameraValues,
    lights: Vec<LightValues>,
    sky: SkyValues,
    ground: Option<GroundValues>,
}

#[derive(Serialize)]
struct ObjectValues {
    id: String,
    height: String,
    foot: String,
    keyword: &'static str,
    texture: String,
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
    parallel: bool,
    across: Option<String>,
    shadow: bool,
}

#[derive(Serialize)]
struct SkyValues {
    horizon: String,
    zenith: String,
}

#[derive(Serialize)]
struct GroundValues {
    height: String,
    colour: String,
    ambient: String,
    diffuse: String,
    reach: String,
}

/// POV-Ray's space from the world's: swapping y and z turns right-handed into left-handed without mirroring the shape.
fn to_pov(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, p.y)
}

fn colour(Colour([r, g, b]): Colour) -> String {
    vector(DVec3::new(r, g, b), PLAIN)
}

/// What stands for the body of object `i` in a filled-in template; no scene text can contain it.
fn body_mark(i: usize) -> String {
    format!("\u{1}{i}\u{1}")
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
        let objects = model.objects.iter().enumerate().map(|(i, object)| ObjectValues {
            id: match &model.objects[..] {
                [_] => prefix.clone(),
                _ => format!("{prefix}_{}", identifier(&object.name)),
            },
            height: number(object.height(), object.digits),
            foot: vector(to_pov(object.foot), object.digits),
            // A union of fewer than two objects warns.
            keyword: if object.balls.len() + object.segments.len() < 2 { "object" } else { "union" },
            texture: material_id(object.material),
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
            inline: model.primitives() > MOST_COPIED,
            objects: objects.collect(),
            materials: materials.collect(),
            camera: CameraValues { kind, location: point(camera.at), look_at: point(camera.look_at), angle, width },
            lights: model.lights.iter().map(|light| light_values(light, extent, &point)).collect(),
            sky: SkyValues { horizon: colour(model.sky.horizon), zenith: colour(model.sky.zenith) },
            ground: model.ground.map(|ground| GroundValues {
                height: number(ground.height, digits),
                colour: colour(ground.material.colour),
                ambient: number(ground.material.ambient, PLAIN),
                diffuse: number(ground.material.diffuse, PLAIN),
                reach: number(ground.reach, digits),
            }),
            prefix,
        };
        Self { model, templates, values }
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
            } else if let Some(object) = part.parse().ok().and_then(|i: usize| self.model.objects.get(i)) {
                write_body(object, &mut out)?;
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
                parallel: true,
                across: (size > 0.0 && shadow).then(|| number(wide, PLAIN)),
                shadow,
            }
        }
        Light::Point { at, colour: c, shadow } => {
            LightValues { location: point(at), colour: colour(c), parallel: false, across: None, shadow }
        }
    }
}

/// Writes the spheres and frusta of `object`.
fn write_body(object: &Object, out: &mut impl Write) -> io::Result<()> {
    let digits = object.digits;
    let scale = digits.scale();
    let mut text = Vec::with_capacity(BUFFER + 256);
    for ball in &object.balls {
        text.extend_from_slice(b"sphere{");
        push_vector(&mut text, to_pov(ball.centre), digits, scale);
        text.push(b',');
        push_number(&mut text, ball.radius, digits, scale);
        text.extend_from_slice(b"}\n");
        flush_at(&mut text, out, BUFFER)?;
    }
    for &[a, b] in &object.segments {
        let (a, b) = (&object.balls[a as usize], &object.balls[b as usize]);
        let Some(f) = frustum(a.centre, a.radius, b.centre, b.radius) else { continue };
        let (from, to) = (to_pov(f.a), to_pov(f.b));
        let (ra, rb) = (digits.round(f.ra), digits.round(f.rb));
        // A cone without length or width is fatal to the whole file.
        if digits.round_point(from) == digits.round_point(to) || (ra == 0.0 && rb == 0.0) {
            continue;
        }
        text.extend_from_slice(b"cone{");
        push_vector(&mut text, from, digits, scale);
        text.push(b',');
        push_number(&mut text, ra, digits, scale);
        text.push(b',');
        push_vector(&mut text, to, digits, scale);
        text.push(b',');
        push_number(&mut text, rb, digits, scale);
        text.extend_from_slice(b" open}\n");
        flush_at(&mut text, out, BUFFER)?;
    }
    flush_at(&mut text, out, 1)
}

/// Writes `text` out and empties it when it has reached `size` bytes.
fn flush_at(text: &mut Vec<u8>, out: &mut impl Write, size: usize) -> io::Result<()> {
    if text.len() >= size {
        out.write_all(text)?;
        text.clear();
    }
    Ok(())
}
