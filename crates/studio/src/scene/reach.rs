//! Reach: the farthest positions of a fingertip with the elbow where it is.

use parry3d::math::{Vec2, Vec3};

use super::Canvas;
use ademan_core::hand::{Finger, Joint};
use ademan_core::kinematics::HandPose;

/// Azimuths of the shell on either side of the forearm, in radians.
const HALF_WIDTH: f32 = 1.2;

/// Elevations of the shell, in radians.
const ELEVATIONS: (f32, f32) = (-0.9, 0.7);

/// Facets of the shell: across and up.
const FACETS: (usize, usize) = (24, 16);

/// Facets between two lines.
const LINE_DISTANCE: usize = 4;

/// Opacity of the shell where it is seen from the front.
const OPACITY: f32 = 0.06;

/// Width of the lines, in points.
const LINE_WIDTH: f32 = 0.6;

/// Opacity of the lines.
const LINE_OPACITY: f32 = 0.35;

/// Adds a shell at the distance of the stretched index finger from the elbow.
pub(super) fn add_reach(canvas: &mut Canvas, pose: &HandPose) {
    let (Some(elbow), Some(radius)) = (pose.position(Joint::Elbow), reach(pose)) else {
        return;
    };
    let forearm = pose
        .position(Joint::Wrist)
        .map_or(Vec3::NEG_Z, |wrist| wrist - elbow);
    let middle = forearm.x.atan2(-forearm.z);
    let (columns, rows) = FACETS;
    let direction = |column: usize, row: usize| {
        let azimuth = middle + (2.0 * column as f32 / columns as f32 - 1.0) * HALF_WIDTH;
        let t = row as f32 / rows as f32;
        let elevation = ELEVATIONS.0 + t * (ELEVATIONS.1 - ELEVATIONS.0);
        let (rise, run) = elevation.sin_cos();
        Vec3::new(azimuth.sin() * run, rise, -azimuth.cos() * run)
    };
    let color = canvas.colors.ring;
    let at = |column: usize, row: usize| {
        let direction = direction(column, row);
        let point = elbow + direction * radius;
        let projected = canvas.project(point)?;
        let facing = canvas
            .projection
            .to_eye(point)
            .normalize_or_zero()
            .dot(direction)
            .abs();
        // As on glass, more is seen at the edge.
        Some((projected.position, OPACITY * (2.5 - 1.5 * facing)))
    };
    // A corner behind the eye leaves out the facets around it.
    let corners: Vec<Option<(Vec2, f32)>> = (0..=rows)
        .flat_map(|row| (0..=columns).map(move |column| (column, row)))
        .map(|(column, row)| at(column, row))
        .collect();
    let corner = |column: usize, row: usize| corners[row * (columns + 1) + column];
    let below = &mut canvas.picture.below;
    for row in 0..rows {
        for column in 0..columns {
            let facet = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| corner(column + x, row + y));
            if let [Some(a), Some(b), Some(c), Some(d)] = facet {
                let first = below.vertices.len() as u32;
                let shaded =
                    [a, b, c, d].map(|(place, opacity)| (place, color.with_opacity(opacity)));
                below.vertices.extend(shaded);
                below
                    .indices
                    .extend([0, 1, 2, 0, 2, 3].map(|index| first + index));
            }
        }
    }
    let line = color.with_opacity(LINE_OPACITY);
    let mut add_line = |from: Option<(Vec2, f32)>, to: Option<(Vec2, f32)>| {
        if let (Some((from, _)), Some((to, _))) = (from, to) {
            below.add_line([(from, line), (to, line)], LINE_WIDTH);
        }
    };
    for row in 0..=rows {
        for column in 0..=columns {
            if row % LINE_DISTANCE == 0 && column < columns {
                add_line(corner(column, row), corner(column + 1, row));
            }
            if column % LINE_DISTANCE == 0 && row < rows {
                add_line(corner(column, row), corner(column, row + 1));
            }
        }
    }
}

/// Returns the length from the elbow to the tip of the stretched index finger, in metres.
fn reach(pose: &HandPose) -> Option<f32> {
    let chain = [Joint::Elbow, Joint::Wrist]
        .into_iter()
        .chain(Finger::Index.joints()[1..].iter().copied());
    let points: Option<Vec<Vec3>> = chain.map(|joint| pose.position(joint)).collect();
    let points = points?;
    Some(
        points
            .windows(2)
            .map(|bone| bone[0].distance(bone[1]))
            .sum(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::hand::Side;
    use ademan_core::time::Timestamp;
    use parry3d::math::Pose;

    #[test]
    fn a_bent_finger_reaches_as_far_as_a_stretched_one() {
        let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
        let mut set = |joint, x, y| {
            pose.set(joint, Pose::from_translation(Vec3::new(x, y, 0.0)));
        };
        set(Joint::Elbow, 0.0, 0.0);
        set(Joint::Wrist, 0.25, 0.0);
        for (index, &joint) in Finger::Index.joints()[1..].iter().enumerate() {
            set(joint, 0.34, index as f32 * -0.03);
        }
        let length = reach(&pose).unwrap();
        assert!((length - (0.25 + 0.09 + 0.09)).abs() < 1e-5, "{length}");
    }
}
