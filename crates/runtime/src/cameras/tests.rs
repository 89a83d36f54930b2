//! Tests of calibrations of simulated cameras.

use std::collections::BTreeMap;

use ademan_core::document::Document;
use glam::{DMat3, DQuat, DVec2, DVec3};

use super::*;

const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

/// Cameras around a volume of two metres that look at its middle.
fn room(count: usize) -> Vec<Camera> {
    let camera = |index: usize| {
        let (sine, cosine) = (0.4 + 1.3 * index as f64).sin_cos();
        let position = DVec3::new(3.0 * cosine, 1.2 + 0.3 * index as f64, 3.0 * sine);
        let z = -position.normalize();
        let x = DVec3::NEG_Y.cross(z).normalize();
        let rotation = DMat3::from_cols(x, z.cross(x), z).transpose();
        let shift = index as f64;
        Camera {
            focal: DVec2::new(1150.0 + 10.0 * shift, 1140.0 + 10.0 * shift),
            center: DVec2::new(645.0 - 3.0 * shift, 352.0 + 4.0 * shift),
            distortion: [-0.12, 0.05, 0.001, -0.0007],
            rotation: DQuat::from_mat3(&rotation),
            translation: -(rotation * position),
            ..Camera::new(format!("cam_{:02}", index + 1), SIZE)
        }
    };
    (0..count).map(camera).collect()
}

/// Returns what the cameras see of labelled points, with noise in pixels.
fn seen(
    cameras: &[Camera],
    points: &[(&str, DVec3)],
    noise: f64,
    random: &mut fastrand::Rng,
) -> Frame {
    let see = |camera: &Camera| {
        let mut marks = BTreeMap::new();
        for (label, point) in points {
            let Some(projected) = camera.project(*point) else {
                continue;
            };
            let mut error = || noise * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
            let pixel = projected.pixel + DVec2::new(error(), error());
            if pixel.cmpge(DVec2::ZERO).all() && pixel.cmplt(SIZE).all() {
                marks.insert((*label).to_owned(), pixel);
            }
        }
        marks
    };
    cameras.iter().map(see).collect()
}

