//! Skin: smooth surfaces around bones, with light and shade, drawn from far to near.

use std::f32::consts::TAU;

use std::mem::take;

use parry3d::math::{Vec2, Vec3};

use super::Canvas;
use super::limb_order::{Ball, back_to_front};
use crate::studio::picture::{Color, Triangles};

/// Width of the soft edge around skin, in points.
const EDGE_WIDTH: f32 = 1.3;

/// Sections from one ball to the next.
const BALL_DISTANCE: usize = 3;

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

    fn point(&self, angle: f32) -> Vec3 {
        self.center + self.across * angle.cos() + self.up * angle.sin()
    }
}

/// A part of a surface on the screen.
struct Facet {
    depth: f32,
    corners: [(Vec2, Color); 4],
}

/// A part of a hand that is drawn as a whole.
struct Limb {
    facets: Vec<Facet>,
    /// Balls that fill it, apart from what fades in.
    balls: Vec<Ball>,
}

/// The skin of a hand.
#[derive(Default)]
pub(super) struct Skin {
    limbs: Vec<Limb>,
}

/// The look of a limb.
pub(super) struct LimbSettings {
    /// Number of sides.
    pub sides: usize,
    /// Opacity, 0..=1.
    pub opacity: f32,
    /// Distance by which it counts as nearer to the eye than it is, in metres.
    pub lift: f32,
}

/// A corner of a surface: its position on the screen, its depth and colour.
#[derive(Clone, Copy)]
struct Corner {
    position: Vec2,
    depth: f32,
    color: Color,
    is_front: bool,
}

impl Skin {
    /// Adds the surface through these sections. Leaves it out if some of it is behind the eye.
    pub fn add(&mut self, canvas: &Canvas, sections: &[Section], settings: &LimbSettings) {
        let &LimbSettings {
            sides,
            opacity,
            lift,
        } = settings;
        let at = |ring: usize, side: usize| {
            sections[ring].point((side % sides) as f32 / sides as f32 * TAU)
        };
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
                match corner(canvas, point, normal, opacity * section.opacity) {
                    Some(corner) => corners.push(corner),
                    None => return,
                }
            }
        }
        let mut limb = Limb {
            facets: Vec::with_capacity(corners.len()),
            balls: balls(canvas, sections, lift),
        };
        limb.add_grid(&corners, sides);
        self.limbs.push(limb);
    }

    /// Adds all limbs to a picture, the farthest first.
    pub fn draw(mut self, triangles: &mut Triangles) {
        let balls: Vec<Vec<Ball>> = self
            .limbs
            .iter_mut()
            .map(|it| take(&mut it.balls))
            .collect();
        for index in back_to_front(&balls) {
            self.limbs[index].draw(triangles);
        }
    }
}

impl Limb {
    /// Adds the facets that face the eye, and a soft edge where they end.
    fn add_grid(&mut self, corners: &[Corner], sides: usize) {
        let rings = corners.len() / sides;
        let corner = |ring: usize, side: usize| corners[ring * sides + side % sides];
        let quad = |ring: usize, side: usize| {
            [
                corner(ring, side),
                corner(ring, side + 1),
                corner(ring + 1, side + 1),
                corner(ring + 1, side),
            ]
        };
        let is_front = |ring: usize, side: usize| {
            let fronts = quad(ring, side).iter().filter(|it| it.is_front).count();
            fronts >= 2
        };
        for ring in 0..rings.saturating_sub(1) {
            for side in 0..sides {
                let here = quad(ring, side);
                let front = is_front(ring, side);
                if front {
                    self.add_facet(here);
                }
                let mut add_edge = |other: [Corner; 4], from: Corner, to: Corner, is_front| {
                    if front != is_front {
                        let inside = if front { here } else { other };
                        self.add_edge(from, to, inside);
                    }
                };
                let next = is_front(ring, side + 1);
                add_edge(quad(ring, side + 1), here[1], here[2], next);
                if ring + 2 < rings {
                    let next = is_front(ring + 1, side);
                    add_edge(quad(ring + 1, side), here[2], here[3], next);
                }
            }
        }
    }

    fn add_facet(&mut self, corners: [Corner; 4]) {
        self.facets.push(Facet {
            depth: corners.iter().map(|corner| corner.depth).sum::<f32>() / 4.0,
            corners: corners.map(|corner| (corner.position, corner.color)),
        });
    }

    /// Adds a strip that fades out, outside the edge of a facet.
    fn add_edge(&mut self, from: Corner, to: Corner, facet: [Corner; 4]) {
        let middle = facet.iter().map(|corner| corner.position).sum::<Vec2>() / 4.0;
        let mut outward = (to.position - from.position).perp().normalize_or_zero();
        if outward.dot(from.position - middle) < 0.0 {
            outward = -outward;
        }
        let fade = |corner: Corner| {
            let color = corner.color.with_opacity(0.0);
            (corner.position + outward * EDGE_WIDTH, color)
        };
        self.facets.push(Facet {
            depth: from.depth.max(to.depth),
            corners: [
                (from.position, from.color),
                (to.position, to.color),
                fade(to),
                fade(from),
            ],
        });
    }

    /// Adds the facets to a picture, the farthest first.
    fn draw(&mut self, triangles: &mut Triangles) {
        self.facets.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        for facet in &self.facets {
            let first = triangles.vertices.len() as u32;
            triangles.vertices.extend(facet.corners);
            triangles
                .indices
                .extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
        }
    }
}

/// Returns balls that fill the opaque sections.
fn balls(canvas: &Canvas, sections: &[Section], lift: f32) -> Vec<Ball> {
    let opaque = sections.iter().filter(|section| section.opacity == 1.0);
    let mut balls = Vec::new();
    for section in opaque.step_by(BALL_DISTANCE) {
        let (half_breadth, radius) = (section.across.length(), section.up.length());
        let count = (half_breadth / radius.max(1e-4)).round().max(1.0) as i32;
        for index in 0..count {
            let t = (2 * index + 1 - count) as f32 / count as f32;
            if let Some(center) = canvas.project(section.center + section.across * t) {
                balls.push(Ball {
                    position: center.position,
                    radius: radius * center.scale,
                    depth: center.depth - lift,
                });
            }
        }
    }
    balls
}

/// Projects and lights a point of a surface. Returns `None` behind the eye.
fn corner(canvas: &Canvas, point: Vec3, normal: Vec3, opacity: f32) -> Option<Corner> {
    let projected = canvas.project(point)?;
    let [right, up, back] = canvas.projection.axes;
    let light = right * LIGHT.x + up * LIGHT.y + back * LIGHT.z;
    let to_eye = (canvas.projection.eye - point).normalize_or_zero();
    let facing = normal.dot(to_eye);
    // Skin is lit from behind the edge of a shadow too.
    let lit = (0.5 + 0.5 * normal.dot(light.normalize_or_zero())).powf(1.6);
    let rim = (1.0 - facing.clamp(0.0, 1.0)).powi(3);
    let colors = canvas.colors;
    let color = colors.skin_edge.mix(colors.skin_light, 0.12 + 0.95 * lit);
    Some(Corner {
        position: projected.position,
        depth: projected.depth,
        color: color.mix(colors.skin_edge, 0.7 * rim).with_opacity(opacity),
        is_front: facing > 0.0,
    })
}
