//! Growth by segments: every number that Amin's paper gives, the same plant on any number of threads, and bad input of growth
//! by segments and by voxels.

use std::fs;

use crate::support::plants::{degrees, grown, load_text, only, scene, way};
use crate::support::{embedded, refuses, run_in, text};
use lichtenberg::files::embedded_scenes;
use lichtenberg::grow::{Segments, Step};
use lichtenberg::math::DVec3;
use lichtenberg::scene::{Override, Source, load_frame};
use lichtenberg::skeleton::{Skeleton, measure};

/// Angle of `v` about `axis`, from a direction that depends on the axis alone, in degrees from 0 to 360.
fn roll(v: DVec3, axis: DVec3) -> f64 {
    let x = (DVec3::new(0.3, 0.5, 0.8) - axis * axis.dot(DVec3::new(0.3, 0.5, 0.8))).normalize();
    libm::atan2(v.dot(axis.cross(x)), v.dot(x)).to_degrees().rem_euclid(360.0)
}

/// Chi-squared of samples against an even distribution over a range, in ten bins: 9 degrees of freedom, 27.9 is one in a
/// thousand.
fn unevenness(samples: &[f64], [low, high]: [f64; 2]) -> f64 {
    let mut bins = [0_u32; 10];
    for x in samples {
        bins[((x - low) / (high - low) * 10.0).clamp(0.0, 9.9) as usize] += 1;
    }
    let expected = samples.len() as f64 / 10.0;
    bins.iter().map(|&n| (f64::from(n) - expected) * (f64::from(n) - expected) / expected).sum()
}

/// "The vector is rotated between 0 and 10 degrees about the y-axis, and then rotated between 0 and 360 degrees about the
/// z-axis": a stem of steps of 5.
#[test]
fn a_stem_strays_by_up_to_ten_degrees() {
    let s = only("[grow.stem]\nfrom.at = [[0, 0, 0]]\nby.segments = { depth = 5000 }\nwidth.constant = 1\n");
    assert_eq!((s.nodes.len(), s.paths.len()), (5001, 1));
    let ways: Vec<DVec3> = (1..5001).map(|i| way(&s, i).unwrap()).collect();
    assert!(degrees(ways[0], DVec3::Z) <= 10.0, "it starts upwards");
    for i in 1..5001 {
        assert_eq!(s.nodes[i].parent, Some(i as u32 - 1));
        let step = s.nodes[i].position.distance(s.nodes[i - 1].position);
        assert!((step - 5.0).abs() < 1e-9 && (s.nodes[i].cost - 5.0 * i as f64).abs() < 1e-9, "{step}");
    }
    let angles: Vec<f64> = ways.windows(2).map(|pair| degrees(pair[0], pair[1])).collect();
    assert!(angles.iter().all(|&a| a <= 10.0 + 1e-6));
    let rolls: Vec<f64> = ways.windows(2).map(|pair| roll(pair[1], pair[0])).collect();
    let uneven = (unevenness(&angles, [0.0, 10.0]), unevenness(&rolls, [0.0, 360.0]));
    assert!(uneven.0 < 27.9 && uneven.1 < 27.9, "{uneven:?}");
}

/// "When the stem hits the edge of the bounding box, the stem stops growing."
#[test]
fn stems_stop_at_the_bounding_box() {
    let s = only(
        "[grow.plant]\nfrom.at = [[0, 0, 0]]\nby.segments = { depth = 60, branches = { chance = 0.15 }, inside.box = { min = [-60, -60, 0], max = [60, 60, 120] } }\nwidth.constant = 1\n",
    );
    let is_in = |p: DVec3| p.x.abs() <= 60.0 && p.y.abs() <= 60.0 && (0.0..=120.0).contains(&p.z);
    assert!(s.nodes.len() > 200 && s.nodes.iter().all(|n| is_in(n.position)));
    let mut stopped = 0;
    for path in &s.paths {
        let end = s.nodes[path.end as usize];
        if end.cost < 299.0 {
            stopped += 1;
            let p = end.position;
            let room = [60.0 - p.x.abs(), 60.0 - p.y.abs(), p.z, 120.0 - p.z].into_iter().fold(f64::INFINITY, f64::min);
            assert!(room <= 5.0, "a limb stopped {room} from the edge");
        }
    }
    assert!(stopped > 10);
}

