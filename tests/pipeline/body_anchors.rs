//! Boards that follow measured points of the body: shoulder, head and hip.

use ademan::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use ademan::capture::{Hc11Format, Reading, Sample, Source, SourceEvent};
use ademan::device::{EventKind, Events};
use ademan::hand::{BodyPoint, Finger, Side};
use ademan::kinematics::HandPose;
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, Setup};
use ademan::time::Timestamp;
use parry3d::math::Vec3;

use crate::camera::{Camera, images};
use crate::recorded_landmarks::recording;
use crate::support::checked::CheckedPipeline;
use crate::support::peers::peer;
use crate::support::wearer::load_layout;

/// The ears and the hips of a body.
const EARS: [usize; 2] = [7, 8];
const HIPS: [usize; 2] = [23, 24];

/// Returns the setup of a layout with one key at a point of the body.
fn setup(anchor: &str, place: &str, source: Option<&str>) -> LoadedSetup {
    let board = format!(
        r#"Layout(name: "badge", boards: [(
            pose: (anchor: {anchor}, {place}),
            keys: [(code: "A", at_mm: (0, 0), size_mm: Box(60, 60), travel_mm: 10)],
        )])"#
    );
    let setup = Setup {
        source: source.map(|source| source.parse().expect("a source")),
        ..Setup::default()
    };
    load_layout(&board, setup)
}

/// A person who is seen as a whole, in the frame of the right shoulder: X to the right, Y up, Z backwards.
struct Person {
    camera: Camera,
    /// The index fingertip.
    tip: Vec3,
    /// The middle between the ears.
    head: Vec3,
    /// Landmarks that are not seen.
    hidden: Vec<usize>,
}

impl Person {
    fn new(setup: &LoadedSetup, tip: Vec3) -> Self {
        Self {
            camera: Camera::new(setup),
            tip,
            head: Vec3::new(-0.18, 0.22, 0.0),
            hidden: Vec::new(),
        }
    }

    fn landmarks(&self) -> BodyLandmarks {
        let mut points = [Landmark {
            position: [0.0; 3],
            confidence: 0.0,
        }; BODY_LANDMARKS];
        let wrist = self.tip + Vec3::new(0.02, 0.01, 0.12);
        let placed = [
            (EARS[0], self.head - Vec3::X * 0.07),
            (EARS[1], self.head + Vec3::X * 0.07),
            (11, Vec3::new(-0.36, 0.0, 0.0)),
            (12, Vec3::ZERO),
            (14, Vec3::new(0.03, -0.28, 0.0)),
            (16, wrist),
            (18, self.tip + Vec3::new(0.06, 0.0, 0.02)),
            (20, self.tip),
            (22, self.tip + Vec3::new(-0.04, 0.0, 0.05)),
            (HIPS[0], Vec3::new(-0.36, -0.5, 0.0)),
            (HIPS[1], Vec3::new(0.0, -0.5, 0.0)),
        ];
        for (index, at) in placed {
            points[index] = Landmark {
                position: [-at.x, -at.y, at.z],
                confidence: if self.hidden.contains(&index) {
                    0.0
                } else {
                    1.0
                },
            };
        }
        BodyLandmarks {
            points: points.into(),
        }
    }

    fn show(&mut self) {
        self.camera.advance();
        let sample = Sample::Body(self.landmarks());
        assert!(self.camera.send(Side::Right, sample), "the arm is seen");
    }

    fn hold(&mut self, seconds: f64) {
        self.go(seconds, self.tip);
    }

    /// Moves the fingertip in a straight line.
    fn go(&mut self, seconds: f64, tip: Vec3) {
        let from = self.tip;
        for t in images(seconds) {
            self.tip = from.lerp(tip, t as f32);
            self.show();
        }
    }
}

/// A source of body landmarks.
const CAMERA: Option<&str> = Some("stdin:?protocol=body-landmarks");

