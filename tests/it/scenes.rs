//! Embedded scenes: what each claims, and the same bytes everywhere.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::LazyLock;

use lichtenberg::grow::Grown;
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{Loaded, check_claims, grow, model};
use rayon::prelude::*;

use crate::support::sample::{sample, tests_all};
use crate::support::{embedded, panic_text, scene_names};

/// What the checks found in a scene; `Err` has what one of them said.
struct Checked {
    digests: Result<String, String>,
    claims: Result<(), String>,
    rib: Result<(), String>,
    plants: Result<usize, String>,
}

/// The scenes that are grown: three tenths of them, other ones with every commit.
static GROWN: LazyLock<Vec<String>> = LazyLock::new(|| sample(scene_names(), scene_names().len() * 3 / 10));

/// The scenes whose RIB, OBJ and PLY are looked at too.
static WHOLE: LazyLock<Vec<String>> = LazyLock::new(|| sample(GROWN.clone(), 12));

/// Each scene is grown once for all checks that want scenes, on two threads; tests/bytes.rs has one.
static CHECKED: LazyLock<Vec<Checked>> = LazyLock::new(|| {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    pool.install(|| GROWN.par_iter().with_max_len(1).map(|name| check(name)).collect())
});

fn check(name: &str) -> Checked {
    let scene = embedded(name, &[]);
    let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
    let model = model(&scene, &grown, [320, 240], &Memory::default(), &Progress::default()).unwrap();
    let is_whole = WHOLE.iter().any(|whole| whole == name);
    Checked {
        digests: told(|| crate::digests::digests(name, &scene, &model, is_whole)),
        claims: told(|| claims_hold(name, &scene, &grown)),
        rib: if is_whole { told(|| crate::rib::reads_back(&model, name)) } else { Ok(()) },
        plants: told(|| crate::irregular::widths_fall(name, &scene, &grown)),
    }
}

/// What a check returns, or the words that it panics with.
fn told<T>(check: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(check)).map_err(|cause| panic_text(&*cause))
}

/// What a check found in the scenes; those where it failed are told together.
fn of_scenes<T>(found: impl Fn(&'static Checked) -> &'static Result<T, String>) -> Vec<&'static T> {
    let (good, bad): (Vec<_>, Vec<_>) = CHECKED.iter().map(|checked| found(checked).as_ref()).partition(Result::is_ok);
    let bad: Vec<&String> = bad.into_iter().filter_map(Result::err).collect();
    assert!(bad.is_empty(), "{bad:#?}");
    good.into_iter().filter_map(Result::ok).collect()
}

fn claims_hold(name: &str, scene: &Loaded, grown: &[Grown]) {
    let findings = check_claims(scene, grown, &Memory::default(), &Progress::default()).unwrap();
    assert_eq!(findings.len(), scene.claims.len(), "{name}: every claim is measured");
    assert!(!findings.is_empty(), "{name} claims nothing");
    for finding in findings {
        assert!(
            finding.holds,
            "{name}: {} ({}): {}, not {}",
            finding.claim, finding.says, finding.measured, finding.against
        );
    }
}

#[test]
fn scenes_hold_what_they_claim() {
    of_scenes(|checked| &checked.claims);
}

/// What a renderer would rebuild from the RIB is what the model says.
#[test]
fn scenes_read_back() {
    of_scenes(|checked| &checked.rib);
}

/// Along every limb of every plant width never grows towards the tip, nor do limbs float.
#[test]
fn width_never_grows_towards_the_tip() {
    let plants: usize = of_scenes(|checked| &checked.plants).into_iter().sum();
    assert!(plants > if tests_all() { 60 } else { 10 }, "{plants}");
}

/// A claim must be able to fail. (Those of the papers' scenes: tests/it/claims.rs.)
#[test]
fn claims_can_fail() {
    for (name, change, claim) in [
        ("ivy", ("grow.ivy.by.voxels.keep_from.by", "0"), "window"),
        ("ivy", ("grow.ivy.by.voxels.cling.within", "[0.02, 0.2]"), "hugs"),
        ("ivy", ("grow.ivy.by.voxels.rounds", "9"), "corner"),
        ("cactus", ("space.air.forbid.box", "{ min = [8, 8, 8], max = [9, 9, 9] }"), "stem"),
    ] {
        let changes = if name == "cactus" {
            vec![("space.air.forbid", "{ box = { min = [8, 8, 8], max = [9, 9, 9] } }")]
        } else {
            vec![change]
        };
        let scene = embedded(name, &changes);
        let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
        let finding = check_claims(&scene, &grown, &Memory::default(), &Progress::default())
            .unwrap()
            .into_iter()
            .find(|f| f.claim == claim)
            .unwrap();
        assert!(!finding.holds, "{name}: {claim} holds with {change:?}");
    }
}

/// The same bytes as tests/digests.txt has, and so as every other build and number of threads gives.
#[test]
fn files_are_the_same_everywhere() {
    let lines: String = of_scenes(|checked| &checked.digests).into_iter().map(String::as_str).collect();
    crate::digests::compare(&lines, WHOLE.len() == scene_names().len());
}

/// Fig. 6: adding endpoints keeps those already placed, and the paths to them.
#[test]
fn more_endpoints_keep_the_first() {
    let ends = |count: &str| {
        let scene = embedded("elm", &[("grow.elm.to.twigs.count", count), ("grow.elm.smooth", "0")]);
        let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
        let skeleton = &grown[0].skeleton;
        skeleton.paths.iter().map(|p| skeleton.nodes[p.end as usize].position).collect::<Vec<_>>()
    };
    let (few, many) = (ends("20"), ends("36"));
    assert_eq!(few[..], many[..few.len()]);
    assert_eq!(many.len(), few.len() + 16);
}
