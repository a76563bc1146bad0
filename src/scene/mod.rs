//! What the artist writes: scene files, parsed with every mistake reported, names and files resolved.
//!
//! Later stages need never handle an unknown key, a name that leads nowhere, or a number out of range.

mod animation;
mod build;
mod claim;
mod document;
mod dress;
mod growth;
mod include;
mod methods;
mod mistake;
mod repeat;
mod resolve;
mod schema;
mod steps;
mod tree;
mod validate;

pub use animation::TrackSpec;
pub use build::{Stage, grow, model};
pub use claim::{Claim, Claimed, Finding, Quantity, check_claims};
pub use document::{LightsSpec, ObjectSpec, Scene};
pub use mistake::{Included, Mistake, SceneError, Span};
pub use resolve::{ObjectPlan, Resolved, View};
pub use schema::{schema, schema_markdown};
pub use tree::Override;

use crate::files::Folder;

/// A scene's text and where it came from.
#[derive(Clone, Debug)]
pub struct Source {
    /// What to call it in errors: a path, or the name of an embedded scene.
    pub name: String,
    /// The TOML text.
    pub text: String,
    /// Where its files are.
    pub folder: Folder,
}

/// Reads a scene: parses it, applies `overrides`, and resolves names and files.
///
/// ```
/// use lichtenberg::files::Folder;
/// use lichtenberg::scene::{Source, load};
///
/// let source = Source {
///     name: "twig.toml".to_owned(),
///     text: r#"
///         title = "Twig"
///         [space.sheet]
///         shape.box = { min = [-1, 0], max = [1, 2] }
///         nodes.lattice = { spacing = 0.1, neighbours = 8 }
///         [grow.twig]
///         space = "sheet"
///         from.at = [[0, 0]]
///         to.tips = { count = 5 }
///         width.constant = 0.02
///         [object.twig]
///         grow = ["twig"]
///     "#.to_owned(),
///     folder: Folder::Disk(".".into()),
/// };
/// let scene = load(&source, &[]).unwrap();
/// assert_eq!(scene.steps.len(), 1);
/// let error = load(&Source { text: source.text.replace("space =", "spcae ="), ..source }, &[]).unwrap_err();
/// assert!(error.to_string().contains("did you mean `space`?"));
/// ```
///
/// # Errors
/// [`SceneError`] with every mistake found.
pub fn load(source: &Source, overrides: &[Override]) -> Result<Resolved, SceneError> {
    load_frame(source, overrides, None)
}

/// [`load`] with every value that `[animation]` moves as it is at `frame`.
///
/// # Errors
/// [`SceneError`] with every mistake found.
pub fn load_frame(source: &Source, overrides: &[Override], frame: Option<f64>) -> Result<Resolved, SceneError> {
    let (mut tree, mut mistakes) = tree::parse(&source.text, None);
    include::include(&mut tree, &source.folder, &mut mistakes);
    tree::apply(&mut tree, overrides, &mut mistakes);
    if let Some(frame) = frame {
        animation::animate(&mut tree, frame, &mut mistakes);
    }
    tree::inherit(&mut tree, &mut mistakes);
    if mistakes.is_empty() {
        validate::validate(&tree, schema(), &mut mistakes);
    }
    let resolved = if mistakes.is_empty() {
        document::read(&tree, &mut mistakes).and_then(|scene| resolve::resolve(scene, source, &tree, &mut mistakes))
    } else {
        None
    };
    match resolved {
        Some(resolved) if mistakes.is_empty() => Ok(resolved),
        _ => Err(SceneError::new(source, mistakes)),
    }
}
