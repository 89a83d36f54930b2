//! Pictures of pixels.

use resvg::tiny_skia::{Pixmap, Transform};

use super::drawing::Drawing;

/// Pixels per millimetre: 203 dots per inch.
const PX_PER_MM: f32 = 8.0;

/// The largest width and height, in pixels. A larger drawing is drawn at a smaller scale.
const MAX_SIDE_PX: f32 = 8192.0;

/// The smallest scale at which labels can be read, in pixels per millimetre.
const MIN_PX_PER_MM: f32 = 2.0;

/// Draws an SVG document whose units are millimetres.
pub fn png(svg: &str) -> Result<Vec<u8>, String> {
    let drawing = Drawing::read(svg)?;
    let px_per_mm = PX_PER_MM.min(MAX_SIDE_PX / drawing.longest_mm());
    if px_per_mm < MIN_PX_PER_MM {
        return Err(format!(
            "the drawing is {:.0} × {:.0} mm, too large to be read in {MAX_SIDE_PX} pixels; write --svg or --html",
            drawing.width_mm, drawing.height_mm
        ));
    }
    let size = drawing.tree.size();
    let scale = px_per_mm * drawing.width_mm / size.width();
    // Without the last fraction of a pixel, which would be transparent.
    let pixels = |length: f32| (length * scale).floor().max(1.0) as u32;
    let pixmap = Pixmap::new(pixels(size.width()), pixels(size.height()));
    let mut pixmap = pixmap.ok_or("the drawing is empty")?;
    resvg::render(
        &drawing.tree,
        Transform::from_scale(scale, scale),
        &mut pixmap.as_mut(),
    );
    pixmap
        .encode_png()
        .map_err(|error| format!("cannot encode the picture: {error}"))
}
