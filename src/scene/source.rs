//! Scenes as they come in.

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
