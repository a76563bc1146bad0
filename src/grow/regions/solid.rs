//! Solids that regions are.

use std::sync::{Arc, OnceLock};

use crate::geom::{Surface, Voxels};
use crate::graph::Window;
use crate::math::DVec3;

/// What a step by regions yields.
#[derive(Clone, Debug)]
pub struct Regions {
    /// The border of each region that is kept, in scene units: closed, seen from outside; in the plane its inside.
    pub surfaces: Vec<Surface>,
    pub(super) window: Window,
    pub(super) is_inside: Vec<bool>,
    /// Made when a step first asks for it.
    pub(super) solid: OnceLock<Arc<Voxels>>,
}

impl Regions {
    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let solid = self.solid.get().map_or(0, |solid| solid.bytes());
        self.is_inside.len() + solid + self.surfaces.iter().map(Surface::bytes).sum::<usize>()
    }

    /// Bytes that [`Regions::solid`] takes at its peak.
    #[must_use]
    pub fn solid_bytes_needed(&self) -> usize {
        let samples = if self.solid.get().is_some() { 0 } else { self.is_inside.len() };
        samples * Voxels::SAMPLE_BYTES
    }

    /// All of them as one solid, without the gaps between them.
    #[must_use]
    pub fn solid(&self) -> Arc<Voxels> {
        let made = || {
            // Beyond the window all is outside: a sample on each side says so.
            let size = self.window.size;
            let frame = size.map(|s| u32::from(s > 1));
            let wide: [u32; 3] = std::array::from_fn(|axis| size[axis] + 2 * frame[axis]);
            let mut is_inside = vec![false; wide.iter().map(|&s| s as usize).product()];
            let row = size[0] as usize;
            for (i, from) in self.is_inside.chunks_exact(row).enumerate() {
                let (y, z) = (i as u32 % size[1] + frame[1], i as u32 / size[1] + frame[2]);
                let to = (y as usize + z as usize * wide[1] as usize) * wide[0] as usize + frame[0] as usize;
                is_inside[to..to + row].copy_from_slice(from);
            }
            let by = DVec3::from_array(frame.map(f64::from)) * self.window.spacing;
            let low = self.window.position([0; 3]) - by;
            Arc::new(Voxels::new(wide, self.window.spacing, low, &is_inside))
        };
        self.solid.get_or_init(made).clone()
    }
}
