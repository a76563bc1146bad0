//! The papers' scenes: their claims hold at any seed, and each can fail.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{Claim, Finding, Stage, check_claims, grow};
use rayon::prelude::*;

use crate::papers::{Measured, keep, measured, papers};
use crate::support::sample::{sample, tests_all};
use crate::support::{embedded, root};

/// The seeds that every scene is held to; a push takes a sample of scenes and seeds.
const SEEDS: [u64; 8] = [1, 2, 3, 4, 5, 6, 7, 8];

/// Is a claim of few growths, or is all asked for? A mean of 64 takes a minute and more.
fn is_quick(claim: &Claim) -> bool {
    tests_all() || claim.seeds as usize <= SEEDS.len()
}

/// What is found of those claims of a scene with some changes that are wanted.
fn found(
    name: &str,
    changes: &[(&str, &str)],
    is_wanted: impl Fn(&str, &Claim) -> bool,
) -> Result<Vec<Finding>, Stage> {
    let mut scene = embedded(name, changes);
    scene.claims.retain(|name, claimed| is_wanted(name, &claimed.claim));
    let (memory, progress) = (Memory::default(), Progress::default());
    let grown = grow(&scene, &[], &memory, &progress)?;
    check_claims(&scene, &grown, &memory, &progress)
}

/// Every claim holds, and is what the table beside the scenes has; with all seeds, UPDATE=1 writes that anew.
#[test]
fn claims_hold_at_any_seed() {
    let runs = papers().into_iter().flat_map(|name| SEEDS.map(|seed| format!("{name}#{seed}"))).collect();
    let all: Vec<(String, Finding)> = sample(runs, 10)
        .par_iter()
        .with_max_len(1)
        .flat_map_iter(|run| {
            let (name, seed) = run.split_once('#').unwrap();
            let findings = found(name, &[("seed", seed)], |_, claim| is_quick(claim))
                .unwrap_or_else(|error| panic!("{run}: {error}"));
            findings.into_iter().map(move |finding| (run.clone(), finding))
        })
        .collect();
    let told =
        |(run, f): &(String, Finding)| format!("{run}: {}: {}, not {} ({})", f.claim, f.measured, f.against, f.says);
    let failed: Vec<String> = all.iter().filter(|(_, finding)| !finding.holds).map(told).collect();
    assert!(failed.is_empty(), "{failed:#?}");
    let key = |run: &str, finding: &Finding| (run.split_once('#').unwrap().0.to_owned(), finding.claim.clone());
    if std::env::var_os("UPDATE").is_some() {
        assert!(tests_all(), "with UPDATE=1 set LICHTENBERG_TEST_ALL=1: the table has all seeds");
        let mut by_claim: BTreeMap<_, Vec<&Finding>> = BTreeMap::new();
        all.iter().for_each(|(run, finding)| by_claim.entry(key(run, finding)).or_default().push(finding));
        keep(&by_claim.into_iter().map(|(key, findings)| (key, Measured::of(&findings))).collect());
    }
    let table = measured();
    let is_other = |(run, finding): &&(String, Finding)| !table[&key(run, finding)].holds(finding.measured);
    let other: Vec<String> = all.iter().filter(is_other).map(told).collect();
    assert!(other.is_empty(), "not as in scenes/papers/measured.tsv: {other:#?}");
}

/// Of the table beside the scenes, which says of each claim what changes of its scene break it.
struct Mutation {
    scene: String,
    claim: String,
    changes: Vec<(String, String)>,
}

fn mutations() -> Vec<Mutation> {
    let text = fs::read_to_string(root().join("scenes/papers/mutations.tsv")).unwrap();
    let row = |line: &str| {
        let [scene, claim, changes @ ..] = &line.split('\t').collect::<Vec<_>>()[..] else { panic!("{line:?}") };
        let parts = |change: &&str| change.split_once('=').map(|(path, value)| (path.to_owned(), value.to_owned()));
        let changes = changes.iter().map(|change| parts(change).unwrap_or_else(|| panic!("{line:?} changes nothing")));
        Mutation { scene: format!("papers/{scene}"), claim: (*claim).to_owned(), changes: changes.collect() }
    };
    text.lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

#[test]
fn every_claim_has_its_mutation() {
    let written: BTreeSet<(String, String)> = mutations().into_iter().map(|m| (m.scene, m.claim)).collect();
    let claims = |name: &String| embedded(name, &[]).claims.into_keys().collect::<Vec<_>>();
    let claimed: BTreeSet<(String, String)> =
        papers().iter().flat_map(|name| claims(name).into_iter().map(|claim| (name.clone(), claim))).collect();
    let [missing, stale] =
        [(&claimed, &written), (&written, &claimed)].map(|(a, b)| a.difference(b).collect::<Vec<_>>());
    assert!(missing.is_empty() && stale.is_empty(), "without a mutation: {missing:?}; without a claim: {stale:?}");
}

/// A claim that survives its mutation says nothing.
#[test]
fn mutations_break_their_claims() {
    let all = mutations();
    let is_quick_one = |m: &&Mutation| is_quick(&embedded(&m.scene, &[]).claims[&m.claim].claim);
    let names = all.iter().filter(is_quick_one).map(|m| format!("{}#{}", m.scene, m.claim)).collect();
    let sampled = sample(names, 12);
    let survived: Vec<String> = sampled
        .par_iter()
        .with_max_len(1)
        .filter(|name| {
            let mutation = all.iter().find(|m| format!("{}#{}", m.scene, m.claim) == **name).unwrap();
            let changes: Vec<_> =
                mutation.changes.iter().map(|(path, value)| (path.as_str(), value.as_str())).collect();
            let findings = found(&mutation.scene, &changes, |claim, _| claim == mutation.claim);
            let findings = findings.unwrap_or_else(|error| panic!("{name}: {error}"));
            findings[0].holds
        })
        .cloned()
        .collect();
    assert!(survived.is_empty(), "these hold all the same: {survived:#?}");
}