/// Branches at 40 to 60 degrees; a limb's next one at least 90 degrees round from its last, anywhere in the arc opposite to it.
#[test]
fn branches_leave_at_their_angle_and_avoid_the_last() {
    let seeds: Vec<String> = (0..150).map(|i| format!("[{i}, 0, 0]")).collect();
    let s = only(&format!(
        "[grow.plant]\nfrom.at = [{}]\nby.segments = {{ depth = 14, branches = {{ most = 1, chance = 0.3 }} }}\nwidth.constant = 1\n",
        seeds.join(", ")
    ));
    let (mut angles, mut turns) = (Vec::new(), Vec::new());
    // The last branch of each limb; limbs come in the order in which they began.
    let mut last: Vec<Option<DVec3>> = vec![None; s.paths.len()];
    for limb in s.limbs() {
        let Some((from, of)) = limb.leaves else { continue };
        let branch = way(&s, limb.nodes[0]).unwrap();
        // The first step is up from nowhere.
        let axis = way(&s, from).unwrap_or(DVec3::Z);
        angles.push(degrees(branch, axis));
        let flat = |v: DVec3| (v - axis * axis.dot(v)).normalize();
        if let Some(before) = last[of as usize] {
            let turn = (roll(branch, axis) - roll(-flat(before), axis) + 180.0).rem_euclid(360.0) - 180.0;
            assert!(turn.abs() <= 90.0 + 1e-6, "{turn}");
            assert!(degrees(flat(branch), flat(before)) >= 90.0 - 1e-6);
            turns.push(turn);
        }
        last[of as usize] = Some(branch);
    }
    assert!(angles.len() > 2000 && turns.len() > 1000, "{} {}", angles.len(), turns.len());
    assert!(angles.iter().all(|a| (40.0 - 1e-6..=60.0 + 1e-6).contains(a)));
    let uneven = (unevenness(&angles, [40.0, 60.0]), unevenness(&turns, [-90.0, 90.0]));
    assert!(uneven.0 < 27.9 && uneven.1 < 27.9, "{uneven:?}");
}

/// "Maximum number of branches = 2 and branch probability = 50%: a 25% chance of no branches, 50% chance of one branch, and 25%
/// chance of two"; ends are `(1 + 2 * 0.5)^depth` on the average, and nodes what is computed before.
#[test]
fn branches_are_binomial() {
    for (most, chance, shares) in [(2, 0.5, vec![0.25, 0.5, 0.25]), (3, 0.2, vec![0.512, 0.384, 0.096, 0.008])] {
        let seeds: Vec<String> = (0..400).map(|i| format!("[{i}, 0, 0]")).collect();
        let plant = scene(&format!(
            "[grow.plant]\nfrom.at = [{}]\nby.segments = {{ depth = 5, branches = {{ most = {most}, chance = {chance} }} }}\nwidth.constant = 1\n",
            seeds.join(", ")
        ));
        let s = grown(&plant).remove(0).skeleton;
        let children = s.child_counts();
        let mut counts = vec![0_u32; shares.len()];
        for (node, &children) in s.nodes.iter().zip(&children).filter(|(node, _)| node.cost < 24.0) {
            assert!(node.cost <= 20.0 && children > 0, "without a box every limb goes on");
            counts[children as usize - 1] += 1;
        }
        let all = f64::from(counts.iter().sum::<u32>());
        let chi2: f64 = counts
            .iter()
            .zip(&shares)
            .map(|(&n, share)| (f64::from(n) - share * all) * (f64::from(n) - share * all) / (share * all))
            .sum();
        assert!(chi2 < 16.3, "{counts:?} of {all}: {chi2} over {} degrees of freedom", shares.len() - 1);
        let growth = 1.0 + f64::from(most) * chance;
        let after = |times: usize| 400.0 * std::iter::repeat_n(growth, times).product::<f64>();
        let ends = after(5);
        assert!((s.paths.len() as f64 / ends - 1.0).abs() < 0.06, "{} of {ends}", s.paths.len());
        let segments = segments(&plant.recipe.steps[0]);
        let expected = segments.expected(segments.starts);
        assert!((expected.ends - ends).abs() < 1e-6);
        let nodes: f64 = (0..=5).map(after).sum();
        assert!((expected.nodes - nodes).abs() < 1e-6);
    }
}