#[test]
fn boards_are_measured_from_the_shoulder_the_head_and_the_hip() {
    for (anchor, place, key) in [
        ("shoulder", "forward_mm: 250", Vec3::new(0.0, 0.0, -0.25)),
        (
            "head",
            "right_mm: 180, height_mm: -220, forward_mm: 250",
            Vec3::new(0.0, 0.0, -0.25),
        ),
        (
            "hip",
            "height_mm: 300, forward_mm: 250",
            Vec3::new(0.0, -0.2, -0.25),
        ),
    ] {
        let above = key + Vec3::Y * 0.05;
        let mut person = Person::new(&setup(anchor, place, CAMERA), above);
        person.hold(1.0);
        let state = person.camera.pipeline.state();
        assert_eq!(state, PipelineState::Running, "{anchor}");
        person.go(0.3, key - Vec3::Y * 0.01);
        person.hold(0.2);
        assert_eq!(person.camera.keys(), "A", "{anchor}");
        person.go(0.3, above);
        assert_eq!(person.camera.keys(), "-A", "{anchor}");
    }
}

#[test]
fn a_board_goes_with_the_head() {
    let place = "right_mm: 180, height_mm: -220, forward_mm: 250";
    let key = Vec3::new(0.0, 0.0, -0.25);
    let mut person = Person::new(&setup("head", place, CAMERA), key + Vec3::Y * 0.05);
    person.hold(1.0);
    person.head += Vec3::new(0.16, 0.0, 0.0);
    person.hold(1.0);
    person.go(0.3, key - Vec3::Y * 0.01);
    person.hold(0.2);
    assert_eq!(person.camera.keys(), "");
    person.go(0.3, key + Vec3::Y * 0.05);
    person.go(0.3, key + Vec3::new(0.16, 0.05, 0.0));
    person.go(0.3, key + Vec3::new(0.16, -0.01, 0.0));
    person.hold(0.2);
    assert_eq!(person.camera.keys(), "A");
}

#[test]
fn a_head_or_hip_that_is_not_seen_releases_after_the_hold_time_and_does_not_touch_on_its_return() {
    for (anchor, place, hidden, depth) in [
        (
            "head",
            "right_mm: 180, height_mm: -220, forward_mm: 250",
            EARS[1],
            0.0,
        ),
        ("hip", "height_mm: 300, forward_mm: 250", HIPS[1], -0.2),
    ] {
        let key = Vec3::new(0.0, depth, -0.25);
        let mut person = Person::new(&setup(anchor, place, CAMERA), key + Vec3::Y * 0.05);
        person.hold(1.0);
        person.go(0.3, key - Vec3::Y * 0.01);
        person.hold(0.2);
        assert_eq!(person.camera.keys(), "A", "{anchor}");
        person.hidden = vec![hidden];
        // The hold time is 100 ms: the reading after it releases.
        person.hold(0.1);
        assert_eq!(person.camera.keys(), "", "{anchor}");
        person.show();
        assert_eq!(person.camera.keys(), "-A", "{anchor}");
        person.hold(0.5);
        person.hidden.clear();
        person.hold(0.5);
        let keys = person.camera.keys();
        assert_eq!(keys, "", "{anchor}: it has to leave the key first");
        person.go(0.3, key + Vec3::Y * 0.05);
        person.go(0.3, key - Vec3::Y * 0.01);
        person.hold(0.2);
        assert_eq!(person.camera.keys(), "A", "{anchor}");
    }
}

#[test]
fn a_simulated_person_taps_boards_at_shoulder_head_and_hip() {
    for (anchor, place) in [
        ("shoulder", "right_mm: 178, forward_mm: 440, height_mm: -45"),
        ("head", "right_mm: 358, forward_mm: 440, height_mm: -265"),
        ("hip", "right_mm: 178, forward_mm: 440, height_mm: 455"),
    ] {
        let setup = setup(anchor, place, None);
        assert!(setup.out_of_reach().is_empty(), "{anchor}");
        let hand = setup.scripted("tap A; tap A", &Hc11Format::default(), 0.0, 0);
        let mut hand = hand.unwrap_or_else(|error| panic!("{anchor}: {error}"));
        let mut pipeline = CheckedPipeline::new(&setup);
        let (mut events, mut presses) = (Events::new(), 0);
        while let Ok(SourceEvent::Reading(reading)) = hand.next() {
            events.clear();
            _ = pipeline.step(&reading, &mut events);
            let is_press = |kind: EventKind| matches!(kind, EventKind::KeyDown(_));
            presses += events.iter().filter(|event| is_press(event.kind)).count();
        }
        assert_eq!(presses, 2, "{anchor}");
    }
}

