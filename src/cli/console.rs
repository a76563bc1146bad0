//! What the command says: results on stdout, everything else on stderr.

use std::io::{self, IsTerminal, Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
#[cfg(unix)]
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
#[cfg(unix)]
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use signal_hook::consts::SIGINT;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGQUIT, SIGTERM};

#[cfg(unix)]
use crate::files::exit;
use crate::math::Progress;

/// Signals that ask us to end.
#[cfg(unix)]
const ENDING: [i32; 4] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT];

/// Work that does not look whether to stop has so long to end by itself.
#[cfg(unix)]
const PATIENCE: Duration = Duration::from_millis(600);

/// The command's voice, and its ear for signals.
pub struct Console {
    /// Results as JSON?
    pub json: bool,
    quiet: bool,
    bar: ProgressBar,
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicI32>,
    lost: Mutex<Option<io::Error>>,
}

impl Console {
    pub fn new(quiet: bool, json: bool) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let signal = Arc::new(AtomicI32::new(SIGINT));
        heed_signals(Arc::clone(&stop), Arc::clone(&signal));
        let shown = !quiet && !json && stderr().is_terminal();
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(1000), target);
        if let Ok(style) = ProgressStyle::with_template("{prefix} {msg:8} {wide_bar} {percent:>3} % {eta:>4}") {
            bar.set_style(style);
        }
        Self { json, quiet, bar, stop, signal, lost: Mutex::default() }
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

    /// Has a signal come?
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The number of the signal that came, if one came.
    pub fn signal(&self) -> u8 {
        self.signal.load(Ordering::Relaxed) as u8
    }

    /// Are colours and box drawing wanted?
    pub fn is_fancy(&self) -> bool {
        stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
    }

    /// A result, on stdout: one line of JSON.
    pub fn result(&self, value: &serde_json::Value) {
        self.line(&value.to_string());
    }

    /// A result, on stdout. A closed pipe is no failure: whoever reads has enough.
    pub fn line(&self, text: &str) {
        if let Err(error) = writeln!(stdout(), "{text}")
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
                let _ = writeln!(stderr(), "{text}");
            });
        }
    }

    /// An error, on stderr.
    pub fn error(&self, text: &str) {
        self.bar.finish_and_clear();
        let _ = writeln!(stderr(), "{text}");
    }
}

/// On a signal sets `stop`, and `signal` to its number. Work that has not ended soon after, or by a second signal, ends with the
/// process; nothing temporary is left.
#[cfg(unix)]
fn heed_signals(stop: Arc<AtomicBool>, signal: Arc<AtomicI32>) {
    // What `nohup` starts goes on without its terminal.
    let heeded = ENDING.into_iter().filter(|&number| number != SIGHUP || !is_ignored(number));
    // Neither fails for signals that may be caught; without a thread the system's own handling stays.
    let Ok(mut signals) = signal_hook::iterator::Signals::new(heeded) else { return };
    let (send, come) = channel();
    let relay = move || signals.forever().try_for_each(|number| send.send(number));
    let heed = move || {
        let Ok(number) = come.recv() else { return };
        signal.store(number, Ordering::Relaxed);
        stop.store(true, Ordering::Relaxed);
        if come.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Disconnected) {
            let _ = writeln!(stderr(), "interrupted");
            exit(128 + number);
        }
    };
    let _ = std::thread::Builder::new().spawn(relay);
    let _ = std::thread::Builder::new().spawn(heed);
}

#[cfg(not(unix))]
fn heed_signals(stop: Arc<AtomicBool>, _signal: Arc<AtomicI32>) {
    let _ = signal_hook::flag::register_conditional_shutdown(SIGINT, 128 + SIGINT, Arc::clone(&stop));
    let _ = signal_hook::flag::register(SIGINT, stop);
}

/// Were we started not to heed the signal?
#[cfg(unix)]
fn is_ignored(number: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (number - 1) & 1 == 1)
}