/// The direction of growth that an attractor along `a` drew to `d`: (1 - strength) g = length d - strength a with |g| = 1, the
/// larger root.
fn undrawn(d: DVec3, a: DVec3, strength: f64) -> DVec3 {
    let along = strength * d.dot(a);
    let length = along + (along * along - strength * strength + (1.0 - strength) * (1.0 - strength)).sqrt();
    (d * length - a * strength) / (1.0 - strength)
}

/// `strength * attractor_dir + (1 - strength) * growth_dir`, renormalised to the step: what is left of each step without the
/// attractor's share lies within the cone of 10 degrees, evenly.
#[test]
fn attractors_follow_the_formula() {
    for strength in [0.0, 0.05, 0.4, 1.0] {
        let s = only(&format!(
            "[grow.stem]\nfrom.at = [[0, 0, 0]]\nby.segments = {{ depth = 400 }}\ntoward = {{ at = [900, 300, -700], strength = {strength} }}\nwidth.constant = 1\n",
        ));
        let goal = DVec3::new(900.0, 300.0, -700.0);
        let mut angles = Vec::new();
        for i in 1..s.nodes.len() {
            let from = s.nodes[i - 1].position;
            let step = s.nodes[i].position - from;
            assert!((step.length() - 5.0).abs() < 1e-9);
            let (d, a) = (step.normalize(), (goal - from).normalize());
            if strength == 1.0 {
                assert!(degrees(d, a) < 1e-4);
                continue;
            }
            let g = undrawn(d, a, strength);
            let before = way(&s, i as u32 - 1).unwrap_or(DVec3::Z);
            angles.push(degrees(g, before));
        }
        assert!(angles.iter().all(|&a| a <= 10.0 + 1e-5), "{strength}");
        assert!(strength == 1.0 || unevenness(&angles, [0.0, 10.0]) < 27.9);
    }
    let reach = |strength: f64| {
        let s = only(&format!(
            "[grow.stem]\nfrom.at = [[0, 0, 0]]\nby.segments = {{ depth = 100 }}\ntoward = {{ at = [0, 0, -9000], strength = {strength} }}\nwidth.constant = 1\n",
        ));
        s.nodes[100].position.z
    };
    assert!(reach(0.2) < reach(0.02), "a stronger one draws more");
}

