//! Widths: the radius of limbs along their paths.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rayon::prelude::*;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::Skeleton;
use crate::math::{PerRound, power, unknown};

/// One number for all classes of paths, or one for each by name.
#[derive(Clone, Debug, PartialEq)]
pub enum PerClass {
    /// The same for all.
    All(f64),
    /// By the name of the class.
    Each(BTreeMap<String, f64>),
}

impl<'de> Deserialize<'de> for PerClass {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = serde_json::Value::deserialize(deserializer)?;
        match value.as_f64() {
            Some(number) => Ok(Self::All(number)),
            None => serde_json::from_value(value).map(Self::Each).map_err(D::Error::custom),
        }
    }
}

impl JsonSchema for PerClass {
    fn schema_name() -> Cow<'static, str> {
        "PerClass".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let number = json_schema!({ "type": "number", "minimum": 0, "maximum": 1e6 });
        json_schema!({
            "description": "A number, or one for each class of endpoints: `{ main = 0.3, minor = 0.2 }`.",
            "anyOf": [number, { "type": "object", "additionalProperties": number }]
        })
    }
}

impl PerClass {
    /// The number for each of `classes`.
    ///
    /// # Errors
    /// [`WidthError`] where a class has no number.
    pub fn resolve(&self, classes: &[String]) -> Result<Vec<f64>, WidthError> {
        match self {
            Self::All(number) => Ok(vec![*number; classes.len()]),
            Self::Each(numbers) => classes
                .iter()
                .map(|class| {
                    let number = numbers.get(class).copied();
                    let known = || numbers.keys().cloned().collect();
                    number.ok_or_else(|| WidthError::Class { class: class.clone(), known: known() })
                })
                .collect(),
        }
    }
}

/// Why a width does not apply to a skeleton.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WidthError {
    /// A class of paths has no number.
    #[error("{}", unknown("number for class", class, known.iter()))]
    Class {
        /// The class.
        class: String,
        /// The classes that have numbers.
        known: Vec<String>,
    },
}

impl From<WidthError> for String {
    fn from(error: WidthError) -> Self {
        error.to_string()
    }
}

/// How a step's limbs get their radii.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Width {
    /// Tapering by path cost (Xu and Mould 2008, eq. 2).
    Taper(Taper),
    /// The same radius everywhere.
    Constant(#[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))] f64),
    /// By the path length to the farthest tip (Xu and Mould 2012, section 3.2).
    Length(ByLength),
    /// The pipe model: the cross-section of a limb is the sum of those of its children (Leonardo's rule; Shinozaki et al. 1964).
    Pipe(Pipe),
}

/// `(s / unit)^z`, scaled so that the plant starts with `root`: s is the path length from an endpoint back to a node, through
/// all earlier steps; the maximum over the endpoints counts. With one z for all it is `root (s / s_max)^z`; with several, a
/// larger z makes the paths to its endpoints thicker, as the paper's bare s^z does, whose unit is the spacing of its graphs.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ByLength {
    /// Radius where the plant starts, in scene units. A step that gives none carries on the plant that it grows from.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub root: Option<f64>,
    /// Least radius, in scene units, given by the step where the plant starts.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub tip: Option<f64>,
    /// The length whose power is 1, in scene units, given by the step where the plant starts; by default a thousandth of
    /// the longest path.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub unit: Option<f64>,
    /// The exponent for this step's endpoints; the paper has 0.6, 0.5, 0.4, 0.3 from the first level to the last.
    pub z: PerRound,
}

/// `r^power` of a limb is the sum of `r^power` of its children.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pipe {
    /// Radius where the plant starts, in scene units: all are scaled to it. A step that gives none carries on the plant
    /// that it grows from.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub root: Option<f64>,
    /// Least radius, in scene units, given by the step where the plant starts.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub tip: Option<f64>,
    /// The exponent, given by the step where the plant starts; the default 2 conserves area, trees have 1.8 to 2.7.
    #[serde(default)]
    #[schemars(range(min = 1.0, max = 5.0))]
    pub power: Option<f64>,
}

/// `T = from (1 - (d/d_max)^beta) + to (d/d_max)^beta`, with d the cost of a node and `d_max` that of the path's own
/// endpoint (Xu and Mould 2008, eq. 2: `from` is T_s, `to` is T_f).
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Taper {
    /// Radius at the generator, in scene units.
    pub from: PerClass,
    /// Radius at the endpoint, in scene units.
    pub to: PerClass,
    /// Shape of the taper: 1 is even in cost, less is thin early. The paper's elms have 0.3 for main and 0.2 for
    /// minor branches.
    #[serde(default = "even")]
    pub beta: PerClass,
}

fn even() -> PerClass {
    PerClass::All(1.0)
}

impl Width {
    /// For widths of whole plants ([`crate::skeleton::Plant`]), whether this one starts a plant; `None` for others.
    #[must_use]
    pub fn starts_plant(&self) -> Option<bool> {
        match self {
            Self::Taper(_) | Self::Constant(_) => None,
            Self::Length(ByLength { root, .. }) | Self::Pipe(Pipe { root, .. }) => Some(root.is_some()),
        }
    }

