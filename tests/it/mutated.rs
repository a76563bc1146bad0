//! Mutated scenes: no panic, no run without an end, and `check` finds what can be known before growth.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use lichtenberg::export::{Origin, Pov, Templates};
use lichtenberg::files::{Folder, embedded_scenes};
use lichtenberg::math::{Memory, Progress, Stream};
use lichtenberg::scene::{Source, Stage, check, grow, load, model};
use lichtenberg::trace::{Look, RenderSettings, World};
use rand::RngExt;

use crate::support::sample::tests_all;
use crate::support::{panic_text, tell};

const WORDS: &[&str] = &[
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "1e300",
    "1.7e308",
    "-1e-300",
    "9223372036854775807",
    "99999999999999999999999",
    "[]",
    "{}",
    "\"\"",
    "\"elm\"",
    "true",
    "[[0, 0]]",
    "[1, 2, 3, 4]",
    "1979-05-27",
    "\"\\u0000\"",
    "{ box = {} }",
    "0.5",
    "3",
    "[",
    "}",
    "=",
    "\n",
    "[grow]",
    "like = \"first\"",
];

const NUMBERS: &[&str] = &["0", "1", "7", "40", "1000", "0.001", "1e-9", "1e6", "-1", "-0.5", "nan", "1e300"];

/// Growth of a mutant may take so much memory.
const MOST_MEMORY: u64 = 64 << 20;
/// A run that takes more of a processor's time has no end that anyone waits for: ten seconds of a release build, which is up to
/// 4.7 times as fast as tests with their checks (nodes among sixty cones: 6.7 and 31.6 s).
const MOST_TIME: Duration = Duration::from_secs(45);
/// A run that takes longer by the clock waits for something that never comes; other tests may take the processors.
const MOST_WAIT: Duration = Duration::from_secs(450);
/// So often the time is looked at.
const LOOK: Duration = Duration::from_millis(100);

/// Scenes small enough that hundreds of them can be grown.
fn small(text: &str) -> String {
    // Nodes that are farther apart are joined farther.
    let joined = |line: &str| {
        if line.starts_with("nodes.scatter") { line.replace("radius = 0.", "radius = 2.") } else { line.to_owned() }
    };
    let text = text.lines().map(joined).collect::<Vec<_>>().join("\n");
    text.replace("spacing = 0.16", "spacing = 1.28")
        // What is replaced here is not replaced again.
        .replace("spacing = 0.00", "spacing=0.01")
        .replace("nodes.scatter = { spacing = 0.", "nodes.scatter = { spacing = 0.9")
        .replace("spacing = 0.0", "spacing = 0.1")
        .replace("count = 1100", "count = 30")
        .replace("count = 1400", "count = 30")
        .replace("count = 220", "count = 30")
        .replace("count = 900", "count = 30")
        .replace("count = 30000", "count = 300")
        .replace("count = 26000", "count = 300")
        .replace("count = 1900", "count = 90")
        .replace("particles = 25000", "particles = 300")
        .replace("particles = 5000", "particles = 100")
        .replace("nodes.lattice = { spacing = 1,", "nodes.lattice = { spacing = 2,")
        .replace("nodes.lattice = { spacing = 0.5,", "nodes.lattice = { spacing = 1,")
        .replace("nodes.lattice = { spacing = 0.14,", "nodes.lattice = { spacing = 0.4,")
}

/// Words, numbers and signs of a scene's text.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    for c in text.chars() {
        let joins = |last: &String| c.is_alphanumeric() && last.ends_with(|l: char| l.is_alphanumeric());
        match tokens.last_mut() {
            Some(last) if joins(last) => last.push(c),
            _ => tokens.push(c.to_string()),
        }
    }
    tokens
}

