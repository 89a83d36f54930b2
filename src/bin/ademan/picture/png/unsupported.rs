//! A program that is built without PNG pictures.

/// Returns the error for a build without the feature `png`.
pub fn from_svg(_: &str) -> Result<Vec<u8>, String> {
    Err(
        "this program is built without PNG pictures; add the feature `png` to its build: `cargo build --release --features png`, or write an SVG \
         picture and convert it with `rsvg-convert`"
            .into(),
    )
}