#[test]
fn a_source_that_does_not_measure_the_point_is_named_with_what_to_do() {
    let reason = |anchor: &str, source| {
        let setup = setup(anchor, "forward_mm: 250", source);
        setup.unmeasured_body_point(&setup.layout)
    };
    for source in [
        "stdin:?protocol=body-landmarks",
        "stdin:?protocol=holistic",
        "recording:session.mcap",
    ] {
        for anchor in ["shoulder", "head", "hip"] {
            assert_eq!(reason(anchor, Some(source)), None, "{anchor} {source}");
        }
    }
    assert_eq!(reason("shoulder", Some("file:a.bvh?protocol=bvh")), None);
    assert_eq!(reason("elbow", Some("stdin:?protocol=hc11")), None);
    for (anchor, source, name) in [
        ("head", Some("file:a.bvh?protocol=bvh"), "file:a.bvh"),
        ("hip", Some("stdin:?protocol=markers"), "markers"),
        (
            "shoulder",
            Some("stdin:?protocol=hand-landmarks"),
            "hand-landmarks",
        ),
        ("shoulder", Some("udp:127.0.0.1:39539?protocol=vmc"), "vmc"),
        ("head", Some("stdin:?protocol=hc11"), "hc11"),
        ("shoulder", None, "the glove"),
    ] {
        let reason = reason(anchor, source).unwrap_or_default();
        assert!(reason.starts_with("`anchor: "), "{reason}");
        for part in [name, "does not measure", anchor, "body-landmarks"] {
            assert!(reason.contains(part), "{anchor} {source:?}: {reason}");
        }
    }
}

#[test]
fn a_webcam_that_shows_no_elbow_is_named_with_the_layouts_that_need_it() {
    const WEBCAM: &str = "stdin:?protocol=hand-landmarks";
    let reason = |layout: &str, source: &str, arm: Option<&str>| {
        let written = Setup {
            layout: layout.to_owned(),
            source: Some(source.parse().expect("a source")),
            arm_source: arm.map(|arm| arm.parse().expect("a source")),
            ..Setup::default()
        };
        let loaded = written.load_files().expect("a shipped layout");
        loaded.unmeasured_elbow(&loaded.layout)
    };
    for (layout, advice) in [
        ("direct", "anchor: start"),
        ("space", "anchor: start"),
        ("joint", "arm_source"),
    ] {
        let found = reason(layout, WEBCAM, None).unwrap_or_default();
        for part in ["hand-landmarks` does not measure", advice] {
            assert!(found.contains(part), "{layout}: {found}");
        }
        for (source, arm) in [
            (WEBCAM, Some("udp:127.0.0.1:9001?protocol=body-landmarks")),
            ("stdin:?protocol=holistic", None),
            ("stdin:?protocol=body-landmarks", None),
            ("stdin:?protocol=openxr", None),
            ("stdin:?protocol=hc11", None),
            ("typist:a?protocol=hand-landmarks&camera=head", None),
        ] {
            assert_eq!(reason(layout, source, arm), None, "{layout} {source}");
        }
    }
    let on_head = format!("{WEBCAM}&camera=head");
    assert_eq!(reason("direct", &on_head, None), None);
    for layout in ["webcam-mouse", "webcam-qwerty", "ray", "qwerty-flat"] {
        assert_eq!(reason(layout, WEBCAM, None), None, "{layout}");
    }
}

#[test]
fn a_box_at_the_elbow_that_a_webcam_sees_needs_no_other_anchor() {
    for (forward_mm, is_hidden) in [(300, true), (-500, false)] {
        let text = format!(
            "Layout(name: \"box\", pointer: Pointer(mode: Direct(pose: (anchor: elbow, forward_mm: {forward_mm}), \
             size_mm: (200, 120, 160))))"
        );
        let written = Setup {
            source: Some("stdin:?protocol=hand-landmarks".parse().expect("a source")),
            ..Setup::default()
        };
        let loaded = load_layout(&text, written);
        let found = loaded.unmeasured_elbow(&loaded.layout);
        assert_eq!(found.is_some(), is_hidden, "{forward_mm}: {found:?}");
    }
}