/// Changes one thing of a text.
fn mutate(text: &str, random: &mut Stream) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let mut tokens = tokens(text);
    let mut at = |length: usize| random.random_range(0..length.max(1));
    match at(16) {
        // Types, and what is no TOML.
        0 | 1 => {
            let to = at(tokens.len());
            tokens[to] = WORDS[at(WORDS.len())].to_owned();
        }
        2 => drop(tokens.remove(at(tokens.len()))),
        3 => {
            let (to, from) = (at(tokens.len()), at(tokens.len()));
            tokens[to] = tokens[from].clone();
        }
        // Swapped, and duplicates.
        4 => {
            let (a, b) = (at(tokens.len()), at(tokens.len()));
            tokens.swap(a, b);
        }
        5 | 6 => {
            let (a, b) = (at(lines.len()), at(lines.len()));
            if a % 2 == 0 {
                lines.swap(a, b)
            } else {
                lines.insert(a, lines[b])
            }
            return lines.join("\n");
        }
        // Deep, and long.
        7 => {
            let depth = [3, 40, 5000][at(3)];
            let value = if at(2) == 0 { ["[", "]"] } else { ["{ union = [", "] }"] };
            return with_value(&lines, at(lines.len()), &(value[0].repeat(depth) + &value[1].repeat(depth)));
        }
        8 => {
            let long = [format!("[{}]", "0.5, ".repeat(20_000)), format!("\"{}\"", "x".repeat(100_000))];
            return with_value(&lines, at(lines.len()), &long[at(2)]);
        }
        // Numbers for numbers: many of these scenes are good, or wrong only further in.
        how => {
            let is_number = |t: &String| t.starts_with(|c: char| c.is_ascii_digit());
            let numbers: Vec<usize> = (0..tokens.len()).filter(|&i| is_number(&tokens[i])).collect();
            let (to, from) = (numbers[at(numbers.len())], numbers[at(numbers.len())]);
            tokens[to] = if how < 13 { tokens[from].clone() } else { NUMBERS[at(NUMBERS.len())].to_owned() };
        }
    }
    tokens.concat()
}

/// The text with another value in the line at or after `at` that has one.
fn with_value(lines: &[&str], at: usize, value: &str) -> String {
    let target = (at..lines.len()).find(|&i| lines[i].contains('='));
    let line = |(i, line): (usize, &&str)| match line.split_once('=') {
        Some((key, _)) if Some(i) == target => format!("{key}= {value}"),
        _ => (*line).to_owned(),
    };
    lines.iter().enumerate().map(line).collect::<Vec<_>>().join("\n")
}

/// What became of a mutant.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Fate {
    /// `check` refuses it.
    Refused,
    /// It needs more memory than allowed, as `check` says or as growth does.
    Large,
    /// It makes a picture.
    Rendered,
    /// `check` accepts it, and it makes none.
    Failed(String),
    /// It has no end.
    Endless,
}

