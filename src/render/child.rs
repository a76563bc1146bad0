//! Outside programs that end when we do.

use std::io::{self, Read};
use std::process::{Child, ExitStatus};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use crate::math::{Cancelled, Progress};

/// How often we look whether to stop.
pub(super) const POLL: Duration = Duration::from_millis(50);

/// A child that does not outlive us.
pub(super) struct Watched(pub Child);

impl Drop for Watched {
    fn drop(&mut self) {
        // Both fail only when it has ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Watched {
    /// Waits for its end.
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

/// The lines of a stream, split at returns as at line ends, from a thread of their own.
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
                // Nobody may listen any more.
                let _ = send.send(rest);
            }
        });
    }
    lines
}
