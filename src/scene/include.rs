//! `include`: what a scene takes from another file.

use std::path::PathBuf;
use std::sync::Arc;

use super::mistake::{Included, Mistake, Span};
use super::tree::{Entry, Value, merge, parse};
use crate::files::{Folder, ReadError};

/// Files that include each other, one the next, at most.
const MOST_DEPTH: usize = 16;
/// An included file has at most this many bytes.
const MOST_BYTES: usize = 4 << 20;

/// Tables by name whose items are taken over key by key.
const BY_KEY: [&str; 5] = ["space", "grow", "object", "material", "claim"];
/// Tables by name whose items are taken over whole: an item is one of several kinds.
const WHOLE: [&str; 3] = ["shape", "light", "animation"];
/// Tables that are taken over key by key.
const PLAIN: [&str; 5] = ["air", "background", "camera", "ground", "view"];

/// Fills `root` with what the files that it includes give and it does not.
pub(super) fn include(root: &mut Entry, folder: &Folder, mistakes: &mut Vec<Mistake>) {
    let mut folder = folder.clone();
    let mut chain: Vec<(String, PathBuf)> = Vec::new();
    // A base's own `include` comes with it, and is next.
    while let Some(entry) = take(root, "include") {
        let Value::String(name) = entry.value else {
            let message = format!("expected the name of a file, found {}", entry.value.kind());
            return mistakes.push(wrong(entry.span, message));
        };
        let path = folder.path(&name);
        // One file may have many paths.
        let place = path.canonicalize().unwrap_or_else(|_| path.clone());
        let start = chain.iter().position(|(_, known)| *known == place);
        let shown = path.strip_prefix(".").unwrap_or(&path).display().to_string();
        chain.push((shown.clone(), place));
        if let Some(start) = start {
            let names: Vec<&str> = chain[start..].iter().map(|(name, _)| name.as_str()).collect();
            return mistakes.push(wrong(entry.span, format!("a file includes itself: {}", names.join(" > "))));
        }
        if chain.len() > MOST_DEPTH {
            let message = format!("more than {MOST_DEPTH} files include each other: {name} is not read");
            return mistakes.push(wrong(entry.span, message));
        }
        let text = match read(&folder, &name) {
            Ok(text) => text,
            Err(error) => return mistakes.push(wrong(entry.span, error.to_string())),
        };
        let file = Arc::new(Included { name: shown, text });
        let (base, found) = parse(&file.text, Some(&file));
        mistakes.extend(found);
        take_over(root, &base);
        folder = folder.of(&name);
    }
}

/// Removes what a key has.
pub(super) fn take(root: &mut Entry, key: &str) -> Option<Entry> {
    let Value::Table(table) = &mut root.value else { return None };
    table.remove(key)
}

fn wrong(span: Option<Span>, message: String) -> Mistake {
    Mistake { span, place: "include".to_owned(), message }
}

