//! Mutated scenes: `check` and `export` never panic and never hang.

use lichtenberg::export::{Origin, Pov, Templates};
use lichtenberg::files::embedded_scenes;
use lichtenberg::math::Progress;
use lichtenberg::scene::{Source, grow, load, model};
use proptest::prelude::*;

const WORDS: &[&str] = &[
    "nan",
    "inf",
    "-1",
    "0",
    "1e300",
    "-1e-300",
    "9223372036854775807",
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

const NUMBERS: &[&str] = &["0", "1", "7", "40", "1000", "0.001", "1e-9", "1e6", "-1", "-0.5"];

/// Scenes small enough that hundreds of them can be grown.
fn small(text: &str) -> String {
    text.replace("spacing = 0.16", "spacing = 1.28")
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
        .replace("nodes.lattice = { spacing = 1,", "nodes.lattice = { spacing = 4,")
        .replace("nodes.lattice = { spacing = 0.5,", "nodes.lattice = { spacing = 2,")
        .replace("nodes.lattice = { spacing = 0.14,", "nodes.lattice = { spacing = 0.4,")
}

/// A third, unless all is to be tested.
fn cases() -> u32 {
    if std::env::var_os("LICHTENBERG_TEST_ALL").is_some() { 3000 } else { 500 }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    #[test]
    fn mutated_scenes_do_no_harm(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..8_u8), 1..4),
    ) {
        let scenes = embedded_scenes();
        let (name, text, folder) = which.get(&scenes).clone();
        let mut tokens: Vec<String> = Vec::new();
        for c in small(text).chars() {
            let joins = |last: &String| c.is_alphanumeric() && last.ends_with(|l: char| l.is_alphanumeric());
            match tokens.last_mut() {
                Some(last) if joins(last) => last.push(c),
                _ => tokens.push(c.to_string()),
            }
        }
        for (at, word, how) in changes {
            let at = at.index(tokens.len());
            let other = word.index(tokens.len());
            match how {
                0 => tokens[at] = (*word.get(WORDS)).to_owned(),
                1 => tokens[at] = String::new(),
                2 => tokens[at] = tokens[other].clone(),
                3 => tokens.swap(at, other),
                // Numbers for numbers: many of these scenes are good, or wrong only further in.
                _ => {
                    let is_number = |t: &String| t.starts_with(|c: char| c.is_ascii_digit());
                    let numbers: Vec<usize> = (0..tokens.len()).filter(|&i| is_number(&tokens[i])).collect();
                    let (to, from) = (numbers[at % numbers.len()], numbers[other % numbers.len()]);
                    tokens[to] = if how < 6 { tokens[from].clone() } else { NUMBERS[other % NUMBERS.len()].to_owned() };
                }
            }
        }
        let source = Source { name, text: tokens.concat(), folder };
        match load(&source, &[]) {
            Err(error) => prop_assert!(!error.mistakes.is_empty() && !error.to_string().is_empty()),
            Ok(scene) => {
                if let Ok(grown) = grow(&scene, &[], 32 << 20, &Progress::default())
                    && let Ok(model) = model(&scene, &grown, [64, 48], &Progress::default())
                {
                    let mut out = Vec::new();
                    Pov::new(&model, &Templates::default(), "x", [64, 48], &Origin::default()).write_inc(&mut out).unwrap();
                    let text = String::from_utf8(out).unwrap();
                    // Comments hold the scene's own words.
                    let is_number = |line: &&str| !line.trim_start().starts_with("//");
                    prop_assert!(text.lines().filter(is_number).all(|l| !l.contains("NaN") && !l.contains("inf")));
                }
            }
        }
    }
}
