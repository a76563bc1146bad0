//! `list`: the embedded scenes.

use super::console::Console;
use super::error::Failure;
use crate::files::embedded_scenes;
use crate::scene::{Source, load};

pub fn run(console: &Console) -> Result<(), Failure> {
    let scenes = embedded_scenes();
    let width = scenes.iter().map(|(name, ..)| name.len()).max().unwrap_or(0);
    for (name, text, folder) in scenes {
        let source = Source { name: name.clone(), text: text.to_owned(), folder };
        let title = load(&source, &[])?.recipe.title;
        if console.json {
            console.result(&serde_json::json!({ "name": name, "title": title }));
        } else {
            console.line(&format!("{name:width$}  {title}"));
        }
    }
    Ok(())
}
