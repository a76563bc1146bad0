//! Child processes that are killed with us.

use std::io::{self, Read};
use std::process::{Child, ExitStatus};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use crate::math::{Cancelled, Progress};

/// Interval of the tests for cancellation.
pub(super) const POLL: Duration = Duration::from_millis(50);

/// A child process that is killed on drop.
pub(super) struct Watched(pub Child);

impl Drop for Watched {
    fn drop(&mut self) {
        // Both fail only if it has exited.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Watched {
    /// Waits for its exit.
    pub fn wait(&mut self, progress: &Progress) -> Result<io::Result<ExitStatus>, Cancelled> {
        loop {
            progress.check()?;
            match self.0.try_wait() {
                Ok(Some(status)) => return Ok(Ok(status)),
                Ok(None) => thread::sleep(POLL),
                Err(error) => return Ok(Err(error)),
            }
        }
    }
}

/// The lines of a stream, split at carriage returns and line feeds, read by a thread of its own.
pub(super) fn listen(stream: Option<impl Read + Send + 'static>) -> Receiver<String> {
    let (send, lines) = channel();
    if let Some(stream) = stream {
        thread::spawn(move || {
            let mut line = Vec::new();
            for byte in io::BufReader::new(stream).bytes().map_while(Result::ok) {
                if byte != b'\r' && byte != b'\n' {
                    line.push(byte);
                    continue;
                }
                let text = String::from_utf8_lossy(&line).trim().to_owned();
                line.clear();
                if !text.is_empty() && send.send(text).is_err() {
                    return;
                }
            }
            let rest = String::from_utf8_lossy(&line).trim().to_owned();
            if !rest.is_empty() {
                // The receiver may be gone.
                let _ = send.send(rest);
            }
        });
    }
    lines
}
