//! Plants of a few lines, and how their limbs lie.

use lichtenberg::files::Folder;
use lichtenberg::grow::Grown;
use lichtenberg::math::{DVec3, Memory, Progress};
use lichtenberg::scene::{Loaded, SceneError, Source, grow, load};
use lichtenberg::skeleton::Skeleton;

pub fn scene(steps: &str) -> Loaded {
    load_text(steps).unwrap_or_else(|error| panic!("{error}"))
}

pub fn load_text(steps: &str) -> Result<Loaded, SceneError> {
    let objects: Vec<&str> = steps.lines().filter_map(|line| line.strip_prefix("[grow.")?.strip_suffix(']')).collect();
    let object =
        format!("[object.all]\ngrow = {:?}\n", objects.iter().filter(|n| !n.contains('.')).collect::<Vec<_>>());
    let text = format!("title = \"Test\"\nseed = 7\n{steps}\n{object}");
    let source = Source { name: "test".to_owned(), text, folder: Folder::Disk(super::root()) };
    load(&source, &[])
}

pub fn grown(scene: &Loaded) -> Vec<Grown> {
    grow(scene, &[], &Memory::new(8 << 30), &Progress::default()).unwrap_or_else(|error| panic!("{error}"))
}

pub fn only(steps: &str) -> Skeleton {
    grown(&scene(steps)).remove(0).skeleton
}

/// The way of the segment that ends at a node, of length 1.
pub fn way(s: &Skeleton, node: u32) -> Option<DVec3> {
    let node = s.nodes[node as usize];
    node.parent.map(|p| (node.position - s.nodes[p as usize].position).normalize())
}

pub fn degrees(a: DVec3, b: DVec3) -> f64 {
    libm::acos(a.dot(b).clamp(-1.0, 1.0)).to_degrees()
}
