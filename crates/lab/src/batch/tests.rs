//! Comparison with one hand at a time.

use parry3d::math::{Pose, Rotation, Vec2, Vec3};

use super::*;
use crate::contact::surface::{Anchor, Shape, Share, TREMOR_MARGIN, Target};
use crate::contact::{ContactTracker, Phase, Touches};
use crate::estimate::Estimate;
use crate::hand::{Joint, Side};
use crate::kinematics::{BoneLengths, typing_angle};

const HANDS: usize = 19;
const FRAMES: usize = 400;

fn arms() -> Vec<ArmModel> {
    let bones = BoneLengths::from_hand_and_forearm(0.19, 0.255).unwrap();
    let arm = |side: &Side| ArmModel::anthropometric(*side, &bones).unwrap();
    Side::ALL.iter().map(arm).collect()
}

/// Returns an arm of which a finger turns about an axis between the axes of its frame.
fn oblique_arm() -> ArmModel {
    let arm = &arms()[0];
    let mut links = arm.links().to_vec();
    let turned = links.iter_mut().rfind(|link| link.dof.is_some()).unwrap();
    turned.axis = Vec3::new(0.6, 0.8, 0.0);
    ArmModel::new(arm.side(), links, arm.world_from_root(), 0.005).unwrap()
}

/// Returns the angles of a hand that taps, moves about and twists.
fn angles(hand: usize, frame: usize) -> JointAngles {
    let mut angles = JointAngles::default();
    let phase = |dof: Dof| (frame * (5 + dof.index() % 7) + 37 * hand) as f64 * 0.02;
    for &dof in Dof::ALL {
        let swing = if dof.finger().is_some() { 0.5 } else { 0.05 };
        // As the batch has them: in single precision.
        let radians = (typing_angle(dof) + swing * phase(dof).sin()) as f32;
        angles.set(dof, radians.into());
    }
    angles
}

fn keys(count: usize, rotation: Rotation) -> Vec<Target> {
    let key = |index: usize| Target {
        shape: match index % 5 {
            0 => Shape::Disc(0.008),
            _ => Shape::Box(Vec2::new(0.008, 0.008)),
        },
        share: Share::NONE,
        surface_from_target: Pose::from_parts(
            Vec3::new(
                (index % 12) as f32 * 0.019,
                (index / 12) as f32 * 0.019,
                0.0,
            ),
            rotation,
        ),
        travel: 0.004,
        press_at: 0.5,
        release_at: 0.25,
        margin: TREMOR_MARGIN,
    };
    (0..count).map(key).collect()
}

/// Creates a flat board that follows the elbow, one of tilted keys in space, and one of the other hand, all where the hand
/// taps.
fn scene(arm: &ArmModel) -> Scene {
    let rest = arm.forward(&Estimate::new(Timestamp(0), angles(0, 0)));
    let tip = rest.fingertip(Finger::Middle).unwrap();
    let elbow = rest.position(Joint::Elbow).unwrap();
    let flat = Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let corner = tip + Vec3::new(-0.11, -0.012, 0.05);
    let mut scene = Scene::new();
    let from_elbow = Pose::from_parts(corner - elbow, flat);
    scene.add_surface(
        Anchor::Joint(Joint::Elbow),
        from_elbow,
        keys(72, Rotation::IDENTITY),
    );
    let tilted = Rotation::from_rotation_y(0.3);
    let in_space = Pose::from_parts(corner - Vec3::Y * 0.02, flat);
    scene.add_surface(Anchor::World, in_space, keys(48, tilted));
    let other = match arm.side() {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
    };
    let of_other = keys(12, Rotation::IDENTITY);
    scene.add_surface_for(Some(other), Anchor::World, in_space, of_other);
    scene.add_surface(Anchor::World, in_space, Vec::new());
    scene
}

fn times() -> Vec<Timestamp> {
    (1..=FRAMES as u64)
        .map(|frame| Timestamp(frame * 5_714))
        .collect()
}

fn lane_angles() -> Vec<LaneAngles> {
    let blocks = HANDS.div_ceil(LANES);
    let mut all = vec![LaneAngles::default(); blocks * FRAMES];
    for (index, block) in all.iter_mut().enumerate() {
        for lane in 0..LANES {
            let hand = index / FRAMES * LANES + lane;
            block.set(lane, &angles(hand, index % FRAMES));
        }
    }
    all
}

