//! Every embedded scene: what it claims, and the same bytes everywhere.

use crate::support::{embedded, scene_names};
use lichtenberg::export::{Origin, Pov, SvgOptions, Templates, write_svg};
use lichtenberg::math::Progress;
use lichtenberg::scene::{Resolved, check_claims, grow, model};

/// What the scene's exported files are, in one number: FNV-1a over the include file and the schematic.
fn digest(scene: &Resolved) -> u64 {
    let grown = grow(scene, &[], u64::MAX, &Progress::default()).unwrap();
    let model = model(scene, &grown, [320, 240]).unwrap();
    let mut bytes = Vec::new();
    let templates = Templates::default();
    let origin = Origin { command: "test".to_owned(), seed: scene.seed };
    Pov::new(&model, &templates, "digest", [320, 240], &origin).write_inc(&mut bytes).unwrap();
    write_svg(&model, SvgOptions { size: [320, 240] }, &mut bytes).unwrap();
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn scenes_hold_what_they_claim() {
    let mut claims = 0;
    for name in scene_names() {
        let scene = embedded(&name, &[]);
        let grown = grow(&scene, &[], u64::MAX, &Progress::default()).unwrap();
        let findings = check_claims(&scene, &grown);
        assert_eq!(findings.len(), scene.claims.len(), "{name}: every claim is measured");
        assert!(!findings.is_empty(), "{name} claims nothing");
        for finding in findings {
            claims += 1;
            assert!(
                finding.holds,
                "{name}: {} ({}): {}, not {}",
                finding.claim, finding.says, finding.measured, finding.against
            );
        }
    }
    assert!(claims >= 25);
}

/// A claim must be able to fail: with other weights, those of Fig. 1 and Fig. 2 do.
#[test]
fn claims_can_fail() {
    for (name, change, claim) in [
        ("papers/2008-fig02", ("space.straight.weights.alpha", "3"), "nearly-straight"),
        ("papers/2008-fig01", ("space.centre.field.cost.scale", "0"), "hugs"),
        ("ivy", ("grow.ivy.by.voxels.keep_from.by", "0"), "window"),
        ("ivy", ("grow.ivy.by.voxels.cling.within", "[0.02, 0.2]"), "hugs"),
        ("ivy", ("grow.ivy.by.voxels.rounds", "9"), "corner"),
        ("papers/2008-fig06", ("grow.many.to.tips.stream", "others"), "same"),
        ("cactus", ("space.air.forbid.box", "{ min = [8, 8, 8], max = [9, 9, 9] }"), "stem"),
    ] {
        let changes = if name == "cactus" {
            vec![("space.air.forbid", "{ box = { min = [8, 8, 8], max = [9, 9, 9] } }")]
        } else {
            vec![change]
        };
        let scene = embedded(name, &changes);
        let grown = grow(&scene, &[], u64::MAX, &Progress::default()).unwrap();
        let finding = check_claims(&scene, &grown).into_iter().find(|f| f.claim == claim).unwrap();
        assert!(!finding.holds, "{name}: {claim} holds with {change:?}");
    }
}

/// One and two threads give the same files, and every build gives those of tests/digests.txt: run in the profiles
/// dev, test and release by ./run-tests. UPDATE=1 accepts new digests, which is a new edition for artists.
#[test]
fn files_are_the_same_everywhere() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (one, two) = (pool(1), pool(2));
    let mut lines = String::new();
    for name in scene_names() {
        let scene = embedded(&name, &[]);
        let digests = [one.install(|| digest(&scene)), two.install(|| digest(&scene))];
        assert_eq!(digests[0], digests[1], "{name} depends on the number of threads");
        lines.push_str(&format!("{:016x} {name}\n", digests[0]));
    }
    let path = crate::support::root().join("tests/digests.txt");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &lines).unwrap();
    }
    assert_eq!(lines, std::fs::read_to_string(&path).unwrap_or_default(), "exported files have changed");
}

/// Fig. 6: adding endpoints keeps those already placed, and the paths to them.
#[test]
fn more_endpoints_keep_the_first() {
    let ends = |count: &str| {
        let scene = embedded("elm", &[("grow.elm.to.twigs.count", count), ("grow.elm.smooth", "0")]);
        let grown = grow(&scene, &[], u64::MAX, &Progress::default()).unwrap();
        let skeleton = &grown[0].skeleton;
        skeleton.paths.iter().map(|p| skeleton.nodes[p.end as usize].position).collect::<Vec<_>>()
    };
    let (few, many) = (ends("20"), ends("36"));
    assert_eq!(few[..], many[..few.len()]);
    assert_eq!(many.len(), few.len() + 16);
}
