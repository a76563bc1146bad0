//! From a scene's text to a recipe.

use super::loaded::Loaded;
use super::mistake::SceneError;
use super::schema::schema;
use super::source::Source;
use super::tree::Override;
use super::{animation, document, include, resolve, set_stage, tree, validate};

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
/// assert_eq!(scene.recipe.steps.len(), 1);
/// let error = load(&Source { text: source.text.replace("space =", "spcae ="), ..source }, &[]).unwrap_err();
/// assert!(error.to_string().contains("did you mean `space`?"));
/// ```
///
/// # Errors
/// [`SceneError`] with every mistake found.
pub fn load(source: &Source, overrides: &[Override]) -> Result<Loaded, SceneError> {
    load_frame(source, overrides, None)
}

/// [`load`] with every value that `[animation]` moves as it is at `frame`.
///
/// # Errors
/// [`SceneError`] with every mistake found.
pub fn load_frame(source: &Source, given: &[Override], frame: Option<f64>) -> Result<Loaded, SceneError> {
    let (mut tree, mut mistakes) = tree::parse(&source.text, None);
    include::include(&mut tree, &source.folder, &mut mistakes);
    // A stage is set first, and changed then.
    let is_first = |change: &Override| change.path == "stage" || change.path == "metre";
    let (first, overrides): (Vec<_>, Vec<_>) = given.iter().cloned().partition(is_first);
    if first.iter().any(|change| change.path == "stage") {
        set_stage::clear_stage(&mut tree);
    }
    tree::apply(&mut tree, &first, &mut mistakes);
    set_stage::set_stage(&mut tree, &mut mistakes);
    tree::apply(&mut tree, &overrides, &mut mistakes);
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
        Some(resolved) if mistakes.is_empty() => Ok(resolved.changed_by(given)),
        _ => Err(SceneError::new(source, mistakes)),
    }
}
