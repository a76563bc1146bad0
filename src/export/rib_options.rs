//! How a RIB scene is written.

/// How a RIB scene has its shadows: renderers differ in that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RibShadows {
    /// None: what every renderer takes.
    #[default]
    None,
    /// Traced by the light `raydistant`, which Pixie has.
    Rays,
    /// Maps that the scene makes first, read by the light `shadowdistant`, which Aqsis has.
    Maps,
}

/// What a RIB scene is like.
#[derive(Clone, Copy, Debug, Default)]
pub struct RibOptions {
    /// Shadows.
    pub shadows: RibShadows,
    /// Leave thorns to the displacement shader `thorns`, which must be compiled; otherwise they are cones.
    pub displace: bool,
}
