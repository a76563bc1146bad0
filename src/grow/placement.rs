//! Sets of endpoints: what they name is looked up, and checked.

use super::endpoints::{Placement, RandomPlaces};
use super::lookup::{Lookup, given_shape, note};
use super::near::Near;
use super::space::Space;
use super::spec::{EndpointSpec, NearSpec};
use crate::geom::Shape;
use crate::math::{DVec3, PerRound};

/// What is said where endpoints are placed in several ways, or in none.
const ONE_WAY: &str = "endpoints need exactly one of `count` (at random), `at` (a list), `through` (lists), `sketch` or `strokes` (a file) and `grammar` (an L-system)";

/// The placement of the set at `key`, whose random stream is `own` unless it has a name; `rounds` are those of a repeated
/// step. What is wrong is noted.
pub(super) fn placement(
    key: &str,
    own: &str,
    spec: &EndpointSpec,
    space: Option<&Space>,
    rounds: Option<u32>,
    lookup: &mut dyn Lookup,
) -> Option<Placement> {
    check_random(key, spec, lookup);
    if rounds.is_some() && (spec.count.is_none() || spec.near.is_some()) {
        let message = "a repeated step places its endpoints at random around each end: it needs `count`, and no `near`";
        lookup.wrong(key, message.to_owned());
        return None;
    }
    let drawn = spec.sketch.as_ref().map(|file| (file, false)).or(spec.strokes.as_ref().map(|file| (file, true)));
    if spec.sketch.is_some() && spec.strokes.is_some() {
        lookup.wrong(key, ONE_WAY.to_owned());
        return None;
    }
    match (&spec.count, &spec.at, drawn, &spec.through, &spec.grammar) {
        (Some(count), None, None, None, None) => random(key, own, spec, count, space, rounds, lookup),
        (None, Some(points), None, None, None) => {
            if points.is_empty() {
                lookup.wrong(&format!("{key}.at"), "list at least one endpoint".to_owned());
            }
            Some(Placement::At(points.iter().map(|p| p.0).collect()))
        }
        (None, None, None, Some(lists), None) => {
            if lists.is_empty() || lists.iter().any(Vec::is_empty) {
                lookup.wrong(&format!("{key}.through"), "list at least one point for each path".to_owned());
            }
            Some(Placement::Through(lists.iter().map(|list| list.iter().map(|p| p.0).collect()).collect()))
        }
        (None, None, None, None, Some(grammar)) => {
            let ends = grammar.endpoints(space?.up() == 1);
            note(lookup, &format!("{key}.grammar"), ends).map(Placement::At)
        }
        (None, None, Some((file, is_followed)), None, None) => sketched(key, file, is_followed, space?, lookup),
        _ => {
            lookup.wrong(key, ONE_WAY.to_owned());
            None
        }
    }
}

/// Endpoints of a sketch: the ends of its strokes, which paths follow if `is_followed`, and otherwise its points too.
fn sketched(key: &str, file: &str, is_followed: bool, space: &Space, lookup: &mut dyn Lookup) -> Option<Placement> {
    let frame = space.shape().bounds();
    let place = format!("{key}.{}", if is_followed { "strokes" } else { "sketch" });
    let (lines, points) = lookup.sketch(&place, file, frame, space.up())?;
    let raise = |p: DVec3| if space.up() == 1 { p } else { DVec3::new(p.x, frame.centre().y, p.y) };
    if !is_followed {
        return Some(Placement::At(points.into_iter().map(raise).collect()));
    }
    let stops = |line: Vec<DVec3>| thinned(&line.into_iter().map(raise).collect::<Vec<_>>(), 2.0 * space.spacing());
    // A point alone is no stroke.
    let strokes: Vec<Vec<DVec3>> = lines.into_iter().filter(|line| line.len() > 1).map(stops).collect();
    if strokes.is_empty() {
        lookup.wrong(&place, format!("`{file}` has points, but no strokes: take them by `sketch`"));
    }
    Some(Placement::Through(strokes))
}

/// Points of a line that are `apart` from the one before, and its last.
fn thinned(line: &[DVec3], apart: f64) -> Vec<DVec3> {
    let Some((&last, rest)) = line.split_last() else { return Vec::new() };
    let mut kept: Vec<DVec3> = Vec::new();
    for &p in rest {
        if p.distance(last) >= apart && kept.last().is_none_or(|before| before.distance(p) >= apart) {
            kept.push(p);
        }
    }
    kept.push(last);
    kept
}

/// Notes keys of random placement where nothing is placed at random.
fn check_random(key: &str, spec: &EndpointSpec, lookup: &mut dyn Lookup) {
    let given = [
        ("near", spec.near.is_some()),
        ("inside", spec.inside.is_some()),
        ("shell", spec.shell.is_some()),
        ("apart", spec.apart > 0.0),
    ];
    for (own, _) in given.iter().filter(|(_, is_given)| *is_given && spec.count.is_none()) {
        let message = format!("`{own}` says where endpoints are placed at random: it needs `count`");
        lookup.wrong(&format!("{key}.{own}"), message);
    }
}

fn random(
    key: &str,
    own: &str,
    spec: &EndpointSpec,
    count: &PerRound,
    space: Option<&Space>,
    rounds: Option<u32>,
    lookup: &mut dyn Lookup,
) -> Option<Placement> {
    check_count(&format!("{key}.count"), count, rounds, lookup)?;
    let stream = spec.stream.clone().unwrap_or_else(|| own.to_owned());
    let inside = given_shape(lookup, &format!("{key}.inside"), spec.inside.as_ref())?;
    let Some(near) = &spec.near else {
        let (count, apart, shell) = (count.clone(), spec.apart, spec.shell);
        return Some(Placement::Random(RandomPlaces { count, inside, apart, shell, stream }));
    };
    if spec.shell.is_some() {
        lookup.wrong(&format!("{key}.shell"), "`near` and `shell` do not go together".to_owned());
    }
    let inside = inside.or_else(|| space.map(|space| space.shape().clone()))?;
    near_step(key, spec, near, stream, inside, lookup).map(Placement::Near)
}

fn near_step(
    key: &str,
    spec: &EndpointSpec,
    near: &NearSpec,
    stream: String,
    inside: Shape,
    lookup: &mut dyn Lookup,
) -> Option<Near> {
    let step = lookup.step(&format!("{key}.near.step"), &near.step)?;
    Some(Near {
        count: spec.count.as_ref()?.once()? as u32,
        step,
        reach: near.reach,
        toward: near.toward,
        lower: near.lower,
        shorten: near.shorten,
        inside,
        apart: spec.apart,
        stream,
    })
}

/// Counts are whole, and there is at least one in some round.
fn check_count(key: &str, count: &PerRound, rounds: Option<u32>, lookup: &mut dyn Lookup) -> Option<()> {
    let least = if rounds.is_some() { 0.0 } else { 1.0 };
    let all = rounds.unwrap_or(1);
    let is_whole = (0..all).all(|round| count.at(round) == libm::floor(count.at(round)) || count.once().is_none());
    if rounds.is_none() && count.once().is_none() {
        lookup.wrong(key, "a number for each round needs `repeat`".to_owned());
    } else if !count.is_within(all, least, 1e6) || !is_whole {
        let found: Vec<String> = (0..all.min(8)).map(|round| count.at(round).to_string()).collect();
        lookup.wrong(key, format!("expected whole numbers from {least} to 1000000, found {}", found.join(", ")));
    } else if (0..all).all(|round| count.at(round) < 1.0) {
        lookup.wrong(key, "no round has an endpoint: nothing would grow".to_owned());
    } else {
        return Some(());
    }
    None
}
