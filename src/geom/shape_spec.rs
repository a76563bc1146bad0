//! Shapes as a scene writes them, and how their names and files are looked up.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::{Bounds, ClosedMesh, Outline, OutlineError, Profile, Shape, ShapeError, Solid};
use crate::math::{DMat3, DVec2, DVec3, Degrees, Point, Ref, rotation, unknown};

/// A solid as a scene writes it, or several combined.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SolidSpec {
    /// An axis-aligned box.
    Box {
        /// The corner with the lowest coordinates.
        min: Point,
        /// The corner with the highest coordinates.
        max: Point,
    },
    /// A ball; in the plane, a disc.
    Sphere {
        /// Its centre.
        centre: Point,
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        radius: f64,
    },
    /// An axis-aligned ellipsoid; in the plane, an ellipse.
    Ellipsoid {
        /// Its centre.
        centre: Point,
        /// Its half-axes.
        radii: Point,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Centre of one end.
        from: Point,
        /// Centre of the other end.
        to: Point,
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        radius: f64,
    },
    /// A cylinder with hemispherical ends.
    Capsule {
        /// Centre of one hemisphere.
        from: Point,
        /// Centre of the other hemisphere.
        to: Point,
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        radius: f64,
    },
    /// A cone with flat ends; with two radii above 0, a truncated cone.
    Cone {
        /// Centre of one end.
        from: Point,
        /// Centre of the other end.
        to: Point,
        /// The radius at `from` and at `to`.
        #[schemars(inner(range(min = 0.0, max = 1e6)))]
        radii: [f64; 2],
    },
    /// A spherical sector: the part of a ball within an angle of a direction (Xu and Mould 2012, section 3.3.2); a hemisphere
    /// with 90 degrees, the whole ball with 180.
    Sector {
        /// Its apex, the ball's centre; by default the origin.
        #[serde(default)]
        at: Option<Point>,
        /// The direction of its axis; by default up.
        #[serde(default)]
        toward: Option<Point>,
        /// Half of its opening angle.
        #[schemars(range(min = 1.0, max = 180.0))]
        angle: Degrees,
        /// The ball's radius.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        radius: f64,
    },
    /// The solid of revolution of a sketched outline (2012, section 3.3.1, Fig. 14). In the SVG file the axis is the straight
    /// stroke of two points, the outline the other; without an axis the page's left edge is the axis.
    Revolve {
        /// The SVG file, beside the scene.
        sketch: String,
        /// The lower end of the axis; by default the origin.
        #[serde(default)]
        from: Option<Point>,
        /// The upper end of the axis.
        to: Point,
    },
    /// The inside of a closed triangle mesh.
    Mesh {
        /// A Wavefront OBJ (y up, as usual there) or PLY file (z up), beside the scene.
        file: String,
    },
    /// Letters (Xu and Mould 2007, Fig. 13): in the plane, or with a `depth` upright in space, seen from the front.
    Letters {
        /// The text, of one or more lines.
        #[schemars(length(min = 1, max = 1000))]
        text: String,
        /// A font file (TrueType, OpenType) beside the scene; by default DejaVu Sans Bold.
        #[serde(default)]
        font: Option<String>,
        /// The font's size (its em), in scene units: capitals are about 0.7 of it.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        size: f64,
        /// The start of the first baseline; by default the origin.
        #[serde(default)]
        at: Option<Point>,
        /// In space: their extent along y.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        depth: Option<f64>,
    },
    /// The dark parts of a picture: in the plane, or with a `depth` upright in space.
    Picture {
        /// A picture beside the scene: PNG or JPEG.
        file: String,
        /// Its height in scene units; the width follows from the aspect ratio.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        height: f64,
        /// Its lower left corner; by default the origin.
        #[serde(default)]
        at: Option<Point>,
        /// Brighter than this, from 0 (black) to 1 (white), is outside.
        #[serde(default = "half")]
        #[schemars(range(min = 0.0, max = 1.0))]
        threshold: f64,
        /// Take the bright parts instead.
        #[serde(default)]
        bright: bool,
        /// In space: its extent along y.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        depth: Option<f64>,
    },
    /// The points near the surface of a shape: a skin around a rock.
    Shell {
        /// The shape.
        of: ShapeSpec,
        /// Thickness outside the surface.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 1e6))]
        outside: f64,
        /// Thickness inside the surface.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 1e6))]
        inside: f64,
    },
    /// What a step with `by.regions` grew: spaces and endpoints with it wait for that step.
    Grown(String),
    /// A shape scaled about the origin, then rotated about an axis through it, then translated.
    Placed {
        /// The shape.
        shape: ShapeSpec,
        /// Scale factor.
        #[serde(default = "one")]
        #[schemars(range(min = 1e-6, max = 1e6))]
        scale: f64,
        /// The axis of rotation; by default y, which tilts an upright shape towards x.
        #[serde(default)]
        about: Option<Point>,
        /// The angle of rotation, right-handed about the axis.
        #[serde(default)]
        turn: Degrees,
        /// The translation.
        #[serde(default)]
        by: Option<Point>,
    },
    /// The union of shapes.
    Union(Vec<ShapeSpec>),
    /// The intersection of shapes.
    Intersection(Vec<ShapeSpec>),
    /// The first shape less all others.
    Difference(Vec<ShapeSpec>),
}

