//! Objects: what they name is looked up, and whether their skin fits.

use std::io::Cursor;
use std::sync::Arc;

use super::document::{ObjectSpec, TileSpec};
use super::resolver::Resolver;
use crate::assemble::{LeavesRecipe, ObjectRecipe};
use crate::files::{Folder, ReadError, SketchError, decode_linear, decode_mesh, decode_sketch, leaf_names};
use crate::grow::{MethodSpec, Step};
use crate::math::{DVec2, DVec3, Ref, unknown};
use crate::model::{Instance, Material, Mesh};
use crate::skin::{LeafError, LeavesSpec, PaintSpec, Painting, Skin, ball_mesh, leaf_mesh};

/// More places of a tile than this are refused.
const MOST_TILES: u64 = 100_000;

impl Resolver<'_> {
    /// The object called `name`.
    pub fn object(
        &mut self,
        name: &str,
        spec: &ObjectSpec,
        materials: &[(String, Material)],
        is_flat: bool,
    ) -> Option<ObjectRecipe> {
        let place = format!("object.{name}");
        let steps = self.object_steps(&place, spec);
        if spec.grow.is_empty() == spec.mesh.is_none() {
            self.wrong(&place, "an object has either steps (`grow`) or a `mesh`".to_owned());
        }
        if spec.glow.is_some() && self.scene.view.is_none() {
            self.wrong(&format!("{place}.glow"), "only scenes with `[view]` have glowing objects".to_owned());
        }
        let mesh = match &spec.mesh {
            Some(file) => self.read(&format!("{place}.mesh"), file, |bytes| decode_mesh(file, bytes)).map(Some),
            None => Some(None),
        };
        let names = materials.iter().map(|(name, _)| name);
        let material = match &spec.material {
            Some(material) => self.find(&format!("{place}.material"), "material", material, names.clone())?,
            None => names.clone().position(|n| n == "ink").or_else(|| names.clone().position(|n| n == "bark"))?,
        };
        self.skin(&place, spec, is_flat);
        let paint = match &spec.paint {
            Some(paint) => Some((self.painting(&format!("{place}.paint.file"), paint)?, paint.steps)),
            None => None,
        };
        let mut level_materials = Vec::new();
        for (i, material) in spec.level_materials.iter().enumerate() {
            let found = self.find(&format!("{place}.level_materials.{i}"), "material", material, names.clone());
            level_materials.push(found);
        }
        let mut leaves = Vec::new();
        for (key, spec_of) in &spec.leaves {
            leaves.push(self.leaves(&place, key, spec_of, spec.grow.is_empty(), materials));
        }
        let at = spec.at.map_or(DVec3::ZERO, |p| p.0);
        Some(ObjectRecipe {
            level_materials: level_materials.into_iter().collect::<Option<_>>()?,
            leaves: leaves.into_iter().collect::<Option<_>>()?,
            mesh: mesh?,
            skin: spec.skin,
            material,
            thorns: spec.thorns,
            paint,
            at,
            copies: copies(spec, at),
            glow: spec.glow,
            until: spec.until,
            shadow: spec.shadow,
            marks: spec.marks,
            lights: spec.lights,
            ..ObjectRecipe::new(name, steps?)
        })
    }

    fn object_steps(&mut self, place: &str, spec: &ObjectSpec) -> Option<Vec<usize>> {
        let mut steps = Vec::new();
        for (i, step) in spec.grow.iter().enumerate() {
            let place = format!("{place}.grow.{i}");
            if spec.grow[..i].iter().any(|other| other.name == step.name) {
                self.wrong(&place, format!("step `{}` is listed twice", step.name));
            }
            steps.push(self.find(&place, "step", step, self.scene.grow.keys()));
        }
        steps.into_iter().collect()
    }

    fn leaves(
        &mut self,
        place: &str,
        key: &str,
        spec: &LeavesSpec,
        is_mesh: bool,
        materials: &[(String, Material)],
    ) -> Option<LeavesRecipe> {
        let place = format!("{place}.leaves.{key}");
        if is_mesh {
            self.wrong(&place, "only what grew bears leaves".to_owned());
        }
        if spec.facing.is_some_and(|p| p.0 == DVec3::ZERO) {
            self.wrong(&format!("{place}.facing"), "leaves face a direction, not the zero vector".to_owned());
        }
        let names = materials.iter().map(|(name, _)| name);
        let material = self.find(&format!("{place}.material"), "material", &spec.material, names)?;
        let mesh = leaf(&spec.shape, spec.fold.radians(), self.folder);
        let mesh = self.note(&format!("{place}.shape"), mesh)?;
        Some(LeavesRecipe { name: key.to_owned(), spec: spec.clone(), mesh, material })
    }

    /// A skin, and what is on it, fit what the object is made of.
    fn skin(&mut self, place: &str, spec: &ObjectSpec, is_flat: bool) {
        if is_flat && (spec.skin.is_mesh() || !spec.leaves.is_empty()) {
            self.wrong(place, "leaves and the skin `mesh` are for scenes in space".to_owned());
        }
        if !spec.skin.has_levels() && !spec.level_materials.is_empty() {
            let message = "this skin makes all levels one: it has one material".to_owned();
            self.wrong(&format!("{place}.level_materials"), message);
        }
        let is_solid = |step: &Ref<Step>| {
            self.scene.grow.get(&step.name).is_some_and(|step| matches!(step.by, MethodSpec::Regions(_)))
        };
        let solids = spec.grow.iter().filter(|step| is_solid(step)).count();
        let is_surface = spec.skin == Skin::Surface;
        if solids > 0 && !(is_surface && solids == spec.grow.len()) {
            let message =
                "regions have no limbs: their objects have `skin = \"surface\"`, and no other steps".to_owned();
            self.wrong(&format!("{place}.skin"), message);
        } else if is_surface && solids == 0 {
            let message =
                "the skin `surface` is that of regions: limbs have `cones`, `spheres`, `mesh` or `isosurface`";
            self.wrong(&format!("{place}.skin"), message.to_owned());
        }
        let is_cones = spec.skin == Skin::Cones && !spec.grow.is_empty();
        let keys = [
            ("thorns", spec.thorns.is_some(), is_cones, "limbs of cones"),
            ("paint", spec.paint.is_some(), is_cones, "limbs of cones"),
            ("leaves", !spec.leaves.is_empty(), !is_surface, "limbs"),
        ];
        for (key, _, _, what) in keys.into_iter().filter(|(_, is_given, fits, _)| *is_given && !fits) {
            self.wrong(&format!("{place}.{key}"), format!("`{key}` belongs to {what}"));
        }
        if spec.paint.is_some() && !spec.level_materials.is_empty() {
            let message = "colours come either from a picture (`paint`) or by level".to_owned();
            self.wrong(&format!("{place}.paint"), message);
        }
        if spec.tile.as_ref().is_some_and(|tile| !fits(tile)) {
            let message = format!("a tile has {MOST_TILES} places at most, apart from each other");
            self.wrong(&format!("{place}.tile"), message);
        }
    }

    fn painting(&mut self, place: &str, spec: &PaintSpec) -> Option<Arc<Painting>> {
        let picture = self.read(place, &spec.file, |bytes| decode_linear(Cursor::new(bytes)))?;
        let pixels = picture.pixels(["R", "G", "B"])?;
        Some(Arc::new(Painting { size: [picture.width, picture.height], pixels }))
    }
}

