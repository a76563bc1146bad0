//! Strokes: the skeletons that shine.

use crate::math::DVec2;
use crate::model::{CORE, GlowSpec, Piece, Stroke};
use crate::skeleton::{Skeleton, SkeletonNode};

/// The segments of skeletons, and whether each belongs to the core: all do where no path is of class [`CORE`].
pub fn shining<'a>(
    skeletons: &'a [&'a Skeleton],
) -> impl Iterator<Item = (&'a SkeletonNode, &'a SkeletonNode, bool)> + 'a {
    let core = |s: &Skeleton| s.classes.iter().position(|class| class == CORE);
    let has_core = skeletons.iter().any(|s| core(s).is_some());
    skeletons.iter().flat_map(move |s| {
        let core = core(s);
        s.segments().map(move |(from, to)| (from, to, !has_core || core == Some(to.class as usize)))
    })
}

/// The stroke that `skeletons` are, moved by `offset`.
#[must_use]
pub fn stroke(name: &str, skeletons: &[&Skeleton], offset: DVec2, glow: GlowSpec) -> Stroke {
    let pieces = shining(skeletons)
        .map(|(from, to, is_core)| Piece {
            ends: [from, to].map(|n| n.position.truncate() + offset),
            radii: [from.radius, to.radius],
            is_core,
        })
        .collect();
    Stroke { name: name.to_owned(), pieces, glow }
}
