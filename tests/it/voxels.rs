//! Growth by voxels: what the automaton promises.

use crate::support::plants::{degrees, grown, only, scene, way};
use lichtenberg::assemble::bytes_needed;
use lichtenberg::math::{DVec3, Memory, Progress};
use lichtenberg::scene::check_claims;
use lichtenberg::skeleton::{Skeleton, nearest};
use proptest::prelude::*;

/// How far two segments of a skeleton are related: nodes from the nearer to a common ancestor.
fn relation(s: &Skeleton, a: u32, b: u32) -> usize {
    let up = |n: u32| std::iter::successors(Some(n), |&n| s.nodes[n as usize].parent).collect::<Vec<_>>();
    let (one, other) = (up(a), up(b));
    one.iter()
        .enumerate()
        .filter_map(|(i, n)| Some(i.max(other.iter().position(|m| m == n)?)))
        .min()
        .unwrap_or(usize::MAX)
}

/// The least distance between two segments, by samples about the nearest of the samples before.
fn least_distance([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    let (mut middle, mut half, mut least) = ([0.5, 0.5], 0.5, f64::INFINITY);
    for _ in 0..8 {
        let [u0, v0] = middle;
        for i in -5..=5 {
            for j in -5..=5 {
                let [u, v] = [(u0, i), (v0, j)].map(|(at, k)| (at + half * f64::from(k) / 5.0).clamp(0.0, 1.0));
                let apart = (a + (b - a) * u).distance(c + (d - c) * v);
                if apart < least {
                    (least, middle) = (apart, [u, v]);
                }
            }
        }
        half *= 0.35;
    }
    least
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// In voxels limbs stay in the space, out of what is forbidden, where they cling, away from what they keep from, and apart
    /// from each other; they branch at their age.
    #[test]
    fn voxels_keep_their_promises(seed in 0..1000_u32, apart in 0.05..0.14_f64, room in 0.0..3.0_f64) {
        let s = only(&format!(
            "[space.air]\nshape.box = {{ min = [-1.5, -1, 0], max = [1.5, 1, 2] }}\nforbid.sphere = {{ centre = [0, 0, 0.8], radius = 0.7 }}\nnodes.voxels = {{ side = 0.07 }}\n\
             [grow.ivy]\nspace = \"air\"\nfrom.at = [[0.75, 0, 0.7], [-0.75, 0, 0.8], [0, {}, 1]]\nwidth.constant = 0.01\n\
             by.voxels = {{ step = 0.1, rounds = 24, apart = {apart}, room = {room}, straight = 1, branches = {{ age = [2, 4], angle = [50, 80] }}, cling = {{ to.sphere = {{ centre = [0, 0, 0.8], radius = 0.7 }}, within = [0.01, 0.06] }}, keep_from = {{ shape.box = {{ min = [-0.2, -2, 1], max = [0.2, 0, 1.6] }}, by = 0.1 }} }}\n",
            0.71 + f64::from(seed) * 1e-5
        ));
        prop_assert!(s.nodes.len() > 40, "{}", s.nodes.len());
        for node in &s.nodes {
            let p = node.position;
            prop_assert!(p.x.abs() <= 1.5 && p.y.abs() <= 1.0 && (0.0..=2.0).contains(&p.z));
            let d = p.distance(DVec3::new(0.0, 0.0, 0.8)) - 0.7;
            prop_assert!((0.01 - 1e-9..=0.06 + 1e-9).contains(&d), "{}", d);
            if node.parent.is_some() {
                let off = (p - p.clamp(DVec3::new(-0.2, -2.0, 1.0), DVec3::new(0.2, 0.0, 1.6))).length();
                prop_assert!(off >= 0.1 - 1e-9, "{}", off);
            }
        }
        let kin = (apart / 0.1 * 2.0).ceil() as usize + 2;
        let segment = |i: u32| (s.nodes[s.nodes[i as usize].parent.unwrap() as usize].position, s.nodes[i as usize].position);
        let ends: Vec<u32> = (0..s.nodes.len() as u32).filter(|&i| s.nodes[i as usize].parent.is_some()).collect();
        for (k, &i) in ends.iter().enumerate() {
            for &j in &ends[..k] {
                // The nodes before the two, as the rule counts them.
                let [a, b] = [i, j].map(|n| s.nodes[n as usize].parent.unwrap());
                if relation(&s, i, j).min(relation(&s, a, j)).min(relation(&s, i, b)) <= kin {
                    continue;
                }
                let ((a, b), (c, d)) = (segment(i), segment(j));
                let least = least_distance([a, b], [c, d]);
                prop_assert!(least >= apart - 1e-9, "{} and {} are {} apart", i, j, least);
            }
        }
        for limb in s.limbs() {
            let Some((from, of)) = limb.leaves else { continue };
            let own = &s.limbs()[of as usize];
            let place = own.nodes.iter().position(|&n| n == from).unwrap();
            prop_assert!(place > 0 || own.leaves.is_none(), "a limb branches where it has grown");
        }
    }
}

/// Limbs seek the sun of their latitude, and the sky that is left to them.
#[test]
fn growth_seeks_the_light() {
    let plant = |light: &str, forbid: &str| {
        let s = only(&format!(
            "[space.air]\nshape.box = {{ min = [-4, -4, 0], max = [4, 4, 6] }}\n{forbid}nodes.voxels = {{ side = 0.1 }}\n\
             [grow.plant]\nspace = \"air\"\nfrom.at = [[0, 0, 0.05]]\nwidth.constant = 0.01\nby.voxels = {{ step = 0.2, rounds = 14, tries = 16, light = {light} }}\n"
        ));
        s.nodes[s.nodes.len() - 1].position
    };
    let noon = "{ sky = 0, sun = { latitude = 60, day = 355, hours = [11, 13] } }";
    let south = plant(noon, "");
    assert!(south.y < -1.0 && south.y < -south.x.abs(), "{south}");
    let turned = plant("{ sky = 0, sun = { latitude = 60, day = 355, hours = [11, 13], north = 180 } }", "");
    assert!(turned.y > 1.0, "{turned}");
    let morning = plant("{ sky = 0, sun = { latitude = 0, day = 80, hours = [7, 8] } }", "");
    assert!(morning.x > 1.0, "{morning}");
    // Limbs that set out level turn up for the sky; in the dark they do not, and some light is the default.
    let [dark, sky, default] = ["{ sky = 0 }", "{ sky = 1 }", "{ rays = 12 }"]
        .map(|light| plant(&format!("{light}, heading = [1, 0, 0.2]"), "").z);
    assert!(sky > 2.0 && dark < 1.2 && default == sky, "{dark} {sky} {default}");
    // A roof over one half of the sky.
    let roof = "forbid.box = { min = [-4, -4, 3], max = [0.5, 4, 3.4] }\n";
    assert!(plant("{ sky = 3, rays = 40 }", roof).x > 0.4);
}

/// A limb's branches are as far apart as their ages, but for those that found no place.
#[test]
fn branches_come_at_their_age() {
    let s = only(
        "[space.air]\nshape.box = { min = [-9, -9, 0], max = [9, 9, 18] }\nnodes.voxels = { side = 0.2 }\n\
         [grow.plant]\nspace = \"air\"\nfrom.at = [[0, 0, 0.05]]\nwidth.constant = 0.01\nby.voxels = { step = 0.2, rounds = 44, apart = 0.01, straight = 1, branches = { age = [5, 9], angle = [40, 60] } }\n",
    );
    let limbs = s.limbs();
    let mut places: Vec<Vec<usize>> = vec![Vec::new(); limbs.len()];
    let mut angles = Vec::new();
    for limb in &limbs {
        let Some((from, of)) = limb.leaves else { continue };
        let own = &limbs[of as usize];
        // Rounds since the limb began; a branch begins at a node of what it leaves.
        let at = own.nodes.iter().position(|&n| n == from).unwrap() + usize::from(own.leaves.is_some());
        places[of as usize].push(at);
        angles.push(degrees(way(&s, limb.nodes[0]).unwrap(), way(&s, from).unwrap()));
    }
    let mut gaps = Vec::new();
    for list in &places {
        let mut before = 0;
        for &at in list {
            gaps.push(at - before);
            before = at;
        }
    }
    assert!(gaps.len() > 40 && gaps.iter().all(|gap| (5..=9).contains(gap)), "{gaps:?}");
    assert!((5..=9).all(|age| gaps.contains(&age)));
    assert!(angles.iter().all(|a| (40.0 - 1e-6..=60.0 + 1e-6).contains(a)));
}

/// Steps in one space keep from each other, whether they grow together or one after the other; seeds compete.
#[test]
fn plants_share_their_voxels() {
    let plants = grown(&scene(
        "[space.air]\nshape.box = { min = [-1, -1, 0], max = [1, 1, 2] }\nnodes.voxels = { side = 0.05 }\n\
         [grow.a]\nspace = \"air\"\nfrom.at = [[-0.2, 0, 0.02], [0.2, 0.3, 0.02]]\nwidth.constant = 0.01\nby.voxels = { step = 0.1, rounds = 30, apart = 0.08, branches = { age = [2, 4] } }\n\
         [grow.b]\nlike = \"a\"\nfrom.at = [[0.2, -0.2, 0.02]]\n\
         [grow.c]\nlike = \"a\"\nfrom.ends = \"b\"\n",
    ));
    let [a, b, c] = [0, 1, 2].map(|i| &plants[i].skeleton);
    assert!(a.nodes.len() > 50 && b.nodes.len() > 30 && c.nodes.len() > b.paths.len());
    assert!(nearest(b, a) >= 0.08 - 1e-9 && nearest(c, a) >= 0.08 - 1e-9, "{} {}", nearest(b, a), nearest(c, a));
    let trees = a.nodes.iter().filter(|n| n.parent.is_none()).count();
    assert_eq!(trees, 2);
    assert!(c.nodes.iter().filter(|n| n.parent.is_none()).all(|n| b.nodes.iter().any(|m| m.position == n.position)));
}

/// Where two would be too near to each other in one round the one with the better score grows, of equals the first.
#[test]
fn conflicts_go_by_score_then_by_order() {
    let meet = |first: f64, second: f64| {
        let step = |name: &str, x: f64, straight: f64| {
            format!(
                "[grow.{name}]\nspace = \"air\"\nfrom.at = [[{x}, 0, 1]]\nwidth.constant = 0.01\nby.voxels = {{ step = 0.1, rounds = 9, tries = 1, turn = [0, 0], apart = 0.12, straight = {straight}, light = {{ sky = 0 }}, heading = [{}, 0, 0] }}\n",
                -x
            )
        };
        let space = "[space.air]\nshape.box = { min = [-1, -1, 0], max = [1, 1, 2] }\nnodes.voxels = { side = 0.05 }\n";
        let all = grown(&scene(&format!("{space}{}{}", step("a", -0.55, first), step("b", 0.55, second))));
        [0, 1].map(|i| all[i].skeleton.nodes.len())
    };
    // They meet after four steps, and there is room for one more.
    assert_eq!(meet(2.0, 1.0), [6, 5]);
    assert_eq!(meet(1.0, 2.0), [5, 6]);
    assert_eq!(meet(1.0, 1.0), [6, 5]);
}

/// A space of a billion voxels costs what is in it.
#[test]
fn a_billion_voxels_are_allowed() {
    let large = scene(
        "[space.air]\nshape.box = { min = [0, 0, 0], max = [102.4, 102.4, 102.4] }\nforbid.sphere = { centre = [50, 50, 50], radius = 4 }\nnodes.voxels = { side = 0.1 }\n\
         [grow.plant]\nspace = \"air\"\nfrom.at = [[1, 1, 1]]\nwidth.constant = 0.01\nby.voxels = { step = 0.5, rounds = 30, nodes = 1000 }\n",
    );
    assert!(bytes_needed(&large.recipe) < 200_000_000, "{}", bytes_needed(&large.recipe));
    let all = grown(&large);
    assert_eq!(all[0].skeleton.nodes.len(), 31);
    assert!(all[0].nodes > 50_000, "{}", all[0].nodes);
}

/// A mesh is sampled at every voxel: limbs cling to it within the side of one.
#[test]
fn limbs_cling_to_a_mesh() {
    let plant = scene(
        "[shape.vase]\nmesh = { file = \"scenes/assets/vase.obj\" }\n\
         [space.air]\nshape.shell = { of = \"vase\", outside = 0.5 }\nforbid = \"vase\"\nnodes.voxels = { side = 0.08 }\n\
         [grow.ivy]\nspace = \"air\"\nfrom.at = [[0.9, 0, 0.5], [-0.9, 0, 0.5]]\nwidth.constant = 0.02\n\
         by.voxels = { step = 0.1, rounds = 20, straight = 1, branches = { age = [2, 5] }, cling = { to = \"vase\", within = [0.02, 0.06] } }\n\
         [claim.near]\nsays = \"near\"\nmeasure = \"farthest\"\nof = \"ivy\"\nshape = \"vase\"\nat_most = 0.14\n\
         [claim.outside]\nsays = \"outside\"\nmeasure = \"nearest\"\nof = \"ivy\"\nshape = \"vase\"\nat_least = -0.06\n",
    );
    let all = grown(&plant);
    assert!(all[0].skeleton.nodes.len() > 60, "{}", all[0].skeleton.nodes.len());
    // Claims measure the mesh itself.
    let findings = check_claims(&plant, &all, &Memory::default(), &Progress::default()).unwrap();
    assert!(findings.len() == 2 && findings.iter().all(|finding| finding.holds), "{findings:?}");
}

/// What is forbidden is not stepped over, however long the steps, nor seen through, however far the foliage reaches.
#[test]
fn walls_stop_limbs_and_light() {
    let plant = |ceiling: &str, more: &str| {
        only(&format!(
            "[space.air]\nshape.box = {{ min = [-5, -5, 0], max = [5, 5, 4] }}\nforbid.box = {{ min = [-5, -5, 1], max = [5, 5, {ceiling}] }}\nnodes.voxels = {{ side = 0.1 }}\n\
             [grow.plant]\nspace = \"air\"\nfrom.at = [[0, 0, 0.8]]\nwidth.constant = 0.01\nby.voxels = {{ tries = 64, turn = [0, 180], straight = 1, heading = [1, 0, 0.5], {more} }}\n"
        ))
    };
    let long = plant("1.1", "step = 0.5, rounds = 8");
    assert!(long.nodes.len() > 5 && long.nodes.iter().all(|n| n.position.z < 1.0));
    for ceiling in ["1.3", "4"] {
        for foliage in ["0", "0.4", "0.8"] {
            let [dark, lit] = [0, 3].map(|sky| {
                plant(ceiling, &format!("step = 0.1, rounds = 2, foliage = {foliage}, light = {{ sky = {sky} }}"))
            });
            assert_eq!(dark.nodes, lit.nodes, "no sky is seen from below: {ceiling} {foliage}");
        }
    }
}

/// Each round is against what the rounds before made: one that is beaten to its place by another waits, and does not turn aside
/// in the same round.
#[test]
fn a_round_sees_the_rounds_before() {
    let step = |name: &str, x: f64, straight: f64, rounds: u32| {
        format!(
            "[grow.{name}]\nspace = \"air\"\nfrom.at = [[{x}, 0, 1]]\nwidth.constant = 0.01\nby.voxels = {{ step = 0.1, rounds = {rounds}, tries = 40, turn = [0, 90], apart = 0.12, straight = {straight}, light = {{ sky = 0 }}, heading = [{}, 0, 0] }}\ntoward = {{ at = [{}, 0, 1], strength = 1 }}\n",
            -x,
            -9.0 * x
        )
    };
    let space = "[space.air]\nshape.box = { min = [-1, -1, 0], max = [1, 1, 2] }\nnodes.voxels = { side = 0.05 }\n";
    let nodes = |rounds: u32| {
        let all = grown(&scene(&format!("{space}{}{}", step("a", -0.5, 2.0, rounds), step("b", 0.5, 1.0, rounds))));
        [0, 1].map(|i| all[i].skeleton.nodes.len())
    };
    // Both grow until they meet; then one waits for a round, and goes around what it then sees.
    let met = (1..9).find(|&rounds| nodes(rounds)[1] < nodes(rounds)[0]).unwrap();
    assert_eq!(nodes(met - 1), [met as usize; 2]);
    assert_eq!(nodes(met), [met as usize + 1, met as usize]);
    assert_eq!(nodes(met + 1)[1], met as usize + 1, "it was not dead");
}

/// Ages are drawn anew for every branch.
#[test]
fn every_branch_has_an_age_of_its_own() {
    let seeds: Vec<String> = (0..144).map(|i| format!("[{}, {}, 0.05]", i % 12 * 2, i / 12 * 2)).collect();
    let s = only(&format!(
        "[space.air]\nshape.box = {{ min = [-2, -2, 0], max = [25, 25, 4] }}\nnodes.voxels = {{ side = 0.2 }}\n\
         [grow.plant]\nspace = \"air\"\nfrom.at = [{}]\nwidth.constant = 0.01\nby.voxels = {{ step = 0.1, rounds = 14, apart = 0.001, straight = 1, branches = {{ age = [1, 6] }} }}\n",
        seeds.join(", ")
    ));
    let limbs = s.limbs();
    let places = |of: usize| {
        let mut at: Vec<usize> = limbs
            .iter()
            .filter_map(|limb| limb.leaves.filter(|(_, path)| *path as usize == of))
            .filter_map(|(from, _)| limbs[of].nodes.iter().position(|&n| n == from))
            .collect();
        at.sort_unstable();
        at
    };
    let after_one: Vec<Vec<usize>> = (0..limbs.len())
        .filter(|&i| limbs[i].leaves.is_none())
        .map(places)
        .filter(|at| at.first() == Some(&1))
        .collect();
    let again = after_one.iter().filter(|at| at.get(1) == Some(&2)).count();
    assert!(after_one.len() > 10 && again * 2 < after_one.len(), "{again} of {}", after_one.len());
}

/// Of two steps the one that keeps farther from others decides how near they come.
#[test]
fn the_wider_distance_counts() {
    let plants = grown(&scene(
        "[space.air]\nshape.box = { min = [-1, -1, 0], max = [1, 1, 2] }\nnodes.voxels = { side = 0.05 }\n\
         [grow.a]\nspace = \"air\"\nfrom.at = [[-0.3, 0, 0.02]]\nwidth.constant = 0.01\nby.voxels = { step = 0.1, rounds = 30, apart = 0.02, branches = { age = [2, 4] } }\n\
         [grow.b]\nspace = \"air\"\nfrom.at = [[0.3, 0, 0.02]]\nwidth.constant = 0.01\nby.voxels = { step = 0.1, rounds = 30, apart = 0.2, branches = { age = [2, 4] } }\n",
    ));
    let [a, b] = [0, 1].map(|i| &plants[i].skeleton);
    assert!(a.nodes.len() > 100 && b.nodes.len() > 20, "{} {}", a.nodes.len(), b.nodes.len());
    assert!(nearest(a, b) >= 0.2 - 1e-9, "{}", nearest(a, b));
}