/// Is a tile of a size that can be handled, its places apart?
fn fits(tile: &TileSpec) -> bool {
    let places = u64::from(tile.count[0]) * u64::from(tile.count[1]);
    let is_apart = (0..2).all(|axis| tile.count[axis] == 1 || tile.step[axis].abs() > 0.0);
    places <= MOST_TILES && is_apart
}

/// Where else an object stands that grew at `at`.
fn copies(spec: &ObjectSpec, at: DVec3) -> Vec<Instance> {
    let copies = spec.copies.iter().map(|copy| Instance { at: copy.at.0, turn: copy.turn.0, scale: copy.scale });
    let tiles = spec.tile.iter().flat_map(|tile| tile.places().map(|by| Instance::at(at + by)));
    copies.chain(tiles).collect()
}

/// Why a file or a name is no leaf.
#[derive(Debug, thiserror::Error)]
enum LeafFileError {
    #[error("{0}")]
    Unknown(String),
    #[error("{0}")]
    Read(#[from] ReadError),
    #[error("cannot use `{0}` as a leaf: {1}")]
    Sketch(String, SketchError),
    #[error("cannot use `{0}` as a leaf: it has no closed outline")]
    Open(String),
    #[error("cannot use `{0}` as a leaf: {1}")]
    Mesh(String, LeafError),
}

/// One leaf: a ball, a shape that comes with the program, or the outline in an SVG file beside the scene.
fn leaf(shape: &str, fold: f64, folder: &Folder) -> Result<Mesh, LeafFileError> {
    if shape == "ball" {
        return Ok(ball_mesh());
    }
    let bytes = if shape.ends_with(".svg") {
        folder.read(shape)?
    } else {
        let own = Folder::Embedded("leaves".into()).read(&format!("{shape}.svg"));
        own.map_err(|_| LeafFileError::Unknown(unknown("leaf", shape, leaf_names().iter())))?
    };
    let page = decode_sketch(&bytes).map_err(|error| LeafFileError::Sketch(shape.to_owned(), error))?;
    let outline = page.lines.iter().find(|(_, is_closed)| *is_closed).map(|(line, _)| line);
    let outline = outline.ok_or_else(|| LeafFileError::Open(shape.to_owned()))?;
    let outline: Vec<DVec2> = outline.iter().map(|p| DVec2::new(p.x * page.aspect, p.y)).collect();
    leaf_mesh(&outline, fold).map_err(|error| LeafFileError::Mesh(shape.to_owned(), error))
}
