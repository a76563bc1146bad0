//! Ray queries: round cones and triangles in 8-wide trees, collapsed from the binary tree that `obvhs` builds.
//!
//! The tree is traversed with one code for every instruction set, chosen at run time (`fearless_simd`), without fused
//! or approximate operations: all give the same hits, and equal hits go to the lowest id. Any input is accepted:
//! primitives that are no solid (a radius that is not above 0, a number that is not finite) are left out, identical
//! ones by the thousand are kept once, and the depth of the tree is bounded.

mod build;
mod collapse;
mod queries;
mod ray;
mod round_cone;
mod tree;
mod triangle;

pub use queries::{Boxes, Primitive, Queries};
pub use ray::{Hit, Ray};
pub use round_cone::{Entry, RoundCone};
pub use triangle::Triangle;

/// Round cones in a tree.
pub type Cones = Queries<RoundCone, 8>;
/// Triangles in a tree.
pub type Triangles = Queries<Triangle, 9>;
