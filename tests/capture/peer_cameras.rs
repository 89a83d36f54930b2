//! The calibration of cameras of another program, against what the cameras see of a person.

use std::collections::BTreeMap;
use std::fs;

use ademan::cameras::{Camera, Frame, refine};
use ademan::capture::markers::{Ray, triangulate};
use glam::{DQuat, DVec2, DVec3};
use serde_json::Value;

use crate::support::peers::peer;

/// Confidence below which a key point does not count.
const MIN_CONFIDENCE: f64 = 0.3;

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|number| number.as_f64().expect("a number"))
        .collect()
}

fn camera(name: &str, described: &Value) -> Camera {
    let rows: Vec<Vec<f64>> = described["matrix"]
        .as_array()
        .unwrap()
        .iter()
        .map(numbers)
        .collect();
    Camera {
        focal: DVec2::new(rows[0][0], rows[1][1]),
        center: DVec2::new(rows[0][2], rows[1][2]),
        distortion: numbers(&described["distortions"]).try_into().unwrap(),
        rotation: DQuat::from_scaled_axis(DVec3::from_slice(&numbers(&described["rotation"]))),
        translation: DVec3::from_slice(&numbers(&described["translation"])),
        ..Camera::new(
            name.to_owned(),
            DVec2::from_slice(&numbers(&described["size"])),
        )
    }
}

fn frames(file: &Value, cameras: &[Camera]) -> Vec<Frame> {
    let names: Vec<String> = serde_json::from_value(file["keypoint_names"].clone()).unwrap();
    let seen = |points: &Value| -> BTreeMap<String, DVec2> {
        let points = points.as_array().unwrap().iter().map(numbers);
        let named = names
            .iter()
            .zip(points)
            .filter(|(_, point)| point[2] >= MIN_CONFIDENCE);
        named
            .map(|(name, point)| (name.clone(), DVec2::from_slice(&point)))
            .collect()
    };
    let list = file["frames"].as_array().unwrap().iter();
    list.map(|frame| {
        cameras
            .iter()
            .map(|camera| seen(&frame["points2d"][&camera.name]))
            .collect()
    })
    .collect()
}

/// Returns the median distance in pixels of the key points from where the cameras show the point nearest to their rays.
fn median_error(cameras: &[Camera], frames: &[Frame]) -> f64 {
    let mut distances = Vec::new();
    for frame in frames {
        let labels: std::collections::BTreeSet<&String> =
            frame.iter().flat_map(BTreeMap::keys).collect();
        for label in labels {
            let seen = cameras
                .iter()
                .zip(frame)
                .filter_map(|(camera, marks)| Some((camera, *marks.get(label)?)));
            let seen: Vec<(&Camera, DVec2)> = seen.collect();
            let rays: Vec<Ray> = seen
                .iter()
                .map(|(camera, pixel)| Ray {
                    origin: camera.position(),
                    direction: camera.direction(*pixel),
                })
                .collect();
            let Ok(found) = triangulate(&rays) else {
                continue;
            };
            let projected = seen.iter().filter_map(|(camera, pixel)| {
                Some(camera.project(found.point)?.pixel.distance(*pixel))
            });
            distances.extend(projected);
        }
    }
    distances.sort_by(f64::total_cmp);
    distances[distances.len() / 2]
}

#[test]
fn refined_cameras_show_a_person_with_a_smaller_error_than_the_published_ones() {
    let Some(path) = peer("markers/pose2sim_balancing_4cam.json") else {
        return;
    };
    let text = fs::read(path).expect("a file");
    let file: Value = serde_json::from_slice(&text).unwrap();
    let described = file["cameras"].as_object().unwrap();
    let published: Vec<Camera> = described
        .iter()
        .map(|(name, described)| camera(name, described))
        .collect();
    let frames = frames(&file, &published);
    // Half of the frames, so that the others test the result.
    let refined = refine(&published, &frames[..frames.len() / 2], true).unwrap();
    let rest = &frames[frames.len() / 2..];
    let (before, after) = (
        median_error(&published, rest),
        median_error(&refined.cameras, rest),
    );
    println!(
        "median error: published {before:.1} px, refined {after:.1} px; {:?}",
        refined.errors
    );
    assert!(before > 8.0, "{before}");
    assert!(after < 0.75 * before, "{before} {after}");
    let distance = |cameras: &[Camera]| cameras[0].position().distance(cameras[1].position());
    assert!((distance(&published) - distance(&refined.cameras)).abs() < 1e-9);
}
