//! Where results go: to files, and to standard output where the name is `-`.

use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Write, stdout};
use std::path::{Path, PathBuf};

use super::console::Console;
use super::error::Failure;
use crate::files::write_atomic;

/// Does the name stand for standard output?
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Writes what `write` writes to the file at `path`, whole or not at all, or to standard output.
pub fn write(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> Result<(), Failure> {
    if is_stdout(path) { to_stdout(write) } else { write_atomic(path, write) }.map_err(|error| {
        Failure::file("write", if is_stdout(path) { Path::new("standard output") } else { path }, &error)
    })
}

/// Says that `path` was written, unless it is where results are told.
pub fn tell(path: &Path, details: serde_json::Value, console: &Console) {
    if !is_stdout(path) {
        console.wrote(path, details);
    }
}

/// A reader that has enough is no failure.
fn to_stdout(write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let file = File::from(duplicate()?);
    let mut buffer = BufWriter::new(&file);
    match write(&mut buffer).and_then(|()| buffer.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
            // What is left is for nobody.
            drop(buffer.into_parts());
            Ok(())
        }
        written => written,
    }
}

#[cfg(unix)]
fn duplicate() -> io::Result<std::os::fd::OwnedFd> {
    std::os::fd::AsFd::as_fd(&stdout()).try_clone_to_owned()
}

#[cfg(windows)]
fn duplicate() -> io::Result<std::os::windows::io::OwnedHandle> {
    std::os::windows::io::AsHandle::as_handle(&stdout()).try_clone_to_owned()
}

/// Refuses standard output for `outputs` where others go there too, or where people would see bytes.
pub fn check(outputs: &[PathBuf], prints_json: bool) -> Result<(), Failure> {
    if !outputs.iter().any(|output| is_stdout(output)) {
        return Ok(());
    }
    if outputs.len() > 1 || prints_json {
        return Err(Failure::Usage("standard output (-) takes one file, and nothing else".to_owned()));
    }
    if stdout().is_terminal() {
        return Err(Failure::Usage("- writes to standard output, which is a terminal here: redirect it".to_owned()));
    }
    Ok(())
}
