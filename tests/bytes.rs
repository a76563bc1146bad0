//! Every scene's files in another build: each scene grows on one thread, and gives the bytes of tests/digests.txt. The
//! tests in `it` hold the same on two threads. `./run-tests --all` builds this in the profiles dev and release.

#[path = "it/digests.rs"]
mod digests;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use lichtenberg::files::embedded_scenes;
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{Source, grow, load, model};

#[test]
fn files_are_the_same_everywhere() {
    let scenes = embedded_scenes();
    let found = Mutex::new(vec![String::new(); scenes.len()]);
    let next = AtomicUsize::new(0);
    let work = || {
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        while let Some((name, text, folder)) = scenes.get(next.fetch_add(1, Ordering::Relaxed)).cloned() {
            let lines = alone.install(|| {
                let scene = load(&Source { name: name.clone(), text: text.to_owned(), folder }, &[]).unwrap();
                let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
                let model = model(&scene, &grown, [320, 240], &Memory::default(), &Progress::default()).unwrap();
                digests::digests(&name, &scene, &model, true)
            });
            let place = scenes.iter().position(|(other, ..)| *other == name).unwrap();
            found.lock().unwrap()[place] = lines;
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    digests::compare(&found.into_inner().unwrap().concat(), true);
}
