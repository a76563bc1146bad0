//! `completions` and `man`.

use clap::CommandFactory;

use super::args::{Args, CompletionsArgs};
use super::console::Console;
use super::error::Failure;

pub fn completions(args: &CompletionsArgs, console: &Console) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "lichtenberg", &mut text);
    console.line(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}

pub fn man(console: &Console) -> Result<(), Failure> {
    let mut text = Vec::new();
    let mut page = |command: clap::Command| {
        clap_mangen::Man::new(command).render(&mut text).map_err(|e| Failure::Usage(e.to_string()))
    };
    let command = Args::command();
    page(command.clone())?;
    command.get_subcommands().cloned().try_for_each(&mut page)?;
    console.line(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}
