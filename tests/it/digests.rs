//! What exported files are, as numbers; tests/digests.txt keeps them.

use lichtenberg::export::{
    Origin, Pov, Rib, RibOptions, RibPart, SvgOptions, Templates, write_obj, write_ply, write_svg,
};
use lichtenberg::model::Model;
use lichtenberg::scene::Loaded;

/// FNV-1a.
fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// A line for the include files and the schematic. If `is_whole`, also one for the RIB archive, and, of scenes that are all mesh,
/// one for OBJ and one for PLY.
pub fn digests(name: &str, scene: &Loaded, model: &Model, is_whole: bool) -> String {
    let templates = Templates::default();
    let origin = Origin { command: "test".to_owned(), seed: scene.recipe.seed };
    let mut bytes = Vec::new();
    let pov = Pov::new(model, &templates, "digest", [320, 240], &origin);
    pov.write_inc(&mut bytes).unwrap();
    pov.write_stage(&mut bytes).unwrap();
    write_svg(model, SvgOptions { size: [320, 240] }, &mut bytes).unwrap();
    let mut lines = format!("{:016x} {name}\n", fnv(&bytes));
    if !is_whole {
        return lines;
    }
    bytes.clear();
    let rib = Rib::new(model, &templates, "digest", [320, 240], &origin, RibOptions::default());
    rib.write_part(RibPart::Archive, &mut bytes).unwrap();
    lines += &format!("{:016x} {name} rib\n", fnv(&bytes));
    for ending in ["obj", "ply"] {
        bytes.clear();
        match if ending == "obj" { write_obj(model, &mut bytes) } else { write_ply(model, &mut bytes) } {
            Ok(()) => lines += &format!("{:016x} {name} {ending}\n", fnv(&bytes)),
            Err(error) => assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput, "{name}: {error}"),
        }
    }
    lines
}

/// Holds lines to those that are kept: the same if `is_whole`, else some of them. UPDATE=1 accepts new ones, which is a new
/// edition for artists.
pub fn compare(lines: &str, is_whole: bool) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/digests.txt");
    if std::env::var_os("UPDATE").is_some() {
        assert!(is_whole, "with UPDATE=1 set LICHTENBERG_TEST_ALL=1: the file has the lines of all scenes");
        std::fs::write(path, lines).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap_or_default();
    let changed: Vec<&str> = lines.lines().filter(|line| !kept.lines().any(|k| k == *line)).collect();
    assert!(changed.is_empty() && (lines == kept || !is_whole), "exported files have changed: {changed:#?}");
}
