//! Where a scene's files are: beside it on disk, or embedded with it in the program.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use include_dir::{Dir, include_dir};

static SCENES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/scenes");

/// No file of a scene is larger than this.
const MOST_BYTES: u64 = 256 << 20;

/// A folder that a scene's files are named relative to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Folder {
    /// On disk.
    Disk(PathBuf),
    /// Within the embedded scenes, by path.
    Embedded(PathBuf),
}

impl Folder {
    /// The bytes of the file called `name`.
    ///
    /// # Errors
    /// A sentence with the name and the reason.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let wrong = |reason: &dyn std::fmt::Display| format!("cannot read `{name}`: {reason}");
        match self {
            Self::Embedded(folder) => inside(&folder.join(name))
                .and_then(|path| SCENES.get_file(path))
                .map(|file| file.contents().to_vec())
                .ok_or_else(|| wrong(&"it is not among the embedded files")),
            Self::Disk(folder) => {
                let path = folder.join(name);
                let meta = path.metadata().map_err(|e| wrong(&e))?;
                if !meta.is_file() {
                    return Err(wrong(&"it is not a file"));
                }
                if meta.len() > MOST_BYTES {
                    return Err(wrong(&format!("it has {} bytes, {MOST_BYTES} at most can be read", meta.len())));
                }
                let mut bytes = Vec::new();
                File::open(path)
                    .and_then(|file| file.take(MOST_BYTES).read_to_end(&mut bytes))
                    .map_err(|e| wrong(&e))?;
                Ok(bytes)
            }
        }
    }
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

/// The embedded scenes: name (path without `.toml`), text, and the folder of their files; sorted by name.
pub fn embedded_scenes() -> Vec<(String, &'static str, Folder)> {
    fn visit(dir: &'static Dir<'static>, out: &mut Vec<(String, &'static str, Folder)>) {
        for file in dir.files().filter(|f| f.path().extension().is_some_and(|e| e == "toml")) {
            let name = file.path().with_extension("");
            let folder = file.path().parent().unwrap_or(Path::new("")).to_owned();
            if let (Some(name), Some(text)) = (name.to_str(), file.contents_utf8()) {
                out.push((name.replace('\\', "/"), text, Folder::Embedded(folder)));
            }
        }
        dir.dirs().for_each(|dir| visit(dir, out));
    }
    let mut scenes = Vec::new();
    visit(&SCENES, &mut scenes);
    scenes.sort_by(|a, b| a.0.cmp(&b.0));
    scenes
}

/// The names of the leaf shapes that come with the program.
#[must_use]
pub fn leaf_names() -> Vec<String> {
    let files = SCENES.get_dir("leaves").into_iter().flat_map(Dir::files);
    let stems = files.filter_map(|file| Some(file.path().file_stem()?.to_str()?.to_owned()));
    stems.chain(["ball".to_owned()]).collect()
}
