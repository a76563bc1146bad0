//! The texts that exporters fill in: the project's own, or an artist's.

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Serde, Value};
use minijinja::{AutoEscape, Environment, UndefinedBehavior};
use serde::Serialize;

/// The embedded templates by file name.
const EMBEDDED: [(&str, &str); 8] = [
    ("scene.inc", include_str!("../../templates/scene.inc")),
    ("scene.pov", include_str!("../../templates/scene.pov")),
    ("scene.ini", include_str!("../../templates/scene.ini")),
    ("scene.rib", include_str!("../../templates/scene.rib")),
    ("thorns.sl", include_str!("../../templates/thorns.sl")),
    ("leaf.sl", include_str!("../../templates/leaf.sl")),
    ("pattern.sl", include_str!("../../templates/pattern.sl")),
    ("fadepoint.sl", include_str!("../../templates/fadepoint.sl")),
];

/// A template that cannot be filled in.
#[derive(Debug, thiserror::Error)]
#[error("template {name}: {message}")]
pub struct TemplateError {
    /// Its file name.
    pub name: String,
    /// The template engine's words, with the line.
    pub message: String,
}

/// Templates by file name.
#[derive(Clone, Debug)]
pub struct Templates {
    texts: BTreeMap<String, String>,
}

impl Default for Templates {
    fn default() -> Self {
        Self { texts: EMBEDDED.map(|(name, text)| (name.to_owned(), text.to_owned())).into() }
    }
}

impl Templates {
    /// The names of all templates.
    pub fn names() -> impl Iterator<Item = &'static str> {
        EMBEDDED.iter().map(|(name, _)| *name)
    }

    /// Takes `text` in place of the template called `name`.
    pub fn replace(&mut self, name: &str, text: String) {
        self.texts.insert(name.to_owned(), text);
    }

    /// The text of the template called `name`, as it is.
    #[must_use]
    pub fn text(&self, name: &str) -> &str {
        self.texts.get(name).map_or("", String::as_str)
    }

    /// The template called `name`, filled in with `values`.
    ///
    /// # Errors
    /// [`TemplateError`] with the line, where the template is wrong or asks for a value that there is not.
    pub fn fill(&self, name: &str, values: impl Serialize) -> Result<String, TemplateError> {
        let mut engine = Environment::new();
        engine.set_undefined_behavior(UndefinedBehavior::SemiStrict);
        engine.set_auto_escape_callback(|_| AutoEscape::None);
        let lines = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true).build();
        let error = |error: minijinja::Error| TemplateError { name: name.to_owned(), message: error.to_string() };
        engine.set_syntax(lines.map_err(error)?);
        engine
            .template_from_named_str(name, self.texts.get(name).map_or("", String::as_str))
            .and_then(|template| template.render(Value::from(Serde(values))))
            .map_err(error)
    }
}