/// Trunk, limbs and twigs: each starts where the one before ended, with its way and the memory of its last branch; branches as a
/// segment of their own leave the trunk all the way up.
#[test]
fn segments_carry_each_other_on() {
    let all = grown(&scene(
        "[grow.a_trunk]\nfrom.at = [[0, 0, 0]]\nby.segments = { depth = 40, jitter = [0, 3] }\nwidth.constant = 2\n\
         [grow.b_limbs]\nfrom.all = \"a_trunk\"\nby.segments = { depth = 3, sprout = { most = 2, chance = 0.5, angle = [50, 70] }, branches = { chance = 0.5 } }\nwidth.constant = 1\n\
         [grow.c_twigs]\nfrom.ends = \"b_limbs\"\nby.segments = { depth = 1, branches = { most = 3, chance = 1 } }\nwidth.constant = 3\n",
    ));
    let [trunk, limbs, twigs] = [0, 1, 2].map(|i| &all[i].skeleton);
    let roots: Vec<u32> = (0..limbs.nodes.len() as u32).filter(|&i| limbs.nodes[i as usize].parent.is_none()).collect();
    assert!((20..=40).contains(&roots.len()), "{}", roots.len());
    let mut before: Option<DVec3> = None;
    for &root in &roots {
        let place = trunk.nodes.iter().position(|n| n.position == limbs.nodes[root as usize].position).unwrap();
        assert!(place < 40, "a tip does not grow on, so nothing sprouts there");
        let axis = way(trunk, place as u32).unwrap_or_else(|| way(trunk, 1).unwrap());
        let sprouts: Vec<DVec3> = (0..limbs.nodes.len() as u32)
            .filter(|&i| limbs.nodes[i as usize].parent == Some(root))
            .map(|i| way(limbs, i).unwrap())
            .collect();
        assert!((1..=2).contains(&sprouts.len()));
        for sprout in sprouts {
            assert!((50.0 - 1e-6..=70.0 + 1e-6).contains(&degrees(sprout, axis)));
            let flat = |v: DVec3| (v - axis * axis.dot(v)).normalize();
            assert!(before.is_none_or(|before| degrees(flat(sprout), flat(before)) >= 90.0 - 1e-6));
            before = Some(sprout);
        }
    }
    let deepest = |s: &Skeleton| s.nodes.iter().map(|n| n.cost).fold(0.0, f64::max);
    assert!((deepest(limbs) - 15.0).abs() < 1e-9 && (deepest(twigs) - 5.0).abs() < 1e-9);
    // Every end carries on, straight but for 10 degrees, with three branches beside.
    assert_eq!(twigs.paths.len(), 4 * limbs.paths.len());
    let limb_ends: Vec<u32> = limbs.paths.iter().map(|path| path.end).collect();
    for (i, &end) in limb_ends.iter().enumerate() {
        let root = twigs.nodes[i];
        assert_eq!((root.parent, root.position), (None, limbs.nodes[end as usize].position));
        assert!(root.radius <= 1.0, "no wider than what it grows from");
        let axis = way(limbs, end).unwrap();
        let mut angles: Vec<f64> = (0..twigs.nodes.len() as u32)
            .filter(|&n| twigs.nodes[n as usize].parent == Some(i as u32))
            .map(|n| degrees(way(twigs, n).unwrap(), axis))
            .collect();
        angles.sort_by(f64::total_cmp);
        assert!(angles.len() == 4 && angles[0] <= 10.0 + 1e-6 && angles[1] >= 40.0 - 1e-6, "{angles:?}");
    }
    assert!(twigs.nodes.iter().all(|n| n.age > limbs.nodes[0].age), "what grows later is younger");
}

/// A limb remembers its last branch into the next segment, and through one without branches.
#[test]
fn the_next_segment_remembers_the_last_branch() {
    let seeds: Vec<String> = (0..60).map(|i| format!("[{}, 0, 0]", i * 100)).collect();
    let branching = "by.segments = { depth = 1, branches = { chance = 1 } }\nwidth.constant = 1";
    let bare = "[grow.b]\nfrom.ends = \"a\"\nby.segments = { depth = 1 }\nwidth.constant = 1\n";
    for (between, from) in [("", "a"), (bare, "b")] {
        let all = grown(&scene(&format!(
            "[grow.a]\nfrom.at = [{}]\n{branching}\n{between}[grow.c]\nfrom.ends = \"{from}\"\n{branching}\n",
            seeds.join(", ")
        )));
        let [first, before, last] = [0, all.len() - 2, all.len() - 1].map(|i| &all[i].skeleton);
        let mut checked = 0;
        for limb in first.limbs() {
            let Some((_, of)) = limb.leaves else { continue };
            let branch = way(first, limb.nodes[0]).unwrap();
            // The start of the stem in the next segment has the same place in the list.
            let stem = before.paths[of as usize].end;
            let axis = way(before, stem).unwrap();
            let children: Vec<u32> =
                (0..last.nodes.len() as u32).filter(|&n| last.nodes[n as usize].parent == Some(of)).collect();
            let root = last.nodes[of as usize].position;
            assert_eq!((children.len(), root), (2, before.nodes[stem as usize].position));
            let next = way(last, children[1]).unwrap();
            let flat = |v: DVec3| (v - axis * axis.dot(v)).normalize();
            assert!(degrees(flat(next), flat(branch)) >= 90.0 - 1e-6);
            checked += 1;
        }
        assert_eq!(checked, 60);
    }
}

