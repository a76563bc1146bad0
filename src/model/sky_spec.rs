//! The sky as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::{Colour, Degrees};

/// What is behind everything, as a scene writes it: one colour, a gradient, a picture, or a day.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SkySpec {
    /// One colour all over.
    pub colour: Option<Colour>,
    /// Of a gradient: colour at the horizon and below.
    pub horizon: Option<Colour>,
    /// Of a gradient: colour overhead.
    pub zenith: Option<Colour>,
    /// An equirectangular picture of all directions (EXR or Radiance HDR), beside the scene.
    pub file: Option<String>,
    /// How far the picture is turned about the vertical.
    pub turn: Degrees,
    /// The picture's light times this.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub strength: Option<f64>,
    /// The sky of a day, which has its sun: a scene without lights of its own gets that too.
    pub daylight: Option<DaylightSpec>,
}

/// A day: where the sun stands, how hazy the air is, and how cloudy. The clear sky is that of Hosek and Wilkie 2012, the overcast one
/// that of Moon and Spencer 1942.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DaylightSpec {
    /// Latitude, north of the equator.
    pub latitude: Degrees,
    /// Day of the year: 80 is the equinox in spring, 172 the solstice in June.
    #[schemars(range(min = 1.0, max = 366.0))]
    pub day: f64,
    /// Hour of solar time: at 12 the sun is highest.
    #[schemars(range(min = 0.0, max = 24.0))]
    pub hour: f64,
    /// Where north is: the angle from y, counterclockwise from above.
    #[serde(default)]
    pub north: Degrees,
    /// How hazy the air is: 2 is very clear, 3 clear, 6 hazy.
    #[serde(default = "turbidity")]
    #[schemars(range(min = 1.0, max = 10.0))]
    pub turbidity: f64,
    /// Share of the sky that clouds cover: 0.3 is a fair day, 1 overcast. They move with day and hour.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub clouds: f64,
    /// Light times this, as a longer exposure takes more of it.
    #[serde(default = "exposure")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 100))]
    pub exposure: f64,
}

fn turbidity() -> f64 {
    3.0
}

fn exposure() -> f64 {
    1.0
}
