//! Cryptomatte 1.2 (Friedman and Jones 2015): ID mattes by name.

use std::io::Cursor;

use crate::raster::{Channel, Layers};
use crate::trace::{RANKS, Ranks};

/// The hash of a name (MurmurHash3, 32 bits, seed 0).
fn murmur(name: &str) -> u32 {
    // Reading from memory does not fail.
    murmur3::murmur3_32(&mut Cursor::new(name.as_bytes()), 0).unwrap_or(0)
}

/// The ID of a name: its hash, adjusted to be the bits of a normal float.
fn id(name: &str) -> u32 {
    let hash = murmur(name);
    let exponent = hash >> 23 & 255;
    if exponent == 0 || exponent == 255 { hash ^ 1 << 23 } else { hash }
}

/// Adds the mattes of `ranks` as the Cryptomatte layer `layer`; the ID `i + 1` in `ranks` is `names[i]`. The manifest lists only
/// names that occur.
pub fn add_mattes(picture: &mut Layers, layer: &str, names: &[String], ranks: &[Ranks]) {
    let ids: Vec<f32> = names.iter().map(|name| f32::from_bits(id(name))).collect();
    let mut is_seen = vec![false; names.len()];
    for &(id, _) in ranks.iter().flatten().filter(|(id, _)| *id != 0) {
        is_seen[id as usize - 1] = true;
    }
    for rank in 0..RANKS {
        let of = |id: u32| if id == 0 { 0.0 } else { ids[id as usize - 1] };
        let [ids, shares] = [["R", "G"], ["B", "A"]][rank % 2];
        for (channel, values) in [
            (ids, ranks.iter().map(|r| of(r[rank].0)).collect::<Vec<f32>>()),
            (shares, ranks.iter().map(|r| r[rank].1).collect()),
        ] {
            let name = format!("{layer}{:02}.{channel}", rank / 2);
            picture.channels.push(Channel { name, values, is_half: false });
        }
    }
    let seen = names.iter().zip(&is_seen).filter(|(_, seen)| **seen).map(|(name, _)| name);
    let manifest: serde_json::Map<String, serde_json::Value> =
        seen.map(|name| (name.clone(), format!("{:08x}", id(name)).into())).collect();
    let key = format!("cryptomatte/{}", &format!("{:08x}", murmur(layer))[..7]);
    for (name, text) in [
        ("name", layer.to_owned()),
        ("hash", "MurmurHash3_32".to_owned()),
        ("conversion", "uint32_to_float32".to_owned()),
        ("manifest", serde_json::Value::Object(manifest).to_string()),
    ] {
        picture.texts.push((format!("{key}/{name}"), text));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_those_of_the_specification() {
        // The specification's own examples.
        assert_eq!(murmur("hello"), 0x248b_fa47);
        assert_eq!(murmur(""), 0);
        for name in ["bunny", "elm.12", "ground", "ü"] {
            assert!(f32::from_bits(id(name)).is_normal());
        }
    }
}
