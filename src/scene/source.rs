//! Scenes as they come in.

use crate::files::{Folder, Reads};

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

impl Source {
    /// This scene, recording in `reads` which files that it names are asked for.
    #[must_use]
    pub fn recorded(self, reads: &Reads) -> Self {
        Self { folder: self.folder.recorded(reads), ..self }
    }
}
