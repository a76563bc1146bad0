//! How a RIB scene is written.

/// How a RIB scene has its shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RibShadows {
    /// None.
    None,
    /// Traced by the light `raydistant`, which Pixie has: sharper.
    Rays,
    /// Maps that the scene makes first, read by the light `shadowdistant`: what Pixie and Aqsis both take.
    #[default]
    Maps,
}

/// What a RIB scene is like.
#[derive(Clone, Copy, Debug, Default)]
pub struct RibOptions {
    /// Shadows.
    pub shadows: RibShadows,
    /// Leave thorns to the displacement shader `thorns`, which must be compiled; otherwise they are cones.
    pub displace: bool,
    /// Write the picture in linear light with 16 bits a channel, for whoever makes it one for the screen; otherwise it has 8, bent by
    /// a gamma of 2.2.
    pub linear: bool,
    /// How far limbs may be from their place, in pixels of the picture: what it is too coarse to show is left out
    /// ([`crate::model::Limbs::within`]). 0 leaves out nothing.
    pub detail: f64,
}
