//! What other methods grow, against what their papers say.

use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::grow;
use lichtenberg::skeleton::Skeleton;

use crate::support::embedded;

const LEVELS: &str = "grow.tree.by.weber_penn.levels";

/// The skeleton of Weber and Penn's tree with some changes, as it grows before it takes its form.
fn tree(changes: &[(&str, &str)]) -> Skeleton {
    let scene =
        embedded("baselines/weber-penn", &[&[("grow.tree.form", "{ smoothness = 0, flare = 1 }")], changes].concat());
    let mut grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
    grown.remove(0).skeleton
}

/// Stems are as many as nBranches says, leave the trunk above its bare part alone, and are as long as ShapeRatio allows
/// (Weber and Penn 1995, section 4.3).
#[test]
fn stems_are_as_told() {
    let levels = "[{ length = 1, segments = 10 }, { branches = 12, length = 0.5, segments = 4 }]";
    for seed in ["1", "2", "3"] {
        let tree = tree(&[(LEVELS, levels), ("seed", seed)]);
        assert_eq!(tree.paths.len(), 13, "a trunk and its limbs");
        let top = tree.nodes.iter().filter(|node| node.level == 0).map(|node| node.position.z).fold(0.0, f64::max);
        assert!((top - 8.4).abs() < 1e-9, "the trunk is as high as the scale: {top}");
        for path in tree.paths.iter().filter(|path| tree.nodes[path.end as usize].level == 1) {
            let ways = std::iter::successors(Some(path.end), |&i| tree.nodes[i as usize].parent);
            let limb: Vec<u32> = ways.take_while(|&i| tree.nodes[i as usize].level == 1).collect();
            let foot = tree.nodes[*limb.last().unwrap() as usize].parent.unwrap();
            let foot = tree.nodes[foot as usize].position;
            assert!(foot.z >= 0.42 * 8.4 - 1e-9, "it leaves the bare trunk at {}", foot.z);
            let above = (8.4 - foot.z) / (8.4 * 0.58);
            let most = 8.4 * 0.5 * (0.2 + 0.8 * libm::sin(std::f64::consts::PI * above));
            let length = tree.nodes[path.end as usize].position.distance(foot);
            assert!((length - most).abs() < 1e-6 * most, "a straight limb is {length} long, not {most}");
        }
    }
}

/// 0BaseSplits parts the trunk, and every part bears its share of the limbs.
#[test]
fn trunks_split_at_their_base() {
    let levels = "[{ length = 1, segments = 10, base_splits = 2, split_angle = 25 }, { branches = 30, length = 0.3 }]";
    let tree = tree(&[(LEVELS, levels)]);
    let ends = |level: u16| tree.paths.iter().filter(|path| tree.nodes[path.end as usize].level == level).count();
    assert_eq!(ends(0), 3);
    assert!((28..=32).contains(&ends(1)), "{}", ends(1));
}

/// AttractionUp lifts the ends of stems from the third level on.
#[test]
fn attraction_lifts_branches() {
    let height = |attraction: &str| {
        let tree = tree(&[("grow.tree.by.weber_penn.attraction_up", attraction)]);
        let ends = tree.paths.iter().map(|path| tree.nodes[path.end as usize].position.z);
        ends.sum::<f64>() / tree.paths.len() as f64
    };
    assert!(height("4") > height("0") && height("0") > height("-4"));
}
