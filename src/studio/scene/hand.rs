//! Hands: skin around bones, and the rings below fingertips.

use parry3d::math::{Vec2, Vec3};

use super::{Canvas, SceneOptions};
use crate::hand::{Finger, Joint};
use crate::kinematics::HandPose;
use crate::studio::camera::Projected;
use crate::studio::model::StudioModel;
use crate::studio::picture::{Color, Triangles, capsule, convex_hull};

/// Radius of the wrist, in metres.
const WRIST_RADIUS: f32 = 0.019;

/// Radius of the forearm at the elbow, in metres.
const ELBOW_RADIUS: f32 = 0.034;

/// Radius of the palm at a knuckle, in metres.
const KNUCKLE_RADIUS: f32 = 0.011;

/// Opacity of skin through which bones are seen.
const SKIN_OVER_BONES: f32 = 0.45;

/// Height of a fingertip over a board below which its ring is drawn, in metres.
const RING_HEIGHT: f32 = 0.06;

/// Radius of the ring of a fingertip that touches, in metres.
const RING_RADIUS: f32 = 0.004;

/// Radius that a ring gains per metre of height.
const RING_GROWTH: f32 = 0.35;

/// A joint with its radius, in metres.
type Ball = (Vec3, f32);

/// A part of a hand: two balls and the skin between them, or the palm.
enum Part {
    Bone(Ball, Ball),
    Palm(Vec<Ball>),
}

/// Adds a hand with its forearm.
pub(super) fn add_hand(canvas: &mut Canvas, pose: &HandPose, options: SceneOptions) {
    let mut parts: Vec<(f32, Part)> = parts(pose)
        .into_iter()
        .filter_map(|part| Some((depth(canvas, &part)?, part)))
        .collect();
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let opacity = if options.bones { SKIN_OVER_BONES } else { 1.0 };
    for (_, part) in &parts {
        add_part(canvas, part, opacity);
    }
    if options.bones {
        add_bones(canvas, pose);
    }
}

fn parts(pose: &HandPose) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut palm = Vec::new();
    let wrist = pose.position(Joint::Wrist);
    for &finger in Finger::ALL {
        // A finger is drawn from its knuckle; the bones before it are in the palm.
        let skip = usize::from(finger != Finger::Thumb);
        let joints = finger.joints()[skip..].iter();
        let points: Vec<Vec3> = joints.filter_map(|&joint| pose.position(joint)).collect();
        let radius = finger_radius(finger, pose);
        for bone in points.windows(2) {
            parts.push(Part::Bone((bone[0], radius * 1.08), (bone[1], radius)));
        }
        palm.extend(points.first().map(|&knuckle| (knuckle, KNUCKLE_RADIUS)));
    }
    if let Some(wrist) = wrist {
        palm.push((wrist, WRIST_RADIUS));
        if let Some(elbow) = pose.position(Joint::Elbow) {
            parts.push(Part::Bone((wrist, WRIST_RADIUS), (elbow, ELBOW_RADIUS)));
        }
    }
    if palm.len() > 2 {
        parts.push(Part::Palm(palm));
    }
    parts
}

/// Returns the radius of a finger: that of the fingertip spheres, a little more for the thumb and less for the little finger.
fn finger_radius(finger: Finger, pose: &HandPose) -> f32 {
    let ratio = match finger {
        Finger::Thumb => 1.15,
        Finger::Little => 0.88,
        _ => 1.0,
    };
    pose.tip_radius.clamp(0.005, 0.012) * ratio
}

/// Returns the distance of a part along the view, or `None` if some of it is behind the eye.
fn depth(canvas: &Canvas, part: &Part) -> Option<f32> {
    let balls: &[Ball] = match part {
        Part::Bone(from, to) => &[*from, *to],
        Part::Palm(balls) => balls,
    };
    let depths: Option<Vec<f32>> = balls
        .iter()
        .map(|(at, _)| Some(canvas.project(*at)?.depth))
        .collect();
    let depths = depths?;
    let mean = depths.iter().sum::<f32>() / depths.len() as f32;
    Some(mean)
}

