//! The rotation of the wrist from the forearm to the hand.

use glam::{DMat3, DVec3};

/// Returns the axes of the hand, as columns, in the frame of a hand that is in line with the forearm: the wrist is
/// inclined by `inclination` about the axis with the azimuth `rotation`, in radians.
pub(super) fn wrist_turn(inclination: f64, rotation: f64) -> DMat3 {
    let (b, a) = inclination.sin_cos();
    let (d, c) = rotation.sin_cos();
    DMat3::from_cols(
        DVec3::new(1.0 + (a - 1.0) * c * c, (a - 1.0) * c * d, -b * c),
        DVec3::new((a - 1.0) * c * d, 1.0 + (a - 1.0) * d * d, -b * d),
        DVec3::new(b * c, b * d, a),
    )
}
