//! Where a model came from.

/// Where a model came from, for the header of what is written.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// The command that repeats it.
    pub command: String,
    /// The scene's seed.
    pub seed: u64,
}
