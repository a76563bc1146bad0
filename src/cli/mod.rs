//! The command `lichtenberg`: one file a subcommand.

mod args;
mod check;
mod compare;
mod console;
mod draw;
mod error;
mod export;
mod info;
mod jobs;
mod list;
mod memory;
mod new;
mod place;
mod preview;
mod render;
mod schema;
mod sheet;
mod shell;
mod strike;
mod terminal;
mod watch;
mod write;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};
use console::Console;
use error::Failure;

/// Runs the command with the arguments of the process.
#[must_use]
pub fn main() -> ExitCode {
    let args = Args::parse();
    let console = Console::new(args.quiet, args.json);
    match run(args, &console) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print(&console);
            ExitCode::from(failure.code(&console))
        }
    }
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
