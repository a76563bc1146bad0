//! Reports of many pairs: text lines, JUnit XML, and an HTML page with the pictures.

use base64::Engine;
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;

use super::{Measures, Metric};

/// The result of comparing a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It could not be compared.
    Failed,
    /// The pictures differ.
    Different,
    /// There is no expected picture.
    New,
    /// There is no actual picture.
    Missing,
    /// The pictures are the same, within the threshold.
    Same,
}

impl Outcome {
    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Different => "different",
            Self::New => "new",
            Self::Missing => "missing",
            Self::Same => "same",
        }
    }
}

/// Two pictures with the same name.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    /// The path within both folders.
    pub name: String,
    /// The result.
    pub outcome: Outcome,
    /// Why there are no measures.
    pub reason: Option<String>,
    /// Their differences.
    #[serde(flatten)]
    pub measures: Option<Measures>,
    /// The deciding metric.
    pub metric: Metric,
    /// The value of the metric above which the pictures differ.
    pub threshold: f64,
    /// Differing parameters of the scenes in the pictures' metadata.
    pub changes: Vec<String>,
}

/// The pictures of a pair, as PNG, for the HTML page.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// The expected picture.
    pub expected: Option<Vec<u8>>,
    /// The actual picture.
    pub actual: Option<Vec<u8>>,
    /// The FLIP map in false colours.
    pub difference: Option<Vec<u8>>,
}

impl Pair {
    /// Is it the same within the threshold?
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.outcome == Outcome::Same
    }

    /// Its line of a text report: outcome, name, measures or reason.
    #[must_use]
    pub fn line(&self) -> String {
        let mut line = format!("{:<9} {}  {}", self.outcome.name(), self.name, self.told());
        for change in &self.changes {
            line.push_str(&format!("\n          {change}"));
        }
        line
    }

    /// Measures or reason.
    #[must_use]
    pub fn told(&self) -> String {
        match (&self.measures, &self.reason) {
            (Some(m), _) => format!(
                "FLIP {:.4} mean, {:.4} 95 %, {:.4} max; error {:.4} max, {:.5} RMS; {:.3} % of pixels ({} at most {})",
                m.flip,
                m.flip_95,
                m.flip_max,
                m.max,
                m.rms,
                m.share * 100.0,
                self.metric.name(),
                (self.threshold * 1e6).round() / 1e6
            ),
            (None, Some(reason)) => reason.clone(),
            (None, None) => String::new(),
        }
    }
}

/// The summary line of a comparison.
#[must_use]
pub fn summary(pairs: &[Pair]) -> String {
    let same = pairs.iter().filter(|pair| pair.is_same()).count();
    format!("{same} of {} pictures are as expected", pairs.len())
}

/// Fills in a template.
fn fill(text: &str, values: minijinja::Value) -> String {
    let mut engine = Environment::new();
    engine.set_auto_escape_callback(|_| AutoEscape::Html);
    // Embedded templates do not fail: a test fills in each.
    engine.render_str(text, values).unwrap_or_else(|error| error.to_string())
}

/// A text without characters that XML cannot hold (XML 1.0, section 2.2), escaped or not.
fn storable(text: &str) -> String {
    let is_stored = |c: char| !c.is_control() || "\t\n\r".contains(c);
    text.chars().map(|c| if is_stored(c) && !"\u{fffe}\u{ffff}".contains(c) { c } else { '\u{fffd}' }).collect()
}

/// JUnit XML with a test case for each pair.
#[must_use]
pub fn junit(pairs: &[Pair]) -> String {
    let cases: Vec<_> = pairs
        .iter()
        .map(|p| context! { name => storable(&p.name), told => storable(&p.line()), same => p.is_same(), failed => p.outcome == Outcome::Failed })
        .collect();
    let failures = pairs.iter().filter(|p| !p.is_same() && p.outcome != Outcome::Failed).count();
    let errors = pairs.iter().filter(|p| p.outcome == Outcome::Failed).count();
    fill(include_str!("../../templates/compare.junit.xml"), context! { cases, failures, errors, count => pairs.len() })
}

/// A self-contained HTML page: failed pairs first, each with expected, actual, difference and a slider between them.
#[must_use]
pub fn html(pairs: &[(Pair, Panel)]) -> String {
    let url = |png: &Option<Vec<u8>>| {
        png.as_ref()
            .map(|png| format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png)))
    };
    let mut sorted: Vec<&(Pair, Panel)> = pairs.iter().collect();
    sorted.sort_by(|a, b| (a.0.outcome, &a.0.name).cmp(&(b.0.outcome, &b.0.name)));
    let panels: Vec<_> = sorted
        .iter()
        .map(|(pair, panel)| {
            context! {
                name => storable(&pair.name),
                outcome => pair.outcome.name(),
                told => storable(&pair.told()),
                changes => &pair.changes,
                expected => url(&panel.expected),
                actual => url(&panel.actual),
                difference => url(&panel.difference),
            }
        })
        .collect();
    let pairs: Vec<Pair> = pairs.iter().map(|(pair, _)| pair.clone()).collect();
    fill(include_str!("../../templates/compare.html"), context! { panels, summary => summary(&pairs) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_escape_and_count() {
        let pair = |name: &str, outcome| Pair {
            name: name.to_owned(),
            outcome,
            reason: Some("<reason>".to_owned()),
            measures: None,
            metric: Metric::default(),
            threshold: 0.1,
            changes: vec!["a: 1 -> 2".to_owned()],
        };
        let pairs = [pair("a&b.png", Outcome::Same), pair("c.png", Outcome::Different), pair("d.png", Outcome::Failed)];
        let xml = junit(&pairs);
        assert!(xml.contains(r#"tests="3" failures="1" errors="1""#) && xml.contains("a&amp;b.png"), "{xml}");
        assert!(!xml.contains("<reason>"));
        let page = html(&pairs.clone().map(|p| (p, Panel { actual: Some(vec![1, 2, 3]), ..Panel::default() })));
        assert!(page.contains("data:image/png;base64,AQID") && page.contains("1 of 3 pictures"));
        assert!(page.find("d.png") < page.find("a&amp;b.png"), "what failed comes first");
        assert!(!page.contains("http"), "it works offline");
    }
}