fn add_part(canvas: &mut Canvas, part: &Part, opacity: f32) {
    let colors = canvas.colors;
    let disc = |ball: &Ball| {
        let Projected {
            position, scale, ..
        } = canvas.project(ball.0)?;
        Some((position, ball.1 * scale))
    };
    let outline = |extra: f32| -> Option<Vec<Vec2>> {
        let grown = |ball: &Ball| disc(ball).map(|(at, radius)| (at, radius + extra));
        Some(match part {
            Part::Bone(from, to) => capsule(grown(from)?, grown(to)?),
            Part::Palm(balls) => {
                let discs: Option<Vec<_>> = balls.iter().map(grown).collect();
                let points = discs?.into_iter().flat_map(|disc| capsule(disc, disc));
                convex_hull(points.collect())
            }
        })
    };
    let (Some(edge), Some(inner)) = (outline(1.2), outline(0.0)) else {
        return;
    };
    let edge_color = colors.skin_edge.with_opacity(opacity);
    let triangles = &mut canvas.picture.above;
    triangles.add_flat_polygon(&edge, edge_color);
    let lit = colors.skin_light.with_opacity(opacity);
    let shaded = colors
        .skin
        .mix(colors.skin_edge, 0.35)
        .with_opacity(opacity);
    add_shaded(triangles, &inner, lit, shaded);
}

/// Adds a polygon that is lit from the upper left.
fn add_shaded(triangles: &mut Triangles, outline: &[Vec2], lit: Color, shaded: Color) {
    let toward_light = Vec2::new(-0.6, -0.8);
    let heights = || outline.iter().map(|point| point.dot(toward_light));
    let (low, high) = heights().fold((f32::MAX, f32::MIN), |(low, high), it| {
        (low.min(it), high.max(it))
    });
    let range = (high - low).max(1.0);
    let corners: Vec<_> = outline
        .iter()
        .zip(heights())
        .map(|(&at, height)| (at, shaded.mix(lit, (height - low) / range)))
        .collect();
    triangles.add_polygon(&corners);
}

/// Adds lines from joint to joint.
fn add_bones(canvas: &mut Canvas, pose: &HandPose) {
    let arm = [Joint::Shoulder, Joint::Elbow, Joint::Wrist];
    let mut chains: Vec<Vec<Joint>> = vec![arm.to_vec()];
    for finger in Finger::ALL {
        let joints = finger.joints().iter().copied();
        chains.push(std::iter::once(Joint::Wrist).chain(joints).collect());
    }
    let color = canvas.colors.bone;
    for chain in chains {
        let points = chain.iter().filter_map(|&joint| pose.position(joint));
        let points: Vec<Vec2> = points
            .filter_map(|point| Some(canvas.project(point)?.position))
            .collect();
        let triangles = &mut canvas.picture.above;
        for bone in points.windows(2) {
            triangles.add_flat_polygon(&capsule((bone[0], 1.2), (bone[1], 1.2)), color);
        }
        for &joint in &points {
            triangles.add_flat_polygon(&capsule((joint, 3.0), (joint, 3.0)), color);
        }
    }
}

/// Adds a ring on the board below each fingertip that is near it. It shrinks as the fingertip comes down.
pub(super) fn add_rings(canvas: &mut Canvas, model: &StudioModel, pose: &HandPose) {
    for index in 0..model.view.layout.boards.len() {
        let Some(world_from_board) = model.world_from_board(index) else {
            continue;
        };
        for tip in Finger::ALL
            .iter()
            .filter_map(|&finger| pose.fingertip(finger))
        {
            let on_board = world_from_board.inverse_transform_point(tip);
            let height = (on_board.z - pose.tip_radius).max(0.0);
            if height > RING_HEIGHT || on_board.z < -RING_HEIGHT {
                continue;
            }
            let below = world_from_board * Vec3::new(on_board.x, on_board.y, 0.0);
            let Some(center) = canvas.project(below) else {
                continue;
            };
            let radius = (RING_RADIUS + RING_GROWTH * height) * center.scale;
            let opacity = 0.9 * (1.0 - height / RING_HEIGHT);
            let color = canvas.colors.ring.with_opacity(opacity);
            canvas
                .picture
                .above
                .add_ring(center.position, radius, 1.6, color);
        }
    }
}
