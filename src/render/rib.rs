//! RenderMan renderers: one run on a RIB scene in a folder (`reference/rib.md`).

use std::io;
use std::path::Path;
use std::process::Stdio;
use std::sync::mpsc::RecvTimeoutError;

use super::child::{POLL, Watched, command, deepen_stack, listen};
use crate::math::{Cancelled, Progress};

/// Lines of a renderer's output in an error message.
const WORDS: usize = 12;

/// A renderer that reads RIB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RibRenderer {
    /// Pixie, by `rndr`.
    Pixie,
    /// Aqsis, by `aqsis`.
    Aqsis,
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RibError {
    /// The program is not installed.
    #[error("{0} was not found: install it and put it on the PATH, or export the scene with `export --to rib`")]
    Missing(&'static str),
    /// The program could not be started or waited for.
    #[error("{0} could not be run: {1}")]
    Run(&'static str, io::Error),
    /// The program failed, whatever its exit status.
    #[error("{program} failed ({how}):\n{words}")]
    Failed {
        /// Its name.
        program: &'static str,
        /// How it failed.
        how: String,
        /// Its output.
        words: String,
    },
    /// Cancelled by its [`Progress`]; the child was killed.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl RibRenderer {
    /// The name of its program.
    #[must_use]
    pub fn program(self) -> &'static str {
        match self {
            Self::Pixie => "rndr",
            Self::Aqsis => "aqsis",
        }
    }

    /// The name of its compiler of shaders.
    #[must_use]
    pub fn compiler(self) -> &'static str {
        match self {
            Self::Pixie => "sdrc",
            Self::Aqsis => "aqsl",
        }
    }

    /// Compiles the shader `file` in `folder`, beside it.
    ///
    /// # Errors
    /// [`RibError`].
    pub fn compile(self, folder: &Path, file: &str, progress: &Progress) -> Result<(), RibError> {
        let (said, how) = run(self.compiler(), folder, &[file], progress, &mut |_| Ok(false))?;
        // What they say of their work is no fault.
        how.map_or(Ok(()), |how| Err(failed(self.compiler(), how, &said)))
    }

    /// Renders the RIB file `scene` in `folder`, which writes the file `picture` there.
    ///
    /// Both programs exit with 0 after most errors: a run succeeds only if it told nothing but its progress, its status is 0 and the
    /// picture exists.
    ///
    /// # Errors
    /// [`RibError`].
    pub fn render(self, folder: &Path, scene: &str, picture: &str, progress: &Progress) -> Result<(), RibError> {
        deepen_stack();
        let asked = match self {
            Self::Pixie => "-p",
            Self::Aqsis => "-Progress",
        };
        let (said, how) = run(self.program(), folder, &[asked, scene], progress, &mut |line| {
            let Some(share) = share_done(line) else { return Ok(false) };
            share.map_or(Ok(()), |share| progress.report("render", share))?;
            Ok(true)
        })?;
        let how = if how.is_some() {
            how
        } else if !said.is_empty() {
            Some("it did not stay silent".to_owned())
        } else if !folder.join(picture).is_file() {
            Some("it made no picture".to_owned())
        } else {
            None
        };
        how.map_or(Ok(()), |how| Err(failed(self.program(), how, &said)))
    }
}

/// Runs `program` in `folder`: what it said but for the lines that `takes` takes, and its status, if that is no success.
fn run(
    program: &'static str,
    folder: &Path,
    arguments: &[&str],
    progress: &Progress,
    takes: &mut dyn FnMut(&str) -> Result<bool, Cancelled>,
) -> Result<(Vec<String>, Option<String>), RibError> {
    let mut command = command(program).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => RibError::Missing(program),
        _ => RibError::Run(program, error),
    })?;
    command.current_dir(folder).args(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = Watched(command.spawn().map_err(|error| RibError::Run(program, error))?);
    let streams = [listen(child.0.stdout.take()), listen(child.0.stderr.take())];
    let mut said: Vec<String> = Vec::new();
    for lines in streams {
        loop {
            progress.check()?;
            match lines.recv_timeout(POLL) {
                Ok(line) if takes(&line)? => {}
                Ok(line) => said.push(line),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
    }
    let status = child.wait(progress)?.map_err(|error| RibError::Run(program, error))?;
    Ok((said, (!status.success()).then(|| status.to_string())))
}

fn failed(program: &'static str, how: String, said: &[String]) -> RibError {
    let words = said.iter().take(WORDS).cloned().collect::<Vec<_>>().join("\n");
    RibError::Failed { program, how, words }
}

/// The share done in a line such as Pixie's `Done % 81.25` or Aqsis' `R90000 98.00%`; Pixie ends with a bare `Done`.
#[allow(clippy::option_option, reason = "no line of progress, one without a number, one with it")]
fn share_done(line: &str) -> Option<Option<f64>> {
    let rest = line.strip_prefix("Done").or_else(|| line.strip_prefix("R90000"))?;
    let number = rest.trim_matches(|c: char| c.is_whitespace() || c == '%');
    if number.is_empty() {
        return Some(None);
    }
    number.parse::<f64>().ok().map(|percent| Some(percent / 100.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_progress() {
        assert_eq!(share_done("Done %81.25"), Some(Some(0.8125)));
        assert_eq!(share_done("R90000100.00%"), Some(Some(1.0)));
        assert_eq!(share_done("Done"), Some(None));
        assert_eq!(share_done("scene.rib (3): no such shader"), None);
    }
}
