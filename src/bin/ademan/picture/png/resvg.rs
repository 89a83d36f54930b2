//! PNG pictures by the library resvg, with the fonts of the system.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Family, Query};
use resvg::usvg::{Options, Tree};

/// Pixels per millimetre: 203 dots per inch.
const PX_PER_MM: f32 = 8.0;

/// The largest width and height, in pixels. A larger drawing is drawn at a smaller scale.
const MAX_SIDE_PX: f32 = 8192.0;

/// The smallest scale at which labels can be read, in pixels per millimetre.
const MIN_PX_PER_MM: f32 = 2.0;

/// Families without serifs that have arrows and the symbols of keys, the best first.
const FAMILIES: [&str; 7] = [
    "DejaVu Sans",
    "Noto Sans",
    "Liberation Sans",
    "Arial",
    "Helvetica",
    "Segoe UI",
    "Roboto",
];

/// Draws an SVG document whose units are millimetres.
pub fn from_svg(svg: &str) -> Result<Vec<u8>, String> {
    let options = Options {
        fontdb: Arc::new(fonts()?),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options);
    let tree = tree.map_err(|error| format!("cannot read the drawing: {error}"))?;
    let view_box_mm = view_box(svg).ok_or("the drawing has no size")?;
    let (width, height) = (tree.size().width(), tree.size().height());
    let longest_mm = view_box_mm.0.max(view_box_mm.1);
    let px_per_mm = PX_PER_MM.min(MAX_SIDE_PX / longest_mm);
    if px_per_mm < MIN_PX_PER_MM {
        return Err(format!(
            "the drawing is {:.0} × {:.0} mm, too large to be read in {MAX_SIDE_PX} pixels; write --svg or --html",
            view_box_mm.0, view_box_mm.1
        ));
    }
    let scale = px_per_mm * view_box_mm.0 / width;
    // Without the last fraction of a pixel, which would be transparent.
    let pixels = |length: f32| (length * scale).floor().max(1.0) as u32;
    let mut pixmap = Pixmap::new(pixels(width), pixels(height)).ok_or("the drawing is empty")?;
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut pixmap.as_mut(),
    );
    pixmap
        .encode_png()
        .map_err(|error| format!("cannot encode the picture: {error}"))
}

/// Returns the width and height of the view box, in millimetres.
fn view_box(svg: &str) -> Option<(f32, f32)> {
    let (_, rest) = svg.split_once("viewBox=\"")?;
    let (numbers, _) = rest.split_once('"')?;
    let mut numbers = numbers.split(' ').skip(2).map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

/// Returns the fonts of the system, with the best family for `sans-serif`.
fn fonts() -> Result<Database, String> {
    let mut fonts = Database::new();
    fonts.load_system_fonts();
    let Some(family) = best_family(&fonts) else {
        return Err("there is no font to write labels with; install one, as with `apt install fonts-dejavu-core`, or write --svg".into());
    };
    fonts.set_sans_serif_family(family);
    Ok(fonts)
}

/// Returns the best family for labels, or any if none of the list is there.
fn best_family(fonts: &Database) -> Option<String> {
    let is_there = |family: &str| {
        let families = [Family::Name(family)];
        let query = Query {
            families: &families,
            ..Query::default()
        };
        fonts.query(&query).is_some()
    };
    if let Some(family) = FAMILIES.into_iter().find(|family| is_there(family)) {
        return Some(family.to_owned());
    }
    let (name, _) = fonts.faces().find_map(|face| face.families.first())?;
    Some(name.clone())
}
