//! Colors of marks.

use clap::ValueEnum;

/// A color of marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// Bright, of any color
    White,
    /// Dark on a bright background
    Dark,
    /// Red
    Red,
    /// Green
    Green,
    /// Blue
    Blue,
    /// Yellow
    Yellow,
    /// Cyan
    Cyan,
    /// Magenta
    Magenta,
}

impl Color {
    /// Returns how much of the color a pixel has, from 0 to 1: the brightness, or by how much the numbers of the color exceed the
    /// others.
    pub fn value(self, [red, green, blue]: [f32; 3]) -> f32 {
        let brightness = 0.299 * red + 0.587 * green + 0.114 * blue;
        let value = match self {
            Self::White => brightness,
            Self::Dark => 1.0 - brightness,
            Self::Red => red - green.max(blue),
            Self::Green => green - red.max(blue),
            Self::Blue => blue - red.max(green),
            Self::Yellow => red.min(green) - blue,
            Self::Cyan => green.min(blue) - red,
            Self::Magenta => red.min(blue) - green,
        };
        value.max(0.0)
    }

    /// Returns the threshold without `--threshold`. Colors of things are seldom pure.
    pub fn threshold(self) -> f32 {
        match self {
            Self::White | Self::Dark => 0.5,
            _ => 0.3,
        }
    }

    /// Returns the name on the command line.
    pub fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    }
}
