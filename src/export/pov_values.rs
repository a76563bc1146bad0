//! What the templates of POV-Ray may ask for.

use serde::Serialize;

use super::Origin;
use super::decimal::{number, vector};
use super::identifier::{identifier, part_identifier, plain};
use super::pov_body::{texture_at, tip_texture};
use super::pov_text::{PLAIN, colour, to_pov};
use crate::math::{Colour, DVec3};
use crate::model::pattern::{Figure, STEPS};
use crate::model::{
    Body, Camera, Digits, Dome, FADE, Ground, Instance, Light, Look, Material, Model, Object, Pattern, Projection, Sky,
    Tips,
};

/// With more primitives than this the scene takes the objects inline, since `object { Name }` copies a union.
const MOST_COPIED: usize = 1_000_000;
/// A slope of 1 is a normal of so much in POV-Ray: it adds five times the amount times what a pattern is at four points
/// about a place, a fiftieth away, in their directions, which is four thirds of a fiftieth of the slope.
const BUMP: f64 = 7.5;
/// Lights that stand for the sky in the studio look: more take longer, fewer show as separate shadows.
const DOME: u32 = 96;

/// What the templates may ask for.
#[derive(Clone, Serialize)]
pub(super) struct PovValues {
    version: &'static str,
    pub stem: String,
    pub prefix: String,
    title: String,
    command: String,
    seed: u64,
    width: u32,
    height_pixels: u32,
    height: String,
    /// Corners of all, and the way from there to the camera.
    min: String,
    max: String,
    side: String,
    inline: bool,
    extent: String,
    pub objects: Vec<ObjectValues>,
    /// The stem of the file that has what stands about them, and what that is declared as.
    stage: Option<[String; 2]>,
    pub materials: Vec<MaterialValues>,
    camera: CameraValues,
    lights: Vec<LightValues>,
    /// The look besides the exact one.
    look: &'static str,
    /// Of the natural look: how light goes on.
    natural: Option<NaturalValues>,
    /// Of the studio look: towards the light, and its colour.
    dome: Vec<[String; 2]>,
    sky: SkyValues,
    /// Of haze: how far one sees, and its height.
    air: Option<[String; 2]>,
    ground: Option<GroundValues>,
}

#[derive(Clone, Serialize)]
pub(super) struct ObjectValues {
    /// Its number in the model.
    #[serde(skip)]
    pub number: usize,
    pub id: String,
    height: String,
    /// Its corners, from its foot.
    min: String,
    max: String,
    /// How many ends its limbs have, and what stands for them in the text.
    ends: usize,
    tips: String,
    foot: String,
    /// How it is scaled and turned where it stands first, at its foot.
    turned: String,
    /// What follows the object where it stands, after the first.
    places: Vec<String>,
    keyword: &'static str,
    shadow: bool,
    texture: String,
    /// That of the lower side of its triangles, where that is another.
    below: Option<String>,
    /// What is posed, if anything is: what it is declared as.
    pub posed: Option<String>,
    /// Its mesh, where it is declared: objects that pose the same have one.
    one: Option<String>,
    body: String,
}

#[derive(Clone, Serialize)]
pub(super) struct MaterialValues {
    /// Its number in the model.
    #[serde(skip)]
    pub number: usize,
    pub id: String,
    colour: String,
    ambient: String,
    diffuse: String,
    through: String,
    emission: String,
    specular: String,
    roughness: String,
    phong: String,
    phong_size: String,
    /// The colour of the lower side, where that is another.
    below: Option<String>,
    pattern: Option<PatternValues>,
    /// What limbs show that are too thin for all of the pattern.
    younger: Vec<YoungValues>,
    /// The textures of the ends of limbs, and their colours.
    tips: Vec<[String; 2]>,
}

#[derive(Clone, Serialize)]
struct PatternValues {
    function: String,
    colour: String,
    size: String,
    /// How much the slope of the function counts.
    bump: Option<String>,
    /// The material's colour where it is too thin for the pattern.
    mean: String,
}

#[derive(Clone, Serialize)]
struct YoungValues {
    id: String,
    colour: String,
    over: String,
    bump: Option<String>,
}

#[derive(Clone, Serialize)]
struct CameraValues {
    kind: &'static str,
    location: String,
    look_at: String,
    angle: Option<String>,
    width: Option<String>,
    lens: Option<LensValues>,
}

#[derive(Clone, Serialize)]
struct LensValues {
    aperture: String,
    /// A point that is sharp.
    focus: String,
}

#[derive(Clone, Serialize)]
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

#[derive(Clone, Serialize)]
struct SkyValues {
    horizon: String,
    zenith: Option<String>,
    /// How far its picture is turned, in degrees; without one it is a gradient.
    turn: Option<String>,
}

