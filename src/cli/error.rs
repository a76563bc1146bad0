//! How the command fails: one clear error and an exit code.

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteDiagnostic, Report};

use super::console::Console;
use super::excerpt::Excerpt;
use crate::render::{PovrayError, RibError};
use crate::scene::{SceneError, Stage};

/// Mistakes that are told of a scene: those after them are counted.
const MOST_MISTAKES: usize = 20;

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
        Self::Usage(format!("cannot {action} {}: {error}", path.display()))
    }

    /// 1 the answer is no, 2 bad usage or scene, 3 an outside program failed, 128 + signal interrupted.
    pub fn code(&self, console: &Console) -> u8 {
        match self {
            Self::No(_) => 1,
            Self::Scene(_) | Self::Usage(_) => 2,
            Self::Outside(_) => 3,
            Self::Stopped => 128 + console.signal(),
        }
    }

    /// Prints the error on stderr, and as JSON on stdout where that is wanted.
    pub fn print(&self, console: &Console) {
        if console.json {
            console.result(&self.to_json());
        }
        match self {
            Self::Stopped => console.error("interrupted"),
            Self::Usage(text) | Self::No(text) | Self::Outside(text) => console.error(&format!("error: {text}")),
            Self::Scene(error) => print_scene(error, console),
        }
    }

    fn to_json(&self) -> serde_json::Value {
        let mistakes = match self {
            Self::Scene(error) => mistakes(error),
            Self::Usage(text) | Self::No(text) | Self::Outside(text) => {
                vec![serde_json::json!({ "message": text })]
            }
            Self::Stopped => vec![serde_json::json!({ "message": "interrupted" })],
        };
        match self {
            Self::Scene(error) if more(error) > 0 => {
                serde_json::json!({ "errors": mistakes, "more": more(error) })
            }
            _ => serde_json::json!({ "errors": mistakes }),
        }
    }
}

/// The number of mistakes that are not told.
fn more(error: &SceneError) -> usize {
    error.mistakes.len().saturating_sub(MOST_MISTAKES)
}

/// Mistakes as JSON: scene, file (the scene or what it includes), line, column, place, message.
fn mistakes(error: &SceneError) -> Vec<serde_json::Value> {
    let mistakes = error.mistakes.iter().take(MOST_MISTAKES).map(|mistake| {
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
    for mistake in error.mistakes.iter().take(MOST_MISTAKES) {
        let place = if mistake.place.is_empty() { String::new() } else { format!("{}: ", mistake.place) };
        let mut diagnostic = MietteDiagnostic::new(format!("{place}{}", mistake.message));
        let (name, source) = error.file(mistake);
        let report = match &mistake.span {
            Some(span) => {
                let excerpt = Excerpt::new(name, source, &span.range);
                diagnostic.labels = Some(vec![LabeledSpan::at(excerpt.mistake.clone(), "here")]);
                Report::new(diagnostic).with_source_code(excerpt)
            }
            None => {
                diagnostic.message = format!("{}: {}", error.name, diagnostic.message);
                Report::new(diagnostic)
            }
        };
        let mut text = String::new();
        if handler.render_report(&mut text, report.as_ref()).is_err() {
            text = format!("{name}: {place}{}", mistake.message);
        }
        console.error(text.trim_end());
    }
    if more(error) > 0 {
        console.error(&format!("... and {} more", more(error)));
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
