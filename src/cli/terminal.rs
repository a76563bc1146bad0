//! Pictures in the terminal: in full where it can show them (Kitty, iTerm), in half blocks of colour elsewhere.

#[cfg(unix)]
use std::fs::File;
use std::io::{IsTerminal, stdout};
use std::sync::OnceLock;
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use super::console::Console;
use super::error::Failure;
use crate::files::Rgba;

/// So long a terminal may take to say whether it knows Kitty's protocol: not all answer.
const PATIENCE: Duration = Duration::from_millis(500);

/// What it said; it is asked once.
static SHOWS_PICTURES: OnceLock<bool> = OnceLock::new();

/// Asks the terminal whether it knows Kitty's protocol.
fn shows_pictures() -> bool {
    let mode = Mode::now();
    let (send, answer) = channel();
    // Where there is no answer this thread waits on, until the process ends.
    thread::spawn(move || send.send(viuer::get_kitty_support() != viuer::KittySupport::None));
    let answer = answer.recv_timeout(PATIENCE);
    if answer.is_err() {
        mode.restore();
    }
    answer.unwrap_or(false)
}

/// How the terminal treats what is typed: whoever waits for its answer has it neither shown nor held back.
#[cfg(unix)]
struct Mode(Option<(File, rustix::termios::Termios)>);

#[cfg(unix)]
impl Mode {
    fn now() -> Self {
        let known = File::open("/dev/tty").ok().and_then(|tty| {
            let mode = rustix::termios::tcgetattr(&tty).ok()?;
            Some((tty, mode))
        });
        Self(known)
    }

    fn restore(&self) {
        if let Some((tty, mode)) = &self.0 {
            let _ = rustix::termios::tcsetattr(tty, rustix::termios::OptionalActions::Now, mode);
        }
    }
}

#[cfg(not(unix))]
struct Mode;

#[cfg(not(unix))]
impl Mode {
    fn now() -> Self {
        Self
    }

    fn restore(&self) {}
}

/// Shows `picture` on stdout; elsewhere than on a terminal it says why not.
pub fn show(picture: &Rgba, console: &Console) -> Result<(), Failure> {
    if !stdout().is_terminal() {
        console.note("note: --show shows nothing where stdout is not a terminal");
        return Ok(());
    }
    console.done();
    let buffer = image::RgbaImage::from_raw(picture.width, picture.height, picture.bytes.clone())
        .ok_or_else(|| Failure::Usage("the picture is broken".to_owned()))?;
    let use_kitty = *SHOWS_PICTURES.get_or_init(shows_pictures);
    let config = viuer::Config { absolute_offset: false, use_kitty, ..viuer::Config::default() };
    viuer::print(&image::DynamicImage::from(buffer), &config)
        .map(drop)
        .map_err(|error| Failure::Usage(format!("cannot show the picture in this terminal: {error}")))
}
