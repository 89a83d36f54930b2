//! Tests of markers that are followed over many lines.

use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use super::*;
use crate::hand::{Joint, JointPositions};

const CAMERAS: [DVec3; 4] = [
    DVec3::new(0.8, 1.0, 0.3),
    DVec3::new(-0.9, 0.9, -0.2),
    DVec3::new(0.1, 1.2, -1.4),
    DVec3::new(-0.6, -0.9, -1.1),
];

/// A marker as the cameras see it: its label, and whether each of them sees it.
struct Shown<'a> {
    label: &'a str,
    point: DVec3,
    cameras: [bool; CAMERAS.len()],
}

fn shown(label: &str, point: DVec3) -> Shown<'_> {
    Shown {
        label,
        point,
        cameras: [true; CAMERAS.len()],
    }
}

/// Lines of cameras of which the first states labels.
struct Film {
    random: fastrand::Rng,
    cameras: usize,
    /// Standard deviation of the rays at the marker, in metres.
    noise: f64,
    period_us: u64,
    frames: u64,
}

impl Film {
    fn new(cameras: usize, noise: f64, rate_hz: u64) -> Self {
        Self {
            random: fastrand::Rng::with_seed(4),
            cameras,
            noise,
            period_us: 1_000_000 / rate_hz,
            frames: 0,
        }
    }

    fn normal(&mut self) -> f64 {
        let sum: f64 = (0..12).map(|_| self.random.f64()).sum();
        sum - 6.0
    }

    fn line(&mut self, markers: &[Shown], has_labels: bool) -> String {
        let mut cameras = Vec::new();
        for (camera, &position) in CAMERAS[..self.cameras].iter().enumerate() {
            let mut seen: Vec<Value> = Vec::new();
            for marker in markers.iter().filter(|marker| marker.cameras[camera]) {
                let noise = DVec3::from_array([0; 3].map(|_| self.noise * self.normal()));
                let direction = (marker.point + noise - position).to_array();
                seen.push(if has_labels && camera == 0 {
                    json!({"label": marker.label, "direction": direction})
                } else {
                    json!({"direction": direction})
                });
            }
            self.random.shuffle(&mut seen);
            cameras.push(json!({"position": position.to_array(), "markers": seen}));
        }
        self.frames += 1;
        let time = self.frames * self.period_us;
        format!("{}\n", json!({"time_us": time, "cameras": cameras}))
    }
}

/// Decodes a line; `None` if it gives no positions.
fn decode(
    decoder: &mut dyn crate::capture::protocol::Decoder,
    line: &str,
) -> Option<JointPositions> {
    let mut decoded = None;
    decoder.push(line.as_bytes(), &mut |packet| match packet.sample {
        Sample::Joints { positions } => decoded = Some(positions),
        other => panic!("{other:?}"),
    });
    decoded
}

/// Returns the markers of an arm and hand at a time in seconds, by label, and the joints that they show.
fn arm(time: f64) -> Vec<(&'static str, DVec3, Joint)> {
    let wave = |frequency: f64, phase: f64| (frequency * time + phase).sin();
    let upper = DQuat::from_euler(
        glam::EulerRot::YXZ,
        0.5 * wave(2.3, 0.0),
        0.6 + 0.5 * wave(3.1, 1.0),
        0.4 * wave(1.7, 2.0),
    );
    let fore = upper * DQuat::from_rotation_x(1.0 + 0.8 * wave(3.7, 0.3));
    let hand = fore
        * DQuat::from_rotation_y(0.9 * wave(4.3, 0.5))
        * DQuat::from_rotation_x(0.4 * wave(5.1, 1.5));
    let elbow = upper * DVec3::new(0.0, -0.3, 0.0);
    let wrist = elbow + fore * DVec3::new(0.0, -0.26, 0.0);
    let on_hand = |x: f64, y: f64, z: f64| wrist + hand * DVec3::new(x, -y, z);
    vec![
        ("shoulder", DVec3::ZERO, Joint::Shoulder),
        ("elbow", elbow, Joint::Elbow),
        ("wrist", wrist, Joint::Wrist),
        (
            "RightHandThumb4",
            on_hand(-0.06, 0.07, -0.03),
            Joint::ThumbTip,
        ),
        (
            "RightHandIndex1",
            on_hand(-0.03, 0.09, 0.0),
            Joint::IndexPhalanxProximal,
        ),
        (
            "RightHandIndex4",
            on_hand(-0.03, 0.18, -0.01),
            Joint::IndexTip,
        ),
        (
            "RightHandMiddle1",
            on_hand(0.0, 0.09, 0.0),
            Joint::MiddlePhalanxProximal,
        ),
        (
            "RightHandMiddle4",
            on_hand(0.0, 0.19, -0.01),
            Joint::MiddleTip,
        ),
        (
            "RightHandPinky1",
            on_hand(0.03, 0.08, 0.0),
            Joint::LittlePhalanxProximal,
        ),
        (
            "RightHandPinky4",
            on_hand(0.04, 0.15, -0.01),
            Joint::LittleTip,
        ),
    ]
}

