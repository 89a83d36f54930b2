//! Colors of the 3D view.

use crate::picture::Color;

/// Colors of the 3D view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneColors {
    /// Behind everything.
    pub background: Color,
    /// The plate below the keys.
    pub board: Color,
    /// The front of a key.
    pub key: Color,
    /// The sides of a key.
    pub key_side: Color,
    /// The track of a handle.
    pub groove: Color,
    /// The label of a key.
    pub label: Color,
    /// The front of a pressed key.
    pub lit: Color,
    /// The sides of a pressed key.
    pub lit_side: Color,
    /// The label of a pressed key.
    pub lit_label: Color,
    /// Skin.
    pub skin: Color,
    /// Skin in the light.
    pub skin_light: Color,
    /// Skin in the shade.
    pub skin_edge: Color,
    /// Bones and joints.
    pub bone: Color,
    /// The ring below a fingertip.
    pub ring: Color,
    /// The outline of a control with an error.
    pub fault: Color,
}

impl SceneColors {
    /// Returns the colors for a window.
    pub const fn new(is_dark: bool, has_high_contrast: bool) -> Self {
        match (is_dark, has_high_contrast) {
            (false, false) => Self::LIGHT,
            (true, false) => Self::DARK,
            (false, true) => Self::LIGHT_CONTRAST,
            (true, true) => Self::DARK_CONTRAST,
        }
    }

    /// Returns `true` for colors of high contrast.
    pub fn has_high_contrast(&self) -> bool {
        [Self::LIGHT_CONTRAST, Self::DARK_CONTRAST].contains(self)
    }

    /// Colors of high contrast for a light window.
    pub const LIGHT_CONTRAST: Self = Self {
        background: Color::rgb(0xff, 0xff, 0xff),
        board: Color::rgb(0x8a, 0x90, 0x9a),
        key_side: Color::rgb(0x20, 0x20, 0x20),
        groove: Color::rgb(0xff, 0xff, 0xff),
        label: Color::rgb(0x00, 0x00, 0x00),
        skin_edge: Color::rgb(0x4a, 0x28, 0x14),
        bone: Color::rgb(0x00, 0x18, 0x50),
        ring: Color::rgb(0x00, 0x30, 0xc0),
        ..Self::LIGHT
    };

    /// Colors of high contrast for a dark window.
    pub const DARK_CONTRAST: Self = Self {
        background: Color::rgb(0x00, 0x00, 0x00),
        board: Color::rgb(0x55, 0x5c, 0x68),
        key: Color::rgb(0x10, 0x10, 0x14),
        key_side: Color::rgb(0xb0, 0xb8, 0xc4),
        groove: Color::rgb(0x00, 0x00, 0x00),
        label: Color::rgb(0xff, 0xff, 0xff),
        skin_edge: Color::rgb(0x40, 0x24, 0x10),
        ring: Color::rgb(0xff, 0xe0, 0x40),
        ..Self::DARK
    };

    /// Colors for a light window.
    pub const LIGHT: Self = Self {
        background: Color::rgb(0xee, 0xf1, 0xf7),
        board: Color::rgb(0xc3, 0xcd, 0xde),
        key: Color::rgb(0xff, 0xff, 0xff),
        key_side: Color::rgb(0x9d, 0xa9, 0xbf),
        groove: Color::rgb(0xa8, 0xb3, 0xc8),
        label: Color::rgb(0x1d, 0x27, 0x40),
        lit: Color::rgb(0xff, 0xa0, 0x1c),
        lit_side: Color::rgb(0xc4, 0x72, 0x00),
        lit_label: Color::rgb(0x22, 0x14, 0x00),
        skin: Color::rgb(0xea, 0xbf, 0x9c),
        skin_light: Color::rgb(0xf8, 0xdf, 0xc8),
        skin_edge: Color::rgb(0xb0, 0x7c, 0x5a),
        bone: Color::rgb(0x3a, 0x56, 0x8e),
        ring: Color::rgb(0x1f, 0x6f, 0xeb),
        fault: Color::rgb(0xd0, 0x1c, 0x1c),
    };

    /// Colors for a dark window.
    pub const DARK: Self = Self {
        background: Color::rgb(0x16, 0x1a, 0x22),
        board: Color::rgb(0x2a, 0x32, 0x40),
        key: Color::rgb(0x49, 0x54, 0x68),
        key_side: Color::rgb(0x1d, 0x23, 0x2e),
        groove: Color::rgb(0x1d, 0x23, 0x2e),
        label: Color::rgb(0xee, 0xf2, 0xfa),
        lit: Color::rgb(0xff, 0xa0, 0x1c),
        lit_side: Color::rgb(0xa8, 0x62, 0x00),
        lit_label: Color::rgb(0x22, 0x14, 0x00),
        skin: Color::rgb(0xd9, 0xad, 0x8a),
        skin_light: Color::rgb(0xf2, 0xd2, 0xb6),
        skin_edge: Color::rgb(0x8d, 0x60, 0x44),
        bone: Color::rgb(0x24, 0x3a, 0x66),
        ring: Color::rgb(0x6f, 0xb3, 0xff),
        fault: Color::rgb(0xff, 0x5c, 0x52),
    };
}

/// All themes: dark, high contrast, and the least contrast of their words.
#[cfg(test)]
pub(crate) const THEMES: [(bool, bool, f32); 4] = [
    (false, false, 4.5),
    (true, false, 4.5),
    (false, true, 7.0),
    (true, true, 7.0),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_readable_in_every_theme() {
        for (is_dark, has_high_contrast, least) in THEMES {
            let colors = SceneColors::new(is_dark, has_high_contrast);
            for (label, key) in [(colors.label, colors.key), (colors.lit_label, colors.lit)] {
                let ratio = label.contrast(key);
                assert!(ratio >= least, "{is_dark} {has_high_contrast}: {ratio}");
            }
            assert_eq!(colors.has_high_contrast(), has_high_contrast);
        }
    }

    #[test]
    fn the_edge_of_a_key_is_seen_in_high_contrast() {
        for colors in [SceneColors::LIGHT_CONTRAST, SceneColors::DARK_CONTRAST] {
            for beside in [colors.key, colors.background] {
                let ratio = colors.key_side.contrast(beside);
                assert!(ratio >= 3.0, "{ratio}");
            }
        }
    }
}
