//! Paint: strands take their colour from a picture that lies under them (Xu and Mould 2007, Fig. 15).

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::Bounds;
use crate::math::{Colour, DVec3, from_srgb, to_srgb};
use crate::model::{Ball, Body, Limbs, Object};

/// Every tree or strand of an object has the colour of a picture where it starts. The picture is stretched over all their
/// starts, seen from above; in a flat scene from the front.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PaintSpec {
    /// The picture, beside the scene: PNG or JPEG.
    pub file: String,
    /// Steps of each of red, green and blue: so many objects are the most that come of it, cubed.
    #[serde(default = "steps")]
    #[schemars(range(min = 2, max = 16))]
    pub steps: u32,
}

fn steps() -> u32 {
    6
}

/// A picture to paint with.
#[derive(Clone, Debug, PartialEq)]
pub struct Painting {
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// Red, green and blue in linear light, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

/// The colour of each tree of `limbs` as steps of red, green and blue: that of `picture` where the tree starts; a number a
/// ball.
fn colours(limbs: &Limbs, picture: &Painting, steps: u32, is_flat: bool) -> Vec<[u8; 3]> {
    let mut is_root = vec![true; limbs.balls.len()];
    limbs.segments.iter().for_each(|&[_, b]| is_root[b as usize] = false);
    let roots = (0..limbs.balls.len()).filter(|&i| is_root[i]);
    let point = |i: usize| DVec3::new(limbs.balls[i].centre.x, limbs.balls[i].centre[if is_flat { 2 } else { 1 }], 0.0);
    let bounds = roots.fold(Bounds::EMPTY, |b, i| b.union(Bounds { min: point(i), max: point(i) }));
    let size = bounds.size().max(DVec3::splat(1e-9));
    let [width, height] = picture.size;
    let step = |i: usize| -> [u8; 3] {
        let at = (point(i) - bounds.min) / size;
        let pixel = |share: f64, n: u32| ((share * f64::from(n)) as u32).min(n - 1) as usize;
        let cell = pixel(at.x, width) + pixel(1.0 - at.y, height) * width as usize;
        // As bright as it is seen.
        picture.pixels[cell].map(|value| libm::round(to_srgb(f64::from(value)) * f64::from(steps - 1)) as u8)
    };
    // Parents come before children.
    let mut colours: Vec<[u8; 3]> = (0..limbs.balls.len()).map(|i| if is_root[i] { step(i) } else { [0; 3] }).collect();
    limbs.segments.iter().for_each(|&[a, b]| colours[b as usize] = colours[a as usize]);
    colours
}

/// `object` as one for each colour that `picture` has, in `steps` of each channel, where its trees start.
#[must_use]
pub fn painted(object: &Object, picture: &Painting, steps: u32, is_flat: bool) -> Vec<(Object, Colour)> {
    let Body::Limbs(limbs) = &object.body else { return Vec::new() };
    let colours = colours(limbs, picture, steps, is_flat);
    let mut parts: BTreeMap<[u8; 3], Limbs> = BTreeMap::new();
    let mut renamed = vec![0; limbs.balls.len()];
    // Limbs are numbered anew in each part.
    let count = limbs.balls.iter().map(|ball| ball.branch as usize + 1).max().unwrap_or(0);
    let mut limb = vec![u32::MAX; count];
    let mut counts: BTreeMap<[u8; 3], u32> = BTreeMap::new();
    for (i, ball) in limbs.balls.iter().enumerate() {
        let part = parts.entry(colours[i]).or_default();
        renamed[i] = part.balls.len() as u32;
        let branch = &mut limb[ball.branch as usize];
        if *branch == u32::MAX {
            let count = counts.entry(colours[i]).or_default();
            *branch = *count;
            *count += 1;
        }
        part.balls.push(Ball { branch: *branch, ..*ball });
    }
    for &[a, b] in &limbs.segments {
        if let Some(part) = parts.get_mut(&colours[a as usize]) {
            part.segments.push([renamed[a as usize], renamed[b as usize]]);
        }
    }
    let colour = |step: [u8; 3]| Colour(step.map(|c| from_srgb(f64::from(c) / f64::from(steps - 1))));
    let made = (1..).zip(parts).map(|(i, (step, part)): (u32, _)| {
        let name = format!("{}_{i}", object.name);
        let part = Object { name, instances: object.instances.clone(), body: Body::Limbs(part), ..*object };
        (part, colour(step))
    });
    made.collect()
}
