//! Pointers and targets in space: boxes, balls, the ray, and the cursor.

use parry3d::math::{Pose, Vec2, Vec3};

use super::Canvas;
use crate::fonts::{Fitted, fitted};
use crate::model::StudioModel;
use crate::picture::{Color, Label, convex_hull, disc};
use ademan_core::contact::TargetId;
use ademan_core::contact::volume::{Volume, VolumeShape};
use ademan_core::device::pointer::mode::{DirectPointing, RayOrigin, RayPointing};
use ademan_core::device::pointer::{AnchoredFrame, PointerSettings, PointingMode};
use ademan_core::hand::{Finger, Joint};
use ademan_core::kinematics::HandPose;
use ademan_core::layout::SpaceTargets;

/// Radius of the cursor, in points.
const CURSOR_RADIUS: f32 = 5.0;

/// Width of edges and of the ray, in points.
const LINE_WIDTH: f32 = 1.2;

/// Opacity of a target that is not selected.
const VOLUME_OPACITY: f32 = 0.35;

/// Opacity of a selected target.
const SELECTED_OPACITY: f32 = 0.8;

/// Height of the letters of a target in space, as a fraction of its radius.
const LETTER_HEIGHT: f32 = 0.35;

/// Width of the name of a target in space, as a fraction of its radius.
const NAME_WIDTH: f32 = 1.7;

/// The smallest label that can be read, in points.
const MIN_LABEL_PT: f32 = 6.0;

/// The edges of a box, by the indices of its corners.
const EDGES: [(usize, usize); 12] = [
    (0, 1),
    (2, 3),
    (4, 5),
    (6, 7),
    (0, 2),
    (1, 3),
    (4, 6),
    (5, 7),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
];

/// Returns the points that show all targets in space and the range of the pointer.
pub(super) fn points(model: &StudioModel) -> Vec<Vec3> {
    let layout = &model.view.layout;
    let mut points = Vec::new();
    for SpaceTargets { space, .. } in &layout.spaces {
        let Some(frame) = world_from_frame(model, &space.frame) else {
            continue;
        };
        points.extend(space.volumes.iter().flat_map(|volume| {
            let half = half_extents(volume);
            corners(half).map(|corner| frame * (volume.center + corner))
        }));
    }
    if let Some(range) = layout.pointer.as_ref().and_then(range)
        && let Some(frame) = world_from_frame(model, range.frame)
    {
        points.extend(corners(range.half).map(|corner| frame * corner));
    }
    points
}

/// Adds the targets in space.
pub(super) fn add_spaces(canvas: &mut Canvas, model: &StudioModel) {
    let mut volumes = Vec::new();
    for SpaceTargets { names, space } in &model.view.layout.spaces {
        let Some(frame) = world_from_frame(model, &space.frame) else {
            continue;
        };
        for (index, (name, volume)) in names.iter().zip(space.volumes.iter()).enumerate() {
            let target = TargetId(space.first_target.0 + index as u32);
            if let Some(center) = canvas.project(frame * volume.center) {
                volumes.push((center.depth, frame, volume, name, target));
            }
        }
    }
    volumes.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, frame, volume, name, target) in volumes {
        let is_selected = model.view.state.selected.contains(&target);
        add_volume(canvas, &frame, volume, is_selected);
        add_name(canvas, frame * volume.center, volume, name);
    }
}

pub(super) fn add_volume(canvas: &mut Canvas, frame: &Pose, volume: &Volume, is_selected: bool) {
    let color = if is_selected {
        canvas.colors.lit.with_opacity(SELECTED_OPACITY)
    } else {
        canvas.colors.ring.with_opacity(VOLUME_OPACITY)
    };
    match volume.shape {
        VolumeShape::Ball(radius) => {
            if let Some(center) = canvas.project(*frame * volume.center) {
                let (at, radius) = (center.position, radius * center.scale);
                let below = &mut canvas.picture.below;
                below.add_flat_polygon(&disc(at, radius), color);
                below.add_ring(at, radius, LINE_WIDTH, color.with_opacity(0.9));
            }
        }
        VolumeShape::Box(half) => {
            let corners = corners(half).map(|corner| *frame * (volume.center + corner));
            add_box(canvas, &corners, color);
        }
    }
}

/// Adds a box: its outline, filled, and its edges.
fn add_box(canvas: &mut Canvas, corners: &[Vec3; 8], color: Color) {
    let projected = corners.map(|corner| canvas.project(corner));
    let projected: Vec<Vec2> = projected.iter().flatten().map(|it| it.position).collect();
    if projected.len() < corners.len() {
        return;
    }
    let below = &mut canvas.picture.below;
    below.add_flat_polygon(&convex_hull(projected.clone()), color);
    let edge = color.with_opacity(0.8);
    for (from, to) in EDGES {
        below.add_line([(projected[from], edge), (projected[to], edge)], LINE_WIDTH);
    }
}

