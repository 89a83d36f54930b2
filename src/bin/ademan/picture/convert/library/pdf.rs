//! Pages of lines and text, at the real size of the boards.

use krilla::Document;
use krilla::geom::Size;
use krilla::metadata::Metadata;
use krilla::page::PageSettings;
use krilla_svg::{SurfaceExt, SvgSettings};

use super::drawing::Drawing;

/// Points of a page per millimetre.
const POINTS_PER_MM: f32 = 72.0 / 25.4;

/// The longest side of a page that every reader shows (ISO 32000-1, annex C), in points.
const MAX_SIDE_POINTS: f32 = 14400.0;

/// Writes an SVG document whose units are millimetres as one page.
pub fn pdf(svg: &str) -> Result<Vec<u8>, String> {
    let drawing = Drawing::read(svg)?;
    let points = |length_mm: f32| length_mm * POINTS_PER_MM;
    if points(drawing.longest_mm()) > MAX_SIDE_POINTS {
        return Err(format!(
            "the drawing is {:.0} × {:.0} mm, too large for a page of 5080 mm; write --svg or --html",
            drawing.width_mm, drawing.height_mm
        ));
    }
    let size = Size::from_wh(points(drawing.width_mm), points(drawing.height_mm))
        .ok_or("the drawing is empty")?;
    let mut document = Document::new();
    document.set_metadata(Metadata::new().title(drawing.title));
    let mut page = document.start_page_with(PageSettings::new(size));
    let mut surface = page.surface();
    // Text stays text: it can be searched and copied.
    surface
        .draw_svg(&drawing.tree, size, SvgSettings::default())
        .ok_or("cannot draw the page")?;
    surface.finish();
    page.finish();
    document
        .finish()
        .map_err(|error| format!("cannot write the page: {error}"))
}
