//! The command `lichtenberg`: one file a subcommand.

mod args;
mod check;
mod choices;
mod claims;
mod compare;
mod console;
mod draw;
mod error;
mod excerpt;
mod export;
mod guard;
mod info;
mod jobs;
mod list;
mod memory;
mod new;
mod output;
mod pattern;
mod place;
mod preview;
mod render;
mod schema;
mod sheet;
mod shell;
mod shown;
mod strike;
mod terminal;
mod watch;
mod write;

use std::io::Write;
use std::panic::UnwindSafe;
use std::process::ExitCode;
#[cfg(unix)]
use std::sync::Arc;
use std::time::Duration;

use clap::Parser;

use args::{Args, Command};
use console::Console;
use error::Failure;

/// Runs the command with the arguments of the process.
#[must_use]
pub fn main() -> ExitCode {
    std::panic::set_hook(Box::new(report_panic));
    caught(parse_and_run)
}

/// Runs `work`; what a panic leaves behind is taken away while it unwinds.
fn caught(work: impl FnOnce() -> ExitCode + UnwindSafe) -> ExitCode {
    std::panic::catch_unwind(work).unwrap_or(ExitCode::from(INTERNAL_ERROR))
}

/// The exit code of a panic, which is always a fault of the program: `EX_SOFTWARE` of sysexits.h.
const INTERNAL_ERROR: u8 = 70;

/// Says on stderr what a panic is to its user.
fn report_panic(panic: &std::panic::PanicHookInfo<'_>) {
    let message = panic.payload_as_str().unwrap_or("no message");
    let place = panic.location().map_or_else(String::new, |at| format!(" ({}:{})", at.file(), at.line()));
    let _ = writeln!(
        std::io::stderr(),
        "internal error: {message}{place}\nThis is a fault of lichtenberg {}: please report it with the command and its scene.",
        env!("CARGO_PKG_VERSION")
    );
}

fn parse_and_run() -> ExitCode {
    let args = Args::parse();
    let console = Console::new(args.quiet, args.json, args.max_seconds.map(Duration::from_secs));
    let result = args.max_bytes.map_or(Ok(()), limit_files).and_then(|()| run(args, &console)).and_then(|()| {
        match console.lost() {
            None => Ok(()),
            Some(error) => Err(Failure::Usage(format!("cannot write to standard output: {error}"))),
        }
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print(&console);
            ExitCode::from(failure.code(&console))
        }
    }
}

/// No file that we or our children write gets larger than this; what would fails.
#[cfg(unix)]
fn limit_files(max_bytes: u64) -> Result<(), Failure> {
    use rustix::process::{Resource, Rlimit, setrlimit};
    // The signal that comes too would end us where it is not heeded.
    let heeded = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    let limit = Rlimit { current: Some(max_bytes), maximum: Some(max_bytes) };
    heeded
        .and_then(|_| Ok(setrlimit(Resource::Fsize, limit)?))
        .map_err(|error| Failure::Usage(format!("--max-bytes cannot be had: {error}")))
}

#[cfg(not(unix))]
fn limit_files(_max_bytes: u64) -> Result<(), Failure> {
    Err(Failure::Usage("--max-bytes cannot be had on this system".to_owned()))
}

fn run(args: Args, console: &Console) -> Result<(), Failure> {
    let threads = args.threads.map(usize::from);
    // Fails only when a pool is there already, which this process has not made.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build_global();
    match args.command {
        Command::Render(chosen) => render::run(&chosen, threads, console),
        Command::Export(chosen) => export::run(&chosen, console),
        Command::Strike(chosen) => strike::run(&chosen, console),
        Command::Compare(chosen) => compare::run(&chosen, console),
        Command::List => list::run(console),
        Command::New(chosen) => new::run(&chosen, console),
        Command::Check(chosen) => check::run(&chosen, console),
        Command::Info(chosen) => info::run(&chosen, console),
        Command::Schema(chosen) => schema::run(&chosen, console),
        Command::Completions(chosen) => shell::completions(&chosen, console),
        Command::Man => shell::man(console),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Temporary;

    #[test]
    fn panics_are_internal_errors() {
        let folder = tempfile::tempdir().unwrap();
        let code = caught(|| {
            let _temporary = Temporary::folder(|| tempfile::tempdir_in(folder.path())).unwrap();
            panic!("on purpose")
        });
        assert_eq!(code, ExitCode::from(70));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
