//! How the command fails: one clear error and an exit code.

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteDiagnostic, Report};

use super::console::Console;
use super::excerpt::Excerpt;
use super::shown;
use crate::render::{PovrayError, RibError};
use crate::scene::{SceneError, Stage};

/// Why the command did not do what was asked.
#[derive(Debug)]
pub enum Failure {
    /// The scene is wrong.
    Scene(SceneError),
    /// The call or its files are wrong.
    Usage(String),
    /// The answer is no.
    No(String),
    /// An outside program failed.
    Outside(String),
    /// Interrupted.
    Stopped,
}

impl Failure {
    /// A usage error about a file.
    pub fn file(action: &str, path: &std::path::Path, error: &std::io::Error) -> Self {
        let hint = if error.kind() == std::io::ErrorKind::FileTooLarge {
            ", more than --max-bytes or the system allows"
        } else {
            ""
        };
        Self::Usage(format!("cannot {action} {}: {error}{hint}", shown::path(path)))
    }

    /// 1 the answer is no, 2 bad usage or scene, 3 an outside program failed, 124 out of time, 128 + signal interrupted.
    pub fn code(&self, console: &Console) -> u8 {
        match self {
            Self::No(_) => 1,
            Self::Scene(_) | Self::Usage(_) => 2,
            Self::Outside(_) => 3,
            Self::Stopped => console.stopped_code(),
        }
    }

    /// Prints the error on stderr, and as JSON on stdout where that is wanted.
    pub fn print(&self, console: &Console) {
        if console.json {
            console.result(&self.to_json(console));
        }
        match self {
            Self::Stopped => console.error(console.stopped_because()),
            Self::Usage(text) | Self::No(text) | Self::Outside(text) => console.error(&format!("error: {text}")),
            Self::Scene(error) => print_scene(error, console),
        }
    }

    fn to_json(&self, console: &Console) -> serde_json::Value {
        let mistakes = match self {
            Self::Scene(error) => mistakes(error),
            Self::Usage(text) | Self::No(text) | Self::Outside(text) => {
                vec![serde_json::json!({ "message": text })]
            }
            Self::Stopped => vec![serde_json::json!({ "message": console.stopped_because() })],
        };
        match self {
            Self::Scene(error) if error.told().1 > 0 => {
                serde_json::json!({ "errors": mistakes, "more": error.told().1 })
            }
            _ => serde_json::json!({ "errors": mistakes }),
        }
    }
}

/// Mistakes as JSON: scene, file (the scene or what it includes), line, column, place, message.
fn mistakes(error: &SceneError) -> Vec<serde_json::Value> {
    let mistakes = error.told().0.iter().map(|mistake| {
        let at = error.line_column(mistake);
        serde_json::json!({
            "scene": error.name,
            "file": error.file(mistake).0,
            "line": at.map(|(line, _)| line),
            "column": at.map(|(_, column)| column),
            "place": mistake.place,
            "message": mistake.message,
        })
    });
    mistakes.collect()
}

/// Prints each mistake with the lines around it.
fn print_scene(error: &SceneError, console: &Console) {
    let theme = if console.is_fancy() { GraphicalTheme::unicode() } else { GraphicalTheme::none() };
    let handler = GraphicalReportHandler::new_themed(theme);
    let (told, more) = error.told();
    for mistake in told {
        let place = if mistake.place.is_empty() { String::new() } else { format!("{}: ", mistake.place) };
        let message = format!("{place}{}", mistake.message);
        let mut diagnostic = MietteDiagnostic::new(shown::lines(&message));
        let (name, source) = error.file(mistake);
        let name = &shown::line(name);
        let report = match &mistake.span {
            Some(span) => {
                let excerpt = Excerpt::new(name, source, &span.range);
                diagnostic.labels = Some(vec![LabeledSpan::at(excerpt.mistake.clone(), "here")]);
                Report::new(diagnostic).with_source_code(excerpt)
            }
            None => {
                diagnostic.message = format!("{name}: {}", diagnostic.message);
                Report::new(diagnostic)
            }
        };
        let mut text = String::new();
        if handler.render_report(&mut text, report.as_ref()).is_err() {
            text = format!("{name}: {}", shown::lines(&message));
        }
        console.report(text.trim_end());
    }
    if more > 0 {
        console.error(&format!("... and {more} more"));
    }
}

impl From<Stage> for Failure {
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::Scene(error) => Self::Scene(error),
            Stage::Memory { .. } => Self::Usage(stage.to_string()),
            Stage::Cancelled(_) => Self::Stopped,
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

impl From<PovrayError> for Failure {
    fn from(error: PovrayError) -> Self {
        match error {
            PovrayError::Cancelled(_) => Self::Stopped,
            error => Self::Outside(error.to_string()),
        }
    }
}

impl From<RibError> for Failure {
    fn from(error: RibError) -> Self {
        match error {
            RibError::Cancelled(_) => Self::Stopped,
            error => Self::Outside(error.to_string()),
        }
    }
}
