//! A cost field from a function of one's own: a river keeps to a winding valley. `cargo run --example own_field > river.svg`.

use std::error::Error;
use std::io;
use std::sync::Arc;

use lichtenberg::assemble::{ObjectRecipe, Recipe, grow, model};
use lichtenberg::export::{SvgOptions, write_svg};
use lichtenberg::geom::{Neighbours, Shape, Solid};
use lichtenberg::graph::{CostField, FieldFunction, Measure};
use lichtenberg::grow::{Endpoints, Generators, LatticeSpace, Paths, Placement, Space, Step};
use lichtenberg::math::{Colour, DVec3, Memory, Progress};
use lichtenberg::model::{CameraSpec, Material};
use lichtenberg::skeleton::Width;

/// The middle of the valley at `x`.
fn valley(x: f64) -> f64 {
    3.0 + 1.5 * libm::sin(x)
}

fn main() -> Result<(), Box<dyn Error>> {
    let land = Shape::new(Solid::Box { min: DVec3::ZERO, max: DVec3::new(12.0, 6.0, 0.0) });
    // A step costs up to 10; away from the valley it costs 20 more for each unit of distance.
    let height = |p: DVec3| 20.0 * (p.y - valley(p.x)).abs();
    let field = CostField::new(Measure::Function(FieldFunction(Arc::new(height))));
    let space = LatticeSpace { fields: vec![field], ..LatticeSpace::new(land, 0.05, Neighbours::EIGHT)? };
    let river = Step {
        source: Generators::At(vec![DVec3::new(0.0, valley(0.0), 0.0)]),
        endpoints: vec![Endpoints::new("mouth", Placement::At(vec![DVec3::new(12.0, valley(12.0), 0.0)]))],
        width: Width::Constant(0.08),
        smooth: 3.0,
        ..Step::new("river", Some(Space::Lattice(space)), Paths::method())
    };
    let recipe = Recipe {
        is_flat: true,
        size: [640, 320],
        camera: CameraSpec::front(),
        steps: vec![river],
        objects: vec![ObjectRecipe::new("river", vec![0])],
        materials: vec![("ink".to_owned(), Material::ink(Colour::from_srgb([34, 85, 170])))],
        ..Recipe::default()
    };
    let (memory, progress) = (Memory::new(1 << 30), Progress::default());
    let grown = grow(&recipe, &[], &memory, &progress)?;
    let model = model(&recipe, &grown, recipe.size, &memory, &progress)?;
    write_svg(&model, SvgOptions { size: recipe.size }, io::stdout().lock())?;
    Ok(())
}
