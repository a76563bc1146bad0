//! Numbers that may vary over the rounds of a repeated step.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// A number for all rounds, a list with one for each (the last repeats), or a geometric progression.
#[derive(Clone, Debug, PartialEq)]
pub enum PerRound {
    /// The same in every round.
    All(f64),
    /// One for each round, at least one; the last repeats.
    Each(Vec<f64>),
    /// A geometric progression.
    Ratio {
        /// The first term.
        first: f64,
        /// Each term over the one before.
        ratio: f64,
    },
}

impl PerRound {
    /// The number in `round`, counted from 0.
    #[must_use]
    pub fn at(&self, round: u32) -> f64 {
        match self {
            Self::All(number) => *number,
            Self::Each(numbers) => numbers[(round as usize).min(numbers.len() - 1)],
            Self::Ratio { first, ratio } => (0..round).fold(*first, |number, _| number * ratio),
        }
    }

    /// The number where it is the same in every round.
    #[must_use]
    pub fn once(&self) -> Option<f64> {
        if let Self::All(number) = self { Some(*number) } else { None }
    }

    /// Are all of the first `rounds` numbers from `least` to `most`?
    #[must_use]
    pub fn is_within(&self, rounds: u32, least: f64, most: f64) -> bool {
        (0..rounds.max(1)).all(|round| (least..=most).contains(&self.at(round)))
    }
}

impl<'de> Deserialize<'de> for PerRound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        struct Ratio {
            first: f64,
            ratio: f64,
        }
        let value = serde_json::Value::deserialize(deserializer)?;
        if let Some(number) = value.as_f64() {
            return Ok(Self::All(number));
        }
        if value.is_array() {
            let numbers: Vec<f64> = serde_json::from_value(value).map_err(D::Error::custom)?;
            return if numbers.is_empty() {
                Err(D::Error::custom("list at least one number"))
            } else {
                Ok(Self::Each(numbers))
            };
        }
        let Ratio { first, ratio } = serde_json::from_value(value).map_err(D::Error::custom)?;
        Ok(Self::Ratio { first, ratio })
    }
}

impl JsonSchema for PerRound {
    fn schema_name() -> Cow<'static, str> {
        "PerRound".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let number = json_schema!({ "type": "number", "minimum": -1e6, "maximum": 1e6 });
        json_schema!({
            "description": "A number; in a repeated step also a list with one for each round (the last one stays), or `{ first = 1.5, ratio = 0.8 }`.",
            "anyOf": [
                number,
                { "type": "array", "minItems": 1, "items": number },
                {
                    "type": "object",
                    "properties": { "first": number, "ratio": { "type": "number", "minimum": 0, "maximum": 10 } },
                    "required": ["first", "ratio"],
                    "additionalProperties": false
                }
            ]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_the_rounds() {
        let read = |text: &str| serde_json::from_str::<PerRound>(text).map(|n| [n.at(0), n.at(2), n.at(9)]).ok();
        assert_eq!(read("3"), Some([3.0; 3]));
        assert_eq!(read("[2, 1, 5]"), Some([2.0, 5.0, 5.0]));
        assert_eq!(read("{\"first\": 8, \"ratio\": 0.5}"), Some([8.0, 2.0, 8.0 / 512.0]));
        assert_eq!(read("[]"), None);
        assert!(PerRound::Ratio { first: 1.0, ratio: 2.0 }.is_within(3, 0.0, 4.0));
        assert!(!PerRound::Ratio { first: 1.0, ratio: 2.0 }.is_within(4, 0.0, 4.0));
    }
}
