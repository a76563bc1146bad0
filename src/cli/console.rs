//! What the command says: results on stdout, everything else on stderr.

use std::io::{self, IsTerminal, Write, stderr, stdout};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use signal_hook::consts::SIGINT;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGQUIT, SIGTERM};

use super::shown;
use crate::files::exit;
use crate::math::Progress;

/// Signals that ask us to end.
#[cfg(unix)]
const ENDING: [i32; 4] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT];

/// Work that does not look whether to stop has so long to end by itself.
const PATIENCE: Duration = Duration::from_millis(600);

/// The exit code where time is over, as `timeout` has it.
const OUT_OF_TIME: i32 = 124;

/// The command's voice, and its ear for what ends it early.
pub struct Console {
    /// Results as JSON?
    pub json: bool,
    quiet: bool,
    bar: ProgressBar,
    stop: Arc<AtomicBool>,
    /// The exit code, once `stop` is set.
    code: Arc<AtomicI32>,
    lost: Mutex<Option<io::Error>>,
}

impl Console {
    /// One that signals end, or, if `max_time` is given, its end.
    pub fn new(quiet: bool, json: bool, max_time: Option<Duration>) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let code = Arc::new(AtomicI32::new(128 + SIGINT));
        heed(Arc::clone(&stop), Arc::clone(&code), max_time);
        let shown = !quiet && !json && stderr().is_terminal();
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(1000), target);
        if let Ok(style) = ProgressStyle::with_template("{prefix} {msg:8} {wide_bar} {percent:>3} % {eta:>4}") {
            bar.set_style(style);
        }
        Self { json, quiet, bar, stop, code, lost: Mutex::default() }
    }

    /// The handle for long work on what `label` names; it shows a bar where stderr is a terminal.
    pub fn progress(&self, label: &str) -> Progress {
        self.progress_until(label, Arc::clone(&self.stop))
    }

    /// [`Console::progress`] for work that `stop` ends in place of a signal.
    pub fn progress_until(&self, label: &str, stop: Arc<AtomicBool>) -> Progress {
        let bar = self.bar.clone();
        bar.reset();
        bar.set_prefix(label.to_owned());
        let mut last = String::new();
        Progress::new(stop, move |stage, share| {
            if last != stage {
                stage.clone_into(&mut last);
                bar.set_message(last.clone());
                bar.reset_elapsed();
                bar.reset_eta();
            }
            bar.set_position((share.clamp(0.0, 1.0) * 1000.0) as u64);
        })
    }

    /// Takes the bar away.
    pub fn done(&self) {
        self.bar.finish_and_clear();
    }

    /// Has a signal come, or the time run out?
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The exit code of what was stopped.
    pub fn stopped_code(&self) -> u8 {
        self.code.load(Ordering::Relaxed) as u8
    }

    /// Why it was stopped.
    pub fn stopped_because(&self) -> &'static str {
        because(self.code.load(Ordering::Relaxed))
    }

    /// Are colours and box drawing wanted?
    pub fn is_fancy(&self) -> bool {
        stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
    }

    /// A result, on stdout: one line of JSON.
    pub fn result(&self, value: &serde_json::Value) {
        let mut line = String::new();
        // JSON lets some of them through, terminals obey them.
        for c in value.to_string().chars() {
            if c.is_control() { line.push_str(&format!("\\u{:04x}", u32::from(c))) } else { line.push(c) }
        }
        self.print(line.as_bytes());
    }

    /// A result, on stdout.
    pub fn line(&self, text: &str) {
        self.print(shown::lines(text).as_bytes());
    }

    /// The result is that `path` was written: its name on stdout, or JSON of it and the fields of `details`.
    pub fn wrote(&self, path: &Path, details: serde_json::Value) {
        if self.json {
            let mut all = serde_json::json!({ "file": path.to_string_lossy() });
            if let (Some(all), serde_json::Value::Object(details)) = (all.as_object_mut(), details) {
                all.extend(details);
            }
            self.result(&all);
        } else if stdout().is_terminal() {
            self.print(shown::path(path).as_bytes());
        } else {
            // As it is, for the next program.
            self.print(path.as_os_str().as_encoded_bytes());
        }
    }

    /// A line on stdout. A closed pipe is no failure: whoever reads has enough.
    fn print(&self, text: &[u8]) {
        if let Err(error) = stdout().write_all(&[text, b"\n"].concat())
            && error.kind() != io::ErrorKind::BrokenPipe
        {
            self.lost.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
    }

    /// Why results could not be written, where any was lost.
    pub fn lost(&self) -> Option<io::Error> {
        self.lost.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Something to know, on stderr.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            self.bar.suspend(|| {
                let _ = writeln!(stderr(), "{}", shown::lines(text));
            });
        }
    }

    /// An error, on stderr.
    pub fn error(&self, text: &str) {
        self.report(&shown::lines(text));
    }

    /// An error, on stderr, whose colours are our own and whose texts are [`shown`].
    pub fn report(&self, text: &str) {
        self.bar.finish_and_clear();
        let _ = writeln!(stderr(), "{text}");
    }
}

fn because(code: i32) -> &'static str {
    if code == OUT_OF_TIME { "the time of --max-seconds is over" } else { "interrupted" }
}

/// On a signal, or after `max_time`, sets `stop`, and `code` to the exit code. Work that has not ended soon after, or by a second
/// signal, ends with the process; nothing temporary is left.
fn heed(stop: Arc<AtomicBool>, code: Arc<AtomicI32>, max_time: Option<Duration>) {
    let (send, come) = channel();
    // Without a thread the system's own handling stays.
    let _ = thread::Builder::new().spawn(move || relay_signals(&send));
    let heed = move || {
        let first = match max_time {
            None => come.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(time) => come.recv_timeout(time),
        };
        let ended = match first {
            Ok(signal) => 128 + signal,
            Err(RecvTimeoutError::Timeout) => OUT_OF_TIME,
            Err(RecvTimeoutError::Disconnected) => return,
        };
        code.store(ended, Ordering::Relaxed);
        stop.store(true, Ordering::Relaxed);
        if come.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Disconnected) {
            let _ = writeln!(stderr(), "{}", because(ended));
            exit(ended);
        }
    };
    let _ = thread::Builder::new().spawn(heed);
}

/// Sends the numbers of signals that ask us to end, for ever.
#[cfg(unix)]
fn relay_signals(come: &Sender<i32>) {
    // What `nohup` starts goes on without its terminal.
    let heeded = ENDING.into_iter().filter(|&number| number != SIGHUP || !is_ignored(number));
    // This does not fail for signals that may be caught.
    if let Ok(mut signals) = signal_hook::iterator::Signals::new(heeded) {
        let _ = signals.forever().try_for_each(|number| come.send(number));
    }
}

/// Looks for an interrupt, for ever.
#[cfg(not(unix))]
fn relay_signals(come: &Sender<i32>) {
    let interrupted = Arc::new(AtomicBool::new(false));
    let _ = signal_hook::flag::register(SIGINT, Arc::clone(&interrupted));
    loop {
        thread::sleep(Duration::from_millis(50));
        if interrupted.swap(false, Ordering::Relaxed) && come.send(SIGINT).is_err() {
            return;
        }
    }
}

/// Were we started not to heed the signal?
#[cfg(unix)]
fn is_ignored(number: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (number - 1) & 1 == 1)
}
