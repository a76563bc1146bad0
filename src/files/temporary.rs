//! What is on disk for a while only, and is taken away even where the process has to end at once.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, TempDir};

/// What is to be taken away. What makes, moves or removes it holds the lock, so that [`exit`] misses none.
static KNOWN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn known() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file or folder that goes when this does.
#[derive(Debug)]
pub struct Temporary(PathBuf);

impl Temporary {
    /// The file that `make` makes, and what `make` has of it: open, say.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn file<F>(make: impl FnOnce() -> io::Result<NamedTempFile<F>>) -> io::Result<(F, Self)> {
        let mut known = known();
        let (file, path) = make()?.keep().map_err(|error| error.error)?;
        known.insert(path.clone());
        Ok((file, Self(path)))
    }

    /// The folder that `make` makes.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn folder(make: impl FnOnce() -> io::Result<TempDir>) -> io::Result<Self> {
        let mut known = known();
        let path = make()?.keep();
        known.insert(path.clone());
        Ok(Self(path))
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Moves it to `path`, where it stays.
    ///
    /// # Errors
    /// Those of the file system; it is then taken away.
    pub fn persist(self, path: &Path) -> io::Result<()> {
        let _known = known();
        fs::rename(&self.0, path)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut known = known();
        remove(&self.0);
        known.remove(&self.0);
    }
}

/// Removes what is at `path`; what was moved away is not.
fn remove(path: &Path) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}

/// Ends the process, with nothing temporary left on disk.
pub fn exit(code: i32) -> ! {
    // Held to the end: nothing more is made.
    let known = known();
    known.iter().for_each(|path| remove(path));
    std::process::exit(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_kept_goes() {
        let folder = Temporary::folder(tempfile::tempdir).unwrap();
        let at = folder.path().to_owned();
        let make = || Temporary::file(|| NamedTempFile::new_in(&at)).unwrap();
        let ((_, kept), (_, gone)) = (make(), make());
        let (old, to) = (gone.path().to_owned(), at.join("kept"));
        kept.persist(&to).unwrap();
        drop(gone);
        assert!(to.exists() && !old.exists() && known().contains(&at));
        let (_, lost) = make();
        assert!(lost.persist(&at.join("no/folder")).is_err());
        assert_eq!(fs::read_dir(&at).unwrap().count(), 1);
        drop(folder);
        assert!(!at.exists() && !known().contains(&at));
    }
}
