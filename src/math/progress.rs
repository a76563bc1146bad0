//! The handle by which long work reports progress and is cancelled.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// Work was stopped by its [`Progress`] handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

type Listener = dyn FnMut(&str, f64) + Send;

/// Reports progress and carries cancellation. Clones share both; the default reports nothing and is never cancelled.
#[derive(Clone, Default)]
pub struct Progress {
    stop: Arc<AtomicBool>,
    listener: Option<Arc<Mutex<Listener>>>,
}

impl Progress {
    /// A handle that is cancelled when `stop` becomes true and reports stage and share done (0 to 1) to `listener`.
    pub fn new(stop: Arc<AtomicBool>, listener: impl FnMut(&str, f64) + Send + 'static) -> Self {
        Self { stop, listener: Some(Arc::new(Mutex::new(listener))) }
    }

    /// Reports that `share` (0 to 1) of `stage` is done.
    ///
    /// # Errors
    /// [`Cancelled`] once the work is to stop; callers pass it on with `?`.
    pub fn report(&self, stage: &str, share: f64) -> Result<(), Cancelled> {
        if let Some(listener) = &self.listener
            && let Ok(mut listener) = listener.lock()
        {
            listener(stage, share);
        }
        self.check()
    }

    /// Tests for cancellation without a report.
    ///
    /// # Errors
    /// [`Cancelled`] once the work is to stop.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.stop.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }
}

impl std::fmt::Debug for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress").field("stop", &self.stop).finish_non_exhaustive()
    }
}
