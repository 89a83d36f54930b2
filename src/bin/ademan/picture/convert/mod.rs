//! Drawings as PNG and PDF, where the program is built with these pictures.

#[cfg(feature = "pictures")]
mod library;
#[cfg(feature = "pictures")]
pub use self::library::{pdf, png};

#[cfg(not(feature = "pictures"))]
mod unsupported;
#[cfg(not(feature = "pictures"))]
pub use self::unsupported::{pdf, png};
