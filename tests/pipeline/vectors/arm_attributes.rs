use ademan::estimate::arm_attributes::{
    ArmAttributes, FullRotation, HALF_POSE_ROWS, HalfPose, ImageSize, Trunk,
};
use ademan::hand::Side;
use glam::DVec3;
use serde_json::Value;

use super::check::{assert_close, list, number, numbers, text, tolerance_of};

/// Checks the attributes of each pose, the pose of these attributes, and the pose of given attributes.
pub fn attributes(file: &Value) -> usize {
    let cases = list(&file["cases"]);
    for case in cases {
        match text(&case["kind"]) {
            "pose_to_attributes" => pose_to_attributes(case, file),
            "attributes_to_pose" => attributes_to_pose(case, file),
            other => panic!("unknown kind {other}"),
        }
    }
    cases.len()
}

/// Checks the greatest rotation of a shoulder.
pub fn full_rotation(file: &Value) -> usize {
    let cases = list(&file["cases"]);
    for case in cases {
        let side: Side = text(&case["side"]).parse().expect("a side");
        let what = format!("{side} {}", case["direction"]);
        let full = FullRotation::new(side, vector(&case["direction"])).expect("a direction");
        let psi_tolerance = tolerance_of(case, file, "psi");
        assert_close(full.psi, number(&case["psi"]), psi_tolerance, &what);
        let tolerance = tolerance_of(case, file, "vector");
        assert_vector(full.forearm, vector(&case["forearm"]), tolerance, &what);
        assert_vector(full.normal, vector(&case["normal"]), tolerance, &what);
    }
    cases.len()
}

fn pose_to_attributes(case: &Value, file: &Value) {
    let name = text(&case["name"]);
    let image = image(case);
    let pose = half_pose(&case["half_pose"], image);
    let computed = Side::ALL
        .iter()
        .map(|&side| ArmAttributes::from_landmarks(&pose, side))
        .collect::<Result<Vec<_>, _>>();
    if let Some(error) = case["error"].as_str() {
        // An error of one arm names its side first.
        let side = Side::ALL.iter().find(|side| error.starts_with(side.name()));
        let refused = match side {
            Some(&side) => ArmAttributes::from_landmarks(&pose, side).is_err(),
            None => computed.is_err(),
        };
        assert!(refused, "{name}: {error}");
        return;
    }
    let attributes = computed.unwrap_or_else(|error| panic!("{name}: {error}"));
    let tolerance = |quantity: &str| tolerance_of(case, file, quantity);
    for (&side, ours) in Side::ALL.iter().zip(&attributes) {
        let theirs = attributes_of(&case["attributes"], side);
        let what = format!("{name} {side}");
        assert_attributes(ours, &theirs, tolerance, &what);
    }
    if case["round_trip"] == true {
        let again = HalfPose::from_attributes(&pose.trunk(), &[attributes[0], attributes[1]]);
        let again = again.expect("a pose with these attributes");
        let round_trip = number(&case["round_trip_tolerance_px"]);
        for (ours, theirs) in again.rows().into_iter().zip(pose.rows()) {
            assert_vector(ours, theirs, round_trip, name);
        }
    }
}

fn attributes_to_pose(case: &Value, file: &Value) {
    let image = image(case);
    let rows = list(&case["trunk"]);
    let trunk_row = |row: usize| image.to_pixels(vector(&rows[row]));
    let trunk = Trunk {
        shoulders: [trunk_row(0), trunk_row(1)],
        hips: [trunk_row(2), trunk_row(3)],
    };
    let attributes = [Side::Left, Side::Right].map(|side| attributes_of(&case["attributes"], side));
    let pose = HalfPose::from_attributes(&trunk, &attributes).expect("a pose");
    let expected = list(&case["half_pose"]).iter().map(vector);
    for (ours, theirs) in pose.rows().into_iter().zip(expected) {
        let tolerance = tolerance_of(case, file, "pose_normalised");
        let normalised = ours / DVec3::new(image.width, image.height, image.width);
        assert_vector(normalised, theirs, tolerance, text(&case["name"]));
    }
}

fn assert_attributes(
    ours: &ArmAttributes,
    theirs: &ArmAttributes,
    tolerance: impl Fn(&str) -> f64,
    what: &str,
) {
    let (direction, expected) = (ours.shoulder_direction, theirs.shoulder_direction);
    assert_vector(direction, expected, tolerance("direction"), what);
    let relative = tolerance("length_relative");
    for (our_length, their_length, length) in [
        (ours.upper_arm_length, theirs.upper_arm_length, "upper arm"),
        (ours.forearm_length, theirs.forearm_length, "forearm"),
    ] {
        assert_close(
            our_length,
            their_length,
            relative * their_length,
            &format!("{what} {length}"),
        );
    }
    for (our_angle, their_angle, angle) in [
        (
            ours.shoulder_rotation,
            theirs.shoulder_rotation,
            "shoulder rotation",
        ),
        (ours.elbow_angle, theirs.elbow_angle, "elbow angle"),
        (ours.elbow_rotation, theirs.elbow_rotation, "elbow rotation"),
        (ours.wrist_rotation, theirs.wrist_rotation, "wrist rotation"),
        (
            ours.wrist_inclination,
            theirs.wrist_inclination,
            "wrist inclination",
        ),
    ] {
        assert_close(
            our_angle,
            their_angle,
            tolerance("angle"),
            &format!("{what} {angle}"),
        );
    }
    for (our_vector, their_vector) in [
        (ours.little_vector, theirs.little_vector),
        (ours.index_vector, theirs.index_vector),
        (ours.thumb_vector, theirs.thumb_vector),
    ] {
        assert_vector(
            our_vector,
            their_vector,
            tolerance("finger_vector_px"),
            what,
        );
    }
}

fn image(case: &Value) -> ImageSize {
    ImageSize {
        width: number(&case["width"]),
        height: number(&case["height"]),
    }
}

fn half_pose(rows: &Value, image: ImageSize) -> HalfPose {
    let rows: Vec<DVec3> = list(rows).iter().map(vector).collect();
    let rows: [DVec3; HALF_POSE_ROWS] = rows.try_into().expect("14 rows");
    HalfPose::from_rows(&rows.map(|row| image.to_pixels(row)))
}

/// Reads the attributes of one side.
fn attributes_of(values: &Value, side: Side) -> ArmAttributes {
    let value = |name: &str| &values[format!("{side}_{name}")];
    ArmAttributes {
        shoulder_direction: vector(value("shoulder_direction")),
        upper_arm_length: number(value("upperarm_length")),
        shoulder_rotation: number(value("shoulder_rotation")),
        elbow_angle: number(value("elbow_angle")),
        forearm_length: number(value("forearm_length")),
        elbow_rotation: number(value("elbow_rotation")),
        wrist_rotation: number(value("wrist_rotation")),
        wrist_inclination: number(value("wrist_inclination")),
        little_vector: vector(value("pinky_vector")),
        index_vector: vector(value("index_vector")),
        thumb_vector: vector(value("thumb_vector")),
    }
}

/// Reads the first three numbers of a list; a fourth one is a visibility.
fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value)[..3])
}

fn assert_vector(ours: DVec3, theirs: DVec3, tolerance: f64, what: &str) {
    for (one, other) in ours.to_array().into_iter().zip(theirs.to_array()) {
        assert_close(one, other, tolerance, what);
    }
}
