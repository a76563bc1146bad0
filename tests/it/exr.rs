//! OpenEXR files as others read them: OpenImageIO and OpenEXR's own tools, from Debian.

use std::path::Path;
use std::process::Command;

use crate::support::{openimageio, succeed_in, text};

/// Reads every channel with OpenImageIO's Python module, decodes the mattes after the specification with code of its
/// own, and prints what it found, a fact a line.
const READER: &str = r#"
import json, struct, sys
import OpenImageIO as oiio

def murmur3(data):
    h, n = 0, len(data)
    rotl = lambda x, r: ((x << r) | (x >> (32 - r))) & 0xffffffff
    for i in range(0, n // 4 * 4, 4):
        k = int.from_bytes(data[i:i + 4], "little") * 0xcc9e2d51 & 0xffffffff
        h = (rotl(h ^ (rotl(k, 15) * 0x1b873593 & 0xffffffff), 13) * 5 + 0xe6546b64) & 0xffffffff
    if n % 4:
        k = int.from_bytes(data[n // 4 * 4:], "little") * 0xcc9e2d51 & 0xffffffff
        h ^= rotl(k, 15) * 0x1b873593 & 0xffffffff
    h ^= n
    for c in (0x85ebca6b, 0xc2b2ae35):
        h = (h ^ (h >> (16 if c == 0x85ebca6b else 13))) * c & 0xffffffff
    return h ^ (h >> 16)

def matte_id(name):
    h = murmur3(name.encode())
    if (h >> 23 & 255) in (0, 255):
        h ^= 1 << 23
    return h

image = oiio.ImageBuf(sys.argv[1])
spec = image.spec()
pixels = image.get_pixels(oiio.FLOAT)
at = {name: i for i, name in enumerate(spec.channelnames)}
print("size", spec.width, spec.height)
print("channels", *sorted(at))
native = oiio.ImageInput.open(sys.argv[1]).spec()
print("half", *sorted(n for n in at if str(native.channelformat(at[n])) == "half"))
for layer in ("CryptoObject", "CryptoBranch"):
    key = "cryptomatte/%08x" % murmur3(layer.encode())
    key = key[:-1]
    assert spec.getattribute(key + "/name") == layer
    assert spec.getattribute(key + "/hash") == "MurmurHash3_32"
    assert spec.getattribute(key + "/conversion") == "uint32_to_float32"
    manifest = json.loads(spec.getattribute(key + "/manifest"))
    names = {}
    for name, h in manifest.items():
        assert int(h, 16) == matte_id(name), name
        names[int(h, 16)] = name
    cover = {}
    for y in range(spec.height):
        for x in range(spec.width):
            p, total = pixels[y][x], 0.0
            for rank in range(6):
                level, pair = rank // 2, "RG" if rank % 2 == 0 else "BA"
                i = struct.unpack("<I", struct.pack("<f", p[at["%s%02d.%s" % (layer, level, pair[0])]]))[0]
                share = float(p[at["%s%02d.%s" % (layer, level, pair[1])]])
                total += share
                if i:
                    cover[names[i]] = cover.get(names[i], 0.0) + share
                else:
                    assert share == 0.0
            assert total <= 1.0001
    print(layer, json.dumps({k: round(v, 3) for k, v in sorted(cover.items())}))
middle = pixels[spec.height // 2][spec.width // 2]
print("middle", json.dumps({n: float(middle[at[n]]) for n in ("R", "A", "Z", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "level")}))
print("cost", float(pixels[:, :, at["cost"]].max()))
print("sky", float(pixels[0][0][at["Z"]]), float(pixels[0][0][at["A"]]))
print("title", spec.getattribute("Title"))
print("scene", json.loads(spec.getattribute("Scene"))["title"])
print("software", spec.getattribute("Software"))
"#;

fn told<'a>(said: &'a str, key: &str) -> &'a str {
    said.lines()
        .find_map(|line| line.strip_prefix(key)?.strip_prefix(' '))
        .unwrap_or_else(|| panic!("no {key}: {said}"))
}

fn render(folder: &Path) -> String {
    succeed_in(
        folder,
        &[
            "render",
            "cactus",
            "--size",
            "64x78",
            "--samples",
            "8",
            "--transparent",
            "--set",
            "camera.turn=0",
            "-o",
            "c.exr",
        ],
    );
    openimageio(folder, READER, &["c.exr"])
}

#[test]
fn openimageio_reads_every_channel() {
    let folder = tempfile::tempdir().unwrap();
    let said = render(folder.path());
    assert_eq!(told(&said, "size"), "64 78");
    assert_eq!(told(&said, "half"), "A B G R");
    for name in ["Z", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "cost", "level", "CryptoObject00.R", "CryptoBranch02.A"]
    {
        assert!(told(&said, "channels").split(' ').any(|c| c == name), "{name}");
    }
    let json = |key: &str| serde_json::from_str::<serde_json::Value>(told(&said, key)).unwrap();
    // The stem stands in the middle: it is seen from the front.
    let middle = json("middle");
    let number = |name: &str| middle[name].as_f64().unwrap();
    assert!(number("N.Y") < -0.7 && number("A") == 1.0 && number("Z") > 1.0, "{middle}");
    assert!(number("P.X").abs() < 0.6 && (1.0..6.5).contains(&number("P.Z")), "{middle}");
    assert_eq!(told(&said, "sky"), "inf 0.0");
    assert!(told(&said, "cost").parse::<f64>().unwrap() > 0.0);
    let objects = json("CryptoObject");
    let [cactus, ground] = ["cactus", "terrain"].map(|name| objects[name].as_f64().unwrap());
    assert!(cactus > 200.0 && ground > 500.0 && cactus + ground < 64.0 * 78.0, "{objects}");
    let branches = json("CryptoBranch");
    let all = branches.as_object().unwrap().iter();
    let limbs: Vec<f64> =
        all.filter(|(name, _)| name.starts_with("cactus.")).map(|(_, v)| v.as_f64().unwrap()).collect();
    assert!(limbs.len() >= 3, "stem and arms: {branches}");
    let limbs: f64 = limbs.iter().sum();
    assert!((limbs - cactus).abs() < 1.0, "limbs make up the cactus: {limbs}, {cactus}");
    assert_eq!((told(&said, "title"), told(&said, "scene")), ("Saguaro", "Saguaro"));
    assert!(told(&said, "software").starts_with("lichtenberg "));
}

#[test]
fn openexr_finds_the_file_sound() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path());
    let output = Command::new("exrheader").current_dir(folder.path()).arg("c.exr").output();
    let output = output.expect("these tests need OpenEXR's tools: run ./run-tests, or apt-get install openexr");
    let said = text(&output.stdout);
    assert!(output.status.success() && said.contains("zip, multi-scanline blocks"), "{said}");
    assert!(
        said.contains("CryptoObject00.R, 32-bit floating-point") && said.contains("R, 16-bit floating-point"),
        "{said}"
    );
}
