//! The fonts of the window, and the width of words in them.

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex, PoisonError};

use eframe::egui::epaint::text::{Fonts, TextOptions};
use eframe::egui::{FontDefinitions, FontFamily, FontId};
use parry3d::math::Vec2;

/// Height of a capital letter as a fraction of the size of its font.
pub const CAPITAL_HEIGHT: f32 = 0.72;

/// The font with the signs that the one of the texts lacks, such as ⇧ and ▬.
const SIGNS: &str = "Hack";

/// Distance of two lines, as a multiple of the height of a capital letter.
const LINE_DISTANCE: f32 = 1.6;

/// Height of capital letters, as a part of the largest one, below which two lines are better than one.
const SMALL: f32 = 0.3;

/// Returns the fonts of egui, with a second font for signs.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let family = fonts.families.entry(FontFamily::Proportional).or_default();
    if !family.iter().any(|font| font == SIGNS) {
        family.push(SIGNS.to_owned());
    }
    fonts
}

/// The widths of the characters that were measured, as multiples of the height of a capital letter.
struct Widths {
    fonts: Fonts,
    known: BTreeMap<char, f32>,
}

impl Widths {
    fn new() -> Self {
        Self {
            fonts: Fonts::new(TextOptions::default(), fonts()),
            known: BTreeMap::new(),
        }
    }

    fn width(&mut self, character: char) -> f32 {
        let Self { fonts, known } = self;
        *known.entry(character).or_insert_with(|| {
            let font = FontId::proportional(1.0 / CAPITAL_HEIGHT);
            fonts
                .with_pixels_per_point(1.0)
                .glyph_width(&font, character)
        })
    }
}

static WIDTHS: LazyLock<Mutex<Widths>> = LazyLock::new(|| Mutex::new(Widths::new()));

/// Returns the width of a text in one line, as a multiple of the height of a capital letter.
pub fn text_width(text: &str) -> f32 {
    let mut widths = WIDTHS.lock().unwrap_or_else(PoisonError::into_inner);
    text.chars().map(|character| widths.width(character)).sum()
}

/// A text that fits into its room.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The text, in one line or two.
    pub text: String,
    /// The height of its capital letters, in the unit of the room.
    pub size: f32,
}

/// Returns a text with capital letters of at most the height `largest`, in a room with this width and height. It has two lines
/// if it is small in one and larger in two.
pub fn fitted(text: String, room: Vec2, largest: f32) -> Fitted {
    let in_one = largest.min(room.x / text_width(&text).max(f32::EPSILON));
    if in_one < SMALL * largest
        && let Some((first, second, width)) = halves(&text)
    {
        let size = (room.x / width).min(room.y / (1.0 + LINE_DISTANCE));
        let in_two = size.min(largest);
        if in_two > in_one {
            return Fitted {
                text: format!("{first}\n{second}"),
                size: in_two,
            };
        }
    }
    Fitted { text, size: in_one }
}

/// Returns two lines of a text, broken at the space that makes them narrowest, and the width of the wider one.
fn halves(text: &str) -> Option<(&str, &str, f32)> {
    let spaces = text.char_indices().filter(|(_, it)| *it == ' ');
    let broken = spaces.map(|(at, _)| {
        let (first, second) = (text[..at].trim_end(), text[at..].trim_start());
        (first, second, text_width(first).max(text_width(second)))
    });
    broken.min_by(|a, b| a.2.total_cmp(&b.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_as_wide_as_its_letters() {
        for (narrow, wide) in [("ill", "lmn"), ("1.,/'-", "MNO6WX"), ("", ".")] {
            assert!(text_width(narrow) < text_width(wide), "{narrow} {wide}");
        }
        // A sign of the second font.
        assert!(text_width("⇧") > 0.5);
        let twice = text_width("WXYZ9WXYZ9");
        assert!((twice - 2.0 * text_width("WXYZ9")).abs() < 1e-4);
    }

    #[test]
    fn a_label_of_narrow_letters_is_larger_than_one_of_as_many_wide_ones() {
        let room = Vec2::new(14.0, 14.0);
        let size = |text: &str| fitted(text.to_owned(), room, 9.0).size;
        assert!(size("1 . , '") > 1.5 * size("MWMWMWM"));
        for text in ["MNO6", "WXYZ9", "1 . , / ' -", "A"] {
            let label = fitted(text.to_owned(), room, 9.0);
            assert!(
                text_width(&label.text) * label.size <= room.x + 1e-3,
                "{text}"
            );
            assert!(label.size <= 9.0);
        }
    }

    #[test]
    fn a_label_that_is_small_in_one_line_has_two() {
        let room = Vec2::new(14.0, 14.0);
        let long = fitted("previous window".to_owned(), room, 9.0);
        assert_eq!(long.text, "previous\nwindow");
        let one_line = room.x / text_width("previous window");
        assert!(long.size > 1.5 * one_line, "{}", long.size);
        // Both lines are within the room.
        assert!(text_width("previous") * long.size <= room.x + 1e-3);
        assert!((1.0 + LINE_DISTANCE) * long.size <= room.y);
        for text in ["2 abc", "unbreakable-word"] {
            let one = fitted(text.to_owned(), room, 9.0);
            assert_eq!(one.text, text);
        }
        // There is no room for a second line.
        let low = fitted("previous window".to_owned(), Vec2::new(14.0, 2.0), 9.0);
        assert!(!low.text.contains('\n'));
    }
}
