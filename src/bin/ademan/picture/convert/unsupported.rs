//! A program that is built without PNG and PDF.

const REMEDY: &str = "this program is built without PNG and PDF; add the feature `pictures` to its build: `cargo build --release --features pictures`, \
     or write an SVG picture and convert it with `rsvg-convert`";

/// Returns the error for a build without the feature `pictures`.
pub fn png(_: &str) -> Result<Vec<u8>, String> {
    Err(REMEDY.into())
}

/// Returns the error for a build without the feature `pictures`.
pub fn pdf(_: &str) -> Result<Vec<u8>, String> {
    Err(REMEDY.into())
}
