//! A webcam in the session of the page: lines of hand landmarks that arrive now.

use std::time::Duration;

use ademan_core::capture::protocol::hand_landmarks;
use ademan_core::document::Document;
use ademan_core::estimate::{Estimate, JointAngles};
use ademan_core::hand::{Dof, JointPositions, Side};
use ademan_core::kinematics::{ArmModel, BoneLengths, typing_angle};
use ademan_core::time::Timestamp;
use ademan_web::{HandState, PageSession};
use glam::DVec3;
use serde_json::Value;

const FORMAT: &str = "hand-landmarks?camera=head";
const FRAME: Duration = Duration::from_millis(33);

/// A person before a camera.
struct Webcam {
    session: PageSession,
    arm: ArmModel,
    time_us: u64,
}

impl Webcam {
    fn new(layout: &str) -> Self {
        let layout = Document::shipped(layout).expect("a shipped layout").text;
        let bones = BoneLengths::from_hand_and_forearm(0.19, 0.26).expect("human");
        Self {
            session: PageSession::new(&layout).expect("a valid layout"),
            arm: ArmModel::anthropometric(Side::Right, &bones).expect("an arm"),
            time_us: 40_000_000,
        }
    }

    /// Returns the hand in the typing posture, with the flexion of the index finger at its knuckle and of the fingers beyond theirs.
    fn hand(&self, index: f64, fingers: f64) -> Vec<(Side, JointPositions)> {
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL {
            let is_finger = dof.finger().is_some() && dof.name().contains("flexion");
            angles.set(
                dof,
                if is_finger {
                    fingers
                } else {
                    typing_angle(dof)
                },
            );
        }
        angles.set(Dof::ElbowFlexion, 0.0);
        for (dof, angle) in [
            (Dof::IndexMcpFlexion, index),
            (Dof::MiddleMcpFlexion, -0.4),
            (Dof::RingMcpFlexion, -0.4),
            (Dof::LittleMcpFlexion, -0.4),
        ] {
            angles.set(dof, angle);
        }
        let pose = self.arm.forward(&Estimate::new(Timestamp(0), angles));
        let mut positions = JointPositions::default();
        for (joint, joint_pose) in pose.known() {
            positions.set(
                joint,
                joint_pose.translation.as_dvec3() + DVec3::new(-0.2, 0.3, -0.1),
            );
        }
        vec![(Side::Right, positions)]
    }

    /// Shows hands for a number of images. Returns the objects.
    fn show(&mut self, hands: &[(Side, JointPositions)], images: usize) -> Vec<Value> {
        let mut objects = Vec::new();
        for _ in 0..images {
            self.time_us += 33_000;
            let line = hand_landmarks::encode(Some(self.time_us), hands);
            let pushed = self.session.push_live(FORMAT, line.as_bytes());
            pushed.expect("a protocol");
            objects.extend(self.wait(1));
        }
        objects
    }

    /// Waits for a number of images without one.
    fn wait(&mut self, images: usize) -> Vec<Value> {
        let lines: String = (0..images).map(|_| self.session.advance(FRAME)).collect();
        let object = |line| serde_json::from_str(line).expect("an object");
        lines.lines().map(object).collect()
    }

    /// Holds the hand open until the boards are placed.
    fn place(&mut self) -> Vec<Value> {
        self.session.place_under_hands();
        let open = self.hand(0.0, 0.0);
        self.show(&open, 40)
    }
}

fn events(objects: &[Value]) -> Vec<String> {
    let of_kind = objects.iter().filter(|it| it["kind"] == "events");
    let event = |it: &Value| it["event"].as_str().unwrap_or_default().to_owned();
    of_kind.map(event).collect()
}

fn last<'a>(objects: &'a [Value], kind: &str) -> &'a Value {
    let mut of_kind = objects.iter().filter(|it| it["kind"] == kind);
    of_kind.next_back().unwrap_or(&Value::Null)
}

/// Bends the index finger until it presses something. Returns the objects.
fn press(webcam: &mut Webcam) -> Vec<Value> {
    let mut objects = Vec::new();
    for step in 0..24 {
        let hand = webcam.hand(0.2 + 0.04 * f64::from(step), 0.45);
        objects.extend(webcam.show(&hand, 1));
        if events(&objects).contains(&"key-down".to_owned()) {
            return objects;
        }
    }
    panic!("nothing is pressed: {objects:?}");
}

#[test]
fn boards_are_put_under_a_hand_that_is_held_open_and_it_types() {
    let mut webcam = Webcam::new("qwerty-flat");
    let bent = webcam.hand(1.2, 1.2);
    webcam.session.place_under_hands();
    let waiting = webcam.show(&bent, 40);
    assert_eq!(last(&waiting, "live")["advice"], "stretch your fingers");
    assert_eq!(last(&waiting, "live")["is_placed"], false);
    let placed = webcam.place();
    assert_eq!(last(&placed, "live")["is_placed"], true, "{placed:?}");
    assert!(placed.iter().any(|it| it["kind"] == "layout"));
    assert_eq!(webcam.session.hand_state(), HandState::Followed);
    let pressed = press(&mut webcam);
    assert_eq!(
        webcam.session.text().chars().count(),
        1,
        "{:?}",
        events(&pressed)
    );
}

#[test]
fn a_hand_that_disappears_or_a_camera_that_stops_releases_all_keys() {
    let is_released = |objects: &[Value]| events(objects).contains(&"key-up".to_owned());
    let mut webcam = Webcam::new("qwerty-flat");
    webcam.place();
    press(&mut webcam);
    let lost = webcam.show(&[], 8);
    assert!(is_released(&lost), "the hand disappears: {lost:?}");

    let mut silent = Webcam::new("qwerty-flat");
    silent.place();
    press(&mut silent);
    assert!(is_released(&silent.wait(24)), "no more images arrive");

    let mut stopping = Webcam::new("qwerty-flat");
    stopping.place();
    press(&mut stopping);
    stopping.session.release();
    let stopped = stopping.wait(1);
    assert!(is_released(&stopped), "the camera is stopped: {stopped:?}");
    assert_eq!(last(&stopped, "live")["is_placed"], false);
    assert_eq!(stopping.session.type_text("a"), [], "the boards are back");
    stopping.wait(200);
    assert!(
        stopping.session.text().ends_with('a'),
        "{}",
        stopping.session.text()
    );
}

#[test]
fn an_edited_layout_stays_under_the_hand_and_options_are_checked() {
    let mut webcam = Webcam::new("qwerty-flat");
    webcam.place();
    let text = webcam
        .session
        .layout()
        .text
        .replace("name: \"", "name: \"My ");
    let lines = webcam.session.set_layout(&text);
    assert!(lines.contains("\"kind\":\"layout\""), "{lines}");
    press(&mut webcam);
    let wrong = webcam
        .session
        .push_live("hand-landmarks?mirrored=perhaps", b"");
    assert!(wrong.is_err_and(|it| it.contains("instead of `perhaps`")));
    let unknown = webcam.session.push_live("hand-landmarks?zoom=2", b"");
    assert!(unknown.is_err_and(|it| it.contains("no such option")));
}
