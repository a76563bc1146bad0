//! Greyscale pictures, such as painted maps.

/// Grey values from 0 (black) to 1 (white), row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Grey {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

impl Grey {
    /// A picture of `width` by `height` pixels, or `None` if `values` has another length or is empty.
    #[must_use]
    pub fn new(width: u32, height: u32, values: Vec<f32>) -> Option<Self> {
        let fits = u64::from(width) * u64::from(height) == values.len() as u64;
        (fits && !values.is_empty()).then_some(Self { width, height, values })
    }

    /// Pixels in a row, and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The value of a pixel.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> f32 {
        self.values[y as usize * self.width as usize + x as usize]
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }

    /// The bilinearly interpolated value at `(u, v)`, fractions of width and height from the top left; clamped to the edge.
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> f64 {
        let locate = |t: f64, size: u32| {
            let t = (t * f64::from(size) - 0.5).clamp(0.0, f64::from(size - 1));
            let low = libm::floor(t) as u32;
            (low, (low + 1).min(size - 1), t - f64::from(low))
        };
        let (x0, x1, fx) = locate(u, self.width);
        let (y0, y1, fy) = locate(v, self.height);
        let pixel = |x: u32, y: u32| f64::from(self.values[y as usize * self.width as usize + x as usize]);
        let lerp = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
        lerp(lerp(pixel(x0, y0), pixel(x1, y0), fx), lerp(pixel(x0, y1), pixel(x1, y1), fx), fy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_between_pixel_centres() {
        let grey = Grey::new(2, 1, vec![0.0, 1.0]).unwrap();
        assert_eq!(grey.at(0.25, 0.5), 0.0);
        assert_eq!(grey.at(0.5, 0.5), 0.5);
        assert_eq!(grey.at(2.0, -1.0), 1.0);
        assert!(Grey::new(2, 2, vec![0.0]).is_none());
    }
}