/// Branches are drawn to the attractor as stems are: without its share they leave at their angle and avoid the last one.
#[test]
fn branches_follow_the_attractor_too() {
    let (strength, goal) = (0.3, DVec3::new(40.0, 10.0, 30.0));
    let s = only(&format!(
        "[grow.plant]\nfrom.at = [[0, 0, 0], [60, 0, 0]]\nby.segments = {{ depth = 12, branches = {{ chance = 0.5 }} }}\ntoward = {{ at = [40, 10, 30], strength = {strength} }}\nwidth.constant = 1\n"
    ));
    let mut last: Vec<Option<DVec3>> = vec![None; s.paths.len()];
    let mut turns = 0;
    for limb in s.limbs() {
        let Some((from, of)) = limb.leaves else { continue };
        let there = (goal - s.nodes[from as usize].position).normalize();
        let drawn = undrawn(way(&s, limb.nodes[0]).unwrap(), there, strength);
        let axis = way(&s, from).unwrap_or(DVec3::Z);
        let angle = degrees(drawn, axis);
        assert!((40.0 - 1e-5..=60.0 + 1e-5).contains(&angle), "{angle}");
        let flat = |v: DVec3| (v - axis * axis.dot(v)).normalize();
        if let Some(before) = last[of as usize].replace(drawn) {
            assert!(degrees(flat(drawn), flat(before)) >= 90.0 - 1e-4);
            turns += 1;
        }
    }
    assert!(turns > 100, "{turns}");
}

/// Smoothing adds nodes; limbs sprout at those that grew.
#[test]
fn smoothing_adds_no_sprouts() {
    let mut most = 0;
    for smooth in [0, 1, 2] {
        let all = grown(&scene(&format!(
            "[grow.a]\nfrom.at = [[0, 0, 0]]\nby.segments = {{ depth = 30, jitter = [0, 60] }}\nsmooth = {smooth}\nwidth.constant = 1\n\
             [grow.b]\nfrom.all = \"a\"\nby.segments = {{ depth = 1, sprout = {{ chance = 1 }} }}\nwidth.constant = 1\n"
        )));
        assert_eq!(all[1].skeleton.paths.len(), 30, "{smooth}");
        most = most.max(all[0].skeleton.nodes.len());
    }
    assert!(most > 31, "smoothing adds nodes");
}

/// How a step grows by segments.
fn segments(step: &Step) -> &Segments {
    let method: &dyn std::any::Any = step.method.as_ref();
    method.downcast_ref().expect("segments")
}

/// What each segment starts from is expected from the one before: the product over all, times the parts of a symmetry.
#[test]
fn expectations_multiply() {
    let plant = scene(
        "[grow.a]\nfrom.at = [[1, 0, 0], [2, 0, 0]]\nby.segments = { depth = 3, branches = { most = 2, chance = 0.5 } }\nsymmetry = { fold = 6 }\nwidth.constant = 1\n\
         [grow.b]\nfrom.ends = \"a\"\nby.segments = { depth = 2, branches = { chance = 0.5 } }\nwidth.constant = 1\n\
         [grow.c]\nfrom.all = \"b\"\nby.segments = { depth = 2, sprout = { most = 3, chance = 1 }, branches = { chance = 1 } }\nwidth.constant = 1\n",
    );
    let [a, b, c] = [0, 1, 2].map(|i| segments(&plant.recipe.steps[i]));
    // 2 * 2^3 ends, six times; the limbs of b grow on at their starts and at (1 + 0.5) nodes after one step.
    assert_eq!((a.starts, b.starts), (2.0, 96.0));
    assert!((c.starts - 96.0 * 2.5).abs() < 1e-9, "{}", c.starts);
    assert!((c.expected(c.starts).ends - 96.0 * 2.5 * 3.0 * 2.0).abs() < 1e-9);
    // A symmetry of what is small enough without it is counted too.
    let sixfold = "[grow.a]\nfrom.at = [[1, 0, 0]]\nby.segments = { depth = 14, branches = { most = 2, chance = 1 } }\nsymmetry = { fold = 6 }\nwidth.constant = 1\n";
    let error = load_text(sixfold).unwrap_err();
    assert!(error.to_string().contains("4.30e7 nodes are to be expected of all steps"), "{error}");
    // Many steps that each start from the ends of all before are counted once each.
    let chain: String = (0..40)
        .map(|i| {
            let from: Vec<String> = (0..i).map(|j| format!("\"s{j:02}\"")).collect();
            let from = if i == 0 { "from.at = [[0, 0, 0]]".to_owned() } else { format!("from.every_end = [{}]", from.join(", ")) };
            let width = if i == 0 { "width.constant = 1" } else { "width.constant = 0.5" };
            format!("[grow.s{i:02}]\n{from}\nby.segments = {{ depth = 1, inside.box = {{ min = [-9, -9, 0], max = [9, 9, 1] }} }}\n{width}\n")
        })
        .collect();
    let error = load_text(&chain).unwrap_err();
    assert!(error.to_string().contains("nodes are to be expected"), "2^38 starts: {error}");
}