#[test]
fn fingertips_have_the_bits_of_those_of_one_hand_at_a_time() {
    for arm in arms().into_iter().chain([oblique_arm()]) {
        let batch = HandBatch::new(&arm, &Scene::new(), HANDS);
        let all = lane_angles();
        let mut tips = vec![LaneTips::default(); all.len()];
        batch.forward(&all, &mut tips);
        for (index, lane_tips) in tips.iter().enumerate() {
            for lane in 0..LANES {
                let hand = index / FRAMES * LANES + lane;
                let angles = angles(hand, index % FRAMES);
                let pose = arm.forward(&Estimate::new(Timestamp(0), angles));
                for &finger in Finger::ALL {
                    let expected = pose.fingertip(finger);
                    assert_eq!(
                        lane_tips.get(lane, finger),
                        expected,
                        "{index} {lane} {finger}"
                    );
                }
            }
        }
    }
}

/// Returns the touches of one hand, from the tracker alone.
fn touches_of(arm: &ArmModel, scene: &Scene, hand: usize) -> Vec<HandTouch> {
    let mut tracker = ContactTracker::new(scene);
    let mut all = Vec::new();
    for (frame, time) in times().into_iter().enumerate() {
        let mut touches = Touches::new();
        let pose = arm.forward(&Estimate::new(time, angles(hand, frame)));
        tracker.update(scene, &pose, &mut touches);
        all.extend(touches.into_iter().map(|touch| HandTouch { hand, touch }));
    }
    all
}

#[test]
fn touches_are_equal_to_those_of_one_hand_at_a_time_on_any_number_of_threads() {
    for arm in arms() {
        let scene = scene(&arm);
        let hands = HANDS.next_multiple_of(LANES);
        let expected: Vec<HandTouch> = (0..hands)
            .flat_map(|hand| touches_of(&arm, &scene, hand))
            .collect();
        assert!(expected.len() > 1_000, "only {} touches", expected.len());
        let all = lane_angles();
        for threads in [0, 1, 2, 7] {
            let mut batch = HandBatch::new(&arm, &scene, HANDS);
            assert_eq!(
                batch.run(&times(), &all, threads),
                expected,
                "{threads} threads"
            );
        }
    }
}

#[test]
fn hands_go_on_from_an_earlier_call() {
    let arm = &arms()[0];
    let scene = scene(arm);
    let (times, all) = (times(), lane_angles());
    let first_block = &all[..FRAMES];
    let mut whole = HandBatch::new(arm, &scene, LANES);
    let expected = whole.run(&times, first_block, 1);
    let mut parts = HandBatch::new(arm, &scene, LANES);
    let mut found = Vec::new();
    for part in 0..4 {
        let frames = part * FRAMES / 4..(part + 1) * FRAMES / 4;
        found.extend(parts.run(&times[frames.clone()], &first_block[frames], 1));
    }
    found.sort_by_key(|touch| touch.hand);
    assert_eq!(found, expected);
}

#[test]
fn an_angle_that_is_no_number_cancels_the_touches_of_its_hand_only() {
    const HAND: usize = 3;
    let arm = &arms()[0];
    let scene = scene(arm);
    let (times, mut all) = (times(), lane_angles());
    let run = |given: &[LaneAngles]| {
        let mut batch = HandBatch::new(arm, &scene, LANES);
        let touches = batch.run(&times, &given[..FRAMES], 1);
        let (own, others): (Vec<HandTouch>, Vec<HandTouch>) =
            touches.into_iter().partition(|touch| touch.hand == HAND);
        let own: Vec<Touch> = own.into_iter().map(|touch| touch.touch).collect();
        (own, others)
    };
    let (expected, others) = run(&all);
    // A fingertip that moves on a key is still there at the end of the step.
    let held = |touch: &&Touch| touch.phase == Phase::Moved && touch.time >= times[FRAMES / 2];
    let held = expected.iter().find(held).unwrap();
    let lost = times.iter().position(|time| *time > held.time).unwrap();
    for angles in &mut all[lost..FRAMES] {
        angles.dof_mut(Dof::ElbowFlexion)[HAND] = f32::NAN;
    }
    let (found, others_found) = run(&all);
    assert_eq!(others_found, others);
    let until_lost = |touches: &[Touch]| -> (Vec<Touch>, Vec<Touch>) {
        let touches = touches.iter().copied();
        touches.partition(|touch| touch.time <= held.time)
    };
    let (expected, later) = until_lost(&expected);
    assert!(later.iter().any(|touch| touch.phase == Phase::Touched));
    let (found, last) = until_lost(&found);
    assert_eq!(found, expected);
    let cancelled = |touch: &Touch| (touch.time, touch.phase) == (times[lost], Phase::Cancelled);
    assert!(last.iter().all(cancelled), "{last:?}");
    let of_held = |touch: &Touch| (touch.finger, touch.target) == (held.finger, held.target);
    assert!(last.iter().any(of_held), "{last:?}");
}
