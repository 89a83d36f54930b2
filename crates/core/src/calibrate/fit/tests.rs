//! Tests of the fit with hands whose joints have exactly the expected angles.

use super::*;
use crate::calibrate::observation::{ChannelObservation, PoseObservation};
use crate::document::Document;
use crate::hand::Dof;
use crate::layout::Glove;

/// Observations of channels with these counts, by pose and index of the channel.
fn observe(
    poses: &[CalibrationPose],
    counts: impl Fn(CalibrationPose, usize) -> f64,
) -> Observations {
    let mut observations = Observations::default();
    for &pose in poses {
        let channels = shipped().angle_channels().into_iter().map(|channel| {
            let median = counts(pose, channel);
            ChannelObservation {
                channel,
                median,
                low: median - 1.0,
                high: median + 1.0,
                is_still: true,
                is_sent: true,
            }
        });
        observations.insert(PoseObservation {
            pose,
            channels: channels.collect(),
        });
    }
    observations
}

fn shipped() -> ChannelMap {
    Glove::parse(&Document::shipped("unam-hc11").unwrap())
        .unwrap()
        .map
}

/// The counts of a glove that needs no calibration.
fn exact(pose: CalibrationPose, channel: usize) -> f64 {
    let map = shipped();
    let row = map
        .rows()
        .iter()
        .find(|row| row.channel == channel)
        .unwrap();
    row.calibration
        .apply_inverse(pose.expected(row.dof).radians)
}

fn row(map: &ChannelMap, dof: Dof) -> &ChannelRow {
    map.rows().iter().find(|row| row.dof == dof).unwrap()
}

fn problems(error: CalibrationError) -> Vec<Problem> {
    match error {
        CalibrationError::Unusable { problems } => problems,
        other => panic!("{other}"),
    }
}

#[test]
fn the_poses_have_their_angles_after_the_fit() {
    let observations = observe(CalibrationPose::GUIDED, |pose, channel| {
        40.0 + 0.7 * exact(pose, channel)
    });
    let result = fit(&observations, &shipped()).unwrap();
    assert_eq!(result.problems, []);
    assert!(result.score > 80, "{}", result.score);
    for (dof, pose) in [
        (Dof::IndexMcpFlexion, CalibrationPose::Flat),
        (Dof::IndexMcpFlexion, CalibrationPose::Fist),
        (Dof::WristDeviation, CalibrationPose::WristIn),
        (Dof::ElbowFlexion, CalibrationPose::ElbowBent),
        (Dof::ForearmSupination, CalibrationPose::PalmUp),
    ] {
        let row = row(&result.map, dof);
        let count = observations.get(pose).unwrap().median(row.channel).unwrap();
        let error = result.map.radians(row, count) - pose.expected(dof).radians;
        assert!(
            error.to_degrees().abs() < 4.0,
            "{dof} {pose}: {}",
            error.to_degrees()
        );
    }
}

#[test]
fn the_second_bone_turns_in_proportion_to_the_first() {
    let result = fit(&observe(CalibrationPose::GUIDED, exact), &shipped()).unwrap();
    let ratio = |map: &ChannelMap| {
        row(map, Dof::ForearmSecondBone).calibration.gain
            / row(map, Dof::ForearmSupination).calibration.gain
    };
    assert!((ratio(&result.map) - ratio(&shipped())).abs() < 1e-9);
}

#[test]
fn a_joint_whose_poses_are_skipped_keeps_its_values_and_costs_points() {
    use CalibrationPose::{Fist, Flat, Rest, Spread};
    let poses = [Rest, Flat, Spread, Fist];
    let result = fit(&observe(&poses, exact), &shipped()).unwrap();
    let elbow = Dof::ElbowFlexion;
    assert_eq!(
        row(&result.map, elbow).calibration,
        row(&shipped(), elbow).calibration
    );
    assert!(
        result
            .problems
            .contains(&Problem::NotObserved { dof: elbow })
    );
    let all = fit(&observe(CalibrationPose::GUIDED, exact), &shipped()).unwrap();
    assert!(result.score < all.score);
}

