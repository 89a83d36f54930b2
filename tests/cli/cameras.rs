//! Cameras are calibrated by a wand, and what they see is read as markers.

use std::path::Path;

use ademan::cameras::{Camera, CamerasFile, CamerasFormat};
use ademan::document::Document;
use glam::{DMat3, DQuat, DVec2, DVec3};
use serde_json::json;

use crate::{Ended, file, run, text};

/// Cameras around a volume of two metres that look at its middle.
fn room() -> Vec<Camera> {
    let camera = |index: usize| {
        let (sine, cosine) = (0.4 + 1.3 * index as f64).sin_cos();
        let position = DVec3::new(3.0 * cosine, 1.2, 3.0 * sine);
        let z = -position.normalize();
        let x = DVec3::NEG_Y.cross(z).normalize();
        let rotation = DMat3::from_cols(x, z.cross(x), z).transpose();
        Camera {
            focal: DVec2::splat(1150.0),
            distortion: [-0.1, 0.03, 0.0, 0.0],
            rotation: DQuat::from_mat3(&rotation),
            translation: -(rotation * position),
            ..Camera::new(format!("cam{index}"), DVec2::new(1280.0, 720.0))
        }
    };
    (0..3).map(camera).collect()
}

/// Returns the line of what cameras see of labelled points.
fn line(cameras: &[Camera], points: &[(&str, DVec3)]) -> String {
    let views = cameras.iter().map(|camera| {
        let marks = points.iter().filter_map(|(label, point)| {
            let image = camera.project(*point)?.pixel;
            let is_inside = image.cmpge(DVec2::ZERO).all() && image.cmple(camera.size).all();
            is_inside.then(|| json!({"label": label, "image": image.to_array()}))
        });
        json!({"name": camera.name, "markers": marks.collect::<Vec<_>>()})
    });
    json!({"cameras": views.collect::<Vec<_>>()}).to_string()
}

fn wand_lines(cameras: &[Camera]) -> Vec<String> {
    let mut random = fastrand::Rng::with_seed(7);
    let mut place = |size: f64| DVec3::from_array([0; 3].map(|_| size * (random.f64() - 0.5)));
    (0..80)
        .map(|_| {
            let (middle, half) = (place(1.2), place(1.0).normalize() * 0.25);
            line(cameras, &[("a", middle - half), ("b", middle + half)])
        })
        .collect()
}

/// Calibrates cameras by what they see of a wand of half a metre.
fn calibrate(wand: &str, output: &Path) -> Ended {
    run([
        "cameras",
        "calibrate",
        wand,
        "--wand",
        "500",
        "--size",
        "1280x720",
        "--output",
        text(output),
    ])
}

#[test]
fn a_wand_calibrates_cameras_whose_marks_are_then_markers() {
    let folder = tempfile::tempdir().unwrap();
    let exact = room();
    let wand = file(&folder, "wand.jsonl", wand_lines(&exact).join("\n"));
    for (name, format) in [
        ("cameras.ron", CamerasFormat::Ron),
        ("cameras.toml", CamerasFormat::Toml),
    ] {
        let path = folder.path().join(name);
        let calibrated = calibrate(&wand, &path).done();
        let wrote = format!("wrote {}\n", path.display());
        assert!(calibrated.err.starts_with(&wrote), "{}", calibrated.err);
        calibrated.reported("cam2: 160 marks, median error 0.0");
        let written = std::fs::read_to_string(&path).unwrap();
        let document = Document::new(name, written);
        let cameras = CamerasFile::parse(&document, format).unwrap().cameras();
        assert_eq!(cameras.len(), 3);

        // Two markers of known distance, seen by the cameras as they are.
        let marks = [
            ("RightHand", DVec3::new(0.1, 0.2, 0.3)),
            ("RightForeArm", DVec3::new(0.3, -0.1, 0.2)),
        ];
        let seen = file(&folder, "seen.jsonl", line(&exact, &marks));
        let lines = folder.path().join(format!("{name}.jsonl"));
        let lines = text(&lines);
        let from = ["cameras", "lines", &seen, "--cameras", text(&path)];
        let printed = run(from.into_iter().chain(["--output", lines])).done();
        assert_eq!(printed.err, format!("wrote {lines}\n"));
        let source = format!("file:{lines}?protocol=markers");
        let readings = run(["trace", "readings", "--source", &source]).done();
        let reading: serde_json::Value = serde_json::from_str(readings.out.trim()).unwrap();
        let joint = |label: &str| -> DVec3 {
            let position: [f64; 3] =
                serde_json::from_value(reading["joints_m"][label].clone()).unwrap();
            DVec3::from_array(position)
        };
        let found = joint("wrist").distance(joint("elbow"));
        let expected = marks[0].1.distance(marks[1].1);
        assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    }
    let path = folder.path().join("cameras.ron");
    let again = calibrate("no-wand.jsonl", &path);
    assert_eq!(again.code, Some(2), "before anything is read");
    again.reported("the file exists");
}

