//! Pictures in the terminal: in full where it can show them (Kitty, iTerm), in half blocks of colour elsewhere.

use std::io::{IsTerminal, stdout};

use super::console::Console;
use super::error::Failure;
use crate::files::Rgba;

/// Shows `picture` on stdout; elsewhere than on a terminal it says why not.
pub fn show(picture: &Rgba, console: &Console) -> Result<(), Failure> {
    if !stdout().is_terminal() {
        console.note("note: --show shows nothing where stdout is not a terminal");
        return Ok(());
    }
    console.done();
    let buffer = image::RgbaImage::from_raw(picture.width, picture.height, picture.bytes.clone())
        .ok_or_else(|| Failure::Usage("the picture is broken".to_owned()))?;
    let config = viuer::Config { absolute_offset: false, ..viuer::Config::default() };
    viuer::print(&image::DynamicImage::from(buffer), &config)
        .map(drop)
        .map_err(|error| Failure::Usage(format!("cannot show the picture in this terminal: {error}")))
}