#[test]
fn a_sensor_whose_poses_are_skipped_keeps_its_curvature() {
    use CalibrationPose::{ElbowStraight, Fist, Flat, Rest, Spread};
    let elbow = Dof::ElbowFlexion;
    let channel = row(&shipped(), elbow).channel;
    let start = shipped().with_curvatures(vec![(channel, 10.0)]);
    let skipped = fit(&observe(&[Rest, Flat, Spread, Fist], exact), &start).unwrap();
    assert_eq!(skipped.map.linearity(channel), start.linearity(channel));
    let angle = |map: &ChannelMap, count| map.radians(row(map, elbow), count);
    assert_eq!(angle(&skipped.map, 128.0), angle(&start, 128.0));
    // One angle changes the offset only.
    let observations = observe(&[Rest, Flat, ElbowStraight, Fist], exact);
    let shifted = fit(&observations, &start).unwrap();
    let turn = |map: &ChannelMap| angle(map, 128.0) - angle(map, 64.0);
    assert!((turn(&shifted.map) - turn(&start)).abs() < 1e-9);
    let straight = angle(&shifted.map, exact(ElbowStraight, channel));
    assert!(straight.abs() < 1e-9, "{straight}");
}

#[test]
fn a_small_range_near_an_end_is_bent_to_the_side_of_its_curvature() {
    let wide = curvature::over_full_scale(0.055, (60.0, 200.0), 255.0);
    assert!((0.1..51.0).contains(&wide), "{wide}");
    for (range, fraction) in [((200.0, 230.0), 0.055), ((25.0, 55.0), -0.055)] {
        let counts = curvature::over_full_scale(fraction, range, 255.0);
        assert_eq!(counts, 51_f64.copysign(fraction), "{range:?}");
    }
}

#[test]
fn without_the_flat_hand_there_is_no_calibration() {
    let observations = observe(&[CalibrationPose::Rest, CalibrationPose::Fist], exact);
    let error = fit(&observations, &shipped()).unwrap_err();
    assert_eq!(error, CalibrationError::TooFewPoses { observed: 2 });
    let empty = ChannelMap::new(Vec::new(), 255);
    assert_eq!(
        fit(&observations, &empty),
        Err(CalibrationError::EmptyGlove)
    );
}

#[test]
fn a_dead_sensor_of_a_finger_is_named_and_one_of_the_elbow_refused() {
    let dead = |dead: usize| {
        observe(CalibrationPose::GUIDED, move |pose, channel| {
            if channel == dead {
                85.0
            } else {
                exact(pose, channel)
            }
        })
    };
    let result = fit(&dead(33), &shipped()).unwrap();
    let expected = Problem::DeadChannel {
        channel: 33,
        dof: Dof::RingMcpFlexion,
        count: 85.0,
    };
    assert_eq!(result.problems, [expected]);
    let ring = row(&result.map, Dof::RingMcpFlexion);
    let stuck = result.map.radians(ring, 85.0);
    assert!(stuck.abs() < 1e-9, "the finger is not bent: {stuck}");
    let error = fit(&dead(17), &shipped()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("channel 17 (elbow-flexion) stays at 85"),
        "{error}"
    );
}

#[test]
fn a_sensor_without_contact_is_named_and_not_said_to_follow_its_own_copies() {
    use CalibrationPose::{Fist, Flat, Rest, Spread};
    let floating = |pose, channel| match (channel, pose) {
        (33, Flat) => 100.0,
        (33, Spread) => 60.0,
        (33, Fist) => 90.0,
        (33, _) => 80.0,
        _ => exact(pose, channel),
    };
    let result = fit(&observe(&[Rest, Flat, Spread, Fist], floating), &shipped()).unwrap();
    let expected = Problem::Erratic {
        channel: 33,
        dof: Dof::RingMcpFlexion,
    };
    assert!(result.problems.contains(&expected), "{:?}", result.problems);
    // A finger with one sensor, whose count is in two channels.
    let copied = |pose: CalibrationPose, channel: usize| match channel {
        9 | 33 => 60.0 + (pose.index() * 37 % 50) as f64,
        _ => exact(pose, channel),
    };
    let problems = match fit(&observe(CalibrationPose::GUIDED, copied), &shipped()) {
        Ok(fitted) => fitted.problems,
        Err(error) => problems(error),
    };
    let follows_copy = problems.iter().any(|problem| {
        matches!(
            problem,
            Problem::CrossTalk {
                channel: 9 | 33,
                source: (9 | 33, _),
                ..
            }
        )
    });
    assert!(!follows_copy, "{problems:?}");
}

