//! A sample of the scenes for tests that take long: others with every commit, all for `./run-tests --all`.

use std::process::Command;

/// Scenes that take longer than most others together, and grow as one of them does: for `./run-tests --all`.
const HEAVY: [&str; 8] = [
    "aggregate",
    "forest",
    "ivy-word",
    "oak-summer",
    "papers/2007-fig11",
    "papers/2008-fig10",
    "papers/2012-fig20",
    "papers/2012-fig22",
];

/// Is all to be tested, as by `./run-tests --all`?
pub fn tests_all() -> bool {
    std::env::var_os("LICHTENBERG_TEST_ALL").is_some()
}

/// `size` of the names, none of them a heavy scene's, told on stderr; all with `LICHTENBERG_TEST_ALL` set. What follows a `#` tells
/// several of a scene apart.
pub fn sample(mut names: Vec<String>, size: usize) -> Vec<String> {
    if tests_all() {
        return names;
    }
    let commit = commit();
    names.retain(|name| !HEAVY.contains(&name.split('#').next().unwrap_or_default()));
    names.sort_by_key(|name| hash(&commit, name));
    names.truncate(size);
    super::tell(&format!("sample of {commit}: {}", names.join(", ")));
    names
}

/// The commit that is checked out, or a fixed word where git does not know.
fn commit() -> String {
    let output = Command::new("git").current_dir(super::root()).args(["rev-parse", "HEAD"]).output();
    let output = output.ok().filter(|output| output.status.success());
    output.map_or_else(|| "unknown".to_owned(), |output| super::text(&output.stdout).trim().to_owned())
}

/// FNV-1a over both, then mixed: names that differ in their ends alone get orders of their own.
fn hash(commit: &str, name: &str) -> u64 {
    let bytes = commit.bytes().chain(name.bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325, |h: u64, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    lichtenberg::math::mix(hash)
}

#[test]
fn samples_change_with_the_commit() {
    let names = || (0..100).map(|i| format!("scene-{i}")).collect::<Vec<_>>();
    let order = |commit: &str| {
        let mut names = names();
        names.sort_by_key(|name| hash(commit, name));
        names
    };
    assert_eq!(order("a"), order("a"));
    let first: std::collections::BTreeSet<String> =
        (0..100).flat_map(|i| order(&format!("commit {i}")).into_iter().take(8)).collect();
    assert_eq!(first.len(), 100, "a hundred commits show every scene");
}
