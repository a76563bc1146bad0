//! Multi-channel pictures.

use super::DataWindow;

/// One channel of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Its name, as in EXR: `R`, `N.X`, `CryptoObject00.R`.
    pub name: String,
    /// A value a pixel, row by row from the top.
    pub values: Vec<f32>,
    /// May it be stored as 16-bit floats?
    pub is_half: bool,
}

/// A multi-channel picture with metadata; colours are in linear light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The channels.
    pub channels: Vec<Channel>,
    /// Keyword and text.
    pub texts: Vec<(String, String)>,
    /// Data window and display window.
    pub window: DataWindow,
    /// CIE xy of red, green, blue and white, if they are known.
    pub chromaticities: Option<[f32; 8]>,
}

impl Layers {
    /// The values of the channel called `name`.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|c| c.name == name).map(|c| &c.values[..])
    }

    /// Three channels, interleaved; `None` if one is missing.
    #[must_use]
    pub fn pixels(&self, names: [&str; 3]) -> Option<Vec<[f32; 3]>> {
        let [r, g, b] = names.map(|name| self.channel(name));
        let (r, g, b) = (r?, g?, b?);
        Some((0..r.len()).map(|i| [r[i], g[i], b[i]]).collect())
    }

    /// The text under `keyword`.
    #[must_use]
    pub fn text(&self, keyword: &str) -> Option<&str> {
        self.texts.iter().find(|(k, _)| k == keyword).map(|(_, text)| &text[..])
    }
}
