//! Scenes as they come in.

use std::path::PathBuf;

use crate::files::{FileRead, Folder, Reads};

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
    /// This scene, recording in `reads` which files are asked for: its own, where it is one on disk, and those that it names.
    #[must_use]
    pub fn recorded(self, reads: &Reads) -> Self {
        if matches!(self.folder, Folder::Disk(_)) {
            reads.add(FileRead { name: self.name.clone(), path: PathBuf::from(&self.name) });
        }
        Self { folder: self.folder.recorded(reads), ..self }
    }
}
