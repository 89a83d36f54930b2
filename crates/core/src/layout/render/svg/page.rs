//! Pages: sections one below the other, below the name of the layout.

use parry3d::math::Vec2;

use super::canvas::{Align, Canvas, Placement};
use super::text::{LINE_HEIGHT, wrap};

/// The font size of captions and lists, in millimetres.
pub const CAPTION_SIZE: f32 = 3.2;

const TITLE_SIZE: f32 = 6.0;
const HEADING_SIZE: f32 = 4.0;
const GAP: f32 = 7.0;

/// A section of a page.
pub struct Section {
    /// Heading; `None` for a part that needs none.
    pub heading: Option<&'static str>,
    /// Content.
    pub content: Canvas,
}

/// Returns the sections one below the other, aligned on the left.
pub fn compose(name: &str, description: &str, sections: &[Section], text_width: f32) -> Canvas {
    let mut page = Canvas::default();
    let title = Vec2::new(0.0, TITLE_SIZE / 2.0);
    page.text("title", title, Align::Start, TITLE_SIZE, name);
    let below = Vec2::new(0.0, TITLE_SIZE + CAPTION_SIZE);
    let mut bottom = draw_paragraph("muted", description, below, text_width, 3.6, &mut page);
    for section in sections {
        bottom += GAP - 2.0;
        if let Some(heading) = section.heading {
            let at = Vec2::new(0.0, bottom + HEADING_SIZE / 2.0);
            page.text("title", at, Align::Start, HEADING_SIZE, heading);
            bottom += HEADING_SIZE + 3.0;
        }
        let (min, max) = section.content.bounds();
        let at = Vec2::new(-min.x, bottom - min.y);
        page.group(Placement::at(at), None, &section.content);
        bottom += max.y - min.y;
    }
    page
}

/// Writes lines of at most `width`, the first of which is centered at the height of `at`. Returns the height of the next line.
pub fn draw_paragraph(
    class: &str,
    text: &str,
    at: Vec2,
    width: f32,
    size: f32,
    canvas: &mut Canvas,
) -> f32 {
    let mut at = at;
    for line in wrap(text, width, size) {
        canvas.text(class, at, Align::Start, size, &line);
        at.y += size * LINE_HEIGHT;
    }
    at.y
}

/// Draws rows of names and descriptions in two columns.
pub fn draw_list(rows: &[(String, String)], width: f32) -> Canvas {
    let mut list = Canvas::default();
    let widest = rows.iter().map(|(name, _)| super::text::width_em(name));
    let column = (widest.fold(0.0, f32::max) * CAPTION_SIZE + 4.0).min(width / 2.0);
    let mut y = 0.0;
    for (name, description) in rows {
        let name_end = draw_paragraph(
            "label",
            name,
            Vec2::new(0.0, y),
            column - 2.0,
            CAPTION_SIZE,
            &mut list,
        );
        let at = Vec2::new(column, y);
        let end = draw_paragraph(
            "muted",
            description,
            at,
            width - column,
            CAPTION_SIZE,
            &mut list,
        );
        y = name_end.max(end) + 0.8;
    }
    list
}
