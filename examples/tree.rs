//! A tree from Rust to POV-Ray, without TOML: `cargo run --example tree > tree.inc`.

use std::error::Error;
use std::io;

use lichtenberg::assemble::{ObjectRecipe, Recipe, grow, model};
use lichtenberg::export::{Origin, Pov, Templates};
use lichtenberg::geom::{Neighbours, Shape, Solid};
use lichtenberg::grow::{Endpoints, LatticeSpace, Paths, Placement, RandomPlaces, Space, Step};
use lichtenberg::math::{DVec3, Memory, Progress};
use lichtenberg::skeleton::{PerClass, Taper, Width};

fn main() -> Result<(), Box<dyn Error>> {
    // Limbs go from the origin to 60 places in the crown, on a lattice around trunk and crown.
    let air = Solid::Box { min: DVec3::new(-3.0, -3.0, 0.0), max: DVec3::new(3.0, 3.0, 7.0) };
    let crown = Solid::Ellipsoid { centre: DVec3::new(0.0, 0.0, 4.5), radii: DVec3::new(2.8, 2.8, 2.2) };
    let neighbours = Neighbours::new(26).ok_or("26 neighbours")?;
    let space = LatticeSpace::new(Shape::new(air), 0.12, neighbours)?;
    let taper = |x: f64| PerClass::All(x);
    let tree = Step {
        endpoints: vec![Endpoints::new(
            "twigs",
            Placement::Random(RandomPlaces::new(60, Some(Shape::new(crown)), "twigs")),
        )],
        width: Width::Taper(Taper { from: taper(0.16), to: taper(0.02), beta: taper(0.4) }),
        smooth: 2.0,
        ..Step::new("tree", Some(Space::Lattice(space)), Paths::method())
    };
    let recipe = Recipe {
        title: "A tree from Rust".to_owned(),
        seed: 7,
        steps: vec![tree],
        objects: vec![ObjectRecipe::new("tree", vec![0])],
        ..Recipe::default()
    };
    let (memory, progress) = (Memory::new(1 << 30), Progress::default());
    let grown = grow(&recipe, &[], &memory, &progress)?;
    let model = model(&recipe, &grown, recipe.size, &memory, &progress)?;
    Pov::new(&model, &Templates::default(), "tree", recipe.size, &Origin::default()).write_inc(io::stdout().lock())?;
    Ok(())
}