/// Steps readings through a pipeline and returns the poses.
fn poses(setup: &LoadedSetup, readings: impl IntoIterator<Item = Reading>) -> Vec<HandPose> {
    let mut pipeline = CheckedPipeline::new(setup);
    let mut poses = Vec::new();
    for reading in readings {
        let mut events = Events::new();
        if let Ok(output) = pipeline.step(&reading, &mut events) {
            poses.push(output.pose);
        }
    }
    poses
}

#[test]
fn the_landmarks_of_a_person_who_squats_show_shoulder_head_and_hip_in_their_distances() {
    let Some((_, file)) = recording("tfjs_pose_squats_5fps.json") else {
        return;
    };
    let frames = file["frames"].as_array().expect("frames");
    let at = |frame: &serde_json::Value, index: usize| -> Landmark {
        let numbers = frame["world"][index].as_array().expect("a landmark");
        let number = |axis: usize| numbers[axis].as_f64().expect("a number") as f32;
        Landmark {
            position: [number(0), number(1), number(2)],
            confidence: 1.0,
        }
    };
    let samples = frames.iter().enumerate().map(|(number, frame)| {
        let body = BodyLandmarks {
            points: (0..BODY_LANDMARKS).map(|index| at(frame, index)).collect(),
        };
        Reading::new(
            Timestamp(200_000 * (number as u64 + 1)),
            Some(Side::Right),
            Sample::Body(body),
        )
    });
    let mut setup = setup("head", "forward_mm: 250", CAMERA);
    setup.setup.position_smoothing = ademan::setup::PositionSmoothingSetup::Off;
    let poses = poses(&setup, samples);
    assert!(poses.len() * 2 > frames.len(), "{} poses", poses.len());
    for pose in &poses {
        let frame = &frames[(pose.time.0 / 200_000) as usize - 1];
        let position = |index| Vec3::from(at(frame, index).position);
        let ears = position(EARS[0]).midpoint(position(EARS[1]));
        let known = |point| pose.body.get(point).expect("it is seen");
        let (shoulder, head, hip) = (
            known(BodyPoint::Shoulder),
            known(BodyPoint::Head),
            known(BodyPoint::Hip),
        );
        // The frame moves with the body; distances stay.
        for (found, expected) in [
            (shoulder.distance(head), position(12).distance(ears)),
            (shoulder.distance(hip), position(12).distance(position(24))),
            (head.distance(hip), ears.distance(position(24))),
        ] {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
        assert!(head.y > 0.0 && hip.y < 0.0, "{head} {hip}");
    }
}

#[test]
fn a_motion_capture_of_others_shows_the_shoulder_and_neither_head_nor_hip() {
    let Some(path) = peer("bvh/rokoko_fingers_dance.bvh") else {
        return;
    };
    let source = format!("file:{}?protocol=bvh", path.display());
    let setup = setup("shoulder", "forward_mm: 250", Some(&source));
    let uri = source.parse().expect("a source");
    let mut opened = setup.open_source(&uri).expect("the file");
    let mut readings = Vec::new();
    loop {
        match opened.next().expect("a valid file") {
            SourceEvent::Reading(reading) => readings.push(reading),
            SourceEvent::End => break,
            _ => {}
        }
    }
    let poses = poses(&setup, readings);
    assert!(poses.len() > 10, "{} poses", poses.len());
    for pose in poses {
        let shoulder = pose.body.get(BodyPoint::Shoulder).expect("it is measured");
        let tip = pose.fingertip(Finger::Index).expect("it is measured");
        assert!(
            (0.3..1.1).contains(&shoulder.distance(tip)),
            "{shoulder} {tip}"
        );
        assert_eq!(pose.body.get(BodyPoint::Head), None);
        assert_eq!(pose.body.get(BodyPoint::Hip), None);
    }
}
