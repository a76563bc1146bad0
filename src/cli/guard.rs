//! No output of a call replaces what the call reads.

use std::path::{Path, PathBuf};

use super::error::Failure;
use super::shown;
use crate::files::Inputs;

/// Refuses `outputs` that are among `inputs`, under whatever name.
pub fn refuse_inputs<'a>(inputs: impl IntoIterator<Item = &'a Path>, outputs: &[PathBuf]) -> Result<(), Failure> {
    let mut known = Inputs::default();
    inputs.into_iter().for_each(|path| known.add(path));
    let replaced = outputs.iter().find_map(|output| Some((output, known.replaced_by(output)?)));
    let Some((output, input)) = replaced else { return Ok(()) };
    let what =
        if output == input { "which".to_owned() } else { format!("the same file as {}, which", shown::path(input)) };
    Err(Failure::Usage(format!(
        "{} is an output, {what} is read here: give the output another name",
        shown::path(output)
    )))
}