#[test]
fn a_camera_that_never_sees_the_wand_with_another_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let cameras = room();
    let (both, alone) = (wand_lines(&cameras[..2]), wand_lines(&cameras[2..]));
    let wand = file(&folder, "wand.jsonl", [both, alone].concat().join("\n"));
    let path = folder.path().join("cameras.ron");
    let ended = calibrate(&wand, &path).exited(1);
    let expected = "`cam0` and `cam2` see both ends of the wand together in 0 frames and 8 are needed: 8 are missing";
    ended.reported(expected);
    assert!(!path.exists());
}

#[test]
fn a_camera_that_is_there_twice_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let first = room().remove(0);
    let twin = Camera {
        name: "twin".to_owned(),
        ..first.clone()
    };
    let wand = file(&folder, "wand.jsonl", wand_lines(&[first, twin]).join("\n"));
    let ended = calibrate(&wand, &folder.path().join("cameras.ron")).exited(1);
    ended.reported("`cam0` and `twin`: both cameras see the points from the same position");
}

#[test]
fn marks_outside_the_image_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let view = |u: f64| json!({"name": "left", "markers": [{"label": "a", "image": [u, 300.0]}]});
    let lines = [640.0, 908.5].map(|u| json!({"cameras": [view(u)]}).to_string());
    let wand = file(&folder, "wand.jsonl", lines.join("\n"));
    let output = folder.path().join("cameras.ron");
    let options = [
        "cameras",
        "calibrate",
        &wand,
        "--wand",
        "500",
        "--size",
        "640x360",
    ];
    let ended = run(options.into_iter().chain(["--output", text(&output)])).exited(2);
    let expected = "wand.jsonl:2: camera `left` has a mark at 908.5, 300, outside its image of 640 × 360 pixels";
    ended.reported(expected);
}

#[test]
fn a_line_that_is_no_json_has_its_number_in_the_file_only() {
    let folder = tempfile::tempdir().unwrap();
    let lines = "{\"cameras\": []}\n{\"cameras\" []}\n";
    let wand = file(&folder, "wand.jsonl", lines);
    let ended = calibrate(&wand, &folder.path().join("cameras.ron")).exited(2);
    ended.reported("wand.jsonl:2: expected `:` at column 12");
}

#[test]
fn an_unknown_camera_is_named_and_leaves_no_part_of_the_lines() {
    let folder = tempfile::tempdir().unwrap();
    let exact = room();
    let cameras = CamerasFile::new(&exact).to_text(CamerasFormat::Ron);
    let cameras = file(&folder, "cameras.ron", cameras);
    let mark = [("RightHand", DVec3::new(0.1, 0.2, 0.3))];
    let known = line(&exact, &mark);
    let unknown = known.replace("cam2", "cam9");
    let seen = file(&folder, "seen.jsonl", format!("{known}\n{unknown}\n"));
    let lines = folder.path().join("lines.jsonl");
    let from = ["cameras", "lines", &seen, "--cameras", &cameras];
    let refused = run(from.into_iter().chain(["--output", text(&lines)])).exited(2);
    refused.reported("has no camera `cam9`");
    assert!(!lines.exists(), "a part of the lines is left");

    let better = folder.path().join("better.ron");
    let refine = ["cameras", "calibrate", &seen, "--refine"];
    let files = ["--cameras", &cameras, "--output", text(&better)];
    let refined = run(refine.into_iter().chain(files));
    refined.reported("is called `cam9`");
}

#[cfg(unix)]
#[test]
fn no_part_of_the_cameras_is_left_on_a_full_disk() {
    let folder = tempfile::tempdir().unwrap();
    // The limit of the size of files stands for a full disk: the names alone are longer.
    let mut cameras = room();
    for camera in &mut cameras {
        camera.name.push_str(&"x".repeat(400));
    }
    let wand = file(&folder, "wand.jsonl", wand_lines(&cameras).join("\n"));
    let path = folder.path().join("cameras.ron");
    let ended = crate::lab::run_with_small_files(&[
        "cameras",
        "calibrate",
        &wand,
        "--wand",
        "500",
        "--size",
        "1280x720",
        "--output",
        text(&path),
    ])
    .exited(2);
    ended.reported("cannot create");
    assert!(!path.exists());
}