fn one() -> f64 {
    1.0
}

fn half() -> f64 {
    0.5
}

/// A shape as a scene writes it: a solid, or the name of one under `[shape]`.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeSpec {
    /// The name of a shape.
    Named(Ref<Shape>),
    /// A shape written inline.
    Inline(Box<SolidSpec>),
}

impl<'de> Deserialize<'de> for ShapeSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match serde_json::Value::deserialize(deserializer)? {
            serde_json::Value::String(name) => Ok(Self::Named(Ref::new(name))),
            value => SolidSpec::deserialize(value).map(|solid| Self::Inline(Box::new(solid))).map_err(D::Error::custom),
        }
    }
}

impl JsonSchema for ShapeSpec {
    fn schema_name() -> Cow<'static, str> {
        "Shape".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let solid = generator.subschema_for::<SolidSpec>();
        json_schema!({
            "description": "A shape, or the name of one under `[shape]`.",
            "anyOf": [{ "type": "string" }, solid]
        })
    }
}

/// The strokes of a sketch: polylines in units of its page's height, x to the right, y up.
pub type SketchLines = Vec<Vec<DVec2>>;

/// Vertices, and triangles as three indices of them each.
pub type MeshParts = (Vec<DVec3>, Vec<[u32; 3]>);

/// Closed polylines: x to the right, y up.
pub type Rings = Vec<Vec<DVec2>>;

/// Access to the files and steps to which shapes refer.
pub trait ShapeFiles {
    /// The outlines of `text` in the font `file`, by default the embedded one, with an em of 1.
    ///
    /// # Errors
    /// [`ShapeError`].
    fn letters(&self, text: &str, file: Option<&str>) -> Result<Rings, ShapeError>;

    /// The outlines of the pixels darker than `threshold` (if `bright`, brighter) in the picture `file`, with a height of 1.
    ///
    /// # Errors
    /// [`ShapeError`].
    fn picture_outlines(&self, file: &str, threshold: f64, bright: bool) -> Result<Rings, ShapeError>;

    /// The index of the step called `name`, which yields solids, and the shape of its space.
    ///
    /// # Errors
    /// [`ShapeError`].
    fn solid_step(&self, name: &str) -> Result<(usize, ShapeSpec), ShapeError> {
        Err(ShapeError::NoStep(name.to_owned()))
    }

    /// The strokes of the sketch `file`.
    ///
    /// # Errors
    /// [`ShapeError`].
    fn sketch_lines(&self, file: &str) -> Result<SketchLines, ShapeError>;

    /// The triangles of the mesh `file`, z up.
    ///
    /// # Errors
    /// [`ShapeError`].
    fn mesh_parts(&self, file: &str) -> Result<MeshParts, ShapeError>;
}

impl ShapeSpec {
    /// A box.
    #[must_use]
    pub fn of_box(bounds: Bounds) -> Self {
        Self::Inline(Box::new(SolidSpec::Box { min: Point(bounds.min), max: Point(bounds.max) }))
    }

    /// The shape, with its names looked up in `named` and its files in `files`.
    ///
    /// # Errors
    /// [`ShapeError`]: unknown or circular names, sizes that are not positive, files without outlines or closed meshes.
    pub fn resolve(&self, named: &BTreeMap<String, Self>, files: &dyn ShapeFiles) -> Result<Shape, ShapeError> {
        ShapeLookup { named, files, pending: Vec::new(), done: BTreeMap::new(), solids: 0 }.shape(self)
    }
}

/// The resolution of a shape.
struct ShapeLookup<'a> {
    named: &'a BTreeMap<String, ShapeSpec>,
    files: &'a dyn ShapeFiles,
    /// The names whose resolution has begun, to detect circles.
    pending: Vec<String>,
    /// Shapes that others share, with the number of their solids.
    done: BTreeMap<String, (Shape, u64)>,
    /// Solids so far, each as often as a distance asks for it.
    solids: u64,
}

