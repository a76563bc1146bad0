//! The picture of a sky, painted when it is first looked at.

use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, LazyLock};

use crate::raster::Panorama;

type Painting = LazyLock<Panorama, Box<dyn FnOnce() -> Panorama + Send>>;

/// A picture of all directions. One that is painted is so when it is first looked at: who grows, measures or writes meshes alone never
/// waits for it.
#[derive(Clone)]
pub struct SkyPicture {
    picture: Arc<Painting>,
    bytes: usize,
}

impl SkyPicture {
    /// One of `rows` rows: the light from a direction, by its angle from +x about the vertical and by its elevation, in radians.
    #[must_use]
    pub fn painted(rows: u32, light: impl Fn(f64, f64) -> [f32; 3] + Send + Sync + 'static) -> Self {
        let paint = move || Panorama::painted(rows, light);
        Self { picture: Arc::new(LazyLock::new(Box::new(paint))), bytes: Panorama::bytes_of(rows) }
    }

    /// Bytes that it takes when it is painted.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.bytes
    }
}

impl From<Panorama> for SkyPicture {
    fn from(picture: Panorama) -> Self {
        let bytes = size_of_val(picture.pixels());
        Self { picture: Arc::new(LazyLock::new(Box::new(|| picture))), bytes }
    }
}

impl Deref for SkyPicture {
    type Target = Panorama;

    fn deref(&self) -> &Panorama {
        &self.picture
    }
}

impl PartialEq for SkyPicture {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.picture, &other.picture) || **self == **other
    }
}

impl fmt::Debug for SkyPicture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SkyPicture").field("bytes", &self.bytes).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn it_is_painted_once_and_when_it_is_looked_at() {
        static PAINTED: AtomicU32 = AtomicU32::new(0);
        let sky = SkyPicture::painted(1, |_, _| {
            PAINTED.fetch_add(1, Ordering::Relaxed);
            [1.0; 3]
        });
        assert_eq!((PAINTED.load(Ordering::Relaxed), sky.bytes()), (0, 24));
        let copy = sky.clone();
        assert_eq!((sky.pixels().len(), copy.horizon()), (2, [1.0; 3]));
        assert!(PAINTED.load(Ordering::Relaxed) == 2 && size_of_val(sky.pixels()) == sky.bytes() && sky == copy);
    }
}
