//! Where scene units fall in a picture.

use crate::math::DVec2;
use crate::model::ViewFrame;

/// The pixels that are made of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canvas {
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// Left and top of these pixels within the view's picture; negative where there is more than it shows.
    pub offset: [i64; 2],
    /// The view.
    pub frame: ViewFrame,
}

impl Canvas {
    /// All of a view, as large as `size`.
    #[must_use]
    pub fn new(frame: ViewFrame, size: [u32; 2]) -> Self {
        Self { size, offset: [0, 0], frame }
    }

    /// How many pixels there are.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Where a point of the scene is: pixels from the left and from the top, pixel centres at halves.
    #[must_use]
    pub fn to_pixels(&self, p: DVec2) -> DVec2 {
        let [left, top] = self.offset.map(|o| o as f64);
        DVec2::new(p.x / self.frame.pixel - left, (self.frame.extent[1] - p.y) / self.frame.pixel - top)
    }

    /// The point of the scene at so many pixels from the left and from the top.
    #[must_use]
    pub fn to_scene(&self, p: DVec2) -> DVec2 {
        let [left, top] = self.offset.map(|o| o as f64);
        DVec2::new((p.x + left) * self.frame.pixel, self.frame.extent[1] - (p.y + top) * self.frame.pixel)
    }
}
