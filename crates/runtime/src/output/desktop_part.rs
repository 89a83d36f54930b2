//! The part of the desktop that absolute positions refer to.

use ademan_core::device::EventKind;
use ademan_core::document::schema;
use serde::{Deserialize, Serialize};

schema! {
    /// A part of the desktop, such as one of several monitors, as fractions of the whole desktop.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "DesktopPart", default, deny_unknown_fields)]
    pub struct DesktopPart {
        /// Left edge, from the left edge of the desktop. Default: 0.
        pub left: f64,
        /// Upper edge, from the upper edge of the desktop. Default: 0.
        pub top: f64,
        /// Right edge, from the left edge of the desktop. Default: 1.
        pub right: f64,
        /// Lower edge, from the upper edge of the desktop. Default: 1.
        pub bottom: f64,
    }
}

impl Default for DesktopPart {
    /// The whole desktop.
    fn default() -> Self {
        Self {
            left: 0.0,
            top: 0.0,
            right: 1.0,
            bottom: 1.0,
        }
    }
}

impl DesktopPart {
    /// Returns `true` if it has a width and a height, and is within the desktop.
    pub fn is_valid(&self) -> bool {
        let is_range = |low: f64, high: f64| 0.0 <= low && low < high && high <= 1.0;
        is_range(self.left, self.right) && is_range(self.top, self.bottom)
    }

    /// Returns an event whose position, a fraction of this part, is a fraction of the whole desktop. Other events stay as they are.
    pub(super) fn place(&self, event: EventKind) -> EventKind {
        let EventKind::MoveTo(x, y) = event else {
            return event;
        };
        let between = |low: f64, high: f64, fraction: f32| low + (high - low) * f64::from(fraction);
        let x_of_desktop = between(self.left, self.right, x);
        let y_of_desktop = between(self.top, self.bottom, y);
        EventKind::MoveTo(x_of_desktop as f32, y_of_desktop as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_within_the_part_and_other_motion_is_unchanged() {
        let right_half = DesktopPart {
            left: 0.5,
            ..DesktopPart::default()
        };
        let lower_quarter = DesktopPart {
            top: 0.75,
            ..DesktopPart::default()
        };
        let to = EventKind::MoveTo;
        let by = EventKind::MoveBy(3, -4);
        let table = [
            (DesktopPart::default(), to(0.25, 0.75), to(0.25, 0.75)),
            (right_half, to(0.0, 0.0), to(0.5, 0.0)),
            (right_half, to(0.5, 0.25), to(0.75, 0.25)),
            (right_half, to(1.0, 1.0), to(1.0, 1.0)),
            (lower_quarter, to(0.5, 0.0), to(0.5, 0.75)),
            (right_half, by, by),
        ];
        for (part, event, expected) in table {
            assert_eq!(part.place(event), expected, "{part:?}");
        }
    }

    #[test]
    fn a_part_has_an_extent_within_the_desktop() {
        let table = [
            ([0.0, 0.0, 1.0, 1.0], true),
            ([0.5, 0.1, 0.6, 0.2], true),
            ([0.5, 0.0, 0.5, 1.0], false),
            ([0.0, 0.9, 1.0, 0.1], false),
            ([-0.1, 0.0, 1.0, 1.0], false),
            ([0.0, 0.0, 1.0, 1.1], false),
            ([f64::NAN, 0.0, 1.0, 1.0], false),
        ];
        for ([left, top, right, bottom], is_valid) in table {
            let part = DesktopPart {
                left,
                top,
                right,
                bottom,
            };
            assert_eq!(part.is_valid(), is_valid, "{part:?}");
        }
    }
}
