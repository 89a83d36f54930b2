//! Where things are: a key on its board, a board around its anchor.

use parry3d::math::{Pose, Rot3, Vec2, Vec3};

use super::keyboard::metres;
use super::outline::Outline;
use super::written::{self, Form};
use crate::contact::surface::{Anchor, Shape};
use crate::hand::Joint;

/// The outline of a key, in metres.
pub(super) fn shape(size: written::Outline) -> Shape {
    match size {
        written::Outline::Box(width, depth) => {
            Shape::Box(Vec2::new(metres(width.get()), metres(depth.get())) / 2.0)
        }
        written::Outline::Disc(diameter) => Shape::Disc(metres(diameter.get()) / 2.0),
    }
}

/// Where a key is in the plane of its board; `None` when it is nearer to the centre of the arc than
/// its own size, or more than half a turn along it.
///
/// On an arc `x` is measured along the arc of the key's own row, whose radius is that of the board + `y`.
pub(super) fn outline(form: &Form, at: Vec2, shape: Shape) -> Option<Outline> {
    let Form::Arc { radius_mm } = form else {
        return Some(Outline {
            middle: at,
            rotation: 0.0,
            shape,
        });
    };
    let at_zero = metres(radius_mm.get());
    let radius = at_zero + at.y;
    let size = match shape {
        Shape::Box(half) => half.length(),
        Shape::Disc(radius) => radius,
    };
    let angle = at.x / radius;
    if radius <= size || angle.abs() > std::f32::consts::PI {
        return None;
    }
    let direction = Vec2::new(angle.sin(), angle.cos());
    Some(Outline {
        middle: direction * radius - Vec2::Y * at_zero,
        rotation: -angle,
        shape,
    })
}

/// The joint behind the word.
pub(super) fn anchor(anchor: written::Anchor) -> Anchor {
    match anchor {
        written::Anchor::World => Anchor::World,
        written::Anchor::Elbow => Anchor::Joint(Joint::Elbow),
        written::Anchor::Wrist => Anchor::Joint(Joint::Wrist),
    }
}

/// The board's own frame, with its origin at (0, 0), its rows along +X and its front along +Z, in
/// the world's axes around the anchor (+X right, +Y up, −Z forward).
pub(super) fn anchor_from_board(board: &written::Board) -> Pose {
    let place = &board.place;
    let forward = match (place.forward_mm, board.form) {
        (Some(forward), _) => forward.get(),
        (None, Form::Arc { radius_mm }) => radius_mm.get(),
        (None, Form::Flat) => 0.0,
    };
    let bearing = place.bearing_deg.get().to_radians() as f32;
    let tilt = place.tilt_deg.get().to_radians() as f32;
    let turn = Rot3::from_rotation_y(-bearing);
    // Lying flat: the board's +Y points forward and its +Z up.
    let slope = Rot3::from_rotation_x(tilt - std::f32::consts::FRAC_PI_2);
    let origin = turn * Vec3::new(0.0, metres(place.height_mm.get()), -metres(forward));
    Pose::from_parts(origin, turn * slope)
}
