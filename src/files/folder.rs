//! Where a scene's files are: beside it on disk, or embedded with it in the program.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use include_dir::{Dir, include_dir};

static SCENES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/scenes");

/// Files that scenes name are here: nothing in them is a scene.
const ASSETS: [&str; 2] = ["assets", "stages"];
/// No file of a scene is larger than this.
const MOST_BYTES: u64 = 256 << 20;

/// A folder that a scene's files are named relative to.
#[derive(Clone, Debug)]
pub enum Folder {
    /// On disk.
    Disk(PathBuf),
    /// On disk, reading nothing outside the second: paths without links.
    Confined(PathBuf, Arc<[PathBuf]>),
    /// Within the embedded scenes, by path.
    Embedded(PathBuf),
    /// One of these, whose reads are recorded.
    Recorded(Box<Self>, Reads),
}

/// The files that were asked for, each once, in order; also those that could not be read.
#[derive(Clone, Debug, Default)]
pub struct Reads(Arc<Mutex<Vec<FileRead>>>);

/// A file that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRead {
    /// Its name as it was written.
    pub name: String,
    /// Where it is, as [`Folder::path`] says.
    pub path: PathBuf,
}

/// Why a file that a scene names cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read `{name}`: {reason}")]
pub struct ReadError {
    /// Its name as it was written.
    pub name: String,
    /// Why not.
    pub reason: Unreadable,
}

/// What is wrong with a file that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum Unreadable {
    /// It does not come with the program.
    #[error("it is not among the embedded files")]
    NotEmbedded,
    /// It is not below a folder of [`Folder::Confined`].
    #[error("it lies outside the folders that this scene may read")]
    Outside,
    /// A folder or a device.
    #[error("it is not a file")]
    NotAFile,
    /// So many bytes.
    #[error("it has {0} bytes, {MOST_BYTES} at most can be read")]
    TooLarge(u64),
    /// What the system says.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

impl Reads {
    /// The files asked for so far.
    #[must_use]
    pub fn files(&self) -> Vec<FileRead> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Adds a file that is read.
    pub fn add(&self, read: FileRead) {
        let mut files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !files.contains(&read) {
            files.push(read);
        }
    }
}

impl Folder {
    /// This folder, recording in `reads` which files are asked for.
    #[must_use]
    pub fn recorded(self, reads: &Reads) -> Self {
        Self::Recorded(Box::new(self), reads.clone())
    }

    /// Where the file called `name` is: on disk, or within the embedded scenes.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        match self {
            Self::Disk(folder) | Self::Confined(folder, _) => folder.join(name),
            Self::Embedded(folder) => inside(&folder.join(name)).unwrap_or_else(|| PathBuf::from(name)),
            Self::Recorded(folder, _) => folder.path(name),
        }
    }

    /// The folder that the file called `name` is in.
    #[must_use]
    pub fn of(&self, name: &str) -> Self {
        let holder = |path: PathBuf| path.parent().unwrap_or(Path::new("")).to_owned();
        match self {
            Self::Disk(_) => Self::Disk(holder(self.path(name))),
            Self::Confined(_, allowed) => Self::Confined(holder(self.path(name)), Arc::clone(allowed)),
            Self::Embedded(_) => Self::Embedded(holder(self.path(name))),
            Self::Recorded(folder, reads) => folder.of(name).recorded(reads),
        }
    }

    /// The bytes of the file called `name`.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn read(&self, name: &str) -> Result<Vec<u8>, ReadError> {
        self.bytes(name).map_err(|reason| ReadError { name: name.to_owned(), reason })
    }

    fn bytes(&self, name: &str) -> Result<Vec<u8>, Unreadable> {
        match self {
            Self::Recorded(folder, reads) => {
                reads.add(FileRead { name: name.to_owned(), path: folder.path(name) });
                folder.bytes(name)
            }
            Self::Embedded(folder) => inside(&folder.join(name))
                .and_then(|path| SCENES.get_file(path))
                .map(|file| file.contents().to_vec())
                .ok_or(Unreadable::NotEmbedded),
            Self::Disk(folder) => read_file(&folder.join(name)),
            Self::Confined(folder, allowed) => {
                let place = folder.join(name).canonicalize();
                // Whether something is there or not is told of what may be read alone.
                let is_below = |name: &str| Path::new(name).components().all(|c| matches!(c, Component::Normal(_)));
                match place {
                    Ok(place) if allowed.iter().any(|root| place.starts_with(root)) => read_file(&place),
                    Err(error) if is_below(name) => Err(error.into()),
                    _ => Err(Unreadable::Outside),
                }
            }
        }
    }
}

/// The bytes of a file of reasonable size, or why not.
fn read_file(path: &Path) -> Result<Vec<u8>, Unreadable> {
    let meta = path.metadata()?;
    if !meta.is_file() {
        return Err(Unreadable::NotAFile);
    }
    if meta.len() > MOST_BYTES {
        return Err(Unreadable::TooLarge(meta.len()));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A path without `..`; `None` where it leads out.
fn inside(path: &Path) -> Option<PathBuf> {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => plain.push(name),
            Component::ParentDir if !plain.pop() => return None,
            _ => {}
        }
    }
    Some(plain)
}

