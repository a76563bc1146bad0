//! What goes with a way to grow.

/// Methods that keep some bytes of every node refuse more nodes than this.
pub(super) const MOST_DENSE: u64 = 1 << 27;

/// Which spaces a method grows in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Needs {
    /// Any graph.
    Graph,
    /// A lattice.
    Lattice,
    /// Voxels.
    Voxels,
    /// No space.
    Nothing,
}

/// What goes with a method.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    /// It in a sentence: "regions have".
    pub subject: &'static str,
    /// Where it grows.
    pub needs: Needs,
    /// Can it be repeated, with paths that leave other steps at an angle?
    pub repeats: bool,
    /// Does it grow to endpoints?
    pub has_endpoints: bool,
    /// Does it grow limbs, with a width?
    pub has_limbs: bool,
    /// May an attractor draw it?
    pub has_attractor: bool,
    /// The class of limbs without an endpoint.
    pub class: Option<&'static str>,
    /// More nodes are refused.
    pub most_nodes: u64,
}

impl Rules {
    /// Those of least-cost paths, which other methods differ from.
    pub const PATHS: Self = Self {
        subject: "paths have",
        needs: Needs::Graph,
        repeats: true,
        has_endpoints: true,
        has_limbs: true,
        has_attractor: false,
        class: None,
        most_nodes: u64::MAX,
    };
}
