//! `stage`: where a scene stands and how it is lit, from a file of its own.

use std::sync::Arc;

use super::include::{take, take_over};
use super::mistake::{Included, Mistake};
use super::tree::{Entry, Value, parse};
use crate::files::{embedded_stage, stage_names};

/// Where a scene stands and how it is lit.
const PLACE: [&str; 6] = ["air", "background", "ground", "light", "look", "sky"];
/// Those tables of a stage that have lengths, in metres, and the keys of these.
const LENGTHS: [(&str, &[&str]); 4] = [
    ("air", &["clear", "height"]),
    ("background", &["apart", "from", "groves", "to"]),
    ("camera", &["aperture", "eye", "focus"]),
    ("ground", &["from", "height", "reach", "size"]),
];
/// What within them is in lengths of something else.
const RELATIVE: &str = "grass.reach";

/// Removes what another stage gives, where one is asked for from outside.
pub(super) fn clear_stage(root: &mut Entry) {
    PLACE.iter().for_each(|key| drop(take(root, key)));
}

/// Fills `root` with what its stage gives and it does not.
pub(super) fn set_stage(root: &mut Entry, mistakes: &mut Vec<Mistake>) {
    let Some(entry) = take(root, "stage") else { return };
    let wrong = |message: String| Mistake { span: entry.span.clone(), place: "stage".to_owned(), message };
    let Value::String(name) = &entry.value else {
        return mistakes.push(wrong(format!("expected the name of a stage, found {}", entry.value.kind())));
    };
    let Some(text) = embedded_stage(name) else {
        let names = stage_names();
        return mistakes.push(wrong(format!("there is no stage `{name}`; there are {}", names.join(", "))));
    };
    let file = Arc::new(Included { name: format!("stages/{name}.toml"), text: text.to_owned() });
    let (mut stage, found) = parse(&file.text, Some(&file));
    mistakes.extend(found);
    scale(&mut stage, metre(root));
    take_over(root, &stage);
}

/// The number of scene units to a metre; what is none is told later.
fn metre(root: &Entry) -> f64 {
    let Value::Table(table) = &root.value else { return 1.0 };
    match table.get("metre").map(|entry| &entry.value) {
        Some(Value::Float(x)) => *x,
        Some(Value::Integer(n)) => *n as f64,
        _ => 1.0,
    }
}

/// Turns the lengths of a stage from metres into scene units.
fn scale(stage: &mut Entry, metre: f64) {
    let Value::Table(tables) = &mut stage.value else { return };
    for (table, keys) in LENGTHS {
        if let Some(entry) = tables.get_mut(table) {
            scale_within(entry, "", keys, metre);
        }
    }
}