/// A distance asks at most so many solids.
const MOST_SOLIDS: u64 = 100_000;
/// Shapes are made of each other to this depth at most.
const MOST_DEPTH: usize = 100;

impl ShapeLookup<'_> {
    fn shape(&mut self, spec: &ShapeSpec) -> Result<Shape, ShapeError> {
        let solid = match spec {
            ShapeSpec::Inline(solid) => solid,
            ShapeSpec::Named(Ref { name, .. }) => {
                return self.named_shape(name);
            }
        };
        self.count(1)?;
        self.solid(solid)
    }

    fn named_shape(&mut self, name: &str) -> Result<Shape, ShapeError> {
        if let Some((shape, solids)) = self.done.get(name).cloned() {
            self.count(solids)?;
            return Ok(shape);
        }
        if self.pending.iter().any(|pending| pending == name) {
            return Err(ShapeError::Circular(name.to_owned()));
        }
        if self.pending.len() >= MOST_DEPTH {
            return Err(ShapeError::TooDeep(MOST_DEPTH));
        }
        let spec = self.named.get(name);
        let spec = spec.ok_or_else(|| ShapeError::Unknown(unknown("shape", name, self.named.keys())))?;
        let before = self.solids;
        self.pending.push(name.to_owned());
        let shape = self.shape(spec);
        self.pending.pop();
        let shape = shape?;
        self.done.insert(name.to_owned(), (shape.clone(), self.solids - before));
        Ok(shape)
    }

    fn count(&mut self, solids: u64) -> Result<(), ShapeError> {
        self.solids = self.solids.saturating_add(solids);
        if self.solids > MOST_SOLIDS { Err(ShapeError::TooManySolids(MOST_SOLIDS)) } else { Ok(()) }
    }

    fn all(&mut self, specs: &[ShapeSpec]) -> Result<Vec<Shape>, ShapeError> {
        if specs.is_empty() {
            return Err(ShapeError::NoParts);
        }
        let mut names = BTreeSet::new();
        for spec in specs {
            if let ShapeSpec::Named(Ref { name, .. }) = spec
                && !names.insert(name)
            {
                return Err(ShapeError::Twice(name.clone()));
            }
        }
        specs.iter().map(|spec| self.shape(spec)).collect()
    }

    fn solid(&mut self, spec: &SolidSpec) -> Result<Shape, ShapeError> {
        Ok(Shape::new(match spec {
            SolidSpec::Union(of) => Solid::Union(self.all(of)?),
            SolidSpec::Intersection(of) => Solid::Intersection(self.all(of)?),
            SolidSpec::Difference(of) => Solid::Difference(self.all(of)?),
            SolidSpec::Box { min, max } => {
                if !min.0.cmple(max.0).all() {
                    return Err(ShapeError::Box(min.0, max.0));
                }
                Solid::Box { min: min.0, max: max.0 }
            }
            SolidSpec::Ellipsoid { centre, radii } => ellipsoid(centre.0, radii.0)?,
            &SolidSpec::Sphere { centre, radius } => Solid::Sphere { centre: centre.0, radius },
            &SolidSpec::Cylinder { from, to, radius } => {
                axis(from.0, to.0, "a cylinder")?;
                Solid::Cylinder { from: from.0, to: to.0, radius }
            }
            &SolidSpec::Capsule { from, to, radius } => Solid::Capsule { from: from.0, to: to.0, radius },
            &SolidSpec::Cone { from, to, radii } => {
                axis(from.0, to.0, "a cone")?;
                return Shape::cone(from.0, to.0, radii).ok_or(ShapeError::Cone);
            }
            SolidSpec::Sector { at, toward, angle, radius } => sector(*at, *toward, *angle, *radius)?,
            SolidSpec::Revolve { sketch, from, to } => self.revolved(sketch, *from, to.0)?,
            SolidSpec::Mesh { file } => {
                let (points, triangles) = self.files.mesh_parts(file)?;
                let mesh = ClosedMesh::new(points, triangles);
                let mesh = mesh.map_err(|error| ShapeError::Mesh { file: file.clone(), error })?;
                Solid::Mesh(Arc::new(mesh))
            }
            SolidSpec::Letters { text, font, size, at, depth } => {
                let rings = self.files.letters(text, font.as_deref())?;
                let solid = outlined(&rings, *size, *at, *depth);
                solid.map_err(|error| ShapeError::Letters { text: text.clone(), error })?
            }
            SolidSpec::Picture { file, height, at, threshold, bright, depth } => {
                let rings = self.files.picture_outlines(file, *threshold, *bright)?;
                let solid = outlined(&rings, *height, *at, *depth);
                solid.map_err(|error| ShapeError::Picture { file: file.clone(), error })?
            }
            SolidSpec::Shell { of, outside, inside } => {
                if outside + inside <= 0.0 {
                    return Err(ShapeError::Shell);
                }
                Solid::Shell { of: self.shape(of)?, outside: *outside, inside: *inside }
            }
            SolidSpec::Grown(step) => self.grown(step)?,
            SolidSpec::Placed { shape, scale, about, turn, by } => {
                let axis = about.map_or(DVec3::Y, |p| p.0);
                let axis = axis.try_normalize().ok_or(ShapeError::NoDirection("an axis"))?;
                let by = by.map_or(DVec3::ZERO, |p| p.0);
                return Ok(self.shape(shape)?.placed(*scale, rotation(axis, turn.radians()), by));
            }
        }))
    }

    /// The solid of revolution of a sketch.
    fn revolved(&mut self, sketch: &str, from: Option<Point>, to: DVec3) -> Result<Solid, ShapeError> {
        let from = from.map_or(DVec3::ZERO, |p| p.0);
        let along = axis(from, to, "an axis")?;
        let lines = self.files.sketch_lines(sketch)?;
        let profile = Profile::outline(&lines, (to - from).length()).and_then(Profile::new);
        let profile = profile.map_err(|error| ShapeError::Sketch { file: sketch.to_owned(), error })?;
        Ok(Solid::Revolved { from, along, profile: Arc::new(profile) })
    }

    /// The placeholder of a step's solid.
    fn grown(&mut self, step: &str) -> Result<Solid, ShapeError> {
        let (index, space) = self.files.solid_step(step)?;
        // No shape can have this name.
        let mark = format!("what `{step}` grows in");
        if self.pending.contains(&mark) {
            return Err(ShapeError::CircularStep(step.to_owned()));
        }
        self.pending.push(mark);
        let bounds = self.shape(&space)?.bounds();
        self.pending.pop();
        Ok(Solid::Grown(index, bounds))
    }
}

