//! The small values of scene files: points, angles, and references by name.

use std::marker::PhantomData;

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
