//! Mirror symmetry, round trips and refusals.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::*;
use crate::hand::Side;

/// A standing person who faces the camera, in pixels.
fn trunk() -> Trunk {
    Trunk {
        shoulders: [
            DVec3::new(400.0, 200.0, 5.0),
            DVec3::new(240.0, 205.0, -8.0),
        ],
        hips: [DVec3::new(370.0, 450.0, 0.0), DVec3::new(265.0, 452.0, 2.0)],
    }
}

fn random_attributes(random: &mut fastrand::Rng) -> ArmAttributes {
    let mut between = |low: f64, high: f64| low + random.f64() * (high - low);
    let spread = between(8.0, 20.0);
    let direction = DVec3::new(between(-0.2, 1.0), between(-1.0, 1.0), between(-1.0, 1.0));
    ArmAttributes {
        shoulder_direction: direction.normalize(),
        upper_arm_length: between(60.0, 200.0),
        shoulder_rotation: between(0.05, PI - 0.05),
        elbow_angle: between(0.1, PI - 0.1),
        forearm_length: between(60.0, 200.0),
        elbow_rotation: between(-FRAC_PI_2, FRAC_PI_2),
        wrist_rotation: between(-PI, PI),
        wrist_inclination: between(0.01, 1.2),
        little_vector: DVec3::new(0.0, spread, 50.0),
        index_vector: DVec3::new(0.0, -spread, 55.0),
        thumb_vector: DVec3::new(between(-5.0, 15.0), -25.0, 30.0),
    }
}

/// Returns the attributes of the mirror image on the other side.
fn mirrored(attributes: &ArmAttributes) -> ArmAttributes {
    let flip = |vector: DVec3| vector.with_y(-vector.y);
    let direction = attributes.shoulder_direction;
    ArmAttributes {
        shoulder_direction: direction.with_z(-direction.z),
        wrist_rotation: -attributes.wrist_rotation,
        little_vector: flip(attributes.little_vector),
        index_vector: flip(attributes.index_vector),
        thumb_vector: flip(attributes.thumb_vector),
        ..*attributes
    }
}

/// Returns the largest difference between two sets of attributes.
fn difference(first: &ArmAttributes, second: &ArmAttributes) -> f64 {
    let scalars = |it: &ArmAttributes| {
        [
            it.upper_arm_length,
            it.shoulder_rotation,
            it.elbow_angle,
            it.forearm_length,
            it.elbow_rotation,
            it.wrist_rotation,
            it.wrist_inclination,
        ]
    };
    let vectors = |it: &ArmAttributes| {
        [
            it.shoulder_direction,
            it.little_vector,
            it.index_vector,
            it.thumb_vector,
        ]
    };
    let scalars = scalars(first).into_iter().zip(scalars(second));
    let vectors = vectors(first).into_iter().zip(vectors(second));
    let differences = scalars.map(|(one, other)| (one - other).abs());
    differences
        .chain(vectors.map(|(one, other)| one.distance(other)))
        .fold(0.0, f64::max)
}

#[test]
fn attributes_come_back_from_the_landmarks_that_they_give() {
    let mut random = fastrand::Rng::with_seed(23);
    for round in 0..2_000 {
        let left = random_attributes(&mut random);
        let right = mirrored(&random_attributes(&mut random));
        let pose = HalfPose::from_attributes(&trunk(), &[left, right]).expect("a pose");
        for (side, sent) in [(Side::Left, left), (Side::Right, right)] {
            let received = ArmAttributes::from_landmarks(&pose, side).expect("attributes");
            let difference = difference(&sent, &received);
            assert!(
                difference < 1e-7,
                "{round} {side}: {difference:e}\n{sent:?}\n{received:?}"
            );
        }
        assert_eq!(HalfPose::from_rows(&pose.rows()), pose);
    }
}

#[test]
fn a_straight_elbow_shares_its_turn_equally() {
    let mut random = fastrand::Rng::with_seed(29);
    for _ in 0..500 {
        let mut attributes = random_attributes(&mut random);
        attributes.elbow_angle = PI;
        for &side in Side::ALL {
            let sent = match side {
                Side::Left => attributes,
                Side::Right => mirrored(&attributes),
            };
            let arm = sent.landmarks(&trunk(), side).expect("an arm");
            let mut pose =
                HalfPose::from_attributes(&trunk(), &[attributes, mirrored(&attributes)])
                    .expect("a pose");
            pose.arms[side.index()] = arm;
            let received = ArmAttributes::from_landmarks(&pose, side).expect("attributes");
            let total = (received.shoulder_rotation + received.elbow_rotation)
                - (sent.shoulder_rotation + sent.elbow_rotation);
            let turns = total / (2.0 * PI);
            assert!((turns - turns.round()).abs() < 1e-8, "{side}: {total}");
            let share = received.shoulder_rotation - received.elbow_rotation;
            assert!((share - FRAC_PI_2).abs() < 1e-12);
            assert_eq!(received.elbow_angle, PI);
        }
    }
}