/// The embedded scenes, without what is in `assets`: name (path without `.toml`), text, and the folder of their files; sorted by name.
pub fn embedded_scenes() -> Vec<(String, &'static str, Folder)> {
    fn visit(dir: &'static Dir<'static>, out: &mut Vec<(String, &'static str, Folder)>) {
        for file in dir.files().filter(|f| f.path().extension().is_some_and(|e| e == "toml")) {
            let name = file.path().with_extension("");
            let folder = file.path().parent().unwrap_or(Path::new("")).to_owned();
            if let (Some(name), Some(text)) = (name.to_str(), file.contents_utf8()) {
                out.push((name.replace('\\', "/"), text, Folder::Embedded(folder)));
            }
        }
        dir.dirs()
            .filter(|dir| ASSETS.iter().all(|assets| dir.path() != Path::new(assets)))
            .for_each(|dir| visit(dir, out));
    }
    let mut scenes = Vec::new();
    visit(&SCENES, &mut scenes);
    scenes.sort_by(|a, b| a.0.cmp(&b.0));
    scenes
}

/// The text of the stage called `name` that comes with the program.
#[must_use]
pub fn embedded_stage(name: &str) -> Option<&'static str> {
    let file = stages().find(|file| file.path().file_stem().is_some_and(|stem| stem == name))?;
    file.contents_utf8()
}

/// The names of the stages that come with the program.
#[must_use]
pub fn stage_names() -> Vec<String> {
    let mut names: Vec<String> =
        stages().filter_map(|file| Some(file.path().file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    names
}

fn stages() -> impl Iterator<Item = &'static include_dir::File<'static>> {
    SCENES.get_dir("stages").into_iter().flat_map(Dir::files)
}

/// The names of the leaf shapes that come with the program.
#[must_use]
pub fn leaf_names() -> Vec<String> {
    let files = SCENES.get_dir("leaves").into_iter().flat_map(Dir::files);
    let stems = files.filter_map(|file| Some(file.path().file_stem()?.to_str()?.to_owned()));
    stems.chain(["ball".to_owned()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_are_recorded() {
        let reads = Reads::default();
        let papers = Folder::Embedded("papers".into()).recorded(&reads);
        assert!(papers.read("../assets/peppers.png").is_ok());
        assert!(papers.read("../assets/peppers.png").is_ok());
        assert!(papers.of("../assets/x.toml").read("nothing.obj").is_err());
        assert!(papers.read("../../Cargo.toml").is_err());
        let read = |name: &str, path: &str| FileRead { name: name.to_owned(), path: path.into() };
        assert_eq!(
            reads.files(),
            [
                read("../assets/peppers.png", "assets/peppers.png"),
                read("nothing.obj", "assets/nothing.obj"),
                read("../../Cargo.toml", "../../Cargo.toml")
            ]
        );
    }

    #[cfg(unix)]
    #[test]
    fn confined_scenes_read_what_is_allowed() {
        let place = tempfile::tempdir().unwrap();
        let root = place.path().canonicalize().unwrap();
        for folder in ["mine/sub", "more", "other"] {
            std::fs::create_dir_all(root.join(folder)).unwrap();
            std::fs::write(root.join(folder).join("a"), folder).unwrap();
        }
        for (link, to) in [("mine/out", "../other/a"), ("mine/in", "sub/a"), ("mine/allowed", "../more/a")] {
            std::os::unix::fs::symlink(to, root.join(link)).unwrap();
        }
        let allowed: Arc<[PathBuf]> = [root.join("mine"), root.join("more")].into();
        let mine = Folder::Confined(root.join("mine"), allowed);
        for (name, text) in
            [("sub/a", "mine/sub"), ("sub/../in", "mine/sub"), ("allowed", "more"), ("../more/a", "more")]
        {
            assert_eq!(mine.read(name).unwrap(), text.as_bytes(), "{name}");
        }
        let absolute = root.join("other/a");
        for name in ["../other/a", "../other/none", "out", "/dev/zero", "/none", absolute.to_str().unwrap()] {
            assert!(matches!(mine.read(name).unwrap_err().reason, Unreadable::Outside), "{name}");
        }
        assert!(matches!(mine.read("none").unwrap_err().reason, Unreadable::Io(_)));
        assert!(mine.of("sub/a").read("../../other/a").is_err() && mine.of("sub/a").read("../in").is_ok());
    }

    #[test]
    fn assets_are_no_scenes() {
        let scenes = embedded_scenes();
        assert!(scenes.len() > 100);
        assert!(scenes.iter().all(|(name, ..)| ASSETS.iter().all(|assets| !name.starts_with(assets))));
    }
}
