//! The fonts of the window.

use eframe::egui::{FontDefinitions, FontFamily};

/// The font with the signs that the one of the texts lacks, such as ⇧ and ▬.
const SIGNS: &str = "Hack";

/// Returns the fonts of egui, with a second font for signs.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let family = fonts.families.entry(FontFamily::Proportional).or_default();
    if !family.iter().any(|font| font == SIGNS) {
        family.push(SIGNS.to_owned());
    }
    fonts
}