fn frame(name: &str, step: usize, frame: f64) -> Skeleton {
    let (name, text, folder) = embedded_scenes().into_iter().find(|(n, ..)| n == name).unwrap();
    // Smoothing adds nodes where limbs bend, and the form of whole plants too.
    let plain = [("plant.smooth", "0"), ("stem.width", "{ constant = 1 }"), ("plant.width", "{ constant = 1 }")]
        .map(|(key, value)| Override { path: format!("grow.{key}"), value: value.to_owned() });
    let scene = load_frame(&Source { name, text: text.to_owned(), folder }, &plain, Some(frame)).unwrap();
    grown(&scene).swap_remove(step).skeleton
}

/// Fig. 4: the same plant, limb for limb, to the right, above, to the left.
#[test]
fn a_plant_follows_its_attractor() {
    let frames = [1.0, 2.0, 3.0].map(|f| frame("papers/amin-fig4", 0, f));
    let lean = frames.each_ref().map(|s| measure(s).lean);
    assert!(lean[0] > 0.4 && lean[1].abs() < 0.25 && lean[2] < -0.4, "{lean:?}");
    let parents = |s: &Skeleton| s.nodes.iter().map(|n| n.parent).collect::<Vec<_>>();
    assert!(parents(&frames[0]).len() > 100);
    assert!(frames.windows(2).all(|pair| parents(&pair[0]) == parents(&pair[1])));
    assert_ne!(frame("papers/amin-fig4", 0, 1.5).nodes, frames[0].nodes, "between keys it moves on");
    // The attractor itself is shown: a change of the first item of a list.
    let sun = [1.0, 2.0, 3.0].map(|f| frame("papers/amin-fig4", 2, f).nodes[0].position);
    assert!(sun[0].x == -sun[2].x && sun[1].x == 0.0 && sun[0].x > 50.0, "{sun:?}");
}

/// "Slaves may get nodes in different orders": here any number of threads grows the same plant.
#[test]
fn threads_do_not_change_a_plant() {
    let plant = "[grow.trunk]\nfrom.at = [[0, 0, 0]]\nby.segments = { depth = 4, branches = { chance = 0.5 } }\nwidth.constant = 1\n\
        [grow.twigs]\nfrom.ends = \"trunk\"\nby.segments = { depth = 14, branches = { most = 2, chance = 0.4 }, inside.box = { min = [-70, -70, -70], max = [70, 70, 70] } }\nwidth.pipe = { root = 1 }\ntoward = { at = [0, 0, 500], strength = 0.1 }\n\
        [grow.sprouts]\nfrom.all = \"twigs\"\nby.segments = { depth = 2, sprout = { most = 3, chance = 0.2 } }\nwidth.constant = 0.2\n";
    for scene in [scene(plant), embedded("ivy", &[]), embedded("race-for-light", &[])] {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| grown(&scene).into_iter().map(|g| g.skeleton).collect::<Vec<_>>())
        };
        let one = on(1);
        assert!(one.iter().map(|s| s.nodes.len()).sum::<usize>() > 1500);
        assert!([2, 3].iter().all(|&threads| on(threads) == one), "{}", scene.recipe.title);
    }
}

