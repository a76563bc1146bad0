//! The binary trees of the builder.

use obvhs::bvh2::node::Bvh2Node;

/// A binary tree; its leaves are ranges of `order`.
pub(super) struct Binary {
    pub nodes: Vec<Bvh2Node>,
    pub order: Vec<u32>,
}
