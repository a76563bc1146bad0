//! The files that a run reads, so that none of its outputs replaces one.

use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};

/// Files by what they are, whatever they are called and whichever links lead there.
#[derive(Clone, Debug, Default)]
pub struct Inputs(HashMap<Identity, PathBuf>);

/// Device and inode.
#[cfg(unix)]
type Identity = (u64, u64);
/// The path without links.
#[cfg(not(unix))]
type Identity = PathBuf;

#[cfg(unix)]
fn identity(path: &Path) -> io::Result<Identity> {
    use std::os::unix::fs::MetadataExt;
    path.metadata().map(|meta| (meta.dev(), meta.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> io::Result<Identity> {
    path.canonicalize()
}

impl Inputs {
    /// Adds the file at `path`, if there is one.
    pub fn add(&mut self, path: &Path) {
        if path.is_file()
            && let Ok(identity) = identity(path)
        {
            self.0.entry(identity).or_insert_with(|| path.to_owned());
        }
    }

    /// The input that writing to `path` would replace.
    #[must_use]
    pub fn replaced_by(&self, path: &Path) -> Option<&Path> {
        self.0.get(&identity(path).ok()?).map(PathBuf::as_path)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn inputs_are_known_by_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["map.png", "other.png"] {
            fs::write(at(name), name).unwrap();
        }
        fs::hard_link(at("map.png"), at("hard.png")).unwrap();
        let mut inputs = Inputs::default();
        inputs.add(&at("map.png"));
        inputs.add(&at("missing.png"));
        inputs.add(folder.path());
        for name in ["map.png", "./map.png", "hard.png"] {
            assert_eq!(inputs.replaced_by(&at(name)), Some(at("map.png").as_path()), "{name}");
        }
        for name in ["other.png", "missing.png", "."] {
            assert_eq!(inputs.replaced_by(&at(name)), None, "{name}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("map.png"), at("soft.png")).unwrap();
            assert!(inputs.replaced_by(&at("soft.png")).is_some());
        }
    }
}