#[derive(Clone, Serialize)]
struct NaturalValues {
    /// Is it about leaves, which light goes through?
    leafy: bool,
    /// Light from below the horizon.
    bounce: String,
    /// What the sky's colour counts as light.
    strength: String,
    /// No direction brings more light.
    brightest: String,
    /// Distance of the sky that is seen.
    far: String,
}

#[derive(Clone, Serialize)]
struct GroundValues {
    height: String,
    colour: String,
    ambient: String,
    diffuse: String,
    reach: String,
    fade: String,
    radius: Option<String>,
    pattern: Option<PatternValues>,
}

/// What stands for the body of object `i` in a filled-in template; no scene text can contain it.
fn body_mark(i: usize) -> String {
    format!("\u{1}{i}\u{1}")
}

/// What stands for the mesh of object `i`, declared on its own.
fn mesh_mark(i: usize) -> String {
    format!("\u{1}m{i}\u{1}")
}

/// What stands for the ends of the limbs of object `i`.
fn tips_mark(i: usize) -> String {
    format!("\u{1}t{i}\u{1}")
}

/// The level direction from what a camera looks at to where it stands, of length 1.
fn side(camera: &Camera) -> DVec3 {
    let back = camera.at - camera.look_at;
    DVec3::new(back.x, back.y, 0.0).normalize_or(DVec3::NEG_Y)
}

/// The values of `model`, whose files and declarations are called `name`.
pub(super) fn values(model: &Model, name: &str, size: [u32; 2], origin: &Origin) -> PovValues {
    let prefix = identifier(name);
    let gain = model.camera.gain;
    let bounds = model.bounds();
    let extent = bounds.extent();
    let digits = Digits::for_size(extent);
    let point = |p: DVec3| vector(to_pov(p), digits);
    let own = || model.objects.iter().filter(|object| !object.is_scenery);
    let dome = Dome::new(model);
    let is_natural = model.look == Look::Natural;
    let lights = if is_natural { Vec::new() } else { dome.lights(DOME) };
    PovValues {
        version: env!("CARGO_PKG_VERSION"),
        stem: plain(name),
        title: plain(&model.title),
        command: plain(&origin.command),
        seed: origin.seed,
        width: size[0],
        height_pixels: size[1],
        height: number(bounds.max.z.max(0.0), digits),
        min: point(bounds.min),
        max: point(bounds.max),
        side: vector(to_pov(side(&model.camera)), PLAIN),
        inline: own().map(|object| object.body.primitives()).sum::<usize>() > MOST_COPIED
            && own().all(|object| object.instances.len() == 1),
        extent: number(extent * 100.0, digits),
        objects: object_values(model, &prefix, false),
        stage: model.has_scenery().then(|| [format!("{}-stage", plain(name)), format!("{prefix}_Stage")]),
        materials: all_material_values(model, &prefix, false),
        camera: camera_values(&model.camera, digits),
        lights: model.lights.iter().map(|light| light_values(light, gain, extent, &point)).collect(),
        look: if is_natural { "natural" } else { "studio" },
        natural: is_natural.then(|| natural_values(model, &dome, extent, digits)),
        dome: lights.into_iter().map(|(towards, c)| [vector(to_pov(towards), PLAIN), colour(c.times(gain))]).collect(),
        sky: sky_values(&model.sky, gain),
        air: model.air.map(|air| [number(air.clear, digits), number(air.height, digits)]),
        ground: model.ground.as_ref().map(|ground| ground_values(ground, gain, digits)),
        prefix,
    }
}

fn material_id(prefix: &str, name: &str) -> String {
    format!("{prefix}_{}_Texture", identifier(name))
}

/// The values of what stands about the objects of `of`, a file of its own.
pub(super) fn stage_values(model: &Model, of: &PovValues) -> Option<PovValues> {
    let [stem, prefix] = of.stage.clone()?;
    Some(PovValues {
        objects: object_values(model, &prefix, true),
        materials: all_material_values(model, &prefix, true),
        height: "0".to_owned(),
        stage: None,
        stem,
        prefix,
        ..of.clone()
    })
}

/// The materials that scenery has, or all others.
fn all_material_values(model: &Model, prefix: &str, is_scenery: bool) -> Vec<MaterialValues> {
    let is_of_scenery = |i: usize| model.objects.iter().any(|object| object.material == i && object.is_scenery);
    let materials = model.materials.iter().enumerate().filter(|&(i, _)| is_of_scenery(i) == is_scenery);
    let gain = model.camera.gain;
    materials.map(|(i, (name, material))| material_values(i, material_id(prefix, name), material, gain)).collect()
}

