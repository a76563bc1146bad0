//! Randomly weighted graphs: implicit lattices, whose weights are computed and never stored, and scattered graphs with
//! stored edges.
//!
//! Later stages need never handle a weight of zero, a negative one or one that is not finite: every weight is a
//! fixed-point integer; on a lattice it is between [`WeightRange::least`] and [`WeightRange::most`].

mod cost_field;
mod edge;
mod field;
mod field_spec;
mod lattice;
mod lattice_edges;
mod mask;
mod poisson;
mod scatter;
mod scatter_size;
mod sectors;
mod triangular;
mod weights;
mod window;
mod yao;

pub use cost_field::{CostField, FieldFunction, Measure};
pub use edge::{Edge, Graph, GraphVisitor, Node};
pub use field::{FieldTable, FieldValue};
pub use field_spec::{FieldSpec, FieldUse, HeightEnd, MeasureSpec};
pub use lattice::Lattice;
pub use mask::Mask;
pub use poisson::{Region, poisson_points};
pub use scatter::{EdgeWeights, Joining, Scatter, ScatterPlan};
pub use scatter_size::{ScatterError, scatter_bytes, scatter_estimate, spacing_of_kept};
pub use sectors::{Sectors, SectorsError};
pub use triangular::TriangularSpec;
pub use weights::{WeightError, WeightRange, WeightTable};
pub use window::{LatticeError, Window};
