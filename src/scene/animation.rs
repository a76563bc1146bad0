//! What moves: values of a scene by frame.

use schemars::JsonSchema;
use serde::Deserialize;

use super::mistake::Mistake;
use super::tree;
use super::tree::{Entry, Override, Value, apply};

/// A value of the scene that changes from frame to frame, when `--frames` asks for them: between keys evenly, before the
/// first and after the last not at all.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackSpec {
    /// What changes: a dotted path of keys, as for `--set`.
    #[schemars(length(min = 1))]
    pub of: String,
    /// Frames and values: `[frame, value]`, or `[frame, x, y]` and `[frame, x, y, z]` where the value is a point.
    #[schemars(length(min = 1), inner(length(min = 2, max = 4)))]
    pub keys: Vec<Vec<f64>>,
}

/// The value of a track at a frame.
fn value(keys: &[Vec<f64>], frame: f64) -> Result<Vec<f64>, &'static str> {
    let rises = keys.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    if !rises || keys.windows(2).any(|pair| pair[0].len() != pair[1].len()) {
        return Err("keys are in order of their frames, all with as many numbers");
    }
    let after = keys.partition_point(|key| key[0] <= frame);
    let (low, high) = (&keys[after.saturating_sub(1)], &keys[after.min(keys.len() - 1)]);
    let share = if high[0] > low[0] { ((frame - low[0]) / (high[0] - low[0])).clamp(0.0, 1.0) } else { 0.0 };
    Ok(low.iter().zip(high).skip(1).map(|(a, b)| a + (b - a) * share).collect())
}

/// Sets every animated value of a scene to what it is at `frame`.
pub(super) fn animate(root: &mut Entry, frame: f64, mistakes: &mut Vec<Mistake>) {
    let Value::Table(scene) = &root.value else { return };
    let Some(Entry { value: Value::Table(tracks), .. }) = scene.get("animation") else { return };
    let mut changes = Vec::new();
    for (name, track) in tracks {
        // Anything malformed is told by validation.
        let Ok(track) = serde_json::from_value::<TrackSpec>(track.to_json()) else { continue };
        if track.keys.is_empty() || track.keys.iter().any(|key| key.len() < 2) {
            continue;
        }
        match value(&track.keys, frame) {
            Ok(value) => {
                let text = match &value[..] {
                    [one] => tree::float(*one),
                    several => format!("[{}]", several.iter().map(|x| tree::float(*x)).collect::<Vec<_>>().join(", ")),
                };
                changes.push(Override { path: track.of, value: text });
            }
            Err(message) => {
                let place = format!("animation.{name}.keys");
                mistakes.push(Mistake { span: root.find_span(&place), place, message: message.to_owned() });
            }
        }
    }
    apply(root, &changes, mistakes);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_between_their_keys() {
        let keys = vec![vec![1.0, 0.0, 5.0], vec![3.0, 4.0, 5.0]];
        assert_eq!(value(&keys, 2.0), Ok(vec![2.0, 5.0]));
        assert_eq!(value(&keys, 0.0), Ok(vec![0.0, 5.0]));
        assert_eq!(value(&keys, 9.0), Ok(vec![4.0, 5.0]));
        assert!(value(&[vec![3.0, 1.0], vec![1.0, 1.0]], 1.0).is_err());
    }
}
