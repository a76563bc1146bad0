//! Child processes that are killed with us.

use std::io::{self, Read};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use crate::math::{Cancelled, Progress};

/// Interval of the tests for cancellation.
pub(super) const POLL: Duration = Duration::from_millis(50);

/// Has the program after it killed when the thread that started it ends, be it by KILL (util-linux).
const UNTIL_DEATH: [&str; 4] = ["setpriv", "--pdeathsig", "KILL", "--"];

/// A command that runs `program` in a process group of its own and, on Linux, not beyond our own death.
///
/// # Errors
/// [`io::ErrorKind::NotFound`] where it is not on the PATH.
pub(super) fn command(program: &str) -> io::Result<Command> {
    let program = find(program).ok_or(io::ErrorKind::NotFound)?;
    let mut command = if dies_with_us() {
        let mut command = Command::new(UNTIL_DEATH[0]);
        command.args(&UNTIL_DEATH[1..]).arg(program);
        command
    } else {
        Command::new(program)
    };
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    Ok(command)
}

/// The stack that Pixie takes: it frees what it has read by a call for each primitive within that for the one before, which takes
/// eight megabytes for half a million.
const STACK: u64 = 1 << 30;

/// Children may have a stack as deep as Pixie wants.
pub(super) fn deepen_stack() {
    #[cfg(unix)]
    {
        use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
        let Rlimit { current, maximum } = getrlimit(Resource::Stack);
        let wanted = maximum.unwrap_or(STACK).min(STACK);
        if current.is_some_and(|current| current < wanted) {
            // Without it, most scenes go as well.
            let _ = setrlimit(Resource::Stack, Rlimit { current: Some(wanted), maximum });
        }
    }
}

/// Where `program` is on the PATH.
fn find(program: &str) -> Option<PathBuf> {
    let file = format!("{program}{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&std::env::var_os("PATH")?).map(|folder| folder.join(&file)).find(|path| path.is_file())
}

/// Is there a program that binds the life of another to ours? Some systems have a lesser one of the same name.
fn dies_with_us() -> bool {
    let [setpriv, arguments @ ..] = UNTIL_DEATH;
    let mut trial = Command::new(setpriv);
    trial.args(arguments).arg("true").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    cfg!(target_os = "linux") && trial.status().is_ok_and(|status| status.success())
}

/// A child process that is killed on drop, with all that it started.
pub(super) struct Watched(pub Child);

impl Drop for Watched {
    fn drop(&mut self) {
        // Another group may have the number of one that has been waited for.
        #[cfg(unix)]
        if let Ok(None) = self.0.try_wait() {
            use rustix::process::{Pid, Signal, kill_process_group};
            let _ = kill_process_group(Pid::from_child(&self.0), Signal::KILL);
        }
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
