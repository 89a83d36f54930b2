//! Boards with their keys and controls.

use parry3d::math::{Pose, Vec2, Vec3};

use super::Canvas;
use crate::contact::TargetId;
use crate::contact::surface::{Shape, Target};
use crate::studio::model::StudioModel;
use crate::studio::picture::{Label, convex_hull};

/// The lowest key, in metres: a key with less travel would look like a drawing.
const MIN_KEY_HEIGHT: f32 = 0.004;

/// The edge of the plate around the keys, in metres.
const BOARD_MARGIN: f32 = 0.006;

/// The largest deviation of fronts from a plane for which a plate is drawn, in metres.
const FLATNESS: f32 = 0.002;

/// The largest label, in metres.
const MAX_LABEL: f32 = 0.009;

/// The smallest label that can be read, in points.
const MIN_LABEL_PT: f32 = 7.0;

/// Adds a board, if its pose is known.
pub(super) fn add_board(canvas: &mut Canvas, model: &StudioModel, index: usize) {
    let Some(world_from_board) = model.world_from_board(index) else {
        return;
    };
    let surface = &model.view.layout.scene.surfaces()[index];
    let targets: Vec<_> = surface.targets().collect();
    add_plate(canvas, &world_from_board, &targets);
    let mut keys: Vec<_> = targets
        .into_iter()
        .filter_map(|(id, target)| {
            let world_from_target = world_from_board * target.surface_from_target;
            let depth = canvas.project(world_from_target.translation)?.depth;
            Some((depth, id, target, world_from_target))
        })
        .collect();
    keys.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, id, target, world_from_target) in keys {
        add_key(canvas, model, id, target, &world_from_target);
    }
}

/// Adds the plate below the keys of a flat board.
fn add_plate(canvas: &mut Canvas, world_from_board: &Pose, targets: &[(TargetId, &Target)]) {
    let bounds = targets.iter().map(|(_, target)| {
        let center = target.surface_from_target.translation;
        let half = (target.surface_from_target.rotation * half_extents(target).extend(0.0)).abs();
        (center - half, center + half)
    });
    let Some((low, high)) = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
        return;
    };
    if high.z - low.z > FLATNESS {
        return;
    }
    let height = targets.iter().map(|(_, target)| key_height(target));
    let z = low.z - height.fold(0.0, f32::max);
    let (low, high) = (low - BOARD_MARGIN, high + BOARD_MARGIN);
    let corners = [
        (low.x, low.y),
        (high.x, low.y),
        (high.x, high.y),
        (low.x, high.y),
    ];
    let corners = corners.map(|(x, y)| canvas.project(*world_from_board * Vec3::new(x, y, z)));
    let corners: Vec<Vec2> = corners.iter().flatten().map(|it| it.position).collect();
    if corners.len() == 4 {
        let color = canvas.colors.board;
        canvas.picture.below.add_flat_polygon(&corners, color);
    }
}

fn add_key(canvas: &mut Canvas, model: &StudioModel, id: TargetId, target: &Target, pose: &Pose) {
    let contact = model.contact_with(id);
    let is_lit = contact.is_some_and(|contact| contact.is_pressed)
        || model.view.state.selected.contains(&id);
    let depth = contact.map_or(0.0, |contact| contact.depth * target.travel);
    let outline = outline(target);
    let at = |point: Vec2, z: f32| {
        let projected = canvas.project(*pose * point.extend(z))?;
        Some(projected.position)
    };
    let fronts: Option<Vec<Vec2>> = outline.iter().map(|&point| at(point, -depth)).collect();
    let backs = outline
        .iter()
        .map(|&point| at(point * 1.04, -key_height(target)));
    let (Some(front), Some(back)) = (fronts, backs.collect::<Option<Vec<_>>>()) else {
        return;
    };
    let colors = canvas.colors;
    let (face, side, label) = match is_lit {
        true => (colors.lit, colors.lit_side, colors.lit_label),
        false => (colors.key, colors.key_side, colors.label),
    };
    let hull = convex_hull(front.iter().chain(&back).copied().collect());
    canvas.picture.below.add_flat_polygon(&hull, side);
    canvas.picture.below.add_flat_polygon(&front, face);
    let Some(text) = model.view.layout.face(id).map(|face| &face.label) else {
        return;
    };
    let Some(center) = canvas.project(*pose * Vec3::new(0.0, 0.0, -depth)) else {
        return;
    };
    let half = half_extents(target);
    let width = 1.7 * half.x / (0.62 * text.chars().count().max(1) as f32);
    let size = (half.y * 1.1).min(width).min(MAX_LABEL) * center.scale;
    if size >= MIN_LABEL_PT {
        canvas.picture.labels.push(Label {
            position: center.position,
            size,
            color: label,
            text: with_known_signs(text),
        });
    }
}

/// Replaces the signs that the font of the window lacks.
fn with_known_signs(label: &str) -> String {
    let known = |sign| match sign {
        '⏎' => '↵',
        '⌫' => '⟵',
        '␣' => ' ',
        known => known,
    };
    label.chars().map(known).collect()
}

fn key_height(target: &Target) -> f32 {
    target.travel.max(MIN_KEY_HEIGHT)
}

fn half_extents(target: &Target) -> Vec2 {
    match target.shape {
        Shape::Box(half) => half,
        Shape::Disc(radius) => Vec2::splat(radius),
    }
}

/// Returns the outline of a front: a box with round corners, or a disc.
fn outline(target: &Target) -> Vec<Vec2> {
    let (half, radius, steps) = match target.shape {
        Shape::Box(half) => (half, 0.22 * half.min_element(), 3),
        Shape::Disc(radius) => (Vec2::splat(radius), radius, 8),
    };
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let mut points = Vec::with_capacity(corners.len() * (steps + 1));
    for (corner, (x, y)) in corners.into_iter().enumerate() {
        for step in 0..=steps {
            let angle = (corner as f32 + step as f32 / steps as f32) * std::f32::consts::FRAC_PI_2;
            points.push(Vec2::new(x, y) * (half - radius) + Vec2::from_angle(angle) * radius);
        }
    }
    points
}
