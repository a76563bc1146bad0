//! Text on its way out, in pieces.

use std::io::{self, Write};

/// The text buffered before it is written.
pub(super) const BUFFER: usize = 1 << 16;

/// Writes `text` out and empties it when it has reached `size` bytes.
pub(super) fn flush_at(text: &mut Vec<u8>, out: &mut impl Write, size: usize) -> io::Result<()> {
    if text.len() >= size {
        out.write_all(text)?;
        text.clear();
    }
    Ok(())
}