/// A twig of another plant changes nothing: random numbers come from the way to a node alone.
#[test]
fn limbs_have_random_numbers_of_their_own() {
    let plant = |more: &str, inside: &str| {
        only(&format!(
            "[grow.plant]\nfrom.at = [[0, 0, 0]{more}]\nby.segments = {{ depth = 9, branches = {{ chance = 0.4 }}{inside} }}\nwidth.constant = 1\n"
        ))
    };
    let (alone, both) = (plant("", ""), plant(", [500, 0, 0]", ""));
    assert!(alone.nodes.iter().all(|n| both.nodes.iter().any(|m| m.position == n.position)));
    // No two limbs have the same: neither branches and their stems, nor one seed's and another's, nor the next segment's.
    let all = grown(&scene(
        "[grow.a]\nfrom.at = [[0, 0, 0], [100, 0, 0], [200, 0, 0]]\nby.segments = { depth = 4, branches = { most = 3, chance = 0.9 } }\nwidth.constant = 1\n\
         [grow.b]\nfrom.ends = \"a\"\nby.segments = { depth = 2, branches = { most = 2, chance = 0.9 } }\nwidth.constant = 1\n",
    ));
    for s in [&all[0].skeleton, &all[1].skeleton] {
        let names: std::collections::BTreeSet<u64> = s.paths.iter().map(|path| path.name).collect();
        assert!(names.len() > 300 && names.len() == s.paths.len(), "{} of {}", names.len(), s.paths.len());
    }
    // What a box cuts off leaves the rest as it is.
    let cut = plant("", ", inside.box = { min = [-100, -100, 0], max = [1, 100, 100] }");
    assert!(cut.nodes.len() < alone.nodes.len() && cut.nodes.len() > 3);
    assert!(cut.nodes.iter().all(|n| alone.nodes.iter().any(|m| m.position == n.position)));
}

