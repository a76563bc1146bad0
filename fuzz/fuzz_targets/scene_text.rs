//! Any text as a scene: it is refused with mistakes, or checked. Seed the corpus with `scenes/*.toml`.
#![no_main]

use std::path::PathBuf;

use libfuzzer_sys::fuzz_target;
use lichtenberg::files::Folder;
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{Source, check, load};

fuzz_target!(|text: &str| {
    let source = Source { name: "fuzz".to_owned(), text: text.to_owned(), folder: Folder::Embedded(PathBuf::new()) };
    match load(&source, &[]) {
        Ok(scene) => drop(check(&scene, &Memory::new(16 << 20), &Progress::default())),
        Err(error) => assert!(!error.mistakes.is_empty() && !error.to_string().is_empty()),
    }
});
