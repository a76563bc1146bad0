//! Surfaces of RIB: a colour, and a standard shader or that of a pattern.

use super::decimal::plain_number as number;
use super::rib_text::{PLAIN, colour};
use crate::model::{Body, Material, Object};

/// Standard shaders have highlights of exponent 8 / roughness (Aqsis) or 10 / roughness (Pixie), POV-Ray of 1 / roughness.
const EXPONENT: f64 = 9.0;
/// A highlight after Phong is as wide as one after Blinn with this many times its exponent.
const PHONG: f64 = 4.0;

/// The surface of an object.
pub(super) fn surface(object: &Object, m: &Material) -> String {
    let is_laid = matches!(object.body, Body::Limbs(_));
    let Some(pattern) = m.pattern.filter(|_| is_laid) else { return plain(m, is_leaf(object, m)) };
    let figure = pattern.figure();
    let [size, mean, height] = [figure.size(), figure.mean(), figure.height()].map(|x| number(x, PLAIN));
    format!(
        "Color [{}]\nSurface \"{}\" {} \"float size\" [{size}] \"float mean\" [{mean}] \"float height\" [{height}] \"color over\" [{}]",
        colour(m.colour),
        figure.name(),
        light(m).join(" "),
        colour(figure.colour()),
    )
}

/// Does it let light through, or is its lower side paler, which no standard shader knows?
pub(super) fn is_leaf(object: &Object, m: &Material) -> bool {
    (m.through > 0.0 || m.paler > 0.0) && (m.pattern.is_none() || object.body.limbs().is_none())
}

fn plain(m: &Material, is_leaf: bool) -> String {
    let mean = m.mean_colour();
    if m.diffuse == 0.0 && m.ambient == 0.0 {
        return format!("Color [{}]\nSurface \"constant\"", colour(mean.times(m.emission)));
    }
    let through = match is_leaf {
        true => format!(" \"float Kt\" [{}] \"float paler\" [{}]", number(m.through, PLAIN), number(m.paler, PLAIN)),
        false => String::new(),
    };
    let shader = match is_leaf {
        true => "leaf",
        false if shine(m) > 0.0 => "plastic",
        false => "matte",
    };
    format!("Color [{}]\nSurface \"{shader}\" {}{through}", colour(mean), light(m).join(" "))
}

fn shine(m: &Material) -> f64 {
    m.specular.max(m.phong)
}

/// The parameters that say what becomes of light.
fn light(m: &Material) -> Vec<String> {
    // The ambient light is 1: light of its own adds to it.
    let mut all = vec![("Ka", m.ambient + m.emission), ("Kd", m.diffuse)];
    if shine(m) > 0.0 {
        let exponent = if m.specular > 0.0 { 1.0 / m.roughness } else { PHONG * m.phong_size };
        all.extend([("Ks", shine(m)), ("roughness", EXPONENT / exponent)]);
    }
    all.into_iter().map(|(name, x)| format!("\"float {name}\" [{}]", number(x, PLAIN))).collect()
}