    /// Checks that each of `classes` has a number.
    ///
    /// # Errors
    /// [`WidthError`] where one is missing.
    pub fn check(&self, classes: &[String]) -> Result<(), WidthError> {
        match self {
            Self::Constant(_) | Self::Length(_) | Self::Pipe(_) => Ok(()),
            Self::Taper(Taper { from, to, beta }) => {
                [from, to, beta].into_iter().try_for_each(|numbers| numbers.resolve(classes).map(drop))
            }
        }
    }

    /// Sets the radius of every node of `skeleton`, the maximum over the paths through it. Widths of whole plants do nothing
    /// here ([`crate::skeleton::Plant::thicken`]).
    ///
    /// # Errors
    /// [`WidthError`] where a class of the skeleton has no number.
    pub fn apply(&self, skeleton: &mut Skeleton) -> Result<(), WidthError> {
        match self {
            Self::Constant(radius) => {
                skeleton.nodes.par_iter_mut().for_each(|node| node.radius = *radius);
                Ok(())
            }
            Self::Taper(taper) => taper.apply(skeleton),
            Self::Length(_) | Self::Pipe(_) => Ok(()),
        }
    }
}

impl Taper {
    fn apply(&self, skeleton: &mut Skeleton) -> Result<(), WidthError> {
        let classes = &skeleton.classes;
        let from = self.from.resolve(classes)?;
        let to = self.to.resolve(classes)?;
        let beta = self.beta.resolve(classes)?;
        for class in 0..classes.len() as u16 {
            let (from, to, beta) = (from[class as usize], to[class as usize], beta[class as usize]);
            // At a node the path with the largest d_max is the thickest where limbs taper, the one with the smallest where they
            // widen: one number a node suffices for all paths.
            let larger = |a: f64, b: f64| if (from >= to) == (a > b) { a } else { b };
            let mut d_max: Vec<Option<f64>> = vec![None; skeleton.nodes.len()];
            let join = |slot: &mut Option<f64>, d: f64| *slot = Some(slot.map_or(d, |old| larger(old, d)));
            for path in skeleton.paths.iter().filter(|path| path.class == class) {
                join(&mut d_max[path.end as usize], skeleton.nodes[path.end as usize].cost);
            }
            for i in (0..skeleton.nodes.len()).rev() {
                if let (Some(d), Some(parent)) = (d_max[i], skeleton.nodes[i].parent) {
                    join(&mut d_max[parent as usize], d);
                }
            }
            for (node, d_max) in skeleton.nodes.iter_mut().zip(d_max) {
                let Some(d_max) = d_max else { continue };
                // An endpoint on the generator has d_max 0, and the radius of the root.
                let share = if d_max > 0.0 { power(node.cost / d_max, beta) } else { 0.0 };
                let radius = from * (1.0 - share) + to * share;
                if radius > node.radius {
                    node.radius = radius;
                    node.class = class;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::*;

    fn taper(from: f64, to: f64, beta: f64) -> Width {
        Width::Taper(Taper { from: PerClass::All(from), to: PerClass::All(to), beta: PerClass::All(beta) })
    }

    #[test]
    fn follows_equation_2() {
        let mut s = skeleton(&[&[(0, 4), (0, 3), (0, 2), (0, 1), (0, 0)]]);
        taper(1.0, 0.2, 1.0).apply(&mut s).unwrap();
        let radii: Vec<_> = s.nodes.iter().map(|n| n.radius).collect();
        for (radius, expected) in radii.iter().zip([1.0, 0.8, 0.6, 0.4, 0.2]) {
            assert!((radius - expected).abs() < 1e-12, "{radii:?}");
        }
        taper(1.0, 0.0, 0.5).apply(&mut s).unwrap();
        assert!((s.nodes[1].radius - 0.8).abs() < 1e-12, "the larger radius stays");
    }

    /// Against eq. 2 evaluated path by path, as in the paper.
    #[test]
    fn shared_nodes_keep_the_larger() {
        for (from, to) in [(1.0, 0.1), (0.1, 1.0)] {
            let mut s = skeleton(&[
                &[(0, 3), (0, 2), (0, 1), (0, 0)],
                &[(3, 3), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)],
                &[(1, 1), (0, 1), (0, 0)],
            ]);
            let mut expected = vec![0.0_f64; s.nodes.len()];
            for path in &s.paths {
                let d_max = s.nodes[path.end as usize].cost;
                let mut at = Some(path.end);
                while let Some(i) = at {
                    let share = power(s.nodes[i as usize].cost / d_max, 0.3);
                    let radius = from * (1.0 - share) + to * share;
                    expected[i as usize] = expected[i as usize].max(radius);
                    at = s.nodes[i as usize].parent;
                }
            }
            taper(from, to, 0.3).apply(&mut s).unwrap();
            let radii: Vec<_> = s.nodes.iter().map(|n| n.radius).collect();
            assert_eq!(radii, expected);
        }
    }
}
