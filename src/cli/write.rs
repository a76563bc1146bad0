//! Scenes for renderers as files: what people edit stays as they left it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::{Compression, GzBuilder};

use super::error::Failure;
use super::shown;
use crate::export::{Pov, Rib, RibPart, Templates};
use crate::files::{encode_exr, is_edited, seal, write_atomic, write_bytes};

/// The templates, those in `folder` in place of the program's own.
pub fn read_templates(folder: Option<&Path>) -> Result<Templates, Failure> {
    let mut templates = Templates::default();
    let Some(folder) = folder else { return Ok(templates) };
    let mut found = false;
    for name in Templates::names() {
        let path = folder.join(name);
        match fs::read_to_string(&path) {
            Ok(text) => {
                templates.replace(name, text);
                found = true;
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(Failure::file("read", &path, &error)),
        }
    }
    if found {
        return Ok(templates);
    }
    let names: Vec<_> = Templates::names().collect();
    Err(Failure::Usage(format!("{} has none of the templates {}", shown::path(folder), names.join(", "))))
}

/// What writing a scene did.
pub struct Written {
    /// Files written.
    pub files: Vec<PathBuf>,
    /// Files left alone because they were edited.
    pub kept: Vec<PathBuf>,
}

/// Writes NAME.inc, with NAME-stage.inc, always, and NAME.pov and NAME.ini, unless they were edited.
pub fn write_pov(pov: &Pov<'_>, folder: &Path, name: &str, force: bool) -> Result<Written, Failure> {
    let inc = folder.join(format!("{name}.inc"));
    // Filled in before anything is written, so that a wrong template changes no file.
    let texts = [
        (folder.join(format!("{name}.pov")), "//", pov.scene()),
        (folder.join(format!("{name}.ini")), ";", pov.settings()),
    ];
    let mut filled = Vec::new();
    for (path, comment, text) in texts {
        filled.push((seal(comment, &text.map_err(|e| failure(&path, e))?), path));
    }
    write_atomic(&inc, |out| pov.write_inc(out)).map_err(|e| failure(&inc, e))?;
    let mut written = Written { files: vec![inc], kept: Vec::new() };
    if pov.has_stage() {
        let path = folder.join(format!("{name}-stage.inc"));
        write_atomic(&path, |out| pov.write_stage(out)).map_err(|e| failure(&path, e))?;
        written.files.push(path);
    }
    if let Some((sky, strength)) = pov.sky() {
        let path = folder.join(format!("{name}-sky.exr"));
        write_atomic(&path, |out| out.write_all(&encode_exr(&sky.layers(strength))?)).map_err(|e| failure(&path, e))?;
        written.files.push(path);
    }
    for (text, path) in filled {
        written.keep_or_write(&text, path, force)?;
    }
    Ok(written)
}

/// Writes NAME.archive.rib and what else belongs to it, always, and NAME.rib, unless it was edited; the shaders that the scene uses and no renderer has.
pub fn write_rib(rib: &Rib<'_>, folder: &Path, name: &str, gzip: bool, force: bool) -> Result<Written, Failure> {
    let archive = folder.join(format!("{name}.archive.rib"));
    let scene = folder.join(format!("{name}.rib"));
    let text = seal("#", &rib.scene().map_err(|e| failure(&scene, e))?);
    let shaders = rib.shaders().map_err(|e| failure(&scene, e))?;
    let mut written = Written { files: Vec::new(), kept: Vec::new() };
    let casters = rib.has_casters().then(|| (folder.join(format!("{name}.casters.rib")), RibPart::Casters));
    let stage = rib.has_stage().then(|| (folder.join(format!("{name}.stage.rib")), RibPart::Stage));
    for (path, part) in std::iter::once((archive, RibPart::Archive)).chain(casters).chain(stage) {
        let write = |out: &mut dyn Write| rib.write_part(part, out);
        write_atomic(&path, |out| {
            if !gzip {
                return write(out);
            }
            let mut packed = GzBuilder::new().write(out, Compression::default());
            write(&mut packed)?;
            packed.finish().map(|_| ())
        })
        .map_err(|e| failure(&path, e))?;
        written.files.push(path);
    }
    for (file, shader) in shaders {
        let path = folder.join(file);
        // One that differs was edited.
        let is_kept = !force && fs::read(&path).is_ok_and(|old| old != shader.as_bytes());
        if is_kept {
            written.kept.push(path);
        } else {
            write_bytes(&path, shader.as_bytes()).map_err(|e| failure(&path, e))?;
            written.files.push(path);
        }
    }
    written.keep_or_write(&text, scene, force)?;
    Ok(written)
}

impl Written {
    /// Writes a file that people edit, unless one did.
    fn keep_or_write(&mut self, text: &str, path: PathBuf, force: bool) -> Result<(), Failure> {
        let edited = match fs::read_to_string(&path) {
            Ok(old) => is_edited(&old),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => false,
            // Not what we wrote.
            Err(error) if error.kind() == std::io::ErrorKind::InvalidData => true,
            Err(error) => return Err(failure(&path, error)),
        };
        if edited && !force {
            self.kept.push(path);
            return Ok(());
        }
        write_bytes(&path, text.as_bytes()).map_err(|e| failure(&path, e))?;
        self.files.push(path);
        Ok(())
    }
}

fn failure(path: &Path, error: std::io::Error) -> Failure {
    match error.kind() {
        // The template's own error says which it is.
        std::io::ErrorKind::InvalidData => Failure::Usage(error.to_string()),
        _ => Failure::file("write", path, &error),
    }
}
