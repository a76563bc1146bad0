//! Picture buffers in memory; files are the business of [`crate::files`].
//!
//! Later stages need never handle a picture without pixels or a buffer of the wrong length.

mod grey;

pub use grey::Grey;
