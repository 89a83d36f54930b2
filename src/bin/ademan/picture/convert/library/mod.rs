//! Drawings as PNG by the library resvg and as PDF by the library krilla, with the fonts of the system.

mod drawing;
mod pdf;
mod png;

pub use self::pdf::pdf;
pub use self::png::png;
