//! Ways to grow as a scene writes them: a row each.

use schemars::JsonSchema;
use serde::Deserialize;

use super::baselines::{DbmSpec, DlaSpec};
use super::colonise::ColoniseSpec;
use super::paths::FractalSpec;
use super::regions::RegionsSpec;
use super::segments::SegmentsSpec;
use super::voxels::VoxelsSpec;
use super::weber_penn::WeberPennSpec;

/// How limbs come about.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MethodSpec {
    /// By least-cost paths (Xu and Mould 2007, section 3).
    #[default]
    Paths,
    /// By least-cost paths to endpoints at a distance from all that has grown, again and again (2007, section 3.2); on
    /// lattices.
    Fractal(FractalSpec),
    /// Not limbs but solids: all that is nearest to each generator (2007, section 3.4); on lattices.
    Regions(RegionsSpec),
    /// By segments, a step of each limb at a time, without a graph (Amin's Growth module).
    Segments(SegmentsSpec),
    /// By a voxel space automaton that senses light, other growth and surfaces (Greene 1989).
    Voxels(VoxelsSpec),
    /// By space colonisation, without a graph, as a baseline (Runions, Lane and Prusinkiewicz 2007).
    Colonise(ColoniseSpec),
    /// By parameters of each level of stems, without a graph, as a baseline (Weber and Penn 1995).
    WeberPenn(WeberPennSpec),
    /// By the dielectric breakdown model, as a baseline.
    Dbm(DbmSpec),
    /// By diffusion-limited aggregation, as a baseline.
    Dla(DlaSpec),
}
