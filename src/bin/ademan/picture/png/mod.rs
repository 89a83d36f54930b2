//! PNG pictures, where the program is built with them.

#[cfg(feature = "png")]
mod resvg;
#[cfg(feature = "png")]
pub use self::resvg::from_svg;

#[cfg(not(feature = "png"))]
mod unsupported;
#[cfg(not(feature = "png"))]
pub use self::unsupported::from_svg;
