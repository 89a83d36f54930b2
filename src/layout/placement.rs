//! Where things are: a key on its board, a board around its anchor.

use std::f32::consts::PI;

use parry3d::math::{Pose, Rot3, Vec2, Vec3};

use super::model::metres;
use super::outline::Outline;
use super::schema::{self, Bends, Form};
use crate::contact::board_pose::{AutoRecenter, BoardPose};
use crate::contact::surface::{Anchor, Shape};
use crate::hand::Joint;

/// How a board is bent; radii in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoardShape {
    /// Not at all.
    Flat,
    /// Flat, with rows along arcs of this radius at y = 0, around a point at the wearer's side.
    Arc(f32),
    /// Wrapped around an axis along Y, so far in front of (0, 0); all keys face it.
    Rows(f32),
    /// The same around an axis along X.
    Columns(f32),
}

impl BoardShape {
    /// That of a form.
    pub(super) fn of(form: &Form) -> Self {
        match *form {
            Form::Flat => Self::Flat,
            Form::Arc { radius_mm } => Self::Arc(metres(radius_mm.get())),
            Form::Cylinder { radius_mm, bends } => match bends {
                Bends::Rows => Self::Rows(metres(radius_mm.get())),
                Bends::Columns => Self::Columns(metres(radius_mm.get())),
            },
        }
    }

    /// Where a place on the board is in the board's frame, its +Z out of the board there.
    pub(super) fn surface_from_spot(self, outline: &Outline) -> Pose {
        let Outline {
            center: middle,
            rotation,
            ..
        } = *outline;
        let in_plane = Rot3::from_rotation_z(rotation);
        match self {
            Self::Flat | Self::Arc(_) => Pose::from_parts(middle.extend(0.0), in_plane),
            Self::Rows(radius) => {
                let angle = middle.x / radius;
                let place = Vec3::new(angle.sin() * radius, middle.y, rise(angle, radius));
                Pose::from_parts(place, Rot3::from_rotation_y(-angle) * in_plane)
            }
            Self::Columns(radius) => {
                let angle = middle.y / radius;
                let place = Vec3::new(middle.x, angle.sin() * radius, rise(angle, radius));
                Pose::from_parts(place, Rot3::from_rotation_x(angle) * in_plane)
            }
        }
    }
}

/// How far a point of a cylinder is in front of the plane that touches it at (0, 0).
fn rise(angle: f32, radius: f32) -> f32 {
    radius * (1.0 - angle.cos())
}

/// The outline of a key, in metres.
pub(super) fn shape(size: schema::Outline, scale: f32) -> Shape {
    match size {
        schema::Outline::Box(width, depth) => {
            Shape::Box(Vec2::new(metres(width.get()), metres(depth.get())) * (scale / 2.0))
        }
        schema::Outline::Disc(diameter) => Shape::Disc(metres(diameter.get()) * (scale / 2.0)),
    }
}

/// Where a key is in the plane of its board, which a cylinder has where it is unrolled; `None` when it is
/// nearer to the centre of the arc than its own size, or more than half a turn along an arc or round a
/// cylinder.
///
/// On an arc `x` is measured along the arc of the key's own row, whose radius is that of the board + `y`.
pub(super) fn outline(bend: BoardShape, at: Vec2, shape: Shape) -> Option<Outline> {
    let upright = Outline {
        center: at,
        rotation: 0.0,
        shape,
    };
    let reach = upright.half_extents();
    let at_zero = match bend {
        BoardShape::Flat => return Some(upright),
        BoardShape::Rows(radius) => {
            return (at.x.abs() + reach.x <= PI * radius).then_some(upright);
        }
        BoardShape::Columns(radius) => {
            return (at.y.abs() + reach.y <= PI * radius).then_some(upright);
        }
        BoardShape::Arc(radius) => radius,
    };
    let radius = at_zero + at.y;
    let size = match shape {
        Shape::Box(half) => half.length(),
        Shape::Disc(radius) => radius,
    };
    let angle = at.x / radius;
    if radius <= size || angle.abs() > PI {
        return None;
    }
    let direction = Vec2::new(angle.sin(), angle.cos());
    Some(Outline {
        center: direction * radius - Vec2::Y * at_zero,
        rotation: -angle,
        shape,
    })
}

/// How a key stands out of its board.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stance {
    /// In metres, along +Z.
    pub lift: f32,
    /// In radians, about x, then y, then z of the board at its place.
    pub turn: Vec3,
}

impl Stance {
    /// Whether it stays in the plane, so that others can overlap it there.
    pub fn is_in_plane(&self) -> bool {
        self.lift == 0.0 && self.turn.truncate() == Vec2::ZERO
    }

    /// The frame of its front in that of its place on the board; without the turn about z, which the
    /// outline has.
    pub fn spot_from_target(&self) -> Pose {
        let rotation = Rot3::from_rotation_y(self.turn.y) * Rot3::from_rotation_x(self.turn.x);
        Pose::from_parts(Vec3::Z * self.lift, rotation)
    }
}

/// The joint behind the word.
pub(super) fn anchor(anchor: schema::Anchor) -> Anchor {
    match anchor {
        schema::Anchor::World => Anchor::World,
        schema::Anchor::Elbow => Anchor::Joint(Joint::Elbow),
        schema::Anchor::Wrist => Anchor::Joint(Joint::Wrist),
    }
}

/// The board's own frame, with its origin at (0, 0), its rows along +X and its front along +Z, in
/// the world's axes around the anchor.
pub(super) fn anchor_from_board(board: &schema::Board) -> Pose {
    let place = &board.place;
    let radians = |degrees: f64| degrees.to_radians() as f32;
    BoardPose {
        bearing: radians(place.bearing_deg.get()),
        right: metres(place.right_mm.get()),
        height: metres(place.height_mm.get()),
        forward: match (place.forward_mm, board.form) {
            (Some(forward), _) => metres(forward.get()),
            (None, Form::Arc { radius_mm }) => metres(radius_mm.get()),
            (None, Form::Flat | Form::Cylinder { .. }) => 0.0,
        },
        tilt: radians(place.tilt_deg.get()),
    }
    .to_pose()
}

/// How the board creeps, in metres.
pub(super) fn drift(drift: &schema::Drift) -> AutoRecenter {
    AutoRecenter {
        speed: metres(drift.speed_mm_s.get()),
        delay: std::time::Duration::from_micros((drift.after_ms.get() * 1e3).round() as u64),
        max_offset: metres(drift.limit_mm.get()),
    }
}
