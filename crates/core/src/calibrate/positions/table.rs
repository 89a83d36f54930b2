//! The plane of a table from the fingertips that touch it, and a board on it.

use glam::{DMat2, DVec2, DVec3, Quat, Vec3};
use parry3d::math::Pose;

use super::{MIN_READINGS, PositionError, median_position};
use crate::contact::board_pose::BoardPose;
use crate::hand::{Finger, Joint, JointPositions};

/// The largest distance of a fingertip from the plane, in metres: the error of a webcam.
const MAX_DISTANCE: f64 = 0.012;

/// The smallest spread of the fingertips across their line, in metres.
const MIN_SPREAD: f64 = 0.012;

/// The steepest table, in degrees.
const MAX_SLOPE: f64 = 45.0;

/// The plane of a table in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TablePlane {
    /// The point of the surface in the middle of the fingertips, in metres.
    pub point: DVec3,
    /// The unit vector out of the surface: upwards.
    pub normal: DVec3,
    /// The largest distance of a fingertip from the plane, in metres.
    pub error: f64,
}

impl TablePlane {
    /// Fits the plane to five fingertips that touch it. The surface is `tip_radius` (metres) below their centers.
    ///
    /// It is the least-squares plane y = a x + b z + c through the medians of each fingertip.
    ///
    /// # Errors
    /// Fails if a fingertip is not seen, or if they show no table.
    pub fn fit(readings: &[JointPositions], tip_radius: f64) -> Result<Self, PositionError> {
        let tips = Finger::ALL.iter().map(|&finger| {
            let tip = median_position(readings, Joint::tip(finger));
            tip.ok_or(PositionError::NotSeen {
                part: "fingertips",
                readings: readings.len().min(MIN_READINGS - 1),
            })
        });
        let tips: Vec<DVec3> = tips.collect::<Result<_, _>>()?;
        let center = tips.iter().sum::<DVec3>() / tips.len() as f64;
        let slopes = slopes(&tips, center)?;
        let normal = DVec3::new(-slopes.x, 1.0, -slopes.y).normalize();
        let degrees = normal.y.acos().to_degrees();
        if degrees > MAX_SLOPE {
            return Err(PositionError::TooSteep { degrees });
        }
        let distances = tips.iter().map(|tip| (*tip - center).dot(normal).abs());
        let (index, error) = distances
            .enumerate()
            .max_by(|one, other| one.1.total_cmp(&other.1))
            .unwrap_or((0, 0.0));
        if error <= MAX_DISTANCE {
            Ok(Self {
                point: center - normal * tip_radius,
                normal,
                error,
            })
        } else {
            Err(PositionError::NotPlane {
                finger: Finger::ALL[index],
                millimetres: error * 1e3,
            })
        }
    }
}

/// Returns the slopes of the plane along X and Z.
fn slopes(tips: &[DVec3], center: DVec3) -> Result<DVec2, PositionError> {
    let (mut moments, mut heights) = (DMat2::ZERO, DVec2::ZERO);
    for tip in tips {
        let offset = *tip - center;
        let across = DVec2::new(offset.x, offset.z);
        moments += DMat2::from_cols(across * across.x, across * across.y);
        heights += across * offset.y;
    }
    // The smaller eigenvalue is the squared spread across the line of the fingertips.
    let (half_trace, determinant) = (
        (moments.x_axis.x + moments.y_axis.y) / 2.0,
        moments.determinant(),
    );
    let smaller = half_trace - (half_trace * half_trace - determinant).max(0.0).sqrt();
    if smaller >= MIN_SPREAD * MIN_SPREAD {
        Ok(moments.inverse() * heights)
    } else {
        Err(PositionError::OnALine)
    }
}

