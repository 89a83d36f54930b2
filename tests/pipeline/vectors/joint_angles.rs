use std::f64::consts::{PI, TAU};

use ademan::estimate::t_pose::{BodyJoint, BodyPoint, BodyPoints};
use ademan::geometry::{EulerOrder, rotation_between};
use glam::{DMat3, DVec3};
use serde_json::Value;

use super::check::{assert_close, list, number, numbers, text, tolerance_of};

/// The cosine of the middle angle below which the last angle is 0.
const GIMBAL_COSINE: f64 = 1e-6;

/// Checks the rotations between directions and the angles of rotations.
pub fn rotations(file: &Value) -> usize {
    let (between, euler) = (list(&file["between"]), list(&file["euler"]));
    for case in between {
        check_between(case, file);
    }
    for case in euler {
        check_euler(case, file);
    }
    between.len() + euler.len()
}

fn check_between(case: &Value, file: &Value) {
    let name = text(&case["name"]);
    let (from, to) = (vector(&case["a"]), vector(&case["b"]));
    let rotation = rotation_between(from, to);
    let status = match &rotation {
        None => "degenerate",
        Some(matrix) if *matrix == DMat3::IDENTITY => "parallel",
        // Only half a turn is its own inverse.
        Some(matrix) if *matrix == matrix.transpose() => "antiparallel",
        Some(_) => "ok",
    };
    assert_eq!(status, text(&case["status"]), "{name}");
    let Some(rotation) = rotation else { return };
    let tolerance = tolerance_of(case, file, "rotation");
    assert_matrix(&rotation, &matrix(&case["rotation"]), tolerance, name);
}

fn check_euler(case: &Value, file: &Value) {
    let name = text(&case["name"]);
    let order: EulerOrder = text(&case["order"]).parse().expect("an order");
    let rotation = matrix(&case["matrix"]);
    let angles = order.angles(&rotation).expect("a finite matrix");
    let angle_tolerance = tolerance_of(case, file, "angle");
    for (ours, theirs) in angles.into_iter().zip(numbers(&case["angles"])) {
        assert_angle(ours, theirs, angle_tolerance, name);
    }
    let is_locked = case["gimbal"] == true;
    assert_eq!(
        is_locked,
        angles[1].cos() < GIMBAL_COSINE && angles[2] == 0.0,
        "{name}"
    );
    // With the last angle at 0 the rotation is exact only if the middle one is a quarter turn.
    let lost = if is_locked { 2.0 * GIMBAL_COSINE } else { 0.0 };
    assert_matrix(
        &order.rotation(angles),
        &rotation,
        angle_tolerance + lost,
        name,
    );
}

/// Checks the angles of bodies against the T pose.
pub fn t_pose(file: &Value) -> usize {
    let cases = list(&file["cases"]);
    let tolerance = number(&file["tolerance"]["angle_degrees"]);
    for case in cases {
        let name = text(&case["name"]);
        let mut positions = [DVec3::ZERO; BodyPoint::COUNT];
        for point in BodyPoint::ALL {
            positions[point.index()] = vector(&case["points"][point.name().replace('-', "_")]);
        }
        let rotations = BodyPoints { positions }.rotations();
        if case["error"].is_string() {
            assert!(rotations.is_err(), "{name}");
            continue;
        }
        let rotations = rotations.unwrap_or_else(|error| panic!("{name}: {error}"));
        for &joint in BodyJoint::ALL {
            let expected = numbers(&case["zxy_degrees"][joint.name().replace('-', "_")]);
            for (ours, theirs) in rotations.zxy(joint).into_iter().zip(expected) {
                assert_angle(
                    ours,
                    theirs.to_radians(),
                    tolerance.to_radians(),
                    &format!("{name} {joint}"),
                );
            }
        }
    }
    cases.len()
}

/// Compares two angles in radians up to a turn: a half turn may have either sign.
fn assert_angle(ours: f64, theirs: f64, tolerance: f64, what: &str) {
    assert!(ours.abs() <= PI, "{what}: {ours}");
    let turn = TAU * ((ours - theirs) / TAU).round();
    assert_close(ours, theirs + turn, tolerance, what);
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

/// Reads a matrix from its rows.
fn matrix(value: &Value) -> DMat3 {
    let rows = list(value);
    DMat3::from_cols(vector(&rows[0]), vector(&rows[1]), vector(&rows[2])).transpose()
}

fn assert_matrix(ours: &DMat3, theirs: &DMat3, tolerance: f64, what: &str) {
    let pairs = ours.to_cols_array().into_iter().zip(theirs.to_cols_array());
    for (one, other) in pairs {
        assert_close(one, other, tolerance, what);
    }
}