/// Returns the markers of an [`arm`], seen by all cameras.
fn markers_of(arm: &[(&'static str, DVec3, Joint)]) -> Vec<Shown<'static>> {
    let markers = arm.iter();
    markers
        .map(|&(label, point, _)| shown(label, point))
        .collect()
}

#[test]
fn labels_of_one_camera_are_right_in_every_frame_with_noise() {
    for cameras in [2, 3, 4] {
        for rate_hz in [100, 30] {
            let mut film = Film::new(cameras, 3e-4, rate_hz);
            let mut decoder = (PROTOCOL.decoder)(&ProtocolOptions::default());
            let (mut worst, mut missing) = (0.0_f64, 0);
            for frame in 0..500 {
                let arm = arm(frame as f64 / rate_hz as f64);
                let line = film.line(&markers_of(&arm), true);
                let positions = decode(&mut *decoder, &line).unwrap_or_default();
                for (_, point, joint) in arm {
                    match positions.get(joint) {
                        Some(found) if positions.is_predicted(joint) => {
                            assert!(found.distance(point) < 0.2, "{frame}: {joint}");
                            missing += 1;
                        }
                        Some(found) => worst = worst.max(found.distance(point)),
                        None => missing += 1,
                    }
                }
            }
            println!(
                "{cameras} cameras, {rate_hz} Hz: {:.1} mm, {missing} of 5000 missing",
                worst * 1000.0
            );
            assert!(worst < 0.008, "{cameras} {rate_hz}: {worst}");
            assert!(missing < 250, "{cameras} {rate_hz}: {missing}");
        }
    }
}

#[test]
fn two_markers_that_cross_keep_their_names() {
    // Both cameras label them in the first frame only. They pass each other at 12 mm, and their images cross in each camera.
    for rate_hz in [100, 50] {
        let mut film = Film::new(3, 3e-4, rate_hz);
        let mut decoder = (PROTOCOL.decoder)(&ProtocolOptions::default());
        let frames = rate_hz;
        for frame in 0..=frames {
            let t = frame as f64 / frames as f64 - 0.5;
            let first = DVec3::new(0.6 * t, 0.006, -0.3);
            let second = DVec3::new(-0.6 * t, -0.006, -0.3 + 0.1 * t);
            let markers = [shown("elbow", second), shown("wrist", first)];
            let line = film.line(&markers, frame == 0);
            let positions = decode(&mut *decoder, &line).expect("both are seen");
            for (joint, point) in [(Joint::Wrist, first), (Joint::Elbow, second)] {
                let found = positions.get(joint).expect("it is followed");
                let error = found.distance(point);
                assert!(error < 0.006, "{rate_hz} Hz, {frame}: {joint} {error}");
            }
        }
    }
}

#[test]
fn a_short_gap_is_bridged_and_marked_and_a_long_one_is_not_bridged() {
    let mut film = Film::new(2, 0.0, 100);
    let mut decoder = (PROTOCOL.decoder)(&ProtocolOptions::default());
    for frame in 0..80 {
        let t = f64::from(frame) * 0.01;
        let moving = DVec3::new(0.5 * t, 0.1, -0.3);
        let mut hidden = shown("wrist", moving);
        let is_hidden = (20..28).contains(&frame) || (40..60).contains(&frame);
        hidden.cameras[1] = !is_hidden;
        let still = shown("elbow", DVec3::new(-0.2, 0.0, -0.2));
        let line = film.line(&[hidden, still], frame == 0);
        let positions = decode(&mut *decoder, &line).expect("the elbow is seen");
        assert!(!positions.is_predicted(Joint::Elbow));
        let wrist = positions.get(Joint::Wrist);
        match frame {
            // At the end of the time for which a marker is predicted.
            49 => {}
            50..60 => assert_eq!(wrist, None, "{frame}"),
            _ => {
                let error = wrist.expect("seen or bridged").distance(moving);
                assert!(error < 1e-6, "{frame}: {error}");
                assert_eq!(positions.is_predicted(Joint::Wrist), is_hidden, "{frame}");
            }
        }
    }
}

#[test]
fn a_marker_that_jumps_is_found_where_it_is() {
    let mut film = Film::new(3, 0.0, 100);
    let mut decoder = (PROTOCOL.decoder)(&ProtocolOptions::default());
    for frame in 0..200_u32 {
        // Another pose of the same hand in each line.
        let arm = arm(f64::from(frame * 977 % 1009));
        let line = film.line(&markers_of(&arm), true);
        let positions = decode(&mut *decoder, &line).unwrap_or_default();
        for (_, point, joint) in arm {
            if let Some(found) = positions.get(joint)
                && !positions.is_predicted(joint)
            {
                assert!(found.distance(point) < 1e-6, "{frame}: {joint}");
            }
        }
    }
}
