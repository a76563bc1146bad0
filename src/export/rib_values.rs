//! What the template of RIB may ask for.

use serde::Serialize;

use super::Origin;
use super::decimal::plain_number as number;
use super::identifier::plain;
use super::rib_options::{RibOptions, RibShadows};
use super::rib_sheets::{Sheet, sheets};
use super::rib_text::{PLAIN, colour, to_camera, triple};
use crate::geom::Bounds;
use crate::math::DVec3;
use crate::model::{Camera, Digits, Light, Model, Projection};

/// Fewest and most pixels along a side of a shadow map, which has about two for each of the picture's.
const MAP: [u32; 2] = [512, 4096];
/// What is nearer casts no shadow, as a share of the extent: traced, and by a map, which knows depths at its pixels alone.
const RAY_BIAS: f64 = 0.002;
const MAP_BIAS: f64 = 0.005;

/// What the template may ask for.
#[derive(Serialize)]
pub(super) struct RibValues {
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
    /// Of haze: how far one sees, and its colour.
    air: Option<[String; 2]>,
    /// Where shadows are traced: what is nearer casts none.
    ray_bias: Option<String>,
    /// Linear light with 16 bits a channel?
    linear: bool,
    /// All light is multiplied by this.
    gain: String,
    /// What the maps show: the end of the name of an archive.
    casters: &'static str,
    /// Is there an archive of what stands about?
    stage: bool,
    /// Nothing nearer to the camera is seen.
    #[serde(skip)]
    pub near: f64,
}

#[derive(Serialize)]
struct CameraValues {
    fov: Option<String>,
    /// Focal length and distance of a lens at f/1.
    lens: Option<[String; 2]>,
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
    /// Distance over which it falls off, where it does so; 0 where it does not.
    fade: Option<String>,
    /// Are its shadows traced?
    is_traced: bool,
}

#[derive(Serialize)]
struct MapValues {
    light: String,
    size: u32,
    stem: String,
    window: String,
    clipping: String,
    matrix: String,
    /// Moves what it shows away from its light, so that nothing is in its own shadow.
    bias: String,
}

/// The values of `model`, whose files are called `name`.
pub(super) fn values(model: &Model, name: &str, size: [u32; 2], origin: &Origin, options: RibOptions) -> RibValues {
    let bounds = model.bounds();
    let extent = bounds.extent();
    let digits = Digits::for_size(extent);
    let sheets = sheets(model, size, digits);
    let stem = plain(name);
    let mut lights = Vec::new();
    let mut maps = Vec::new();
    // From anywhere that is seen, past everything.
    let seen = sheets.iter().map(|sheet| sheet.far).fold(extent, f64::max);
    let reach = 2.0 * (seen + bounds.size().length().max(extent));
    let map = size[0].max(size[1]).saturating_mul(2).clamp(MAP[0], MAP[1]).next_power_of_two();
    let world = World { bounds, digits, reach, map };
    for (i, light) in model.lights.iter().enumerate() {
        let (values, map) = light_values(&stem, i, light, &world, options.shadows);
        lights.push(values);
        maps.extend(map);
    }
    RibValues {
        version: env!("CARGO_PKG_VERSION"),
        title: plain(&model.title),
        command: plain(&origin.command),
        seed: origin.seed,
        width: size[0],
        height: size[1],
        camera: camera_values(&model.camera, bounds, extent, &sheets, digits),
        lights,
        maps,
        sheets,
        air: model.air.map(|air| [number(air.clear, digits), colour(model.sky.at_horizon())]),
        ray_bias: (options.shadows == RibShadows::Rays).then(|| number(extent * RAY_BIAS, digits)),
        linear: options.linear,
        gain: number(model.camera.gain, PLAIN),
        stage: model.has_scenery(),
        near: extent * NEAR,
        casters: if has_casters(model, options) { "casters" } else { "archive" },
        stem,
    }
}

/// Nothing nearer to the camera is seen, as a share of the extent.
const NEAR: f64 = 1e-3;

fn camera_values(camera: &Camera, bounds: Bounds, extent: f64, sheets: &[Sheet], digits: Digits) -> CameraValues {
    let frame = camera.frame();
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
    // At f/1 a lens' focal length is the width of its opening.
    let lens = camera.lens;
    let lens = (!lens.is_pinhole()).then(|| [lens.aperture, lens.focus].map(|x| number(x, digits)));
    CameraValues {
        lens,
        fov,
        window,
        clipping: format!("{} {}", number(extent * NEAR, digits), number(far, digits)),
        matrix: to_camera(camera.at, frame, digits),
    }
}

/// What lights need to know of the scene.
struct World {
    bounds: Bounds,
    digits: Digits,
    /// No shadow is longer.
    reach: f64,
    /// Pixels along a side of a shadow map.
    map: u32,
}

/// A light, and the shadow map that it needs.
fn light_values(
    stem: &str,
    i: usize,
    light: &Light,
    world: &World,
    shadows: RibShadows,
) -> (LightValues, Option<MapValues>) {
    let World { bounds, digits, reach, .. } = *world;
    match *light {
        Light::Sun { towards, colour: c, shadow, .. } => {
            let needs_map = shadow && shadows == RibShadows::Maps && !bounds.is_empty();
            let map = needs_map.then(|| map_values(stem, i, towards, world));
            let light = LightValues {
                shader: match shadows {
                    RibShadows::Rays if shadow => "raydistant",
                    RibShadows::Maps if shadow => "shadowdistant",
                    _ => "distantlight",
                },
                intensity: "1".to_owned(),
                colour: colour(c),
                // Pixie looks for what is in the way as far as from here to there.
                from: triple(towards * reach, digits),
                to: Some("0 0 0".to_owned()),
                map: map.as_ref().map(|map| format!("{}.shad", map.stem)),
                fade: None,
                is_traced: false,
            };
            (light, map)
        }
        Light::Point { at, colour: c, fade, shadow } => {
            let light = LightValues {
                shader: "fadepoint",
                intensity: "1".to_owned(),
                colour: colour(c),
                from: triple(at, digits),
                to: None,
                map: None,
                fade: Some(number(fade.unwrap_or(0.0), digits)),
                is_traced: shadow && shadows == RibShadows::Rays,
            };
            (light, None)
        }
    }
}

/// Do shadow maps need an archive of their own, since some objects cast no shadow?
pub(super) fn has_casters(model: &Model, options: RibOptions) -> bool {
    options.shadows == RibShadows::Maps && model.objects.iter().any(|object| !object.shadow && !object.is_scenery)
}

/// A shadow map: the scene as a sun sees it.
fn map_values(stem: &str, i: usize, towards: DVec3, world: &World) -> MapValues {
    let World { bounds, digits, .. } = *world;
    let centre = bounds.centre();
    let radius = bounds.size().length() * 0.5 * 1.02;
    let eye = centre + towards * (radius * 2.0);
    let upright = if towards.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z };
    let right = (-towards).cross(upright).normalize();
    let half = number(radius, digits);
    MapValues {
        light: format!("light {}", i + 1),
        size: world.map,
        stem: format!("{stem}-light{}", i + 1),
        window: format!("-{half} {half} -{half} {half}"),
        clipping: format!("{} {}", number(radius * 0.9, digits), number(radius * 3.1, digits)),
        matrix: to_camera(eye, [right, right.cross(-towards), -towards], digits),
        bias: triple(-towards * (bounds.size().max_element() * MAP_BIAS), digits),
    }
}