/// The direction from one end of `what` to the other.
fn axis(from: DVec3, to: DVec3, what: &'static str) -> Result<DVec3, ShapeError> {
    (to - from).try_normalize().ok_or(ShapeError::SameEnds(what))
}

fn ellipsoid(centre: DVec3, radii: DVec3) -> Result<Solid, ShapeError> {
    // In the plane the third half-axis is not given, and does not matter.
    let own = if radii.z == 0.0 { radii.with_z(1.0) } else { radii };
    if !own.cmpgt(DVec3::ZERO).all() {
        return Err(ShapeError::Ellipsoid(radii));
    }
    Ok(Solid::Ellipsoid { centre, radii: own })
}

fn sector(at: Option<Point>, toward: Option<Point>, angle: Degrees, radius: f64) -> Result<Solid, ShapeError> {
    let at = at.map_or(DVec3::ZERO, |p| p.0);
    if angle.0 >= 180.0 {
        return Ok(Solid::Sphere { centre: at, radius });
    }
    let along = toward.map_or(DVec3::Z, |p| p.0).try_normalize().ok_or(ShapeError::NoDirection("a sector"))?;
    let angle = angle.radians();
    let side = DVec2::new(libm::sin(angle), libm::cos(angle));
    Ok(Solid::Sector { at, along, angle, side, radius })
}

/// The solid of outlines of unit size scaled to `size`, with their origin at `at`.
fn outlined(rings: &Rings, size: f64, at: Option<Point>, depth: Option<f64>) -> Result<Solid, OutlineError> {
    let at = at.map_or(DVec3::ZERO, |p| p.0);
    // Upright in space, the outline has no y; the solid is moved along it.
    let origin = if depth.is_some() { DVec2::new(at.x, at.z) } else { at.truncate() };
    let placed: Rings = rings.iter().map(|ring| ring.iter().map(|&p| origin + p * size).collect()).collect();
    let solid = Solid::Outlined { outline: Arc::new(Outline::new(&placed)?), depth };
    Ok(if depth.is_some() && at.y != 0.0 {
        Solid::Placed { shape: Shape::new(solid), scale: 1.0, turn: DMat3::IDENTITY, by: DVec3::new(0.0, at.y, 0.0) }
    } else {
        solid
    })
}
