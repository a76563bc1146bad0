//! Strokes: limbs that shine, as the glow stage draws them over a photograph or over black.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::Neighbours;
use crate::math::{DVec2, Weights};

/// The class of the paths that are a stroke's core; all others are its branches.
pub const CORE: &str = "main";

/// How an object of a flat scene shines. Only scenes with `[view]` have glowing objects.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GlowSpec {
    /// Strength of all its light, in stops: each doubles it. At 0 a channel just as bright as white paper in sunlight.
    #[schemars(range(min = -20.0, max = 30.0))]
    pub exposure: f64,
    /// Light of all layers times this: for flicker.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub intensity: f64,
    /// Light of the channel itself where its paths are of class `main`.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub core: f64,
    /// Light of the channel itself everywhere else.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub branches: f64,
    /// How fast limbs dim as they thin: the channel's light goes with its radius over the greatest, to this power.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub dim: f64,
    /// Colour of all its light, as that of a body so hot, in kelvin.
    #[schemars(range(min = 1000.0, max = 40000.0))]
    pub temperature: f64,
    /// The glow about the channel: a second distance field (Xu and Mould 2008, section 3).
    pub near: NearGlow,
    /// The halo that the air makes.
    pub halo: Halo,
    /// Light thrown on the photograph.
    pub cloud: CloudLight,
}

/// The paper's glow: `V = exp(-(d / T)^2)`, d the cost from the stroke in a graph of its own.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NearGlow {
    /// Its light.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub strength: f64,
    /// The thickness factor T over the stroke's radius at the nearest place: 1 makes the width of a step its T, which
    /// tapers by eq. 2 as that does.
    #[schemars(range(min = 0.01, max = 1000.0))]
    pub spread: f64,
    /// Spacing of its lattice, in scene units; by default 1/720 of the view's height.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub grain: Option<f64>,
    /// Weights of its lattice. Costs are divided by the mean cost per unit of length that least-cost paths have there, so
    /// that T is a length.
    pub weights: Weights,
    /// Neighbours in its lattice: 4 or 8.
    pub neighbours: Neighbours,
}

/// The halo: light that the air scatters, by the atmospheric point-spread function of Narasimhan and Nayar (2003).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Halo {
    /// Share of the channel's light that is scattered into it.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub strength: f64,
    /// Optical thickness of the air between: 1.1 is haze, 4 thick fog.
    #[schemars(range(min = 1.05, max = 20.0))]
    pub thickness: f64,
    /// Forward scattering: 0.2 air, 0.75 haze, 0.9 fog, 0.95 rain.
    #[schemars(range(min = 0.0, max = 0.99))]
    pub q: f64,
    /// Angle of view from the bottom of the picture to its top.
    #[schemars(range(min = 1.0, max = 150.0))]
    pub angle: f64,
}

/// Light thrown on the clouds and the ground of a photograph.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CloudLight {
    /// How much of it.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub strength: f64,
    /// How far in front of the clouds the channel is, as a share of the view's height: its light falls off over about
    /// that.
    #[schemars(range(min = 0.01, max = 10.0))]
    pub distance: f64,
}

impl Default for GlowSpec {
    fn default() -> Self {
        Self {
            exposure: 0.0,
            intensity: 1.0,
            core: 1.0,
            branches: 1.0,
            dim: 1.0,
            temperature: 9000.0,
            near: NearGlow::default(),
            halo: Halo::default(),
            cloud: CloudLight::default(),
        }
    }
}

impl Default for NearGlow {
    fn default() -> Self {
        let weights = Weights { max: 10.0, alpha: 1.0 };
        // Eight neighbours: with four the glow of a channel has corners.
        let neighbours = Neighbours::EIGHT;
        Self { strength: 0.0, spread: 4.0, grain: None, weights, neighbours }
    }
}

impl Default for Halo {
    fn default() -> Self {
        Self { strength: 0.0, thickness: 1.2, q: 0.75, angle: 45.0 }
    }
}

impl Default for CloudLight {
    fn default() -> Self {
        Self { strength: 0.0, distance: 0.15 }
    }
}

/// A piece of a stroke, from one node to the next; a single node has both ends in one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its ends, in scene units.
    pub ends: [DVec2; 2],
    /// Radii there.
    pub radii: [f64; 2],
    /// Does it belong to the core?
    pub is_core: bool,
}

/// An object that shines.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its name in the scene.
    pub name: String,
    /// Its pieces.
    pub pieces: Vec<Piece>,
    /// How it shines.
    pub glow: GlowSpec,
}

impl Stroke {
    /// Moves it.
    pub fn shift(&mut self, by: DVec2) {
        self.pieces.iter_mut().flat_map(|piece| &mut piece.ends).for_each(|end| *end += by);
    }
}
