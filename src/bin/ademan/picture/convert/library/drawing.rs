//! An SVG drawing, read with the fonts of the system.

use std::sync::Arc;

use resvg::usvg::fontdb::{Database, Family, Query};
use resvg::usvg::roxmltree::Document;
use resvg::usvg::{Options, Tree};

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

/// A drawing of a layout.
pub struct Drawing {
    /// Shapes and texts.
    pub tree: Tree,
    /// Name of the layout; empty if the drawing has none.
    pub title: String,
    /// Width, in millimetres.
    pub width_mm: f32,
    /// Height, in millimetres.
    pub height_mm: f32,
}

impl Drawing {
    /// Reads an SVG document whose units are millimetres.
    pub fn read(svg: &str) -> Result<Self, String> {
        let options = Options {
            fontdb: Arc::new(fonts()?),
            ..Options::default()
        };
        let cannot_read =
            |error: &dyn std::fmt::Display| format!("cannot read the drawing: {error}");
        let document = Document::parse(svg).map_err(|error| cannot_read(&error))?;
        let tree = Tree::from_xmltree(&document, &options).map_err(|error| cannot_read(&error))?;
        let root = document.root_element();
        let (width_mm, height_mm) = root
            .attribute("viewBox")
            .and_then(size_of)
            .ok_or("the drawing has no size")?;
        let title = root.children().find(|it| it.has_tag_name("title"));
        Ok(Self {
            tree,
            title: title.and_then(|it| it.text()).unwrap_or_default().into(),
            width_mm,
            height_mm,
        })
    }

    /// Returns the longer side, in millimetres.
    pub fn longest_mm(&self) -> f32 {
        self.width_mm.max(self.height_mm)
    }
}

/// Returns width and height of a view box.
fn size_of(view_box: &str) -> Option<(f32, f32)> {
    let mut numbers = view_box.split(' ').skip(2).map(str::parse);
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