#[test]
fn fingers_without_a_count_are_not_judged_except_for_the_index_finger() {
    let without = |fingers: &[Finger]| {
        let map = shipped();
        let is_absent = |row: &&ChannelRow| {
            let finger = row.dof.finger();
            finger.is_some_and(|finger| fingers.contains(&finger))
        };
        let absent = map.rows().iter().filter(is_absent);
        let absent: Vec<usize> = absent.map(|row| row.channel).collect();
        let whole = observe(CalibrationPose::GUIDED, |pose, channel| {
            40.0 + 0.7 * exact(pose, channel)
        });
        let mut observations = Observations::default();
        for pose in whole.poses() {
            let mut seen = pose.clone();
            seen.channels.retain(|it| !absent.contains(&it.channel));
            observations.insert(seen);
        }
        fit(&observations, &map)
    };
    let three = without(&[Finger::Thumb, Finger::Ring, Finger::Little]).unwrap();
    assert_eq!(three.problems, []);
    assert!(three.score > 80, "{}", three.score);
    let ring = Dof::RingMcpFlexion;
    assert_eq!(
        row(&three.map, ring).calibration,
        row(&shipped(), ring).calibration
    );
    let refused = problems(without(&[Finger::Index]).unwrap_err());
    let is_missing = |problem: &Problem| matches!(problem, Problem::MissingChannel { .. });
    assert!(
        !refused.is_empty() && refused.iter().all(is_missing),
        "{refused:?}"
    );
}

#[test]
fn an_inverted_sensor_is_corrected_and_named() {
    let observations = observe(CalibrationPose::GUIDED, |pose, channel| match channel {
        12 => 255.0 - exact(pose, channel),
        _ => exact(pose, channel),
    });
    let result = fit(&observations, &shipped()).unwrap();
    assert!(row(&result.map, Dof::IndexMcpFlexion).calibration.gain < 0.0);
    let expected = Problem::InvertedChannel {
        channel: 12,
        dof: Dof::IndexMcpFlexion,
    };
    assert_eq!(result.problems, [expected]);
    // A calibration that starts from this one finds the same.
    let again = fit(&observations, &result.map).unwrap();
    assert_eq!(again.problems, []);
    assert_eq!(again.map.curvatures(), result.map.curvatures());
}

#[test]
fn swapped_sensors_are_refused_with_both_names() {
    let swapped = |pose, channel| match channel {
        17 => exact(pose, 4),
        4 => exact(pose, 17),
        _ => exact(pose, channel),
    };
    let observations = observe(CalibrationPose::GUIDED, swapped);
    let found = problems(fit(&observations, &shipped()).unwrap_err());
    let expected = Problem::SwappedChannels {
        first: (4, Dof::WristFlexion),
        second: (17, Dof::ElbowFlexion),
    };
    assert_eq!(found, [expected]);
}

#[test]
fn swapped_sensors_of_two_fingers_are_found_by_bending_single_fingers() {
    let swapped = |pose, channel| match channel {
        52 => exact(pose, 9),
        9 => exact(pose, 52),
        _ => exact(pose, channel),
    };
    let poses = [CalibrationPose::GUIDED, CalibrationPose::SINGLE_FINGERS].concat();
    let found = problems(fit(&observe(&poses, swapped), &shipped()).unwrap_err());
    let is_swap = |problem: &Problem| {
        matches!(
            problem,
            Problem::SwappedChannels {
                first: (9, _),
                second: (52, _)
            }
        )
    };
    assert!(found.len() == 1 && is_swap(&found[0]), "{found:?}");
    let sound = fit(&observe(&poses, exact), &shipped()).unwrap();
    assert_eq!(sound.problems, []);
}

#[test]
fn cross_talk_is_named_by_both_channels_and_refused_at_the_index_finger() {
    let from_wrist = |mixed: usize, part: f64| {
        observe(CalibrationPose::GUIDED, move |pose, channel| {
            let own = exact(pose, channel);
            let range =
                exact(CalibrationPose::Fist, channel) - exact(CalibrationPose::Flat, channel);
            if channel == mixed {
                own + part * range * (exact(pose, 4) - 90.0) / 195.0
            } else {
                own
            }
        })
    };
    let is_from_wrist = |problem: &Problem, mixed: usize| matches!(problem, Problem::CrossTalk { channel, source: (4, _), .. } if *channel == mixed);
    let result = fit(&from_wrist(33, 0.7), &shipped()).unwrap();
    let named = &result.problems;
    assert!(
        named.len() == 1 && is_from_wrist(&named[0], 33),
        "{named:?}"
    );
    let found = problems(fit(&from_wrist(12, 1.2), &shipped()).unwrap_err());
    assert!(
        found.len() == 1 && is_from_wrist(&found[0], 12),
        "{found:?}"
    );
}
