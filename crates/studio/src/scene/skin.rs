//! Skin: smooth surfaces around bones, with light and shade.

use std::f32::consts::TAU;

use parry3d::math::{Vec2, Vec3};

use super::Canvas;
use super::raster::Corner;
use crate::picture::Color;

/// Distance from the eye up to which skin is not seen, and from which it is opaque, in metres: an arm that passes the eye fades
/// out, as it would be cut open otherwise.
const FADE: (f32, f32) = (0.03, 0.07);

/// Direction of the light, in the axes of the camera: from the upper left, towards the eye.
const LIGHT: Vec3 = Vec3::new(-0.45, 0.65, 0.6);

/// An elliptic cross-section of a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section {
    /// The middle.
    pub center: Vec3,
    /// From the middle to the thumb side.
    pub across: Vec3,
    /// From the middle to the back of the hand.
    pub up: Vec3,
    /// Opacity, 0..=1. A limb that starts inside another one fades in over it.
    pub opacity: f32,
}

impl Section {
    /// Returns the section at `t` between this one (0) and another (1).
    pub fn mix(&self, other: &Self, t: f32) -> Self {
        Self {
            center: self.center.lerp(other.center, t),
            across: self.across.lerp(other.across, t),
            up: self.up.lerp(other.up, t),
            opacity: self.opacity + (other.opacity - self.opacity) * t,
        }
    }

    /// Returns the section with another size, moved.
    pub fn scaled(&self, factor: f32, offset: Vec3) -> Self {
        Self {
            center: self.center + offset,
            across: self.across * factor,
            up: self.up * factor,
            ..*self
        }
    }

    /// Returns the point of the outline in a direction, whose length is 1.
    fn point(&self, direction: Vec2) -> Vec3 {
        self.center + self.across * direction.x + self.up * direction.y
    }
}

/// Adds the surface of a limb through these sections.
pub(super) fn add(canvas: &mut Canvas, sections: &[Section], sides: usize) {
    let angle = |side: usize| side as f32 / sides as f32 * TAU;
    let circle: Vec<Vec2> = (0..sides).map(|it| Vec2::from_angle(angle(it))).collect();
    let at = |ring: usize, side: usize| sections[ring].point(circle[side % sides]);
    let last = sections.len().saturating_sub(1);
    let mut corners = Vec::with_capacity(sections.len() * sides);
    for (ring, section) in sections.iter().enumerate() {
        for side in 0..sides {
            let along = at((ring + 1).min(last), side) - at(ring.saturating_sub(1), side);
            let around = at(ring, side + 1) - at(ring, side + sides - 1);
            let point = at(ring, side);
            let outward = point - section.center;
            let normal = around
                .cross(along)
                .normalize_or(outward.normalize_or(Vec3::Y));
            let normal = normal * normal.dot(outward).signum();
            let colors = [canvas.colors.skin_edge, canvas.colors.skin_light];
            corners.push(corner(canvas, point, normal, colors, section.opacity));
        }
    }
    canvas.skin.start_limb();
    for ring in 0..last {
        for side in 0..sides {
            let next = (side + 1) % sides;
            let of = |row: usize, column: usize| corners[row * sides + column];
            let [a, b, c, d] = [
                of(ring, side),
                of(ring, next),
                of(ring + 1, next),
                of(ring + 1, side),
            ];
            for triangle in [[a, b, c], [a, c, d]] {
                if let [Some(first), Some(second), Some(third)] = triangle {
                    canvas.skin.add([first, second, third]);
                }
            }
        }
    }
}

/// Projects and lights a point of a surface with a dark and a light color. Returns `None` behind the eye.
pub(super) fn corner(
    canvas: &Canvas,
    point: Vec3,
    normal: Vec3,
    [dark, bright]: [Color; 2],
    opacity: f32,
) -> Option<Corner> {
    let projected = canvas.project(point)?;
    let [right, up, back] = canvas.projection.axes;
    let light = right * LIGHT.x + up * LIGHT.y + back * LIGHT.z;
    let to_eye = canvas.projection.to_eye(point).normalize_or_zero();
    let facing = normal.dot(to_eye);
    // Skin is lit from behind the edge of a shadow too.
    let lit = (0.5 + 0.5 * normal.dot(light.normalize_or_zero())).powf(1.6);
    let rim = (1.0 - facing.clamp(0.0, 1.0)).powi(3);
    let color = dark.mix(bright, 0.12 + 0.95 * lit);
    let (clear, opaque) = FADE;
    let fade = ((projected.depth - clear) / (opaque - clear)).clamp(0.0, 1.0);
    Some(Corner {
        position: projected.position,
        depth: projected.depth,
        color: color.mix(dark, 0.7 * rim),
        opacity: opacity * fade,
        is_front: facing > 0.0,
    })
}
