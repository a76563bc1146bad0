//! `new`: a scene of one's own to start from.

use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::args::NewArgs;
use super::console::Console;
use super::error::Failure;
use super::render::check_name;
use super::shown;
use crate::files::{FileRead, Folder, Reads, embedded_scenes, write_bytes};
use crate::math::unknown;
use crate::scene::{Source, load};

/// Writes an embedded scene as NAME.toml and what it reads beside it, under the paths that it has in the program: below
/// `assets` and `skies`, where no output goes by default.
pub fn run(args: &NewArgs, console: &Console) -> Result<(), Failure> {
    check_name(&args.name)?;
    let scenes = embedded_scenes();
    let find = |name: &str| scenes.iter().find(|(known, ..)| known == name);
    let found = match &args.like {
        Some(like) => find(like)
            .ok_or_else(|| Failure::Usage(unknown("embedded scene", like, scenes.iter().map(|(name, ..)| name))))?,
        None => find(&args.name)
            .or_else(|| find("elm"))
            .ok_or_else(|| Failure::Usage("there is no scene to start from".to_owned()))?,
    };
    let (name, text, folder) = found;
    let reads = Reads::default();
    let source = Source { name: name.clone(), text: (*text).to_owned(), folder: folder.clone() }.recorded(&reads);
    load(&source, &[])?;
    let reads = reads.files();
    let own = PathBuf::from(format!("{}.toml", args.name));
    if own.exists() {
        return Err(Failure::Usage(format!("{} is there already", shown::path(&own))));
    }
    let mut files = vec![(own, with_new_paths(text, &reads).into_bytes())];
    for FileRead { path, .. } in reads {
        let bytes = Folder::Embedded(PathBuf::new())
            .read(&slashed(&path))
            .map_err(|error| Failure::Usage(error.to_string()))?;
        match std::fs::read(&path) {
            // Scenes share assets.
            Ok(old) if old == bytes => {}
            Ok(_) => return Err(Failure::Usage(format!("{} is there already, and another file", shown::path(&path)))),
            Err(_) => files.push((path, bytes)),
        }
    }
    for (path, bytes) in files {
        write_bytes(&path, &bytes).map_err(|e| Failure::file("write", &path, &e))?;
        console.wrote(&path, serde_json::Value::Null);
    }
    Ok(())
}

/// A scene's text with every file that it names at its path within the embedded scenes.
fn with_new_paths(text: &str, reads: &[FileRead]) -> String {
    let mut named = Vec::new();
    let (table, _) = DeTable::parse_recoverable(text);
    table.get_ref().iter().for_each(|(_, value)| strings(value.get_ref(), value.span(), &mut named));
    named.sort_by_key(|(_, span)| span.start);
    let mut new = text.to_owned();
    for (name, span) in named.into_iter().rev() {
        if let Some(read) = reads.iter().find(|read| read.name == name && read.path != Path::new(&name)) {
            new.replace_range(span, &toml::Value::from(slashed(&read.path)).to_string());
        }
    }
    new
}

/// The texts in a value, and where they stand.
fn strings(value: &DeValue<'_>, span: std::ops::Range<usize>, out: &mut Vec<(String, std::ops::Range<usize>)>) {
    match value {
        DeValue::String(text) => out.push((text.to_string(), span)),
        DeValue::Table(table) => table.iter().for_each(|(_, value)| strings(value.get_ref(), value.span(), out)),
        DeValue::Array(items) => items.iter().for_each(|item| strings(item.get_ref(), item.span(), out)),
        _ => {}
    }
}

/// A path with `/`, as scenes and the embedded files have it.
fn slashed(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_replaced() {
        let read = |name: &str, path: &str| FileRead { name: name.to_owned(), path: path.into() };
        let reads = [read("../assets/a.png", "assets/a.png"), read("assets/b.obj", "assets/b.obj")];
        let text =
            "# ../assets/a.png\na = { file = \"../assets/a.png\" } # here\nb = [\"../assets/a.png\", 'assets/b.obj']\n";
        let new = "# ../assets/a.png\na = { file = \"assets/a.png\" } # here\nb = [\"assets/a.png\", 'assets/b.obj']\n";
        assert_eq!(with_new_paths(text, &reads), new);
    }
}
