//! Plates: photographs to which light is added.

use rayon::prelude::*;

use crate::math::DMat3;

/// The stored samples of a photograph: red, green and blue of each pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Display-referred code values of 8 bits.
    Eight(Vec<u8>),
    /// Display-referred code values of 16 bits.
    Sixteen(Vec<u16>),
    /// Scene-referred linear light, which may exceed 1.
    Linear(Vec<f32>),
}

/// A photograph as stored, with its colour space.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Width and height of the data window, in pixels.
    pub size: [u32; 2],
    /// The samples.
    pub samples: Samples,
    /// The transfer function of each channel: linear light, 0 to 1, by code value, not decreasing; empty for linear samples.
    pub curves: [Vec<f32>; 3],
    /// The matrix, row-major, from linear Rec. 709 to its own linear colour space.
    pub from_rec709: [[f64; 3]; 3],
    /// The embedded ICC profile.
    pub profile: Option<Vec<u8>>,
    /// Data window and display window.
    pub window: DataWindow,
    /// CIE xy of red, green, blue and white, if the file has them.
    pub chromaticities: Option<[f32; 8]>,
}

/// OpenEXR's data window, the stored pixels, within the display window, the picture itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DataWindow {
    /// Left and top of the data window.
    pub at: [i32; 2],
    /// Left and top of the display window.
    pub origin: [i32; 2],
    /// Width and height of the display window; 0 where it is the data window.
    pub display: [u32; 2],
}

impl Plate {
    /// Width and height of the display window.
    #[must_use]
    pub fn frame(&self) -> [u32; 2] {
        if self.window.display == [0, 0] { self.size } else { self.window.display }
    }

    /// Left and top of the data window relative to the display window.
    #[must_use]
    pub fn offset(&self) -> [i64; 2] {
        [0, 1].map(|i| i64::from(self.window.at[i]) - i64::from(self.window.origin[i]))
    }

    /// The plate converted to linear Rec. 709, without a profile.
    #[must_use]
    pub fn to_rec709(&self) -> Self {
        // Transposed on the way in and on the way out.
        let inverse = DMat3::from_cols_array_2d(&self.from_rec709).inverse().to_cols_array_2d();
        let mut light = vec![0.0_f32; self.size[0] as usize * self.size[1] as usize * 3];
        light.par_chunks_mut(3).enumerate().for_each(|(pixel, rgb)| {
            let own = [0, 1, 2].map(|c| f64::from(self.light(pixel * 3 + c)));
            for (out, row) in rgb.iter_mut().zip(inverse) {
                *out = (row[0] * own[0] + row[1] * own[1] + row[2] * own[2]) as f32;
            }
        });
        Self {
            samples: Samples::Linear(light),
            curves: Default::default(),
            from_rec709: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            profile: None,
            chromaticities: None,
            ..*self
        }
    }

    /// The largest code value; 0 for linear samples.
    #[must_use]
    pub fn most(&self) -> u32 {
        match self.samples {
            Samples::Eight(_) => 255,
            Samples::Sixteen(_) => 65535,
            Samples::Linear(_) => 0,
        }
    }

    /// The linear light of sample `i`, three a pixel, in the plate's colour space.
    #[must_use]
    pub fn light(&self, i: usize) -> f32 {
        match &self.samples {
            Samples::Eight(codes) => self.curves[i % 3][codes[i] as usize],
            Samples::Sixteen(codes) => self.curves[i % 3][codes[i] as usize],
            Samples::Linear(light) => light[i],
        }
    }

    /// The fractional code value of `light` in a channel, the inverse of [`Plate::light`].
    #[must_use]
    pub fn encode(&self, channel: usize, light: f32) -> f64 {
        let curve = &self.curves[channel];
        let above = curve.partition_point(|&x| x < light);
        if above == 0 {
            return 0.0;
        }
        let Some(&high) = curve.get(above) else { return (curve.len() - 1) as f64 };
        let low = curve[above - 1];
        (above - 1) as f64 + f64::from(light - low) / f64::from(high - low).max(1e-12)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_come_back() {
        let curve: Vec<f32> = (0..256).map(|i| (i as f32 / 255.0) * (i as f32 / 255.0)).collect();
        let plate = Plate {
            size: [86, 1],
            samples: Samples::Eight((0..=255).chain([0, 0]).collect()),
            curves: [curve.clone(), curve.clone(), curve],
            from_rec709: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            profile: None,
            window: DataWindow::default(),
            chromaticities: None,
        };
        assert_eq!(plate.frame(), [86, 1]);
        for i in 0..256 {
            assert!((plate.encode(i % 3, plate.light(i)) - i as f64).abs() < 1e-4, "{i}");
        }
        assert_eq!(plate.encode(0, 2.0), 255.0);
    }
}