/// Amin's three outputs: trunk, limbs and twigs are objects of their own, with materials of their own.
#[test]
fn each_segment_is_an_object() {
    for figure in ["papers/amin-fig1", "papers/amin-fig2", "papers/amin-fig3"] {
        let folder = tempfile::tempdir().unwrap();
        let output = run_in(folder.path(), &["export", figure, "--to", "pov", "-o", "."]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let inc = crate::support::files_below(folder.path(), "inc").remove(0);
        let inc = fs::read_to_string(inc).unwrap();
        for name in ["Trunk", "Limbs", "Twigs"] {
            assert!(
                inc.lines().any(|line| line.starts_with("#declare") && line.contains(name)),
                "{figure} has no {name}"
            );
        }
    }
}

/// Every mistake is one clear error that names its place.
#[test]
fn bad_input_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let base = r#"
title = "Plant"
[space.air]
shape.box = { min = [-1, -1, 0], max = [1, 1, 2] }
nodes.voxels = { side = 0.1 }
[grow.ivy]
space = "air"
from.at = [[0, 0, 0.1]]
by.voxels = { step = 0.2, rounds = 9 }
width.constant = 0.02
[grow.stem]
from.at = [[0, 0, 0]]
by.segments = { depth = 5 }
width.constant = 0.1
[object.plant]
grow = ["ivy", "stem"]
"#;
    let segments = "by.segments = { depth = 5 }";
    let voxels = "by.voxels = { step = 0.2, rounds = 9 }";
    // Twelve steps that all start from each other's ends.
    let circle: String = (0..12)
        .map(|i| {
            let others: Vec<String> = (0..12).filter(|j| *j != i).map(|j| format!("\"c{j}\"")).collect();
            format!(
                "[grow.c{i}]\nfrom.every_end = [{}]\nby.segments = {{ depth = 1 }}\nwidth.constant = 0.1\n",
                others.join(", ")
            )
        })
        .collect();
    for (from, to, place, says) in [
        (
            segments,
            "by.segments = { depth = 12, branches = { most = 14, chance = 0.9 } }",
            "grow.stem.by.segments",
            "4.32e13 nodes are to be expected (1 starts with (1 + 14 * 0.9)^12 ends each), more than 40000000",
        ),
        (
            segments,
            "by.segments = { depth = 5, jitter = [10, 0] }",
            "grow.stem.by.segments.jitter",
            "the least comes first",
        ),
        (
            segments,
            "by.segments = { depth = 5, heading = [0, 0, 0] }",
            "grow.stem.by.segments.heading",
            "not the zero vector",
        ),
        (
            segments,
            "by.segments = { depth = 5, sprout = { chance = 1 } }",
            "grow.stem.by.segments.sprout",
            "needs `from.all`",
        ),
        (segments, "by.segments = { depth = 5 }\nspace = \"air\"", "grow.stem.space", "has no space"),
        (segments, "by.segments = { depth = 5 }\nrepeat = { times = 2 }", "grow.stem.repeat", "has no `repeat`"),
        (
            segments,
            "by.segments = { depth = 5, inside.box = { min = [1, 1, 1], max = [2, 2, 2] } }",
            "grow.stem.from.at",
            "starts outside of `inside`",
        ),
        ("from.at = [[0, 0, 0]]", "from.all = \"ivy\"", "grow.stem.from.all", "by.segments.sprout"),
        ("from.at = [[0, 0, 0]]", "from.inside = \"air\"", "grow.stem", "air"),
        ("space = \"air\"", "", "grow.ivy.space", "needs a `space`"),
        (voxels, "to.x = { count = 1 }", "grow.ivy.space", "nothing but growth `by.voxels`"),
        (voxels, "by.voxels = { step = 0.2, rounds = 9 }\nto.x = { count = 1 }", "grow.ivy.to", "has no `to`"),
        (
            voxels,
            "by.voxels = { step = 0.2, rounds = 9, light = { sun = { latitude = 80, day = 355, hours = [9, 15] } } }",
            "grow.ivy.by.voxels.light.sun",
            "below the horizon",
        ),
        (
            voxels,
            "by.voxels = { step = 0.2, rounds = 9, branches = { age = [9, 2] } }",
            "grow.ivy.by.voxels.branches.age",
            "the least comes first: [2, 9]",
        ),
        ("side = 0.1", "side = 0.0001", "space.air.nodes.voxels", "20000 x 20000 x 20000 voxels are too many"),
        ("side = 0.1 }", "side = 0.1 }\nweights = { max = 5 }", "space.air.weights", "voxels have no `weights`"),
        (
            "nodes.voxels = { side = 0.1 }",
            "nodes.lattice = { spacing = 0.1, neighbours = 6 }",
            "grow.ivy.space",
            "`nodes.voxels`",
        ),
        ("from.at = [[0, 0, 0.1]]", "from.at = [[0, 0, 5]]", "grow.ivy.from", "starts outside of the space"),
        ("from.at = [[0, 0, 0.1]]", "from.all = \"stem\"", "grow.ivy.from.all", "at points or at ends"),
        (
            segments,
            "by.segments = { depth = 10, branches = { most = 2, chance = 1 } }\nwidth.constant = 0.1\n[grow.twigs]\nfrom.ends = \"stem\"\nby.segments = { depth = 8, branches = { most = 2, chance = 1 } }",
            "grow.twigs.by.segments",
            "(59049 starts with (1 + 2 * 1)^8 ends each), more than 40000000",
        ),
        (
            segments,
            "by.segments = { depth = 14, branches = { most = 2, chance = 1 } }\nwidth.constant = 0.1\n[grow.twigs]\nfrom.ends = \"stem\"\nby.segments = { depth = 2, branches = { chance = 1 } }",
            "grow",
            "4.07e7 nodes are to be expected of all steps by segments",
        ),
        (
            "from.at = [[0, 0, 0.1]]",
            "from.at = [[0, 0, 0.1], [0.04, 0, 0.1]]",
            "grow.ivy.from",
            "nothing grows: every direction leads",
        ),
        (
            voxels,
            "by.voxels = { step = 0.2, rounds = 9, cling = { to.sphere = { centre = [0, 0, 1], radius = 0.5 }, within = [0.02, 0.02] } }",
            "grow.ivy.from",
            "no place lies within `cling.within`",
        ),
        (
            segments,
            &format!(
                "by.segments = {{ depth = 5 }}\nwidth.constant = 0.1\n{}[grow.last]\nfrom.at = [[0, 0, 0]]\nby.segments = {{ depth = 1 }}",
                circle
            ),
            "grow",
            "wait",
        ),
    ] {
        refuses(folder.path(), base, [from, to], place, says);
    }
}
