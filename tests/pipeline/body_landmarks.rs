//! Arms that a camera loses, and landmarks that show nothing.

use ademan::capture::body::BodyLandmarks;
use ademan::capture::{Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::estimate::{Estimator, EstimatorSettings, Rejection};
use ademan::hand::{Dof, Finger, FingerSet, Joint, Side};
use ademan::pipeline::PipelineState;
use ademan::setup::{OtherHand, Setup};
use ademan::time::Timestamp;
use parry3d::math::Vec3;

use crate::support::body::{Person, RATE_HZ, TWO_KEYS};
use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;

/// The time for which an arm that is not seen keeps its keys, in frames of the camera.
const HELD_FRAMES: usize = 3;

/// A person with two hands, each of which has one key.
struct Camera {
    pipeline: CheckedPipeline,
    frames: u64,
    keys: Vec<String>,
}

impl Camera {
    /// Creates a camera that sees both hands above their keys, with armed output.
    fn new() -> Self {
        let setup = Setup {
            source: Some(
                "file:body?protocol=body-landmarks"
                    .parse()
                    .expect("a source"),
            ),
            other_hand: Some(OtherHand::default()),
            ..Setup::default()
        };
        let setup = load_layout(TWO_KEYS, setup);
        let mut camera = Self {
            pipeline: CheckedPipeline::new(&setup),
            frames: 0,
            keys: Vec::new(),
        };
        camera.see(Person::new(), 12);
        assert_eq!(camera.pipeline.state(), PipelineState::Running);
        camera
    }

    /// Steps both hands with the landmarks of one frame. Returns the results by side.
    fn frame(&mut self, body: &BodyLandmarks) -> [Result<FingerSet, Rejection>; Side::COUNT] {
        self.frames += 1;
        [Side::Left, Side::Right].map(|side| {
            let reading = Reading::new(
                Timestamp::from_seconds(self.frames as f64 / RATE_HZ),
                Some(side),
                Sample::Body(body.clone()),
            );
            let mut events = Events::new();
            let outcome = self.pipeline.step(&reading, &mut events);
            let outcome = outcome.map(|output| output.pose.untrusted);
            for event in &events {
                match event.kind {
                    EventKind::KeyDown(key) => self.keys.push(format!("down {key}")),
                    EventKind::KeyUp(key) => self.keys.push(format!("up {key}")),
                    _ => {}
                }
            }
            outcome
        })
    }

    /// Steps a number of equal frames. Returns the presses and releases.
    fn see(&mut self, person: Person, frames: usize) -> Vec<String> {
        let body = person.landmarks();
        for _ in 0..frames {
            let outcomes = self.frame(&body);
            assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
        }
        std::mem::take(&mut self.keys)
    }

    /// Moves the right hand in frames of 3° each.
    fn move_right(&mut self, from: f64, to: f64) -> Vec<String> {
        let mut keys = Vec::new();
        for step in 0..=5 {
            let mut person = Person::new();
            person.elevations[Side::Right.index()] = from + (to - from) * f64::from(step) / 5.0;
            keys.extend(self.see(person, 1));
        }
        keys
    }
}

/// Returns a person whose arm of one side is not visible.
fn hidden(mut person: Person, side: Side) -> Person {
    person.confidences[side.index()] = 0.3;
    person
}

#[test]
fn an_arm_that_is_lost_releases_its_key_after_the_hold_time_and_the_other_hand_goes_on() {
    let mut camera = Camera::new();
    assert_eq!(camera.move_right(15.0, 0.0), ["down J"]);
    let mut pressing = Person::pressing(Side::Right);
    let hiding = hidden(pressing, Side::Right);
    assert!(camera.see(hiding, HELD_FRAMES).is_empty(), "held");
    assert_eq!(camera.see(hiding, 1), ["up J"], "lost");
    assert!(camera.see(hiding, 30).is_empty());
    assert_eq!(camera.pipeline.state(), PipelineState::Running);

    pressing.elevations[Side::Left.index()] = 8.0;
    camera.see(hidden(pressing, Side::Right), 1);
    pressing.elevations[Side::Left.index()] = 0.0;
    assert_eq!(camera.see(hidden(pressing, Side::Right), 2), ["down F"]);
    pressing.elevations[Side::Left.index()] = 15.0;
    assert_eq!(camera.see(hidden(pressing, Side::Right), 2), ["up F"]);
}

#[test]
fn an_arm_that_comes_back_on_its_key_presses_it_only_after_it_has_left_it() {
    let mut camera = Camera::new();
    assert_eq!(camera.move_right(15.0, 0.0), ["down J"]);
    let pressing = Person::pressing(Side::Right);
    assert_eq!(camera.see(hidden(pressing, Side::Right), 20), ["up J"]);
    assert!(camera.see(pressing, 20).is_empty(), "on the key");
    assert!(camera.move_right(0.0, 15.0).is_empty());
    assert_eq!(camera.move_right(15.0, 0.0), ["down J"]);
}

#[test]
fn a_short_occlusion_keeps_the_key() {
    let mut camera = Camera::new();
    assert_eq!(camera.move_right(15.0, 0.0), ["down J"]);
    let pressing = Person::pressing(Side::Right);
    assert!(camera.see(hidden(pressing, Side::Right), 2).is_empty());
    assert!(camera.see(pressing, 5).is_empty());
    assert_eq!(camera.move_right(0.0, 15.0), ["up J"]);
}

#[test]
fn landmarks_that_show_no_arm_are_rejected_with_their_reason() {
    let mut camera = Camera::new();
    let right = |filmed: &mut Camera, body: &BodyLandmarks| {
        let [left, right] = filmed.frame(body);
        assert!(left.is_ok() || left == right, "{left:?}");
        right
    };
    let mut collapsed = Person::new().landmarks();
    let first = collapsed.points[0];
    collapsed.points.iter_mut().for_each(|point| *point = first);
    assert_eq!(right(&mut camera, &collapsed), Err(Rejection::Collapsed));
    let mut folded = Person::new().landmarks();
    folded.points[16] = folded.points[12];
    assert_eq!(right(&mut camera, &folded), Err(Rejection::Collapsed));
    let mut not_finite = Person::new().landmarks();
    not_finite.points[20].position[1] = f32::NAN;
    assert_eq!(right(&mut camera, &not_finite), Err(Rejection::NotFinite));
    let mut short = Person::new().landmarks();
    short.points.pop();
    assert_eq!(right(&mut camera, &short), Err(Rejection::WrongShape));
    let unseen = BodyLandmarks::default();
    assert_eq!(right(&mut camera, &unseen), Err(Rejection::WrongShape));
}

#[test]
fn the_path_of_an_arm_that_was_lost_is_unknown() {
    let mut estimator = Estimator::new(EstimatorSettings::default());
    let mut frames = 0;
    let mut jumped = |person: Person| {
        frames += 1;
        let reading = Reading::new(
            Timestamp::from_seconds(f64::from(frames) / RATE_HZ),
            Some(Side::Right),
            Sample::Body(person.landmarks()),
        );
        estimator.update(&reading).expect("an arm").jumped
    };
    let person = Person::new();
    assert!(!jumped(person));
    for _ in 0..HELD_FRAMES {
        assert!(!jumped(hidden(person, Side::Right)));
    }
    assert!(!jumped(person), "seen again within the hold time");
    for _ in 0..=HELD_FRAMES {
        jumped(hidden(person, Side::Right));
    }
    assert!(jumped(person));
    assert!(!jumped(person));
}

#[test]
fn an_arm_that_was_never_seen_has_no_pose() {
    let mut estimator = Estimator::new(EstimatorSettings::default());
    let reading = Reading::new(
        Timestamp(1_000),
        Some(Side::Right),
        Sample::Body(hidden(Person::new(), Side::Right).landmarks()),
    );
    assert_eq!(
        estimator.update(&reading).err(),
        Some(Rejection::LowConfidence)
    );
}

#[test]
fn the_joints_are_where_the_camera_sees_them_in_the_frame_of_the_body() {
    let mut person = Person::new();
    person.elevations = [0.0; Side::COUNT];
    for (number, (side, inwards)) in [(Side::Left, 1.0), (Side::Right, -1.0)]
        .into_iter()
        .enumerate()
    {
        let mut estimator = Estimator::new(EstimatorSettings::default());
        let reading = Reading::new(
            Timestamp(1_000 + number as u64),
            Some(side),
            Sample::Body(person.landmarks()),
        );
        let estimate = estimator.update(&reading).expect("an arm");
        for (joint, expected) in [
            (Joint::Shoulder, Vec3::ZERO),
            (Joint::Elbow, Vec3::new(0.0, -0.3, 0.0)),
            (Joint::Wrist, Vec3::new(0.0, -0.3, -0.25)),
            (
                Joint::tip(Finger::Index),
                Vec3::new(0.03 * inwards, -0.3, -0.34),
            ),
        ] {
            let position = estimate.measured.get(joint).expect("a position");
            assert!(
                position.distance(expected) < 1e-5,
                "{side} {joint}: {position}"
            );
        }
        let degrees = |dof| estimate.angles.get(dof).to_degrees();
        assert!((degrees(Dof::ElbowFlexion) - 90.0).abs() < 0.1);
        assert!(degrees(Dof::ForearmSupination).abs() < 0.1);
        let unseen = [Finger::Middle, Finger::Ring];
        assert_eq!(
            estimate.untrusted,
            unseen.into_iter().fold(FingerSet::NONE, FingerSet::with)
        );
    }
}
