//! Reports of pictures with any names: JUnit is XML, whatever they hold.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lichtenberg::compare::{Metric, Outcome, Pair, Panel, html, junit};

fuzz_target!(|texts: Vec<(String, String, bool)>| {
    let pairs: Vec<Pair> = texts
        .into_iter()
        .map(|(name, reason, is_failed)| Pair {
            name,
            outcome: if is_failed { Outcome::Failed } else { Outcome::Different },
            reason: Some(reason.clone()),
            measures: None,
            metric: Metric::default(),
            threshold: 0.1,
            changes: vec![reason],
        })
        .collect();
    let xml = junit(&pairs);
    let read = roxmltree::Document::parse(&xml).expect("XML");
    assert_eq!(read.descendants().filter(|node| node.has_tag_name("testcase")).count(), pairs.len());
    let page = html(&pairs.into_iter().map(|pair| (pair, Panel::default())).collect::<Vec<_>>());
    assert!(!page.contains("<script>alert"));
});
