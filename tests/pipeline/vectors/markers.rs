use ademan::capture::markers::{
    CostMatrix, ElbowCenter, Ray, RayError, assign, closest_points, gap_in_front, triangulate,
    wrist_center,
};
use ademan::geometry::{angle_between, rotation_between};
use glam::{DMat3, DVec3};
use serde_json::Value;

use super::check::{assert_close, list, number, numbers, text, tolerance_of};

/// Angle in radians below which two bones are in line: their axis is lost in rounding.
const STRAIGHT: f64 = 1e-9;

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

pub(super) fn assert_vector(ours: DVec3, theirs: &Value, tolerance: f64, what: &str) {
    for (one, other) in ours.to_array().iter().zip(numbers(theirs)) {
        assert_close(*one, other, tolerance, what);
    }
}

/// Checks the closest points of two rays, and the pairs of observations.
pub fn triangulation(file: &Value) -> usize {
    let cases = list(&file["cases"]);
    for case in cases {
        let tolerance = tolerance_of(case, file, "absolute");
        let ray =
            |camera: &str, image: &str| Ray::through(vector(&case[camera]), vector(&case[image]));
        assert_rays(case, &[ray("c1", "i1"), ray("c2", "i2")], tolerance);
    }
    let matching = list(&file["matching"]);
    for case in matching {
        assert_pairs(case, tolerance_of(case, file, "absolute"));
    }
    cases.len() + matching.len()
}

fn assert_rays(case: &Value, rays: &[Ray; 2], tolerance: f64) {
    let name = text(&case["name"]);
    let found = closest_points(&rays[0], &rays[1]);
    let wanted = match text(&case["status"]) {
        "parallel" => Err(RayError::Parallel),
        "degenerate" => Err(RayError::Degenerate),
        "ok" => Ok(()),
        other => panic!("{name}: unknown status {other}"),
    };
    assert_eq!(
        found.as_ref().map(|_| ()).map_err(|error| *error),
        wanted,
        "{name}"
    );
    let Ok(found) = found else {
        assert!(triangulate(rays).is_err(), "{name}");
        return;
    };
    for (index, (k, p)) in [("k1", "p1"), ("k2", "p2")].into_iter().enumerate() {
        assert_close(found.parameters[index], number(&case[k]), tolerance, name);
        assert_vector(found.points[index], &case[p], tolerance, name);
    }
    assert_vector(found.midpoint(), &case["point"], tolerance, name);
    assert_close(found.gap(), number(&case["gap"]), tolerance, name);
    assert_eq!(
        Some(found.is_in_front()),
        case["in_front"].as_bool(),
        "{name}"
    );
    match triangulate(rays) {
        Ok(position) => {
            assert_vector(position.point, &case["point"], tolerance, name);
            assert_close(position.gap, number(&case["gap"]), tolerance, name);
        }
        Err(error) => assert!(!found.is_in_front(), "{name}: {error}"),
    }
}

/// Returns, for each ray of the first camera, the index of the ray of the second camera that shows the same marker.
pub fn pairs_of_rays(first: &[Ray], second: &[Ray], max_gap: f64) -> Vec<Option<usize>> {
    assign(&CostMatrix::new(
        first.len(),
        second.len(),
        |row, column| gap_in_front(&first[row], &second[column], max_gap),
    ))
}

fn assert_pairs(case: &Value, tolerance: f64) {
    let name = text(&case["name"]);
    let rays = |camera: &str, seen: &str| -> Vec<Ray> {
        let camera = vector(&case[camera]);
        let seen = list(&case[seen]).iter();
        seen.map(|point| Ray::through(camera, vector(point)))
            .collect()
    };
    let (first, second) = (rays("c1", "seen_by_1"), rays("c2", "seen_by_2"));
    for (ray, gaps) in first.iter().zip(list(&case["gap"])) {
        for (other, gap) in second.iter().zip(list(gaps)) {
            match (closest_points(ray, other), gap.as_f64()) {
                (Ok(found), Some(gap)) => assert_close(found.gap(), gap, tolerance, name),
                (Err(_), None) => {}
                (found, gap) => panic!("{name}: {found:?} instead of {gap:?}"),
            }
        }
    }
    let pairs = pairs_of_rays(&first, &second, number(&case["max_gap"]));
    let wanted = list(&case["pairs"]).iter();
    let wanted: Vec<Option<usize>> = wanted
        .map(|index| index.as_u64().map(|index| index as usize))
        .collect();
    assert_eq!(pairs, wanted, "{name}");
}

/// Checks joint centers from markers on the skin, and rotations from bone to bone.
pub fn skeleton_fit(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]);
    let cases = list(&file["cases"]);
    for case in cases {
        let name = text(&case["name"]);
        let point = |field: &str| vector(&case[field]);
        let wrist = wrist_center(point("wrist_a"), point("wrist_b"));
        assert_vector(wrist, &case["wrist"], tolerance, name);
        // The marker of the arm whose elbow is where the vectors have a marker. Only an arm with a bend has a normal.
        let (elbow, offset) = (&case["elbow_marker"], number(&case["offset"]));
        let mut center = ElbowCenter::new(offset);
        if case["normal"].is_array() {
            let marker = vector(elbow) - offset * vector(&case["normal"]);
            let found = center.update(point("shoulder"), marker, wrist);
            assert_vector(found.expect(name), elbow, tolerance, name);
        } else if text(&case["status"]) == "degenerate" {
            let found = center.update(point("shoulder"), vector(elbow), wrist);
            assert_eq!(found, None, "{name}");
        }
    }
    let relative = list(&file["relative"]);
    for case in relative {
        assert_relative(case, tolerance);
    }
    cases.len() + relative.len()
}

fn assert_relative(case: &Value, tolerance: f64) {
    let name = text(&case["name"]);
    let point = |field: &str| vector(&case[field]);
    let (bone, next) = (point("b") - point("a"), point("c") - point("b"));
    let (rotation, angle) = (rotation_between(bone, next), angle_between(bone, next));
    let status = match &rotation {
        None => "degenerate",
        Some(_) if angle < STRAIGHT => "parallel",
        Some(matrix) if (*matrix * *matrix).abs_diff_eq(DMat3::IDENTITY, 1e-9) => "antiparallel",
        Some(_) => "ok",
    };
    assert_eq!(status, text(&case["status"]), "{name}");
    let Some(matrix) = rotation else { return };
    assert_close(angle, number(&case["angle"]), tolerance, name);
    if status == "antiparallel" {
        // Any axis perpendicular to the bone is right.
        let turned = matrix * bone;
        assert!(
            turned.distance(-bone) <= tolerance * bone.length(),
            "{name}"
        );
        return;
    }
    if status == "ok" {
        let axis = bone.cross(next).normalize();
        assert_vector(axis, &case["axis"], tolerance, name);
    }
    for (index, row) in list(&case["rotation"]).iter().enumerate() {
        assert_vector(matrix.row(index), row, tolerance, name);
    }
}
