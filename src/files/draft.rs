//! A file on its way to its name.

use std::fs::{self, File, Metadata};
use std::io;
use std::path::Path;

use tempfile::Builder;

use super::Temporary;

/// How files are called that have to have a name before they are whole.
const PREFIX: &str = ".lichtenberg-";

/// A file that is being filled. It has no name where the system allows that, so that not even KILL leaves it behind; elsewhere
/// a name that is taken away with it.
pub(super) enum Draft {
    /// In no folder.
    Unnamed(File),
    /// In the folder of the file that it becomes.
    Named(File, Temporary),
}

impl Draft {
    /// A file in `folder` for one that takes the place of `old`: with its mode and, where we may, its owner.
    pub fn new(folder: &Path, old: Option<&Metadata>) -> io::Result<Self> {
        let draft = match unnamed(folder) {
            Some(file) => Self::Unnamed(file),
            None => {
                let (file, temporary) = Temporary::file(|| builder().tempfile_in(folder))?;
                Self::Named(file, temporary)
            }
        };
        if let Some(old) = old {
            take_after(draft.file(), old)?;
        }
        Ok(draft)
    }

    /// The file.
    pub fn file(&self) -> &File {
        match self {
            Self::Unnamed(file) | Self::Named(file, _) => file,
        }
    }

    /// Gives it the name `path`, in its folder, in place of what stands there.
    pub fn publish(self, path: &Path) -> io::Result<()> {
        match self {
            Self::Named(_, temporary) => temporary.persist(path),
            Self::Unnamed(file) => match name(&file, path) {
                // A name can be given only where there is none; another one can then be moved there.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
                    let (_, temporary) = Temporary::file(|| builder().make_in(folder, |path| name(&file, path)))?;
                    temporary.persist(path)
                }
                named => named,
            },
        }
    }
}

/// Makes names; files get the mode of any new file, which the umask narrows.
#[cfg(unix)]
fn builder() -> Builder<'static, 'static> {
    use std::os::unix::fs::PermissionsExt;
    let mut builder = Builder::new();
    builder.prefix(PREFIX).permissions(fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX);
    builder
}

/// A file without a name on the disk of `folder`; `None` where there is no such thing, or none that can be named later.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> Option<File> {
    use std::os::unix::fs::OpenOptionsExt;
    let flags = rustix::fs::OFlags::TMPFILE.bits().cast_signed();
    let file = fs::OpenOptions::new().write(true).mode(0o666).custom_flags(flags).open(folder).ok()?;
    fs::exists(descriptor(&file)).ok().filter(|&is_known| is_known).map(|_| file)
}

#[cfg(not(target_os = "linux"))]
fn unnamed(_folder: &Path) -> Option<File> {
    None
}

/// What the system calls an open file.
#[cfg(target_os = "linux")]
fn descriptor(file: &File) -> String {
    use std::os::fd::AsRawFd;
    format!("/proc/self/fd/{}", file.as_raw_fd())
}

/// Gives an unnamed file the name `path`, where there is none yet.
#[cfg(target_os = "linux")]
fn name(file: &File, path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    Ok(linkat(CWD, descriptor(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
}

#[cfg(not(target_os = "linux"))]
fn name(_file: &File, _path: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(unix)]
fn take_after(file: &File, old: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    // Another's file may be replaced but not given back; before its mode, which this may change.
    let _ = fchown(file, Some(old.uid()), Some(old.gid()));
    file.set_permissions(old.permissions())
}

#[cfg(not(unix))]
fn take_after(_file: &File, _old: &Metadata) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn nothing_is_seen_before_it_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("a");
        for text in ["new", "newer"] {
            let before = fs::read_dir(folder.path()).unwrap().count();
            let draft = Draft::new(folder.path(), None).unwrap();
            draft.file().write_all(text.as_bytes()).unwrap();
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before);
            draft.publish(&at).unwrap();
            assert_eq!(fs::read_to_string(&at).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn names_serve_where_they_must() {
        let folder = tempfile::tempdir().unwrap();
        let (file, temporary) = Temporary::file(|| builder().tempfile_in(folder.path())).unwrap();
        (&file).write_all(b"x").unwrap();
        Draft::Named(file, temporary).publish(&folder.path().join("b")).unwrap();
        let names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["b"]);
    }
}