/// Multiplies the numbers that `keys` have in `entry`, which stands under `name`, and in all that it has.
fn scale_within(entry: &mut Entry, name: &str, keys: &[&str], by: f64) {
    match &mut entry.value {
        Value::Table(table) => {
            for (key, entry) in table {
                let path = format!("{name}.{key}");
                let is_length = keys.contains(&key.as_str()) && !path.ends_with(RELATIVE);
                match &mut entry.value {
                    Value::Float(x) if is_length => *x *= by,
                    Value::Integer(n) if is_length => entry.value = Value::Float(*n as f64 * by),
                    _ => scale_within(entry, &path, keys, by),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| scale_within(item, name, keys, by)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Override, Source, load};
    use crate::files::Folder;

    #[test]
    fn a_stage_is_taken_and_changed() {
        let with = |own: &str, given: &[(&str, &str)]| {
            let text = format!(
                "title = \"Mine\"\n{own}\n[space.air]\nshape.box = {{ min = [-1, -1, 0], max = [1, 1, 2] }}\n\
                 nodes.lattice = {{ spacing = 0.5, neighbours = 6 }}\n[grow.twig]\nspace = \"air\"\nfrom.at = [[0, 0, 0]]\n\
                 to.tips = {{ count = 2 }}\nwidth.constant = 0.02\n[object.twig]\ngrow = [\"twig\"]\n"
            );
            let source = Source { name: "mine.toml".to_owned(), text, folder: Folder::Disk(".".into()) };
            let changes: Vec<Override> = given
                .iter()
                .map(|(path, value)| Override { path: (*path).to_owned(), value: (*value).to_owned() })
                .collect();
            load(&source, &changes).map(|scene| scene.recipe).map_err(|error| error.to_string())
        };
        let meadow = with("stage = \"meadow\"", &[]).unwrap();
        let own = with("stage = \"meadow\"\n[sky]\ndaylight = { hour = 9 }\n[ground]\nheight = 1", &[]).unwrap();
        assert_eq!(meadow.look, crate::model::Look::Natural);
        let [its, mine] = [&meadow, &own].map(|recipe| recipe.ground.as_ref().unwrap());
        assert!(its.grass.is_some() && meadow.air.is_some());
        assert_eq!((mine.height, mine.grass), (1.0, its.grass));
        assert_ne!(own.sky, meadow.sky);
        // Another kind of sky takes nothing from the stage's.
        let plain = with("stage = \"meadow\"\n[sky]\ncolour = \"#ffffff\"", &[]).unwrap();
        assert_eq!(plain.sky, crate::model::Sky::plain(crate::math::Colour([1.0; 3])));
        // From outside it replaces what the scene has, and is changed by what follows.
        let changed = with("[sky]\ncolour = \"#ffffff\"", &[("sky.daylight.hour", "9"), ("stage", "meadow")]).unwrap();
        assert_eq!(changed.sky, own.sky);
        let error = with("stage = \"moon\"", &[]).unwrap_err();
        assert!(
            error.contains("there is no stage `moon`; there are desert, heath, meadow, night, sea-floor, snow, studio"),
            "{error}"
        );
    }

    #[test]
    fn its_lengths_are_in_metres() {
        let scene = |metre: &str| {
            let text = format!(
                "title = \"Mine\"\nstage = \"meadow\"\n{metre}\n[space.air]\nshape.box = {{ min = [-1, -1, 0], max = [1, 1, 2] }}\n\
                 nodes.lattice = {{ spacing = 0.5, neighbours = 6 }}\n[grow.twig]\nspace = \"air\"\nfrom.at = [[0, 0, 0]]\n\
                 to.tips = {{ count = 2 }}\nwidth.constant = 0.02\n[object.twig]\ngrow = [\"twig\"]\n"
            );
            let source = Source { name: "mine.toml".to_owned(), text, folder: Folder::Disk(".".into()) };
            load(&source, &[]).map(|scene| scene.recipe).map_err(|error| error.to_string())
        };
        let [one, ten] = ["", "metre = 10"].map(|metre| scene(metre).unwrap());
        let (a, b) = (one.ground.unwrap(), ten.ground.unwrap());
        assert_eq!((b.reach.unwrap() / a.reach.unwrap(), b.mound / a.mound), (10.0, 1.0));
        let (fine, coarse) = (a.grass.unwrap(), b.grass.unwrap());
        assert_eq!((coarse.height / fine.height, coarse.reach / fine.reach), (10.0, 1.0));
        assert_eq!(b.relief[1].from / a.relief[1].from, 10.0);
        assert_eq!(b.pattern.unwrap().figure().size() / a.pattern.unwrap().figure().size(), 10.0);
        let (a, b) = (one.background.unwrap(), ten.background.unwrap());
        assert_eq!((b.apart / a.apart, b.share / a.share), (10.0, 1.0));
        assert_eq!(ten.camera.eye.unwrap() / one.camera.eye.unwrap(), 10.0);
        assert_eq!(ten.air.unwrap().clear / one.air.unwrap().clear, 10.0);
        assert!(scene("metre = 0").unwrap_err().contains("metre"));
    }
}
