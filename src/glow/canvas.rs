//! The map between scene units and pixels.

use crate::math::DVec2;
use crate::model::ViewFrame;

/// The pixels rendered of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canvas {
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// Left and top of these pixels within the view's picture; negative where they extend beyond it.
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

    /// The number of pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// The pixel coordinates of a point of the scene, from the left and from the top, pixel centres at halves.
    #[must_use]
    pub fn to_pixels(&self, p: DVec2) -> DVec2 {
        let [left, top] = self.offset.map(|o| o as f64);
        DVec2::new(p.x / self.frame.pixel - left, (self.frame.extent[1] - p.y) / self.frame.pixel - top)
    }

    /// The point of the scene at pixel coordinates, the inverse of [`Canvas::to_pixels`].
    #[must_use]
    pub fn to_scene(&self, p: DVec2) -> DVec2 {
        let [left, top] = self.offset.map(|o| o as f64);
        DVec2::new((p.x + left) * self.frame.pixel, self.frame.extent[1] - (p.y + top) * self.frame.pixel)
    }
}