/// Returns the pose in the world of a board on a table under a hand: its origin between the four fingertips, its rows across the
/// hand. `None` if the readings do not show the hand.
pub fn board_on_table(table: &TablePlane, readings: &[JointPositions]) -> Option<BoardPose> {
    let median = |joint| median_position(readings, joint);
    let fingers = [Finger::Index, Finger::Middle, Finger::Ring, Finger::Little];
    let tips = fingers.map(|finger| median(Joint::tip(finger)));
    let tips = tips.into_iter().collect::<Option<Vec<DVec3>>>()?;
    let middle = tips.iter().sum::<DVec3>() / tips.len() as f64;
    let on_table = |point: DVec3| point - table.normal * (point - table.point).dot(table.normal);
    let wrist = median(Joint::Wrist)?;
    let away =
        (on_table(median(Joint::MiddlePhalanxProximal)?) - on_table(wrist)).try_normalize()?;
    let right = away.cross(table.normal);
    let vector = |vector: DVec3| vector.as_vec3();
    let axes = glam::Mat3::from_cols(vector(right), vector(away), vector(table.normal));
    let origin: Vec3 = vector(on_table(middle));
    let world_from_board = Pose::from_parts(origin, Quat::from_mat3(&axes));
    Some(BoardPose::from_pose(&world_from_board))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hand whose fingertips touch a table that rises away from the wearer by `slope`, with 2 mm of noise.
    fn touching(slope: f64, change: impl Fn(Joint, DVec3) -> DVec3) -> Vec<JointPositions> {
        let at = |right: f64, away: f64, above: f64| {
            let surface = DVec3::new(right, -0.3 + away * slope.tan(), -away);
            surface + DVec3::new(0.0, slope.cos(), slope.sin()) * above
        };
        let hand = [
            (Joint::Wrist, at(0.05, 0.15, 0.06)),
            (Joint::MiddlePhalanxProximal, at(0.05, 0.24, 0.05)),
            (Joint::ThumbTip, at(0.0, 0.22, 0.005)),
            (Joint::IndexTip, at(0.03, 0.29, 0.005)),
            (Joint::MiddleTip, at(0.05, 0.30, 0.005)),
            (Joint::RingTip, at(0.07, 0.295, 0.005)),
            (Joint::LittleTip, at(0.09, 0.27, 0.005)),
        ];
        let mut random = fastrand::Rng::with_seed(3);
        let mut noise = move || 0.002 * (random.f64() - 0.5) * 3.4;
        (0..60)
            .map(|_| {
                let mut positions = JointPositions::default();
                for (joint, position) in hand {
                    let noise = DVec3::new(noise(), noise(), noise());
                    positions.set(joint, change(joint, position) + noise);
                }
                positions
            })
            .collect()
    }

    #[test]
    fn a_sloping_table_is_found_and_carries_the_board() {
        let slope = 6_f64.to_radians();
        let readings = touching(slope, |_, position| position);
        let table = TablePlane::fit(&readings, 0.005).unwrap();
        let expected = DVec3::new(0.0, slope.cos(), slope.sin());
        assert!(table.normal.angle_between(expected).to_degrees() < 1.0);
        let below = -0.3 - table.point.z * slope.tan();
        assert!((table.point.y - below).abs() < 0.002, "{table:?}");
        let board = board_on_table(&table, &readings).unwrap();
        assert!((board.tilt.to_degrees() - 6.0).abs() < 1.0, "{board:?}");
        assert!(board.bearing.to_degrees().abs() < 2.0, "{board:?}");
        assert!((board.right - 0.06).abs() < 0.002 && (board.forward - 0.289).abs() < 0.003);
        assert!((board.height - (-0.3 + 0.289 * slope.tan() as f32)).abs() < 0.003);
    }

    #[test]
    fn fingertips_that_show_no_table_are_refused_with_the_reason() {
        let fit = |change: fn(Joint, DVec3) -> DVec3| {
            TablePlane::fit(&touching(0.0, change), 0.005).unwrap_err()
        };
        let lifted = fit(|joint, position| match joint {
            Joint::ThumbTip => position + DVec3::Y * 0.0,
            Joint::MiddleTip => position + DVec3::Y * 0.05,
            _ => position,
        });
        assert!(
            matches!(
                lifted,
                PositionError::NotPlane {
                    finger: Finger::Middle,
                    ..
                }
            ),
            "{lifted}"
        );
        let line = fit(|_, position| DVec3::new(position.x, -0.3, -0.25));
        assert_eq!(line, PositionError::OnALine);
        let steep = fit(|_, position| DVec3::new(position.x, -position.z * 2.0, position.z));
        assert!(matches!(steep, PositionError::TooSteep { .. }), "{steep}");
        let few = TablePlane::fit(&touching(0.0, |_, position| position)[..5], 0.005);
        assert!(
            matches!(few, Err(PositionError::NotSeen { readings: 5, .. })),
            "{few:?}"
        );
    }
}
