//! Colours.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::srgb::{from_srgb, srgb_byte};

/// A colour in linear light: `[r, g, b]` linear, or `"#rrggbb"` sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub [f64; 3]);

impl Colour {
    /// The linear colour of an sRGB one of 8 bits a channel (IEC 61966-2-1).
    #[must_use]
    pub fn from_srgb(rgb: [u8; 3]) -> Self {
        Self(rgb.map(|byte| from_srgb(f64::from(byte) / 255.0)))
    }

    /// The same by `factor`.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }

    /// With this share of `other` in place of as much of its own.
    #[must_use]
    pub fn mixed(self, other: Self, share: f64) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] + (other.0[i] - self.0[i]) * share))
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
