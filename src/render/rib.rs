//! RenderMan renderers: one run on a RIB scene in a folder (`reference/rib.md`).

use std::io;
use std::path::Path;
use std::process::Stdio;
use std::sync::mpsc::RecvTimeoutError;

use super::child::{POLL, Watched, command, listen};
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

    /// Renders the RIB file `scene` in `folder`, which writes the file `picture` there.
    ///
    /// Both programs exit with 0 after most errors: a run succeeds only if it wrote nothing, its status is 0 and the picture
    /// exists.
    ///
    /// # Errors
    /// [`RibError`].
    pub fn render(self, folder: &Path, scene: &str, picture: &str, progress: &Progress) -> Result<(), RibError> {
        let program = self.program();
        let mut command = command(program).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => RibError::Missing(program),
            _ => RibError::Run(program, error),
        })?;
        command.current_dir(folder).arg(scene);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = Watched(command.spawn().map_err(|error| RibError::Run(program, error))?);
        let streams = [listen(child.0.stdout.take()), listen(child.0.stderr.take())];
        let mut said: Vec<String> = Vec::new();
        for lines in streams {
            loop {
                progress.check()?;
                match lines.recv_timeout(POLL) {
                    Ok(line) => said.push(line),
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => break,
                }
            }
        }
        let status = child.wait(progress)?.map_err(|error| RibError::Run(program, error))?;
        let how = if !status.success() {
            status.to_string()
        } else if !said.is_empty() {
            "it did not stay silent".to_owned()
        } else if !folder.join(picture).is_file() {
            "it made no picture".to_owned()
        } else {
            return Ok(());
        };
        let words = said.iter().take(WORDS).cloned().collect::<Vec<_>>().join("\n");
        Err(RibError::Failed { program, how, words })
    }
}
