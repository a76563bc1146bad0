//! Limbs in RIB: spheres and hyperboloids.

use std::io::{self, Write};

use super::buffer::{BUFFER, flush_at};
use super::decimal::push_plain as push_number;
use super::rib_text::{MATRIX, colour};
use crate::geom::{Frustum, frustum};
use crate::math::{Colour, DVec3};
use crate::model::{Ball, Digits, LimbFrame, Limbs, Material, limb_frames};

/// What turns the first third of a tube into the others: cosine and sine of 0, 120 and 240 degrees. A tube that is swept at once is
/// diced so coarsely, where it is thin, that it all but vanishes.
const THIRDS: [[f64; 2]; 3] = [[1.0, 0.0], [-0.5, HALF_ROOT_3], [-0.5, -HALF_ROOT_3]];
const HALF_ROOT_3: f64 = 0.866_025_403_784_438_6;

/// Writes `limbs`, moved by `offset`. With a pattern each stands along z of its own space, x towards its upper side, and its texture
/// coordinates say how far along the limb that space begins, and how much of the pattern it shows. (Pixie cannot
/// retain quadrics with primitive variables; it keeps texture coordinates.)
pub(super) fn write_limbs(
    limbs: &Limbs,
    offset: DVec3,
    digits: Digits,
    material: &Material,
    out: &mut impl Write,
) -> io::Result<()> {
    let pattern = material.pattern.as_ref();
    let frames = pattern.map(|pattern| (limb_frames(limbs), pattern.figure()));
    let tip = |i: u32| material.tips.map_or(0, |tips| tips.steps(limbs, i));
    let laid = |i: u32, ball: &Ball| {
        let (frames, figure) = frames.as_ref().filter(|_| tip(i) == 0)?;
        let clarity = figure.clarity(ball.radius);
        (clarity > 0.0).then(|| (frames[i as usize], clarity))
    };
    let mut text = Text {
        bytes: Vec::with_capacity(BUFFER + 1024),
        digits,
        along: frames.is_some().then_some([f64::NAN; 2]),
        tip: 0,
    };
    for (i, ball) in (0..).zip(&limbs.balls) {
        if digits.round(ball.radius) > 0.0 {
            text.set_tip(material, tip(i));
            text.ball(ball, offset, laid(i, ball));
            flush_at(&mut text.bytes, out, BUFFER)?;
        }
    }
    for &[from, to] in &limbs.segments {
        let (a, b) = (&limbs.balls[from as usize], &limbs.balls[to as usize]);
        if let Some(frustum) = frustum(a.centre, a.radius, b.centre, b.radius) {
            text.set_tip(material, tip(to));
            text.tube(&frustum, offset, laid(to, b));
            flush_at(&mut text.bytes, out, BUFFER)?;
        }
    }
    flush_at(&mut text.bytes, out, 1)
}

/// What is written, on its way.
struct Text {
    bytes: Vec<u8>,
    digits: Digits,
    /// The texture coordinates as they were last set, where there is a pattern.
    along: Option<[f64; 2]>,
    /// The steps of the material's tips whose colour is set.
    tip: u8,
}

impl Text {
    fn word(&mut self, word: &str) {
        self.bytes.extend_from_slice(word.as_bytes());
    }

    fn numbers(&mut self, numbers: &[f64], digits: Digits) {
        for &x in numbers {
            push_number(&mut self.bytes, x, digits, digits.scale());
            self.bytes.push(b' ');
        }
    }

    fn lengths(&mut self, lengths: &[f64]) {
        self.numbers(lengths, self.digits);
    }

    /// Sets the colour of so many steps of the material's tips; shaders of patterns mix that of the pattern into it.
    fn set_tip(&mut self, material: &Material, step: u8) {
        if self.tip == step {
            return;
        }
        self.tip = step;
        let own = material.mean_colour();
        let shown = material.tips.map_or(own, |tips| tips.over(own, step));
        let set = match material.pattern {
            Some(_) if step == 0 => material.colour,
            Some(pattern) => {
                let mean = pattern.figure().mean();
                let Colour(c) = shown.mixed(pattern.figure().colour(), -mean / (1.0 - mean));
                Colour(c.map(|c| c.max(0.0)))
            }
            None => shown,
        };
        self.word(&format!("Color [{}]\n", colour(set)));
    }