/// Why a file cannot be included.
#[derive(Debug, thiserror::Error)]
enum IncludeError {
    #[error("{0}")]
    Read(#[from] ReadError),
    #[error("cannot include `{0}`: it has {1} bytes, {MOST_BYTES} at most are read")]
    TooLarge(String, usize),
    #[error("cannot include `{0}`: it is not UTF-8 text")]
    NotText(String),
}

fn read(folder: &Folder, name: &str) -> Result<String, IncludeError> {
    let bytes = folder.read(name)?;
    if bytes.len() > MOST_BYTES {
        return Err(IncludeError::TooLarge(name.to_owned(), bytes.len()));
    }
    String::from_utf8(bytes).map_err(|_| IncludeError::NotText(name.to_owned()))
}

/// Adds to a scene what only its base gives.
pub(super) fn take_over(scene: &mut Entry, base: &Entry) {
    let (Value::Table(scene), Value::Table(base)) = (&mut scene.value, &base.value) else { return };
    for (key, value) in base {
        let Some(own) = scene.get_mut(key) else {
            scene.insert(key.clone(), value.clone());
            continue;
        };
        let key = key.as_str();
        if PLAIN.contains(&key) {
            merge(own, value);
        } else if key == "sky" {
            // It is one of several kinds.
            deepen(own, value);
        } else if BY_KEY.contains(&key) || WHOLE.contains(&key) {
            take_over_named(own, value, BY_KEY.contains(&key));
        }
    }
}

/// Adds to the tables within `own` what those of the same names within `base` give.
fn deepen(own: &mut Entry, base: &Entry) {
    let (Value::Table(own), Value::Table(base)) = (&mut own.value, &base.value) else { return };
    for (name, value) in base {
        if let Some(own) = own.get_mut(name) {
            merge(own, value);
        }
    }
}

fn take_over_named(own: &mut Entry, base: &Entry, is_by_key: bool) {
    let (Value::Table(own), Value::Table(base)) = (&mut own.value, &base.value) else { return };
    for (name, value) in base {
        match own.get_mut(name) {
            None => {
                own.insert(name.clone(), value.clone());
            }
            Some(own) if is_by_key => merge(own, value),
            Some(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::{Override, Source, load};
    use super::*;

    const BASE: &str = "title = \"Base\"\nseed = 7\n\
        [shape.sheet]\nbox = { min = [-1, 0], max = [1, 2] }\n\
        [space.air]\nshape = \"sheet\"\nnodes.lattice = { spacing = 0.1, neighbours = 8 }\nweights = { max = 10, alpha = 2 }\n\
        [grow.twig]\nspace = \"air\"\nfrom.at = [[0, 0]]\nto.tips = { count = 5 }\nwidth.constant = 0.02\n\
        [object.twig]\ngrow = [\"twig\"]\n";

    /// A folder with these files, and the scene `mine.toml` of this text in it.
    fn folder(scene: &str, files: &[(&str, &str)]) -> (tempfile::TempDir, Source) {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let place = folder.path().to_owned();
        (folder, Source { name: "mine.toml".to_owned(), text: scene.to_owned(), folder: Folder::Disk(place) })
    }

    fn error(scene: &str, files: &[(&str, &str)]) -> String {
        let (folder, source) = folder(scene, files);
        let said = load(&source, &[]).unwrap_err().to_string();
        said.replace(&format!("{}/", folder.path().display()), "")
    }

    #[test]
    fn what_is_not_given_is_taken() {
        let text = "include = \"bases/twig.toml\"\ntitle = \"Mine\"\n\
            [space.air]\nweights.alpha = 3\n[shape.sheet]\nbox = { min = [-2, 0], max = [2, 2] }\n\
            [grow.twig]\nto.tips.count = 6\n[material.ink]\ncolour = \"#102030\"\n";
        let (_folder, source) = folder(text, &[("bases/twig.toml", BASE)]);
        let count = Override { path: "grow.twig.width.constant".to_owned(), value: "0.03".to_owned() };
        let scene = load(&source, &[count]).unwrap();
        let document = scene.document();
        assert_eq!((scene.recipe.title.as_str(), scene.recipe.seed), ("Mine", 7));
        assert!(document.get("include").is_none(), "the document is the whole scene");
        for (place, value) in [
            ("/space/air/weights", serde_json::json!({ "max": 10, "alpha": 3 })),
            ("/shape/sheet", serde_json::json!({ "box": { "min": [-2, 0], "max": [2, 2] } })),
            ("/grow/twig/to/tips", serde_json::json!({ "count": 6 })),
            ("/grow/twig/width/constant", serde_json::json!(0.03)),
            ("/object/twig/grow", serde_json::json!(["twig"])),
        ] {
            assert_eq!(document.pointer(place), Some(&value), "{place}");
        }
    }

    #[test]
    fn files_are_relative_to_what_includes_them() {
        let middle = "include = \"../twig.toml\"\n[grow.twig]\nfrom.at = [[0.5, 0]]\n[object.other]\nlike = \"twig\"\n";
        let files = [("bases/middle.toml", middle), ("twig.toml", BASE)];
        let (_folder, source) = folder("include = \"bases/middle.toml\"\n[object.other]\nat = [1, 0]\n", &files);
        let document = load(&source, &[]).unwrap().document();
        assert_eq!(document.pointer("/grow/twig/from/at"), Some(&serde_json::json!([[0.5, 0]])));
        assert_eq!(document.pointer("/object/other/grow"), Some(&serde_json::json!(["twig"])));
    }

    #[test]
    fn mistakes_are_where_they_are_written() {
        let wrong = BASE.replace("count = 5", "cuont = 5");
        let said = error("include = \"bases/twig.toml\"\nsede = 1\n", &[("bases/twig.toml", &wrong)]);
        let lines: Vec<&str> = said.lines().collect();
        assert_eq!(lines.len(), 2, "{said}");
        assert!(lines[0].starts_with("mine.toml:2:1: sede: "), "{said}");
        assert!(lines[1].starts_with("bases/twig.toml:12:13: ") && lines[1].contains("did you mean `count`"), "{said}");
        // A name that leads nowhere, and a file that is no TOML.
        let wrong = BASE.replace("space = \"air\"", "space = \"water\"");
        let said = error("include = \"twig.toml\"\n", &[("twig.toml", &wrong)]);
        assert!(said.starts_with("twig.toml:10:9: grow.twig.space: "), "{said}");
        assert!(error("include = \"a.toml\"\n", &[("a.toml", "seed = \n")]).starts_with("a.toml:1:"));
    }

    #[test]
    fn circles_and_missing_files_are_refused() {
        let said = error(
            "include = \"a.toml\"\n",
            &[("a.toml", "include = \"b.toml\""), ("b.toml", "include = \"./a.toml\"")],
        );
        assert!(said.starts_with("b.toml:1:11: include: a file includes itself: a.toml > b.toml > "), "{said}");
        let chain: Vec<(String, String)> =
            (0..20).map(|i| (format!("{i}.toml"), format!("include = \"{}.toml\"\n", i + 1))).collect();
        let chain: Vec<(&str, &str)> = chain.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        assert!(error("include = \"0.toml\"\n", &chain).contains("15.toml:1:11: include: more than 16 files"));
        let said = error("include = \"nowhere.toml\"\n", &[]);
        assert!(said.starts_with("mine.toml:1:11: include: cannot read `nowhere.toml`"), "{said}");
        assert!(error("include = 3\n", &[]).contains("mine.toml:1:11: include: expected the name of a file, found a"));
        let (_folder, source) = folder("include = \"a.toml\"\n", &[("a.toml", BASE)]);
        let change = Override { path: "include".to_owned(), value: "b.toml".to_owned() };
        assert!(load(&source, &[change]).unwrap_err().to_string().contains("cannot be changed from outside"));
    }

    #[test]
    fn embedded_scenes_include_embedded_files() {
        let folder = Folder::Embedded("papers".into());
        assert_eq!(folder.of("../assets/fig23.toml").path("x"), Path::new("assets/x"));
    }
}
