//! Colors of the plots.

use eframe::egui::{Color32, Visuals};

/// Colors of lines and bars, which are told apart from each other and from the background.
#[derive(Clone, Copy)]
pub struct PlotColors {
    /// Lines, in turn.
    pub lines: [Color32; 8],
    /// Bars of presses.
    pub press: Color32,
}

impl PlotColors {
    /// Returns the colors for a window.
    pub const fn new(visuals: &Visuals) -> Self {
        if visuals.dark_mode {
            Self::DARK
        } else {
            Self::LIGHT
        }
    }

    const LIGHT: Self = Self {
        lines: [
            Color32::from_rgb(0x24, 0x68, 0xb4),
            Color32::from_rgb(0xb0, 0x5a, 0x00),
            Color32::from_rgb(0x2c, 0x7d, 0x45),
            Color32::from_rgb(0x8e, 0x44, 0xa3),
            Color32::from_rgb(0xbb, 0x32, 0x32),
            Color32::from_rgb(0x14, 0x76, 0x7e),
            Color32::from_rgb(0x6a, 0x6a, 0x10),
            Color32::from_rgb(0x75, 0x58, 0x4a),
        ],
        press: Color32::from_rgb(0xc4, 0x72, 0x00),
    };

    const DARK: Self = Self {
        lines: [
            Color32::from_rgb(0x6f, 0xb1, 0xef),
            Color32::from_rgb(0xf0, 0xa0, 0x50),
            Color32::from_rgb(0x6c, 0xc7, 0x88),
            Color32::from_rgb(0xc9, 0x8a, 0xd9),
            Color32::from_rgb(0xee, 0x7f, 0x7f),
            Color32::from_rgb(0x55, 0xc7, 0xcf),
            Color32::from_rgb(0xc2, 0xc2, 0x5a),
            Color32::from_rgb(0xc0, 0xa0, 0x8c),
        ],
        press: Color32::from_rgb(0xff, 0xa0, 0x1c),
    };
}

#[cfg(test)]
mod tests {
    use eframe::egui;

    use super::*;
    use crate::panels::look;
    use crate::picture::Color;
    use crate::settings::Settings;

    /// Least contrast of graphics in the Web Content Accessibility Guidelines 2.2.
    const LEAST: f32 = 3.0;

    #[test]
    fn lines_and_bars_stand_out_from_the_background_in_every_theme() {
        let color = |it: Color32| Color::rgb(it.r(), it.g(), it.b());
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            for has_high_contrast in [false, true] {
                let settings = Settings {
                    has_high_contrast,
                    ..Settings::default()
                };
                let visuals = look::visuals(theme, &settings);
                let background = color(visuals.extreme_bg_color);
                let colors = PlotColors::new(&visuals);
                for drawn in colors.lines.into_iter().chain([colors.press]) {
                    let ratio = color(drawn).contrast(background);
                    assert!(ratio >= LEAST, "{theme:?}: {drawn:?} {ratio}");
                }
            }
        }
    }
}
