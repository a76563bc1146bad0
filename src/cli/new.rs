//! `new`: a scene of one's own to start from.

use std::path::PathBuf;

use super::args::NewArgs;
use super::console::Console;
use super::error::Failure;
use super::render::check_name;
use crate::files::{Folder, embedded_scenes, write_bytes};
use crate::math::unknown;

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
    let (_, text, folder) = found;
    let mut files = vec![(PathBuf::from(format!("{}.toml", args.name)), text.as_bytes().to_vec())];
    for name in named_files(text) {
        files.push((PathBuf::from(&name), read_embedded(folder, &name)?));
    }
    for (path, _) in &files {
        if path.exists() {
            return Err(Failure::Usage(format!("{} is there already", path.display())));
        }
    }
    for (path, bytes) in files {
        write_bytes(&path, &bytes).map_err(|e| Failure::file("write", &path, &e))?;
        if console.json {
            console.result(&serde_json::json!({ "file": path }));
        } else {
            console.line(&path.display().to_string());
        }
    }
    Ok(())
}

fn read_embedded(folder: &Folder, name: &str) -> Result<Vec<u8>, Failure> {
    folder.read(name).map_err(Failure::Usage)
}

/// The files that a scene's text names: values of `file` and `sketch`.
fn named_files(text: &str) -> Vec<String> {
    fn visit(value: &toml::Value, out: &mut Vec<String>) {
        match value {
            toml::Value::Table(table) => {
                for (key, value) in table {
                    match value {
                        toml::Value::String(name) if key == "file" || key == "sketch" => out.push(name.clone()),
                        value => visit(value, out),
                    }
                }
            }
            toml::Value::Array(items) => items.iter().for_each(|item| visit(item, out)),
            _ => {}
        }
    }
    let mut files = Vec::new();
    if let Ok(table) = text.parse::<toml::Table>() {
        visit(&toml::Value::Table(table), &mut files);
    }
    files.sort();
    files.dedup();
    files
}
