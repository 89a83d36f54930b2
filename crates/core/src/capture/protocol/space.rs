//! Options of protocols that carry positions: the hand, the unit of length and the axes.

use glam::{DMat3, DVec3};

use super::{ProtocolOption, ProtocolOptions};
use crate::hand::Side;

/// The hand that is read.
pub(super) const HAND: ProtocolOption = ProtocolOption {
    name: "hand",
    default: "right",
    summary: "hand that is read, `right` or `left`",
    check: |value| match value.parse::<Side>() {
        Ok(_) => Ok(()),
        Err(error) => Err(error.to_string()),
    },
};

/// The axis that points up.
pub(super) const UP: ProtocolOption = ProtocolOption {
    name: "up",
    default: "y",
    summary: "axis that points up, `y` or `z`",
    check: |value| match value {
        "y" | "z" => Ok(()),
        _ => Err(format!(
            "`{value}` is not an axis that points up, write `y` or `z`"
        )),
    },
};

/// Checks the number of millimetres in a unit of length.
pub(super) fn check_unit(value: &str) -> Result<(), String> {
    check_range(
        value,
        0.001..=100_000.0,
        "millimetres in the unit of length",
    )
}

/// Checks that an option is a number within `range`.
pub(super) fn check_range(
    value: &str,
    range: std::ops::RangeInclusive<f64>,
    kind: &str,
) -> Result<(), String> {
    match value.parse::<f64>() {
        Ok(number) if range.contains(&number) => Ok(()),
        _ => Err(format!(
            "`{value}` is not a number of {kind} from {} to {}",
            range.start(),
            range.end()
        )),
    }
}

/// Returns the number that an option was checked to be.
pub(super) fn number(options: &ProtocolOptions, option: &ProtocolOption) -> f64 {
    let value = options.get(option);
    value
        .parse()
        .expect("options are checked when they are set")
}

/// Returns the value of [`HAND`].
pub(super) fn hand(options: &ProtocolOptions) -> Side {
    let value = options.get(&HAND);
    value
        .parse()
        .expect("options are checked when they are set")
}

/// The person in the axes of a source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Facing {
    /// The person looks along the third axis of a frame whose second axis points up, and along −Y with +Z up: the
    /// convention of animation.
    TowardsViewer,
    /// The person looks along −Z with +Y up, and along +Y with +Z up: the axes of the world frame.
    AwayFromViewer,
}

/// The conversion from the unit and the axes of a source to metres in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WorldFromSource(DMat3);

impl WorldFromSource {
    /// Creates the conversion for the value of [`UP`] and a unit of `unit_mm` millimetres.
    pub fn new(options: &ProtocolOptions, unit_mm: f64, facing: Facing) -> Self {
        let is_z_up = options.get(&UP) == "z";
        // Rows: world right, up and backwards.
        let rows = match (facing, is_z_up) {
            (Facing::TowardsViewer, false) => [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z],
            (Facing::TowardsViewer, true) => [DVec3::NEG_X, DVec3::Z, DVec3::Y],
            (Facing::AwayFromViewer, false) => [DVec3::X, DVec3::Y, DVec3::Z],
            (Facing::AwayFromViewer, true) => [DVec3::X, DVec3::Z, DVec3::NEG_Y],
        };
        Self(DMat3::from_cols(rows[0], rows[1], rows[2]).transpose() * (unit_mm / 1000.0))
    }

    /// Converts a position.
    pub fn position(self, position: DVec3) -> DVec3 {
        self.0 * position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_conversion_keeps_handedness_and_scales() {
        for up in ["y", "z"] {
            for facing in [Facing::TowardsViewer, Facing::AwayFromViewer] {
                let mut options = ProtocolOptions::default();
                options.set(&UP, up).unwrap();
                let WorldFromSource(matrix) = WorldFromSource::new(&options, 10.0, facing);
                assert!(
                    (matrix.determinant() - 1e-6).abs() < 1e-15,
                    "{up} {facing:?}"
                );
                let upward = if up == "y" { DVec3::Y } else { DVec3::Z };
                assert!((matrix * upward).distance(DVec3::Y * 0.01) < 1e-15);
            }
        }
    }
}
