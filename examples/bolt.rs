//! A bolt over a picture in memory, to a PNG: `cargo run --example bolt > bolt.png`.

use std::error::Error;
use std::io;
use std::sync::Arc;

use lichtenberg::assemble::{Backdrop, ObjectRecipe, Recipe, grow, model};
use lichtenberg::files::decode_plate;
use lichtenberg::geom::{Neighbours, Shape, Solid};
use lichtenberg::grow::{Endpoints, Generators, LatticeSpace, Paths, Placement, Space, Step};
use lichtenberg::math::{DVec3, Memory, Progress, Weights};
use lichtenberg::model::{GlowSpec, ViewFrame, ViewSpec};
use lichtenberg::picture::{Depth, Shone};
use lichtenberg::skeleton::Width;

fn main() -> Result<(), Box<dyn Error>> {
    // Any picture that is in memory: here one that comes with the crate.
    let plate = decode_plate(include_bytes!("../scenes/skies/dusk-launch-pad.jpg"))?;
    let frame = ViewFrame::new(&ViewSpec::default(), plate.size);
    let [width, height] = frame.extent;

    let sky = Shape::new(Solid::Box { min: DVec3::ZERO, max: DVec3::new(width, height, 0.0) });
    let weights = Weights { max: 10.0, alpha: 1.5 };
    let space = LatticeSpace { weights, ..LatticeSpace::new(sky, height / 200.0, Neighbours::EIGHT)? };
    let bolt = Step {
        source: Generators::At(vec![DVec3::new(width * 0.6, height, 0.0)]),
        endpoints: vec![Endpoints::new("target", Placement::At(vec![DVec3::new(width * 0.4, height * 0.3, 0.0)]))],
        width: Width::Constant(height / 600.0),
        smooth: 1.0,
        ..Step::new("bolt", Some(Space::Lattice(space)), Paths::method())
    };
    let glow = GlowSpec { exposure: 3.0, ..GlowSpec::default() };
    let backdrop = Backdrop { frame, plate: Some(Arc::new(plate)), matte: None };
    let recipe = Recipe {
        is_flat: true,
        steps: vec![bolt],
        objects: vec![ObjectRecipe { glow: Some(glow), ..ObjectRecipe::new("bolt", vec![0]) }],
        view: Some(backdrop.clone()),
        ..Recipe::default()
    };
    let (memory, progress) = (Memory::new(1 << 30), Progress::default());
    let grown = grow(&recipe, &[], &memory, &progress)?;
    let strokes = model(&recipe, &grown, recipe.size, &memory, &progress)?.strokes;
    let shone = Shone::new(&backdrop, recipe.size, &strokes, recipe.seed, &memory, &progress)?;
    shone.write_png(Depth::Eight, &[], &mut io::stdout().lock())?;
    Ok(())
}
