//! What the command says: results on stdout, everything else on stderr.

use std::io::{IsTerminal, Write, stderr, stdout};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use signal_hook::consts::{SIGINT, SIGTERM};

use crate::math::Progress;

/// The command's voice, and its ear for signals.
pub struct Console {
    /// Results as JSON?
    pub json: bool,
    quiet: bool,
    bar: ProgressBar,
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
}

impl Console {
    pub fn new(quiet: bool, json: bool) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let signal = Arc::new(AtomicUsize::new(SIGINT as usize));
        for number in [SIGINT, SIGTERM] {
            // The second signal ends us at once. None of these fails for signals that may be caught.
            let _ = signal_hook::flag::register_conditional_shutdown(number, 128 + number, Arc::clone(&stop));
            let _ = signal_hook::flag::register_usize(number, Arc::clone(&signal), number as usize);
            let _ = signal_hook::flag::register(number, Arc::clone(&stop));
        }
        let shown = !quiet && !json && stderr().is_terminal();
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(1000), target);
        if let Ok(style) = ProgressStyle::with_template("{prefix} {msg:8} {wide_bar} {percent:>3} % {eta:>4}") {
            bar.set_style(style);
        }
        Self { json, quiet, bar, stop, signal }
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

    /// A result, on stdout. A closed pipe is no failure.
    pub fn line(&self, text: &str) {
        let _ = writeln!(stdout(), "{text}");
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
