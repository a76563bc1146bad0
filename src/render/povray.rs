//! POV-Ray: one run on a scene in a folder (`reference/povray.md`).

use std::io;
use std::path::Path;
use std::process::Stdio;
use std::sync::mpsc::RecvTimeoutError;

use super::child::{POLL, Watched, command, listen};
use crate::math::{Cancelled, Progress};

/// Lines of POV-Ray's output in an error message.
const WORDS: usize = 12;

/// The parameters of a run of POV-Ray.
#[derive(Clone, Debug)]
pub struct Povray {
    /// Size of the picture, in pixels.
    pub size: [u32; 2],
    /// The crop window: left, top, width, height, in pixels; the rest stays black.
    pub crop: [u32; 4],
    /// Samples along each side of a pixel; 1 for its centre only.
    pub samples: u32,
    /// Declarations on the command line, such as `Name=1`.
    pub declares: Vec<String>,
    /// Number of threads; `None` is POV-Ray's default.
    pub threads: Option<usize>,
}

/// The output of a successful run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rendered {
    /// POV-Ray's warnings.
    pub warnings: Vec<String>,
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PovrayError {
    /// The program is not installed.
    #[error(
        "povray was not found: install it (Debian: apt-get install povray povray-includes), or export the scene with `export --to pov`"
    )]
    Missing,
    /// The program could not be started or waited for.
    #[error("povray could not be run: {0}")]
    Run(#[from] io::Error),
    /// The program failed.
    #[error("povray failed ({status}):\n{words}")]
    Failed {
        /// Its exit status.
        status: String,
        /// Its output, with file and line if given.
        words: String,
    },
    /// Cancelled by its [`Progress`]; the child was killed.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Povray {
    /// Renders the scene file `scene` in `folder` to the PNG file `picture` there.
    ///
    /// # Errors
    /// [`PovrayError`].
    pub fn render(
        &self,
        folder: &Path,
        scene: &str,
        picture: &str,
        progress: &Progress,
    ) -> Result<Rendered, PovrayError> {
        let [width, height] = self.size;
        let mut command = command("povray").map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => PovrayError::Missing,
            _ => PovrayError::Run(error),
        })?;
        command
            .current_dir(folder)
            .args([format!("+I{scene}"), format!("+O{picture}")])
            .args([format!("+W{width}"), format!("+H{height}")])
            // No display, no pause; progress; no streams but errors and warnings.
            .args(["-D", "-P", "+V", "-GR", "-GS", "-GD", "+FN8"]);
        let [left, top, across, down] = self.crop;
        if self.crop != [0, 0, width, height] {
            // From 1, and to the last.
            command.args([format!("+SC{}", left + 1), format!("+EC{}", left + across)]);
            command.args([format!("+SR{}", top + 1), format!("+ER{}", top + down)]);
        }
        if self.samples > 1 {
            command.args(["+A0.0".to_owned(), "+AM1".to_owned(), format!("+R{}", self.samples), "-J".to_owned()]);
        } else {
            command.arg("-A");
        }
        for declare in &self.declares {
            command.arg(format!("Declare={declare}"));
        }
        if let Some(threads) = self.threads {
            command.arg(format!("+WT{threads}"));
        }
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = Watched(command.spawn()?);

        let lines = listen(child.0.stderr.take());
        let mut said = Vec::new();
        loop {
            progress.check()?;
            match lines.recv_timeout(POLL) {
                Ok(line) => match share_done(&line) {
                    Some(share) => progress.report("render", share)?,
                    None => said.push(line),
                },
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        let status = child.wait(progress)??;
        if !status.success() || !folder.join(picture).is_file() {
            return Err(PovrayError::Failed { status: status.to_string(), words: last_words(&said) });
        }
        Ok(Rendered { warnings: warnings(&said) })
    }
}

/// POV-Ray's word for light that goes through leaves: it warns of it, as of all that a later version may change.
const EXPERIMENT: &str = "backside illumination.";

/// The warnings among what povray said, but for that of [`EXPERIMENT`] alone.
fn warnings(said: &[String]) -> Vec<String> {
    let next = said.iter().skip(1).map(String::as_str).chain(std::iter::once(""));
    let is_warning = |line: &str, next: &str| {
        line.contains("Warning") && !(line.contains("experimental feature") && next.starts_with(EXPERIMENT))
    };
    said.iter().zip(next).filter(|(line, next)| is_warning(line, next)).map(|(line, _)| line.clone()).collect()
}

/// The share done in a line such as `Rendered 1024 of 19200 pixels (5%)`.
fn share_done(line: &str) -> Option<f64> {
    let mut words = line.strip_prefix("Rendered ")?.split_whitespace();
    let done: f64 = words.next()?.parse().ok()?;
    let all: f64 = words.nth(1)?.parse().ok()?;
    (all > 0.0).then(|| done / all)
}

/// The output from the first line with an error on, otherwise the last lines.
fn last_words(said: &[String]) -> String {
    let first = said
        .iter()
        .position(|line| line.contains("Error") || line.contains("error:"))
        .unwrap_or(said.len().saturating_sub(WORDS));
    let words: Vec<_> = said[first..].iter().take(WORDS).map(String::as_str).collect();
    if words.is_empty() { "it said nothing".to_owned() } else { words.join("\n") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_through_leaves_is_no_matter_to_warn_of() {
        let said = |feature: &str| {
            ["Parse Warning: This rendering uses the following experimental feature(s):", feature, "and so on"]
                .map(str::to_owned)
        };
        assert!(warnings(&said("backside illumination. The design and")).is_empty());
        assert_eq!(warnings(&said("tiff, backside illumination.")).len(), 1);
        assert_eq!(warnings(&said("x")[..1]).len(), 1);
    }

    #[test]
    fn reads_progress() {
        assert_eq!(share_done("Rendered 1024 of 4096 pixels (25%)"), Some(0.25));
        assert_eq!(share_done("Parsing 4484K tokens"), None);
    }
}
