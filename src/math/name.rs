//! The small values of scene files: points, angles, colours, and references by name.

use std::marker::PhantomData;

use super::{from_srgb, srgb_byte};
use glam::DVec3;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;

/// An angle in degrees, as scene files give it; code computes in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Degrees(pub f64);

impl Degrees {
    /// The angle in radians.
    #[must_use]
    pub fn radians(self) -> f64 {
        self.0 * (std::f64::consts::PI / 180.0)
    }
}

/// A position or direction of two or three coordinates; in the plane, z is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point(pub DVec3);

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Vec::<f64>::deserialize(deserializer)?[..] {
            [x, y] => Ok(Self(DVec3::new(x, y, 0.0))),
            [x, y, z] => Ok(Self(DVec3::new(x, y, z))),
            _ => Err(D::Error::custom("a point has two or three coordinates")),
        }
    }
}

impl JsonSchema for Point {
    fn schema_name() -> Cow<'static, str> {
        "Point".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A position or direction: `[x, y]` in the plane, `[x, y, z]` in space.",
            "type": "array",
            "items": { "type": "number", "minimum": -1e6, "maximum": 1e6 },
            "minItems": 2,
            "maxItems": 3
        })
    }
}

/// The name of a `T` that the scene file defines elsewhere.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Ref<T> {
    /// The name.
    pub name: String,
    #[serde(skip)]
    kind: PhantomData<fn() -> T>,
}

impl<T> Ref<T> {
    /// A reference to the `T` called `name`.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: PhantomData }
    }
}

impl<T> JsonSchema for Ref<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Name".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string" })
    }
}

/// A colour in linear light: `[r, g, b]` linear, or `"#rrggbb"` sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub [f64; 3]);

impl Colour {
    /// The linear colour of an sRGB one of 8 bits a channel (IEC 61966-2-1).
    #[must_use]
    pub fn from_srgb(rgb: [u8; 3]) -> Self {
        Self(rgb.map(|byte| from_srgb(f64::from(byte) / 255.0)))
    }

    /// Its sRGB encoding as six lower-case hexadecimal digits, such as `707070`.
    #[must_use]
    pub fn hex(self) -> String {
        self.0.map(|c| format!("{:02x}", srgb_byte(c))).concat()
    }

    fn from_hex(text: &str) -> Option<Self> {
        let hex = text.strip_prefix('#').filter(|hex| hex.len() == 6 && hex.is_ascii())?;
        let byte = |i: usize| u8::from_str_radix(hex.get(i..i + 2)?, 16).ok();
        Some(Self::from_srgb([byte(0)?, byte(2)?, byte(4)?]))
    }
}

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let wrong = "a colour is [r, g, b] or \"#rrggbb\"";
        match serde_json::Value::deserialize(deserializer)? {
            serde_json::Value::String(text) => Self::from_hex(&text).ok_or_else(|| D::Error::custom(wrong)),
            value => serde_json::from_value(value).map(Self).map_err(|_| D::Error::custom(wrong)),
        }
    }
}

impl JsonSchema for Colour {
    fn schema_name() -> Cow<'static, str> {
        "Colour".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A colour: `[r, g, b]` in linear light, or `\"#rrggbb\"` as sRGB.",
            "anyOf": [
                { "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" },
                {
                    "type": "array",
                    "items": { "type": "number", "minimum": 0, "maximum": 1e4 },
                    "minItems": 3,
                    "maxItems": 3
                }
            ]
        })
    }
}

/// The message about an unknown name, with the most similar of the `known` ones (Damerau-Levenshtein) or all of them:
/// "there is no shape `crwon`; did you mean `crown`?"
pub fn unknown<'a>(kind: &str, name: &str, known: impl Iterator<Item = &'a String>) -> String {
    let known: Vec<_> = known.map(String::as_str).collect();
    let near = known
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .min()
        .filter(|(distance, _)| *distance <= name.len().max(3) / 3 + 1);
    let hint = match (near, &known[..]) {
        (Some((_, near)), _) => format!("did you mean `{near}`?"),
        (None, []) => "none is defined".to_owned(),
        (None, _) => format!("there are: {}", known.join(", ")),
    };
    format!("there is no {kind} `{name}`; {hint}")
}
