//! Folders for the files of other programs.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;

use tempfile::Builder;

use super::Temporary;

const PREFIX: &str = "lichtenberg-";
/// A file in each folder, locked for as long as its process lives.
const LOCK: &str = ".lock";

/// An empty folder that goes when this does. Folders of processes that were killed go when the next is made.
#[derive(Debug)]
pub struct Scratch {
    folder: Temporary,
    _lock: File,
}

impl Scratch {
    /// A folder among the system's temporary files.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn new() -> io::Result<Self> {
        Self::new_in(&std::env::temp_dir())
    }

    fn new_in(place: &Path) -> io::Result<Self> {
        sweep(place);
        loop {
            let folder = Temporary::folder(|| Builder::new().prefix(PREFIX).tempdir_in(place))?;
            let path = folder.path().join(LOCK);
            let lock = File::create(&path)?;
            // One who sweeps may have been here before the lock was.
            match lock.try_lock() {
                Ok(()) if path.exists() => return Ok(Self { folder, _lock: lock }),
                Ok(()) | Err(TryLockError::WouldBlock) => {}
                Err(TryLockError::Error(error)) => return Err(error),
            }
        }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes our folders in `place` that no process holds any more.
fn sweep(place: &Path) {
    let entries = fs::read_dir(place).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().as_encoded_bytes().starts_with(PREFIX.as_bytes())) {
        let path = entry.path();
        let lock = path.join(LOCK);
        if is_own(&path, fs::Metadata::is_dir)
            && is_own(&lock, fs::Metadata::is_file)
            && File::open(&lock).is_ok_and(|lock| lock.try_lock().is_ok())
        {
            let _ = fs::remove_dir_all(path);
        }
    }
}

/// Is it such a thing, no link to one, and our user's?
fn is_own(path: &Path, is_such: impl Fn(&fs::Metadata) -> bool) -> bool {
    fs::symlink_metadata(path).is_ok_and(|meta| is_such(&meta) && belongs_to_us(&meta))
}

#[cfg(unix)]
fn belongs_to_us(meta: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    meta.uid() == rustix::process::geteuid().as_raw()
}

#[cfg(not(unix))]
fn belongs_to_us(_meta: &fs::Metadata) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_nobody_holds_is_swept() {
        let place = tempfile::tempdir().unwrap();
        let held = Scratch::new_in(place.path()).unwrap();
        let stale = place.path().join("lichtenberg-stale");
        let others = ["lichtenberg-without-lock", "other"].map(|name| place.path().join(name));
        [&stale, &others[0], &others[1]].iter().for_each(|path| fs::create_dir(path).unwrap());
        [&stale, &others[1]].iter().for_each(|path| fs::write(path.join(LOCK), "").unwrap());
        fs::write(stale.join("scene.png"), "half").unwrap();
        drop(Scratch::new_in(place.path()).unwrap());
        assert!(held.path().exists() && others.iter().all(|path| path.exists()) && !stale.exists());
        drop(held);
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 2);
    }
}