fn wand(random: &mut fastrand::Rng) -> [(&'static str, DVec3); 2] {
    let mut place = |size: f64| DVec3::from_array([0; 3].map(|_| size * (random.f64() - 0.5)));
    let middle = place(1.6);
    let half = place(1.0).normalize() * 0.25;
    [("a", middle - half), ("b", middle + half)]
}

fn wand_frames(cameras: &[Camera], count: usize, noise: f64, seed: u64) -> Vec<Frame> {
    let mut random = fastrand::Rng::with_seed(seed);
    let frames = (0..count).map(|_| {
        let ends = wand(&mut random);
        seen(cameras, &ends, noise, &mut random)
    });
    frames.collect()
}

/// Returns cameras that know the size of their images and nothing else.
fn unknown(cameras: &[Camera]) -> Vec<Camera> {
    cameras
        .iter()
        .map(|camera| Camera::new(camera.name.clone(), camera.size))
        .collect()
}

/// Returns the largest distance of a camera from where it is, seen from the first one.
fn place_error(found: &[Camera], exact: &[Camera]) -> f64 {
    let relative =
        |cameras: &[Camera], index: usize| cameras[0].in_camera(cameras[index].position());
    let error = |index: usize| relative(found, index).distance(relative(exact, index));
    (1..exact.len()).map(error).fold(0.0, f64::max)
}

#[test]
fn a_wand_gives_places_lenses_and_scale_of_simulated_cameras() {
    let exact = room(4);
    let without_noise = wand_frames(&exact, 120, 0.0, 1);
    let found = from_wand(&unknown(&exact), &without_noise, 0.5, false).unwrap();
    let error = place_error(&found.cameras, &exact);
    assert!(error < 1e-3, "{error}");
    for (camera, expected) in found.cameras.iter().zip(&exact) {
        assert!((camera.focal - expected.focal).length() < 1.0, "{camera:?}");
        assert!(
            (camera.distortion[0] - expected.distortion[0]).abs() < 5e-3,
            "{camera:?}"
        );
    }
    let noisy = wand_frames(&exact, 200, 0.3, 2);
    let found_noisy = from_wand(&unknown(&exact), &noisy, 0.5, false).unwrap();
    let noisy_error = place_error(&found_noisy.cameras, &exact);
    println!(
        "0.3 px: places {:.1} mm, {:?}",
        noisy_error * 1000.0,
        found_noisy.errors
    );
    assert!(noisy_error < 0.02, "{noisy_error}");
    assert!(
        found_noisy
            .errors
            .iter()
            .all(|it| it.rms_px < 0.6 && it.marks > 100)
    );
}

#[test]
fn a_frame_of_known_points_gives_each_camera_in_its_world() {
    let exact = room(3);
    let mut random = fastrand::Rng::with_seed(3);
    let names: Vec<String> = (0..150).map(|index| format!("p{index}")).collect();
    let points: Vec<(&str, DVec3)> = names
        .iter()
        .map(|name| {
            (
                name.as_str(),
                DVec3::from_array([0; 3].map(|_| 1.6 * (random.f64() - 0.5))),
            )
        })
        .collect();
    let known = |known_points: &[(&str, DVec3)]| -> BTreeMap<String, DVec3> {
        known_points
            .iter()
            .map(|(name, point)| ((*name).to_owned(), *point))
            .collect()
    };
    let frames = [seen(&exact, &points, 0.0, &mut random)];
    let found = from_points(&unknown(&exact), &frames, &known(&points), false).unwrap();
    for (camera, expected) in found.cameras.iter().zip(&exact) {
        assert!(
            camera.position().distance(expected.position()) < 1e-5,
            "{camera:?}"
        );
        assert!(
            (camera.center - expected.center).length() < 1e-2,
            "{camera:?}"
        );
        for (term, expected_term) in camera.distortion.iter().zip(expected.distortion) {
            assert!(
                (term - expected_term).abs() < 1e-4,
                "{term} {expected_term}"
            );
        }
    }
    let flat: Vec<(&str, DVec3)> = points
        .iter()
        .map(|(name, point)| (*name, point.with_y(0.3)))
        .collect();
    let flat_frames = [seen(&exact, &flat, 0.1, &mut random)];
    let error = from_points(&unknown(&exact), &flat_frames, &known(&flat), false).unwrap_err();
    assert!(
        error.to_string().contains("in a plane or on a line"),
        "{error}"
    );
    let few_frames = [seen(&exact, &points[..5], 0.0, &mut random)];
    let few_error = from_points(&unknown(&exact), &few_frames, &known(&points), false).unwrap_err();
    assert_eq!(
        few_error.to_string(),
        "`cam_01`: 5 points are seen and 6 are needed"
    );
}

#[test]
fn cameras_without_common_frames_are_named_and_a_wand_in_a_plane_is_refused() {
    let exact = room(3);
    let mut frames = wand_frames(&exact, 60, 0.1, 4);
    // The third camera sees the wand with another one five times.
    for (index, frame) in frames.iter_mut().enumerate() {
        match index {
            0..40 => frame[2].clear(),
            40..55 => frame[..2].iter_mut().for_each(BTreeMap::clear),
            _ => frame[0].clear(),
        }
    }
    let error = from_wand(&unknown(&exact), &frames, 0.5, false).unwrap_err();
    let CalibrationError::TooFewFrames {
        first,
        second,
        found,
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!((first.as_str(), second.as_str()), ("cam_02", "cam_03"));
    assert!(*found <= 5, "{error}");
    assert!(
        error
            .to_string()
            .ends_with(&format!("{} are missing", 8 - found)),
        "{error}"
    );

    let mut random = fastrand::Rng::with_seed(5);
    let flat: Vec<Frame> = (0..60)
        .map(|_| {
            let ends = wand(&mut random).map(|(end, point)| (end, point.with_y(0.1)));
            seen(&exact, &ends, 0.1, &mut random)
        })
        .collect();
    let flat_error = from_wand(&unknown(&exact), &flat, 0.5, false).unwrap_err();
    assert!(
        flat_error.to_string().contains("in a plane or on a line"),
        "{flat_error}"
    );
}

#[test]
fn files_of_both_forms_keep_all_numbers_and_others_are_refused() {
    let cameras = room(3);
    for format in [CamerasFormat::Ron, CamerasFormat::Toml] {
        let text = CamerasFile::new(&cameras).to_text(format);
        let document = Document::new("cameras", text.as_str());
        let read = CamerasFile::parse(&document, format).unwrap().cameras();
        for (read_camera, camera) in read.iter().zip(&cameras) {
            assert!(
                read_camera.rotation.angle_between(camera.rotation) < 1e-7,
                "{text}"
            );
            let read_camera = Camera {
                rotation: camera.rotation,
                ..read_camera.clone()
            };
            assert_eq!(read_camera, *camera, "{text}");
        }
    }
    // As Anipose writes it.
    let anipose = "[cam_0]\nname = \"A\"\nsize = [ 1600, 1200,]\nmatrix = [ [ 1000.5, 0.0, 799.5,], [ 0.0, 1000.5, 599.5,], [ 0.0, \
                   0.0, 1.0,],]\ndistortions = [ -0.1, 0.0, 0.0, 0.0, 0.0,]\nrotation = [ 0.1, 0.2, 0.3,]\ntranslation = [ 1, 2.0, \
                   3.0,]\n\n[metadata]\nadjusted = false\nerror = 0.0\n";
    let parse =
        |text: &str| CamerasFile::parse(&Document::new("cameras.toml", text), CamerasFormat::Toml);
    let read = parse(anipose).unwrap().cameras();
    assert_eq!((read.len(), read[0].name.as_str()), (1, "A"));
    assert_eq!(read[0].distortion, [-0.1, 0.0, 0.0, 0.0]);
    for (from, to, reason) in [
        ("0.0, 0.0,]\nrot", "0.0, 0.7,]\nrot", "more distortions"),
        (
            "[ -0.1, 0.0, 0.0, 0.0, 0.0,]",
            "[ -0.1 ]",
            "four distortions",
        ),
        ("1000.5, 0.0, 799.5", "1000.5, 2.0, 799.5", "skew"),
        ("1000.5, 0.0, 799.5", "-1.0, 0.0, 799.5", "above 0"),
        ("[ 1, 2.0,", "[ nan, 2.0,", "not finite"),
        ("name = \"A\"", "fisheye = true", "fisheye"),
    ] {
        let text = anipose.replacen(from, to, 1);
        let error = parse(&text).unwrap_err();
        assert!(error.to_string().contains(reason), "{reason}: {error}");
    }
    let (camera, _) = anipose.split_once("[metadata]").unwrap();
    let twice = format!("{camera}{}", camera.replace("cam_0", "cam_1"));
    let twice_error = parse(&twice).unwrap_err();
    assert_eq!(
        twice_error.to_string(),
        "the camera `A` is given twice; give each camera its own name"
    );
}

#[test]
fn an_error_in_a_file_of_cameras_has_its_line() {
    let no_size = "[cam_1]\nmatrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n";
    for (file, text, start) in [
        (
            "c.ron",
            "(\n    cameras: [(name: \"a\", size_px: (1, x))],\n)",
            "c.ron:2:40: expected a number\n 2 |",
        ),
        (
            "c.ron",
            "(\n    cameras: [()],\n)",
            "c.ron:2:16: the field `name` is missing\n 2 |",
        ),
        (
            "c.toml",
            "[cam_1]\nname = \"a\"\nname = \"b\"\n",
            "c.toml:3:1: duplicate key\n 3 |",
        ),
        (
            "c.toml",
            no_size,
            "c.toml: the table `cam_1`: missing field `size`",
        ),
        (
            "c.toml",
            "[cam_1]\nmatrix = [[1.0], [0.0], [0.0]]\n",
            "c.toml: the table `cam_1`: invalid length 1, expected an array of length 3 in `matrix`",
        ),
    ] {
        let format = if file.ends_with("ron") {
            CamerasFormat::Ron
        } else {
            CamerasFormat::Toml
        };
        let error = CamerasFile::parse(&Document::new(file, text), format).unwrap_err();
        assert!(error.to_string().starts_with(start), "{error}");
    }
}

#[test]
fn cameras_whose_first_two_are_at_one_place_have_no_scale() {
    let exact = room(2);
    let twin = Camera::clone(&exact[0]);
    let start = [exact[0].clone(), twin, exact[1].clone()];
    let frames = wand_frames(&exact, 20, 0.0, 3).into_iter();
    let frames: Vec<Frame> = frames
        .map(|frame| vec![frame[0].clone(), BTreeMap::new(), frame[1].clone()])
        .collect();
    let refused = refine(&start, &frames, true).map(|found| found.cameras);
    assert!(
        matches!(
            refused,
            Err(CalibrationError::Camera {
                reason: LinearError::SamePlace,
                ..
            })
        ),
        "{refused:?}"
    );
}
