//! Any changes to a scene that the program brings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lichtenberg::files::embedded_scenes;
use lichtenberg::scene::{Override, Source, load};

fuzz_target!(|input: (u8, Vec<(String, String)>)| {
    let (which, changes) = input;
    let scenes = embedded_scenes();
    let (name, text, folder) = scenes[usize::from(which) % scenes.len()].clone();
    let changes: Vec<Override> = changes.into_iter().map(|(path, value)| Override { path, value }).collect();
    if let Err(error) = load(&Source { name, text: text.to_owned(), folder }, &changes) {
        assert!(!error.to_string().is_empty());
    }
});
