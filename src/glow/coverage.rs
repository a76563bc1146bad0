//! The channel: antialiased coverage of pixels.

use rayon::prelude::*;

use super::Canvas;
use crate::math::DVec2;
use crate::model::Piece;

/// Rows of a strip, the unit of parallel work.
const STRIP: usize = 32;

/// A piece in pixel coordinates.
struct ScreenPiece {
    from: DVec2,
    /// From one end to the other.
    span: DVec2,
    length2: f64,
    radii: [f64; 2],
    light: [f64; 2],
}

/// The coverage of each pixel by `pieces`, times their light, a function `light` of the radius; row by row, in a picture `scale`
/// times smaller than `canvas`.
///
/// The pixel filter is a quadratic B-spline, so that a channel thinner than a pixel emits light in proportion to its area at any
/// angle.
pub(super) fn cover<'a>(
    canvas: &Canvas,
    scale: u32,
    pieces: impl Iterator<Item = &'a Piece>,
    light: impl Fn(f64) -> f64,
) -> Vec<f32> {
    let [width, height] = canvas.size.map(|s| s.div_ceil(scale) as usize);
    let factor = 1.0 / f64::from(scale);
    let drawn: Vec<ScreenPiece> = pieces
        .map(|piece| {
            let [from, to] = piece.ends.map(|p| canvas.to_pixels(p) * factor);
            let span = to - from;
            ScreenPiece {
                from,
                span,
                length2: span.length_squared(),
                radii: piece.radii.map(|r| r / canvas.frame.pixel * factor),
                light: piece.radii.map(&light),
            }
        })
        .collect();
    let strips = height.div_ceil(STRIP);
    let mut met: Vec<Vec<u32>> = vec![Vec::new(); strips];
    for (i, piece) in (0..).zip(&drawn) {
        let [low, high] = piece.rows();
        let first = (low / STRIP as f64).max(0.0) as usize;
        let last = (high / STRIP as f64).min(strips as f64 - 1.0);
        if high >= 0.0 {
            (first..=last.max(0.0) as usize).filter(|&s| s < strips).for_each(|s| met[s].push(i));
        }
    }
    let mut values = vec![0.0_f32; width * height];
    values.par_chunks_mut(STRIP * width).zip(met).enumerate().for_each(|(strip, (rows, met))| {
        for piece in met.iter().map(|&i| &drawn[i as usize]) {
            piece.draw(rows, width, strip * STRIP);
        }
    });
    values
}

impl ScreenPiece {
    fn reach(&self) -> f64 {
        self.radii[0].max(self.radii[1]) + 1.5
    }

    /// The rows that it may cover.
    fn rows(&self) -> [f64; 2] {
        let (a, b) = (self.from.y, self.from.y + self.span.y);
        [a.min(b) - self.reach() - 0.5, a.max(b) + self.reach() + 0.5]
    }

    fn draw(&self, rows: &mut [f32], width: usize, top: usize) {
        let [low, high] = self.rows();
        let height = rows.len() / width;
        let first = (low - top as f64).max(0.0) as usize;
        for y in first..height.min((high - top as f64).max(0.0) as usize + 1) {
            let middle = (top + y) as f64 + 0.5;
            // The part of the piece near this row bounds the columns.
            let (mut t0, mut t1) = (0.0, 1.0);
            if self.span.y.abs() > 1e-9 {
                let at = |y: f64| (y - self.from.y) / self.span.y;
                let (a, b) = (at(middle - self.reach()), at(middle + self.reach()));
                (t0, t1) = (a.min(b).clamp(0.0, 1.0), a.max(b).clamp(0.0, 1.0));
            }
            let (x0, x1) = (self.from.x + self.span.x * t0, self.from.x + self.span.x * t1);
            let left = (x0.min(x1) - self.reach() - 0.5).max(0.0) as usize;
            let right = (x0.max(x1) + self.reach() + 0.5).min(width as f64 - 1.0);
            if right < 0.0 {
                continue;
            }
            let row = &mut rows[y * width..(y + 1) * width];
            for (x, value) in row.iter_mut().enumerate().take(right as usize + 1).skip(left) {
                // Where pieces join, both cover the same area: the maximum counts.
                *value = value.max(self.share(DVec2::new(x as f64 + 0.5, middle)) as f32);
            }
        }
    }

    fn share(&self, p: DVec2) -> f64 {
        let along =
            if self.length2 > 0.0 { ((p - self.from).dot(self.span) / self.length2).clamp(0.0, 1.0) } else { 0.0 };
        let distance = (p - self.from - self.span * along).length();
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * along;
        let light = self.light[0] + (self.light[1] - self.light[0]) * along;
        (seen(radius - distance) - seen(-radius - distance)) * light
    }
}

/// The integral up to `x` of the quadratic B-spline. A tent filter would change the light of channels at 45 degrees by a tenth.
fn seen(x: f64) -> f64 {
    let end = |x: f64| x * x * x / 6.0;
    match x {
        x if x <= -1.5 => 0.0,
        x if x < -0.5 => end(x + 1.5),
        x if x < 0.5 => 0.5 + 0.75 * x - x * x * x / 3.0,
        x if x < 1.5 => 1.0 - end(1.5 - x),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{ViewFrame, ViewSpec};

    /// The light of a channel is its length times its width, at any width and angle.
    #[test]
    fn thin_channels_keep_their_light() {
        let size = [160, 120];
        let frame = ViewFrame::new(&ViewSpec { height: Some(120.0), ..ViewSpec::default() }, size);
        let canvas = Canvas::new(frame, size);
        for radius in [0.02, 0.1, 0.4, 1.0, 3.0] {
            for (x, y) in [(100.0, 0.0), (0.0, 80.0), (77.0, 31.0), (60.0, 60.3)] {
                let from = DVec2::new(20.3, 20.6);
                let piece = Piece { ends: [from, from + DVec2::new(x, y)], radii: [radius; 2], is_core: true };
                for scale in [1, 2] {
                    let light: f32 = cover(&canvas, scale, [&piece].into_iter(), |_| 1.0).iter().sum();
                    let area = f64::from(light) * f64::from(scale * scale);
                    // With round ends, and up to a pixel more at each where it is thin.
                    let length = DVec2::new(x, y).length();
                    let expected = length * radius * 2.0;
                    assert!(
                        (area / expected - 1.0).abs() < 0.025 + (3.2 * radius + 2.0) / length,
                        "{radius} {x} {y}: {area}"
                    );
                }
            }
        }
    }
}