    /// Where there is a pattern, sets the texture coordinates of all corners: how far along its limb what follows is, and how much of
    /// the pattern it shows.
    fn set_along(&mut self, along: Option<[f64; 2]>) {
        let at = along.unwrap_or([0.0; 2]);
        if self.along.is_some_and(|last| last != at) {
            self.along = Some(at);
            self.word("TextureCoordinates ");
            (0..4).for_each(|_| self.lengths(&at));
            self.word("\n");
        }
    }

    /// A limb's own space: its axes, its origin.
    fn begin_space(&mut self, axes: [DVec3; 3], origin: DVec3) {
        self.word("TransformBegin ConcatTransform [");
        for axis in axes {
            self.numbers(&axis.to_array(), MATRIX);
            self.word("0 ");
        }
        self.lengths(&origin.to_array());
        self.word("1] ");
    }

    fn ball(&mut self, ball: &Ball, offset: DVec3, laid: Option<(LimbFrame, f64)>) {
        let centre = ball.centre + offset;
        self.set_along(laid.map(|(frame, clarity)| [frame.along, clarity]));
        if let Some((LimbFrame { axes: [x, z, y], .. }, _)) = laid {
            self.begin_space([x, y, z], centre);
        } else {
            self.word("TransformBegin Translate ");
            self.lengths(&centre.to_array());
        }
        self.word("Sphere ");
        self.lengths(&[ball.radius, -ball.radius, ball.radius]);
        self.word("360 TransformEnd\n");
    }

    fn tube(&mut self, f: &Frustum, offset: DVec3, laid: Option<(LimbFrame, f64)>) {
        let Some(w) = (f.b - f.a).try_normalize() else { return };
        let [ra, rb, long] = [f.ra, f.rb, (f.b - f.a).length()].map(|x| self.digits.round(x));
        if long <= 0.0 || (ra <= 0.0 && rb <= 0.0) {
            return;
        }
        // A whole cone has its apex at its far end.
        let is_turned = ra <= 0.0;
        let laid = laid.filter(|_| !is_turned);
        let (foot, w, ra, rb) = if is_turned { (f.b, -w, rb, ra) } else { (f.a, w, ra, rb) };
        let u = laid.map_or(w.any_orthonormal_vector(), |(frame, _)| frame.axes[0]);
        self.set_along(laid.map(|(frame, clarity)| [frame.local(f.a).y, clarity]));
        self.begin_space([u, w.cross(u), w], foot + offset);
        if rb > 0.0 {
            self.hyperboloid([ra, rb], long);
        } else {
            self.word("Cone ");
            self.lengths(&[long, ra]);
            self.word("360 ");
        }
        self.word("TransformEnd\n");
    }

    /// A tube along z from 0, in thirds. Pixie's rays meet the box around one whose wider end is written first or whose radii are
    /// equal: the narrower end goes first, and the other is wider by a digit at least.
    fn hyperboloid(&mut self, [ra, rb]: [f64; 2], long: f64) {
        let [(narrow, z), (wide, other)] = if ra <= rb { [(ra, 0.0), (rb, long)] } else { [(rb, long), (ra, 0.0)] };
        let wide = wide.max(narrow + 1.0 / self.digits.scale());
        // What the ends differ by counts.
        let finer = Digits(self.digits.0 + 2);
        for [cos, sin] in THIRDS {
            self.word("Hyperboloid ");
            for (r, z) in [(narrow, z), (wide, other)] {
                self.numbers(&[r * cos, r * sin], finer);
                self.lengths(&[z]);
            }
            self.word("120 ");
        }
    }
}