/// The objects that are scenery, or all others.
fn object_values(model: &Model, prefix: &str, is_scenery: bool) -> Vec<ObjectValues> {
    let wanted: Vec<usize> = (0..model.objects.len()).filter(|&i| model.objects[i].is_scenery == is_scenery).collect();
    let mut ids: Vec<String> = Vec::new();
    for &i in &wanted {
        let is_alone = wanted.len() == 1;
        ids.push(if is_alone { prefix.to_owned() } else { part_identifier(prefix, &model.objects[i].name, &ids) });
    }
    let values = wanted.iter().enumerate().map(|(nth, &i)| {
        let object = &model.objects[i];
        let posed = first_posed(model, i);
        let id_of = |i: usize| wanted.iter().position(|&j| j == i).map(|nth| &ids[nth]);
        let (name, material) = &model.materials[object.material];
        let texture = material_id(prefix, name);
        ObjectValues {
            number: i,
            id: ids[nth].clone(),
            height: number(object.body.height(), object.digits),
            min: vector(to_pov(object.body.bounds().min), object.digits),
            max: vector(to_pov(object.body.bounds().max), object.digits),
            ends: object.body.limbs().filter(|limbs| !limbs.is_thorns).map_or(0, |limbs| limbs.ends().len()),
            tips: tips_mark(i),
            foot: vector(to_pov(object.instances[0].at), object.digits),
            turned: turned(&object.instances[0]),
            places: object.instances[1..].iter().map(|place| placed(place, object.digits)).collect(),
            keyword: keyword(&object.body),
            shadow: object.shadow,
            below: (material.paler > 0.0 && object.body.limbs().is_none()).then(|| format!("{texture}_Below")),
            texture: if is_plain(object, material) { format!("{texture}_Plain") } else { texture },
            posed: posed.and_then(id_of).map(|id| format!("{id}_One")),
            one: (posed == Some(i)).then(|| mesh_mark(i)),
            body: body_mark(i),
        }
    });
    values.collect()
}

/// Has the object as a whole the mean of its material's pattern, which its limbs alone show?
fn is_plain(object: &Object, material: &Material) -> bool {
    material.pattern.is_some_and(|pattern| object.body.limbs().is_some() || pattern.figure().follows_limbs())
}

/// The first object that poses the same mesh as object `i` does.
fn first_posed(model: &Model, i: usize) -> Option<usize> {
    let Body::Posed(own, _) = &model.objects[i].body else { return None };
    model.objects.iter().position(|object| matches!(&object.body, Body::Posed(mesh, _) if mesh == own))
}

fn material_values(nth: usize, id: String, m: &Material, gain: f64) -> MaterialValues {
    MaterialValues {
        number: nth,
        tips: m.tips.as_ref().map_or_else(Vec::new, |tips| tip_values(m, tips, &id)),
        younger: m.pattern.as_ref().map_or_else(Vec::new, |pattern| young_values(m, pattern, &id)),
        id,
        colour: colour(m.colour),
        ambient: number(m.ambient * gain, PLAIN),
        diffuse: number(m.diffuse, PLAIN),
        through: number(m.through, PLAIN),
        below: (m.paler > 0.0).then(|| colour(m.below(m.mean_colour()))),
        emission: number(m.emission * gain, PLAIN),
        specular: number(m.specular, PLAIN),
        roughness: number(m.roughness, PLAIN),
        phong: number(m.phong, PLAIN),
        phong_size: number(m.phong_size, PLAIN),
        pattern: m.pattern.as_ref().map(|pattern| pattern_values(m, pattern)),
    }
}

fn camera_values(camera: &Camera, digits: Digits) -> CameraValues {
    let (kind, angle, width) = match camera.projection {
        Projection::Perspective { angle } => {
            ("perspective", Some(number(angle * 180.0 / std::f64::consts::PI, PLAIN)), None)
        }
        Projection::Parallel { width } => ("orthographic", None, Some(number(width, digits))),
    };
    let [location, look_at] = [camera.at, camera.look_at].map(|p| vector(to_pov(p), digits));
    let lens = (!camera.lens.is_pinhole()).then(|| LensValues {
        // POV-Ray's number is twice the width of the opening (measured).
        aperture: number(camera.lens.aperture * 2.0, digits),
        focus: vector(to_pov(camera.at + camera.frame()[2] * camera.lens.focus), digits),
    });
    CameraValues { kind, location, look_at, angle, width, lens }
}

fn sky_values(sky: &Sky, gain: f64) -> SkyValues {
    let horizon = colour(sky.at_horizon().times(gain));
    match sky {
        Sky::Gradient { zenith, .. } => SkyValues { horizon, zenith: Some(colour(zenith.times(gain))), turn: None },
        // POV-Ray's pictures begin along +x, ours end along -x.
        Sky::Picture { turn, .. } => SkyValues { horizon, zenith: None, turn: Some(number(180.0 - turn, PLAIN)) },
    }
}