#[test]
fn a_nearly_straight_elbow_has_the_turn_of_the_formula() {
    let Trunk { shoulders, hips } = trunk();
    let elsewhere = ArmLandmarks {
        shoulder: shoulders[1],
        elbow: shoulders[1],
        wrist: shoulders[1],
        little: shoulders[1],
        index: shoulders[1],
        thumb: shoulders[1],
    };
    // The upper arm and the forearm are 9e-4 rad apart.
    let left = ArmLandmarks {
        shoulder: shoulders[0],
        elbow: DVec3::new(478.2421, 276.3923, -44.4204),
        wrist: DVec3::new(550.0368, 346.3529, -89.7087),
        little: DVec3::new(569.1, 372.7, -115.9),
        index: DVec3::new(583.9, 372.2, -98.1),
        thumb: DVec3::new(581.0, 360.3, -79.8),
    };
    let pose = HalfPose {
        arms: [left, elsewhere],
        hips,
    };
    let found = ArmAttributes::from_landmarks(&pose, Side::Left).expect("attributes");
    assert_eq!(found.elbow_angle, PI);
    // From an independent program: acos(m · r) / 2, and π/2 less.
    assert!((found.shoulder_rotation - 0.012_590_580_695_6).abs() < 1e-9);
    assert!((found.elbow_rotation + 1.558_205_746_099_2).abs() < 1e-9);
}

#[test]
fn a_mirrored_pose_has_mirrored_attributes() {
    let mut random = fastrand::Rng::with_seed(31);
    for _ in 0..500 {
        let attributes = [(); 2].map(|()| random_attributes(&mut random));
        let [left, right] = [attributes[0], mirrored(&attributes[1])];
        let pose = HalfPose::from_attributes(&trunk(), &[left, right]).expect("a pose");
        let mut rows = pose.rows().map(|row| row.with_x(640.0 - row.x));
        rows.as_chunks_mut::<2>()
            .0
            .iter_mut()
            .for_each(|pair| pair.swap(0, 1));
        let mirror = HalfPose::from_rows(&rows);
        for (side, original) in [(Side::Right, left), (Side::Left, right)] {
            let seen = ArmAttributes::from_landmarks(&mirror, side).expect("attributes");
            assert!(difference(&mirrored(&original), &seen) < 1e-7, "{side}");
        }
    }
}

#[test]
fn a_pose_without_a_plane_or_a_length_is_refused() {
    use ArmAttributesError::*;
    let attributes = random_attributes(&mut fastrand::Rng::with_seed(1));
    let pose =
        HalfPose::from_attributes(&trunk(), &[attributes, mirrored(&attributes)]).expect("a pose");
    let refused = |change: &dyn Fn(&mut HalfPose)| {
        let mut pose = pose;
        change(&mut pose);
        ArmAttributes::from_landmarks(&pose, Side::Left).unwrap_err()
    };
    assert_eq!(
        refused(&|it| it.arms[0].shoulder = it.arms[1].shoulder),
        NoTrunk
    );
    assert_eq!(
        refused(&|it| it.hips[0] = it.arms[0].shoulder.lerp(it.arms[1].shoulder, -0.7)),
        NoTrunk
    );
    assert_eq!(
        refused(&|it| it.arms[0].elbow = it.arms[0].shoulder),
        NoUpperArm
    );
    assert_eq!(
        refused(&|it| it.arms[0].wrist = it.arms[0].elbow),
        NoForearm
    );
    assert_eq!(
        refused(&|it| it.arms[0].wrist = it.arms[0].elbow.lerp(it.arms[0].shoulder, 0.8)),
        FoldedElbow
    );
    assert_eq!(
        refused(&|it| it.arms[0].little = it.arms[0].wrist.lerp(it.arms[0].index, 2.0)),
        NoHand
    );
    assert_eq!(refused(&|it| it.arms[0].thumb.z = f64::NAN), NotFinite);
    assert_eq!(refused(&|it| it.hips[1].x = f64::INFINITY), NotFinite);
    assert_eq!(
        refused(&|it| *it = HalfPose::from_rows(&[DVec3::ONE; 14])),
        NoTrunk
    );
}

#[test]
fn attributes_without_a_direction_or_a_length_are_refused() {
    use ArmAttributesError::*;
    let attributes = random_attributes(&mut fastrand::Rng::with_seed(1));
    let refused = |change: &dyn Fn(&mut ArmAttributes)| {
        let mut attributes = attributes;
        change(&mut attributes);
        attributes.landmarks(&trunk(), Side::Left).unwrap_err()
    };
    assert_eq!(
        refused(&|it| it.shoulder_direction = DVec3::ZERO),
        NoUpperArm
    );
    assert_eq!(refused(&|it| it.upper_arm_length = 0.0), NoUpperArm);
    assert_eq!(refused(&|it| it.forearm_length = -1.0), NoForearm);
    assert_eq!(refused(&|it| it.elbow_angle = 0.0), FoldedElbow);
    assert_eq!(refused(&|it| it.wrist_rotation = f64::NAN), NotFinite);
    assert_eq!(refused(&|it| it.thumb_vector = DVec3::INFINITY), NotFinite);
}
