//! Ray queries: round cones and triangles in 8-wide bounding volume hierarchies, collapsed from the binary tree that `obvhs`
//! builds.
//!
//! One source of the traversal is compiled for every instruction set and chosen at run time (`fearless_simd`), without fused
//! or approximate operations: all give the same hits, and of equal hits the lowest id counts. Any input is accepted:
//! degenerate primitives (a radius that is not above 0, a number that is not finite) are left out, thousands of identical
//! ones are deduplicated, and the depth of the tree is bounded.

mod binary;
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

/// A hierarchy of round cones.
pub type Cones = Queries<RoundCone, 8>;
/// A hierarchy of triangles.
pub type Triangles = Queries<Triangle, 9>;