fn natural_values(model: &Model, dome: &Dome, extent: f64, digits: Digits) -> NaturalValues {
    let ground = model.ground.as_ref().map_or(0.0, |ground| ground.reach);
    NaturalValues {
        leafy: model.objects.iter().any(|object| model.materials[object.material].1.through > 0.0),
        bounce: colour(dome.light(DVec3::NEG_Z).times(model.camera.gain)),
        strength: number(dome.strength(), PLAIN),
        brightest: number(Dome::BRIGHTEST * dome.strength() * model.camera.gain, PLAIN),
        far: number(2.0 * ground.max(extent * 50.0), digits),
    }
}

fn ground_values(ground: &Ground, gain: f64, digits: Digits) -> GroundValues {
    GroundValues {
        height: number(ground.height, digits),
        colour: colour(ground.material.colour),
        ambient: number(ground.material.ambient * gain, PLAIN),
        diffuse: number(ground.material.diffuse, PLAIN),
        reach: number(ground.reach, digits),
        fade: number(FADE, PLAIN),
        radius: ground.radius.map(|radius| number(radius, digits)),
        pattern: ground.material.pattern.as_ref().map(|pattern| pattern_values(&ground.material, pattern)),
    }
}

fn light_values(light: &Light, gain: f64, extent: f64, point: &dyn Fn(DVec3) -> String) -> LightValues {
    match *light {
        Light::Sun { towards, colour: c, size, shadow } => {
            let distance = extent * 100.0;
            let wide = 2.0 * distance * libm::tan(size * 0.5);
            LightValues {
                location: point(towards * distance),
                colour: colour(c.times(gain)),
                studio: colour(light.studio().times(gain)),
                parallel: true,
                across: (size > 0.0 && shadow).then(|| number(wide, PLAIN)),
                fade: None,
                shadow,
            }
        }
        Light::Point { at, colour: c, shadow, fade } => LightValues {
            location: point(at),
            colour: colour(c.times(gain)),
            studio: colour(light.studio().times(gain)),
            parallel: false,
            across: None,
            fade: fade.map(|fade| number(fade, PLAIN)),
            shadow,
        },
    }
}

/// An object's further place, as what follows its name.
fn placed(place: &Instance, digits: Digits) -> String {
    format!("{}translate {}", turned(place), vector(to_pov(place.at), digits))
}

/// How an object is scaled and turned at a place, before it is moved.
fn turned(place: &Instance) -> String {
    let mut text = String::new();
    if place.scale != 1.0 {
        text.push_str(&format!("scale {} ", number(place.scale, PLAIN)));
    }
    if place.turn != 0.0 {
        // Left-handed: the other way around.
        text.push_str(&format!("rotate {}*y ", number(-place.turn, PLAIN)));
    }
    text
}

/// A union of fewer than two objects warns.
fn keyword(body: &Body) -> &'static str {
    let parts = match body {
        Body::Limbs(limbs) => limbs.balls.len() + limbs.segments.len(),
        Body::Mesh(_) => 1,
        Body::Posed(_, poses) => poses.len(),
    };
    if parts < 2 { "object" } else { "union" }
}

/// More and more of what the ends of limbs show.
fn tip_values(material: &Material, tips: &Tips, id: &str) -> Vec<[String; 2]> {
    let shown = |step| [tip_texture(id, step), colour(tips.over(material.mean_colour(), step))];
    (1..=Tips::STEPS).map(shown).collect()
}

/// Less and less of a pattern.
fn young_values(material: &Material, pattern: &Pattern, id: &str) -> Vec<YoungValues> {
    let figure = pattern.figure();
    let young = |step: u32| {
        let clarity = f64::from(step) / f64::from(STEPS);
        let mixed = |full: Colour| colour(material.mean_colour().mixed(full, clarity));
        Some(YoungValues {
            id: texture_at(id, clarity)?,
            colour: mixed(material.colour),
            over: mixed(figure.colour()),
            bump: bump(figure, clarity),
        })
    };
    let is_thin = figure.clarity(0.0) < 1.0;
    (1..STEPS).rev().filter(|_| is_thin).filter_map(young).collect()
}

/// How much the slope of a pattern counts in POV-Ray's terms.
fn bump(figure: Figure, clarity: f64) -> Option<String> {
    let height = figure.height() * clarity;
    (height != 0.0).then(|| number(height * BUMP, PLAIN))
}

/// A pattern as POV-Ray's own functions.
fn pattern_values(material: &Material, pattern: &Pattern) -> PatternValues {
    let figure = pattern.figure();
    PatternValues {
        function: figure.share().to_string(),
        colour: colour(figure.colour()),
        size: number(figure.size(), PLAIN),
        bump: bump(figure, 1.0),
        mean: colour(material.mean_colour()),
    }
}