/// The mutant with this number: its scene's name and its text.
fn mutant(number: u64, scenes: &[(String, &'static str, Folder)]) -> Source {
    let mut random = Stream::new(number, "mutant");
    let (name, text, folder) = &scenes[random.random_range(0..scenes.len())];
    let changes = random.random_range(1..4);
    let text = (0..changes).fold(small(text), |text, _| mutate(&text, &mut random));
    Source { name: name.clone(), text, folder: folder.clone() }
}

/// From its text to its picture.
fn run(source: &Source, progress: &Progress) -> Fate {
    let scene = match load(source, &[]) {
        Ok(scene) => scene,
        Err(error) => {
            assert!(!error.mistakes.is_empty() && !error.to_string().is_empty());
            return Fate::Refused;
        }
    };
    let memory = Memory::new(MOST_MEMORY);
    match check(&scene, &memory, progress) {
        Err(Stage::Memory(_)) => return Fate::Large,
        Err(Stage::Cancelled(_)) => return Fate::Endless,
        Err(Stage::Scene(_)) => return Fate::Refused,
        Ok(()) => {}
    }
    let made =
        grow(&scene, &[], &memory, progress).and_then(|grown| model(&scene, &grown, [64, 48], &memory, progress));
    match made {
        Ok(model) => {
            let mut out = Vec::new();
            Pov::new(&model, &Templates::default(), "x", [64, 48], &Origin::default()).write_inc(&mut out).unwrap();
            let text = String::from_utf8(out).unwrap();
            // Comments hold the scene's own words.
            let is_number = |line: &&str| !line.trim_start().starts_with("//");
            assert!(text.lines().filter(is_number).all(|l| !l.contains("NaN") && !l.contains("inf")));
            if scene.recipe.view.is_none() {
                let settings = RenderSettings::new([16, 12], Look::Exact, 1);
                if lichtenberg::trace::render(&World::new(&model), &settings, progress).is_err() {
                    return Fate::Endless;
                }
            }
            Fate::Rendered
        }
        Err(Stage::Memory(_)) => Fate::Large,
        Err(Stage::Cancelled(_)) => Fate::Endless,
        // Ends of rounds are known when they have grown.
        Err(Stage::Scene(error)) if error.to_string().contains("that there is memory for") => Fate::Large,
        Err(Stage::Scene(error)) => Fate::Failed(error.to_string()),
    }
}

/// The processor's time that a thread has had, by its folder in /proc.
fn processor_time(thread: &Path) -> Duration {
    let schedule = fs::read_to_string(thread.join("schedstat")).expect("the test needs Linux's accounts of threads");
    let nanoseconds = schedule.split_whitespace().next().and_then(|time| time.parse().ok());
    Duration::from_nanos(nanoseconds.expect("the accounts of a thread start with its time"))
}

/// [`run`] on this thread alone, stopped after [`MOST_TIME`].
fn run_in_time(source: &Source) -> Result<Fate, String> {
    let stop = Arc::new(AtomicBool::new(false));
    let progress = Progress::new(Arc::clone(&stop), |_, _| {});
    let (done, is_done) = channel::<()>();
    let thread = Path::new("/proc").join(fs::read_link("/proc/thread-self").expect("the test needs Linux's /proc"));
    let (start, start_time) = (Instant::now(), processor_time(&thread));
    std::thread::scope(|scope| {
        scope.spawn(move || {
            while is_done.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                if processor_time(&thread) - start_time > MOST_TIME || start.elapsed() > MOST_WAIT {
                    stop.store(true, Ordering::Relaxed);
                }
            }
        });
        let fate = catch_unwind(AssertUnwindSafe(|| run(source, &progress)));
        let _ = done.send(());
        fate.map_err(|cause| panic_text(&*cause))
    })
}

/// What comes of all mutants, two at a time, each on one thread, whose time is its own.
fn fates(scenes: &[(String, &'static str, Folder)]) -> Vec<(u64, Result<Fate, String>)> {
    let next = AtomicU32::new(numbers().start);
    let work = || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let taken = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        let numbers = taken.take_while(|number| numbers().contains(number)).map(u64::from);
        numbers.map(|number| (number, pool.install(|| run_in_time(&mutant(number, scenes))))).collect()
    };
    std::thread::scope(|scope| {
        let threads = [(); 2].map(|()| scope.spawn(work));
        let mut fates: Vec<_> = threads.into_iter().flat_map(|thread| -> Vec<_> { thread.join().unwrap() }).collect();
        fates.sort_by_key(|(number, _)| *number);
        fates
    })
}

/// The numbers of the mutants: one that `LICHTENBERG_MUTANT` names, or as many as are to be tested.
fn numbers() -> Range<u32> {
    match std::env::var("LICHTENBERG_MUTANT").ok().and_then(|number| number.parse().ok()) {
        Some(number) => number..number + 1,
        None => 0..if tests_all() { 20_000 } else { 500 },
    }
}

#[test]
fn mutated_scenes_do_no_harm() {
    let scenes = embedded_scenes();
    if numbers().len() == 1 {
        tell(&mutant(numbers().start.into(), &scenes).text);
    }
    let fates = fates(&scenes);
    if let [(_, fate)] = &fates[..] {
        tell(&format!("{fate:?}"));
    }
    let told = |number: &u64, what: &str| format!("mutant {number} of {}: {what}", mutant(*number, &scenes).name);
    let panics: Vec<String> = fates.iter().filter_map(|(n, fate)| Some(told(n, fate.as_ref().err()?))).collect();
    assert!(panics.is_empty(), "{panics:#?}");
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut failed, mut endless) = (Vec::new(), Vec::new());
    for (number, fate) in fates.iter().filter_map(|(number, fate)| Some((*number, fate.as_ref().ok()?))) {
        let name = match fate {
            Fate::Refused => "refused by check",
            Fate::Large => "too large",
            Fate::Rendered => "rendered",
            Fate::Failed(message) => {
                failed.push(told(&number, message));
                "accepted, then failed"
            }
            Fate::Endless => {
                endless.push(told(&number, ""));
                "endless"
            }
        };
        *counts.entry(name).or_default() += 1;
    }
    tell(&format!("{counts:?}\n{failed:#?}"));
    assert!(endless.is_empty(), "{endless:#?}");
    let rendered = counts.get("rendered").copied().unwrap_or(0);
    assert!(rendered > fates.len() / 10 || fates.len() == 1, "mutants are too wild: {counts:?}");
    // Of those that check accepts; what growth alone can know is allowed for.
    assert!(failed.len() * 50 <= rendered + failed.len(), "{failed:#?}");
}