/// Adds the name of a target, towards the eye.
pub(super) fn add_name(canvas: &mut Canvas, center: Vec3, volume: &Volume, name: &str) {
    let Some(center) = canvas.project(center) else {
        return;
    };
    let radius = half_extents(volume).min_element() * center.scale;
    let room = Vec2::new(radius * NAME_WIDTH, radius);
    let Fitted { text, size } = fitted(name.to_owned(), room, radius * LETTER_HEIGHT);
    if size >= MIN_LABEL_PT {
        canvas.picture.labels.push(Label {
            position: center.position,
            right: Vec2::X * size,
            down: Vec2::Y * size,
            color: canvas.colors.label,
            text,
        });
    }
}

/// The range of a pointer in space.
struct Range<'a> {
    frame: &'a AnchoredFrame,
    half: Vec3,
}

/// Returns the range of a pointer, if it is a box or a rectangle in space.
fn range(pointer: &PointerSettings) -> Option<Range<'_>> {
    match &pointer.mode {
        PointingMode::Direct(DirectPointing { frame, size, .. }) => Some(Range {
            frame,
            half: *size / 2.0,
        }),
        PointingMode::Ray(RayPointing { frame, size, .. }) => Some(Range {
            frame,
            half: size.extend(0.0) / 2.0,
        }),
        _ => None,
    }
}

/// Adds the range of the pointer, its ray, and the cursor there and in each space.
pub(super) fn add_pointer(canvas: &mut Canvas, model: &StudioModel) {
    let layout = &model.view.layout;
    let state = &model.view.state;
    for (SpaceTargets { space, .. }, position) in layout.spaces.iter().zip(&state.in_spaces_mm) {
        if let Some(position) = position
            && let Some(frame) = world_from_frame(model, &space.frame)
        {
            add_cursor(canvas, frame * (Vec3::from_array(*position) / 1e3));
        }
    }
    let Some(pointer) = &layout.pointer else {
        return;
    };
    let Some(Range { frame, half }) = range(pointer) else {
        return;
    };
    let Some(frame) = world_from_frame(model, frame) else {
        return;
    };
    let color = canvas.colors.ring.with_opacity(0.08);
    add_box(canvas, &corners(half).map(|corner| frame * corner), color);
    if let Some(fractions) = state.pointer {
        let fractions = Vec3::from_array(fractions) - 0.5;
        let cursor = frame * (fractions * 2.0 * half);
        if let PointingMode::Ray(ray) = &pointer.mode {
            add_ray(canvas, model, ray.from, cursor);
        }
        add_cursor(canvas, cursor);
    }
}

/// Adds the ray from the hand to the cursor.
fn add_ray(canvas: &mut Canvas, model: &StudioModel, from: RayOrigin, cursor: Vec3) {
    let origin = hand(model).and_then(|pose| match from {
        RayOrigin::Hand => pose.position(Joint::IndexPhalanxProximal),
        RayOrigin::Index => pose.fingertip(Finger::Index),
    });
    let ends = origin.and_then(|origin| Some([canvas.project(origin)?, canvas.project(cursor)?]));
    if let Some(ends) = ends {
        let color = canvas.colors.lit;
        let ends = ends.map(|end| (end.position, color));
        canvas.picture.marks.add_line(ends, LINE_WIDTH);
    }
}

fn add_cursor(canvas: &mut Canvas, position: Vec3) {
    if let Some(center) = canvas.project(position) {
        let at = center.position;
        let (fill, edge) = (canvas.colors.lit, canvas.colors.lit_label);
        let marks = &mut canvas.picture.marks;
        marks.add_flat_polygon(&disc(at, CURSOR_RADIUS), fill);
        marks.add_ring(at, CURSOR_RADIUS, LINE_WIDTH, edge);
    }
}

/// Returns the hand that points: the first one that is seen.
fn hand(model: &StudioModel) -> Option<&HandPose> {
    let pointer = model.view.layout.pointer.as_ref();
    let side = pointer.and_then(|pointer| pointer.side);
    let mut poses = model.poses.iter().rev().flatten();
    poses.find(|pose| side.is_none_or(|side| side == pose.side))
}

fn world_from_frame(model: &StudioModel, frame: &AnchoredFrame) -> Option<Pose> {
    frame.world_from_frame(hand(model)?)
}

fn half_extents(volume: &Volume) -> Vec3 {
    match volume.shape {
        VolumeShape::Ball(radius) => Vec3::splat(radius),
        VolumeShape::Box(half) => half,
    }
}

/// Returns the corners of the box around a volume, from its center.
pub(crate) fn volume_corners(volume: &Volume) -> [Vec3; 8] {
    corners(half_extents(volume))
}

/// Returns the corners of a box around the origin; bit `i` of an index is the side on axis `i`.
fn corners(half: Vec3) -> [Vec3; 8] {
    std::array::from_fn(|index| {
        let sign = |axis: usize| if index & (1 << axis) == 0 { -1.0 } else { 1.0 };
        half * Vec3::new(sign(0), sign(1), sign(2))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edges_of_a_box_join_corners_that_differ_on_one_axis() {
        let corners = corners(Vec3::ONE);
        for (from, to) in EDGES {
            let difference = (corners[from] - corners[to]).abs();
            assert_eq!(difference.element_sum(), 2.0, "{from} {to}");
        }
    }
}
