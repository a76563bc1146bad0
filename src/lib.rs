//! Lichtenberg grows branching things - elms, lightning, coral, lichen, moss, and the rocks under them - by planning least-cost paths through randomly
//! weighted graphs, and hands them to renderers. This is the library behind the command `lichtenberg`.
//!
//! # Vocabulary
//! A **lattice** is a regular graph, a **scatter** an irregular one; edges have random **weights**, changed in space by **cost fields**. Paths are
//! planned from **generators**, the nodes at **cost** zero, to **endpoints**; the union of **paths** is a **skeleton**,
//! which a **width** makes thick and a **skin** makes solid. A **scene** names all of these in a TOML file.
//!
//! # The stages, in the order in which data passes them
//! | module | makes |
//! | --- | --- |
//! | [`math`] | random streams, names, the progress handle |
//! | [`raster`], [`geom`] | picture buffers; shapes, strokes, round cones |
//! | [`bvh`] | what rays hit |
//! | [`model`] | the neutral description that renderers and exporters read: a [`model::Model`] |
//! | [`graph`] | lattices whose weights are computed, not stored; scattered nodes |
//! | [`plan`](mod@plan) | least-cost paths: a [`plan::Plan`] |
//! | [`skeleton`] | the forest of paths, with radii: a [`skeleton::Skeleton`] |
//! | [`grow`] | the steps of a scene: a [`grow::Grown`] each |
//! | [`skin`] | bodies around skeletons, and what stands on them |
//! | [`assemble`] | the way from a [`assemble::Recipe`] to a model |
//! | [`export`] | POV-Ray, RIB, SVG, OBJ and PLY |
//! | [`trace`] | the preview: a [`trace::Picture`] |
//! | [`glow`] | the light of strokes, in layers |
//! | [`compare`] | how far pictures are apart, and reports |
//! | [`files`] | pictures and sketches in and out; whole files or none |
//! | [`picture`] | finished pictures as pixels, layers, passes and mattes |
//! | [`scene`] | scenes from TOML to a recipe, with every mistake reported |
//! | [`render`] | driving POV-Ray, Pixie and Aqsis |
//!
//! A stage imports earlier ones only; a test holds it to that.
//!
//! # The whole way
//! ```
//! use lichtenberg::export::{Origin, Pov, Templates};
//! use lichtenberg::files::embedded_scenes;
//! use lichtenberg::math::{Memory, Progress};
//! use lichtenberg::scene::{Override, Source, grow, load, model};
//! use lichtenberg::trace::{Look, RenderSettings, World, render};
//!
//! let (name, text, folder) = embedded_scenes().into_iter().find(|(name, ..)| name == "elm").ok_or("no elm")?;
//! let source = Source { name, text: text.to_owned(), folder };
//! let fewer = Override { path: "grow.elm.to.twigs.count".to_owned(), value: "20".to_owned() };
//!
//! let scene = load(&source, &[fewer])?;
//! let memory = Memory::new(1 << 30);
//! let grown = grow(&scene, &[], &memory, &Progress::default())?;
//! assert_eq!(grown[0].skeleton.paths.len(), 38);
//!
//! let model = model(&scene, &grown, scene.recipe.size, &memory, &Progress::default())?;
//! let mut inc = Vec::new();
//! Pov::new(&model, &Templates::default(), "elm", scene.recipe.size, &Origin::default()).write_inc(&mut inc)?;
//! assert!(String::from_utf8(inc)?.contains("#declare Elm_Height"));
//!
//! let view = RenderSettings::new([64, 64], Look::Studio, 4);
//! let picture = render(&World::new(&model), &view, &Progress::default())?;
//! assert_eq!(picture.pixels.len(), 64 * 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The sources are Xu and Mould 2007 (*Modeling dendritic shapes using path planning*), 2008 (*Constructive path
//! planning for natural phenomena modeling*) and 2012, and Amin's Growth module after Greene's voxel space automata;
//! equations and figures are cited where they are used.

pub mod assemble;
pub mod bvh;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compare;
pub mod export;
pub mod files;
pub mod geom;
pub mod glow;
pub mod graph;
pub mod grow;
pub mod math;
pub mod model;
pub mod picture;
pub mod plan;
pub mod raster;
pub mod render;
pub mod scene;
pub mod skeleton;
pub mod skin;
pub mod trace;
